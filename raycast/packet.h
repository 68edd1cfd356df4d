/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/packet.h -- as many rays as a register has lanes, through the tree together.
 *
 * Included after lanes_*.h, trace.h and single_avx2.h. The rays of a packet have one major axis and
 * the same signs of direction; rays of several kinds are traced kind by kind under a mask. A node's
 * 8 boxes are first tested at once against the box of all origins and directions of the packet,
 * then those that are left one by one against all rays. Subtrees that few rays reach are walked by
 * each of them alone. Hits are decided with the same operations as in probe.h, lane by lane, so
 * they are the same bits.
 */
#ifndef RAYCAST_PACKET_H
#define RAYCAST_PACKET_H

#include "raycast/sort.h"

/* Up to so many rays go on alone: then a node costs a packet more than the rays. */
#define PACKET_ALONE (LANES / 8)
/* From so many rays on it pays to ask first which triangles any of them may hit. */
#define PACKET_FILTER (LANES / 2)
/* Subtrees that wait, at most: enough to have work while memory is on its way, few enough that
 * what is met there still cuts off what the packet would visit next. */
#define PACKET_TASKS STREAM_RAYS

/* Rays are tried in packets at the start of each stretch. A subtree walked alone costs a ray about
 * what it would cost without the packet; from one and a half of them the packet is in vain. */
#define STRETCH 4096u
#define STRETCH_TRIAL 256u
#define STRETCH_ALONE (STRETCH_TRIAL * 3 / 2)

typedef struct {
    /* of each ray, as in Probe; origin and shear along axis[] */
    Floats   inverse[3], near_add[3], far_add[3], t_min, limit, origin[3], shear[2], reach;
    Doubles  inverse_z[2];
    /* Best, lane by lane */
    Floats   t, u, v, facing_t, facing_u, facing_v;
    Words    key, place, facing_key, facing_place;
    unsigned front, back; /* lanes whose first hit faces its ray, and does not */
    unsigned blocked;     /* lanes that are done when any hit will do */
    /* what all rays have in common */
    unsigned octant;
    int      axis[3];
    bool     backward;    /* directions along axis[2] are negative */
    float    t_min_least;
    float    near_origin[3], far_origin[3], inverse_from[3], inverse_to[3];
    /* origin and shear along axis[]: middle and half width of their ranges */
    float    middle[3], width[3], shear_middle[2], shear_width[2];
    /* subtrees that few rays reach wait here until there are enough to be walked in turns */
    unsigned probes;      /* lanes whose walker has its probe */
    unsigned waiting;     /* lanes with something to visit */
    unsigned tasks, alone; /* subtrees that wait; all that ever waited */
    Walker   walker[LANES];
} Packet;

/* The rays as they come: field by field. */
typedef struct {
    Floats     field[8]; /* o x y z, t_min, d x y z, t_max */
    const Ray *ray[LANES];
} Bundle;

/* --- into the packet ------------------------------------------------------------------------- */

/* Lanes of `lanes` in the range of all of them. */
LANES_INLINE void packet_bounds(Packet *p, unsigned lanes, const Floats o[3],
                                const Floats margin[3])
{
    const Floats none = floats_all(INFINITY);
    for (int k = 0; k < 3; k++) {
        const Floats low = o[k] - margin[k], high = o[k] + margin[k];
        const float from = floats_least(floats_pick(lanes, low, none));
        const float to = floats_most(floats_pick(lanes, high, -none));
        const bool negative = p->octant >> k & 1;
        p->near_origin[k] = negative ? from : to;
        p->far_origin[k] = negative ? to : from;
        p->inverse_from[k] = floats_least(floats_pick(lanes, p->inverse[k], none));
        p->inverse_to[k] = floats_most(floats_pick(lanes, p->inverse[k], -none));
    }
    p->t_min_least = floats_least(floats_pick(lanes, p->t_min, none));
    for (int k = 0; k < 3; k++) {
        const float a = p->near_origin[p->axis[k]], b = p->far_origin[p->axis[k]];
        p->middle[k] = 0.5f * (a + b);
        p->width[k] = 0.5f * fabsf(a - b);
    }
    for (int k = 0; k < 2; k++) {
        const float a = floats_least(floats_pick(lanes, p->shear[k], none));
        const float b = floats_most(floats_pick(lanes, p->shear[k], -none));
        p->shear_middle[k] = 0.5f * (a + b);
        p->shear_width[k] = 0.5f * (b - a);
    }
}

/* probe_init for all lanes; those not in `lanes` may come out as anything. */
LANES_INLINE void packet_init(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes)
{
    Floats o[3], d[3], reach[3], margin[3];
    for (int k = 0; k < 3; k++) {
        o[k] = b->field[k];
        d[k] = b->field[4 + k];
        reach[k] = floats_max(floats_abs(floats_all(bvh->lo[k]) - o[k]),
                              floats_abs(floats_all(bvh->hi[k]) - o[k]));
    }
    const int x = p->axis[0], y = p->axis[1], z = p->axis[2];
    const Floats smallest = floats_abs(d[z]) * floats_all(PROBE_SMALLEST_SLOPE);
    const Floats one = floats_all(1);
    for (int k = 0; k < 3; k++) {
        const Floats size = floats_max(floats_abs(d[k]), smallest);
        p->inverse[k] = floats_sign_of(one / size, d[k]);
        margin[k] = floats_all(PROBE_MARGIN) * (floats_abs(o[k]) + reach[k] + reach[z]);
        const Floats wider = margin[k] * floats_abs(p->inverse[k]), at = o[k] * p->inverse[k];
        p->near_add[k] = -at - wider;
        p->far_add[k] = wider - at;
    }
    p->t_min = b->field[3];
    p->origin[0] = o[x];
    p->origin[1] = o[y];
    p->origin[2] = o[z];
    p->shear[0] = d[x] * p->inverse[z];
    p->shear[1] = d[y] * p->inverse[z];
    for (int half = 0; half < 2; half++)
        p->inverse_z[half] = doubles_all(1) / doubles_of(d[z], half);
    p->reach = floats_all(BEST_GRADIENT) * (margin[0] + margin[1] + margin[2])
               * floats_abs(p->inverse[z]);
    packet_bounds(p, lanes, o, margin);

    const Floats none = floats_all(0);
    p->t = p->facing_t = p->limit = b->field[7];
    p->u = p->v = p->facing_u = p->facing_v = none;
    p->key = p->facing_key = words_all(0);
    p->place = p->facing_place = words_all(BEST_NOWHERE);
    p->front = p->back = p->blocked = p->probes = p->waiting = p->tasks = p->alone = 0;
}

/* --- one ray of the packet alone ------------------------------------------------------------- */

#define LANE_OF(member, type, lane) (((const type *)(const void *)&(member))[lane])
#define LANE_SET(member, type, lane, value) (((type *)(void *)&(member))[lane] = (value))

LANES_INLINE Best packet_best(const Packet *p, unsigned lane)
{
    return (Best){
        .limit = LANE_OF(p->limit, float, lane),
        .first = { LANE_OF(p->t, float, lane), LANE_OF(p->u, float, lane),
                   LANE_OF(p->v, float, lane), LANE_OF(p->key, uint32_t, lane),
                   LANE_OF(p->place, uint32_t, lane) },
        .facing = { LANE_OF(p->facing_t, float, lane), LANE_OF(p->facing_u, float, lane),
                    LANE_OF(p->facing_v, float, lane), LANE_OF(p->facing_key, uint32_t, lane),
                    LANE_OF(p->facing_place, uint32_t, lane) } };
}

LANES_INLINE void packet_take(Packet *p, unsigned lane, const Best *best)
{
    LANE_SET(p->limit, float, lane, best->limit);
    LANE_SET(p->t, float, lane, best->first.t);
    LANE_SET(p->u, float, lane, best->first.u);
    LANE_SET(p->v, float, lane, best->first.v);
    LANE_SET(p->key, uint32_t, lane, best->first.key);
    LANE_SET(p->place, uint32_t, lane, best->first.place);
    LANE_SET(p->facing_t, float, lane, best->facing.t);
    LANE_SET(p->facing_u, float, lane, best->facing.u);
    LANE_SET(p->facing_v, float, lane, best->facing.v);
    LANE_SET(p->facing_key, uint32_t, lane, best->facing.key);
    LANE_SET(p->facing_place, uint32_t, lane, best->facing.place);
    const unsigned bit = 1u << lane;
    p->front &= ~bit;
    p->back &= ~bit;
    if (best_found(best))
        *(best->first.key & BEST_BACK ? &p->back : &p->front) |= bit;
}

/* What probe_init would make for this lane, but for what only best_choose asks for. */
LANES_INLINE void packet_probe(Packet *p, unsigned lane, const Ray *ray)
{
    Walker *w = &p->walker[lane];
    Probe *probe = &w->probe;
    w->ray = ray;
    for (int k = 0; k < 3; k++) {
        probe->inverse[k] = LANE_OF(p->inverse[k], float, lane);
        probe->near_add[k] = LANE_OF(p->near_add[k], float, lane);
        probe->far_add[k] = LANE_OF(p->far_add[k], float, lane);
        probe->origin[k] = LANE_OF(p->origin[k], float, lane);
        probe->axis[k] = p->axis[k];
    }
    probe->t_min = LANE_OF(p->t_min, float, lane);
    probe->t_max = ray->t_max;
    probe->shear[0] = LANE_OF(p->shear[0], float, lane);
    probe->shear[1] = LANE_OF(p->shear[1], float, lane);
    probe->inverse_z = LANE_OF(p->inverse_z, double, lane);
    probe->reach = LANE_OF(p->reach, float, lane);
    probe->octant = p->octant;
}

/* Walks the subtrees that wait, ray by ray in turns. */
static __attribute__((noinline)) void packet_walk_alone(Packet *p, const Bvh *bvh, const Bundle *b,
                                                        bool any)
{
    unsigned lane[LANES], walking = 0;
    for (unsigned left = p->waiting; left != 0; left &= left - 1) {
        const unsigned i = (unsigned)__builtin_ctz(left), bit = 1u << i;
        Walker *w = &p->walker[i];
        if ((p->probes & bit) == 0)
            packet_probe(p, i, b->ray[i]);
        p->probes |= bit;
        w->best = any ? best_none(LANE_OF(p->t, float, i)) : packet_best(p, i);
        /* They came near ones first: the stack has those on top. */
        for (uint32_t from = 0, to = w->top - 1; from < to; from++, to--) {
            const uint32_t child = w->child[from];
            const float near = w->near[from];
            w->child[from] = w->child[to];
            w->near[from] = w->near[to];
            w->child[to] = child;
            w->near[to] = near;
        }
        if (walker_pop(w, bvh, any))
            lane[walking++] = i;
        else
            w->top = 0;
    }
    p->waiting = p->tasks = 0;
    while (walking > 0)
        for (unsigned k = 0; k < walking; k++) {
            const unsigned i = lane[k];
            Walker *w = &p->walker[i];
            if (walker_step(w, bvh, any))
                continue;
            w->top = 0;
            if (!any) {
                packet_take(p, i, &w->best);
            } else if (best_found(&w->best)) {
                p->blocked |= 1u << i;
                LANE_SET(p->limit, float, i, -INFINITY);
            }
            lane[k--] = lane[--walking];
        }
}

/* The subtree below `child` is for each of `lanes` alone. */
LANES_INLINE void packet_alone(Packet *p, const Bvh *bvh, const Bundle *b, uint32_t child,
                               const Floats *near, unsigned lanes, bool any)
{
    child_prefetch(bvh, child);
    for (; lanes != 0; lanes &= lanes - 1) {
        const unsigned i = (unsigned)__builtin_ctz(lanes), bit = 1u << i;
        Walker *w = &p->walker[i];
        if ((p->waiting & bit) == 0)
            w->top = 0;
        p->waiting |= bit;
        w->near[w->top] = LANE_OF(*near, float, i);
        w->child[w->top++] = child;
        p->alone++;
        if (++p->tasks == PACKET_TASKS)
            packet_walk_alone(p, bvh, b, any);
    }
}

#endif
