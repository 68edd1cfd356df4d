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

/* Up to so many rays go on alone. On trial twice as many, of 16: how many do so tells rays that go
 * together from those that fall apart. */
#define PACKET_ALONE 1
#define PACKET_ALONE_TRIAL (LANES / 8)
/* From so many rays on it pays to ask first which triangles any of them may hit. */
#define PACKET_FILTER (LANES / 2)
/* Subtrees that wait, at most: enough to have work while memory is on its way, few enough that
 * what is met there still cuts off what the packet would visit next. */
#define PACKET_TASKS STREAM_RAYS

/* Between which values the rays of a packet, or of several, lie. */
typedef struct {
    float t_min_least;
    float near_origin[3], far_origin[3], inverse_from[3], inverse_to[3];
    /* origin and shear along axis[]: middle and half width */
    float middle[3], width[3], shear_middle[2], shear_width[2];
} Range;

typedef struct {
    /* of each ray, as in Probe; origin and shear along axis[] */
    Floats   inverse[3], near_add[3], far_add[3], t_min, limit, origin[3], shear[2], reach;
    Floats   size; /* of the direction along axis[2] */
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
    bool     ranged;      /* `range` is filled in: of a packet in a team only when needed */
    Range    range;
    Floats   margin[3];
    /* subtrees that few rays reach wait here until there are enough to be walked in turns */
    unsigned probes;      /* lanes whose walker has its probe */
    unsigned waiting;     /* lanes with something to visit */
    unsigned tasks, alone; /* subtrees that wait; all that ever waited */
    int      few;         /* up to so many rays go on alone */
    Walker   walker[LANES];
} Packet;

/* The rays as they come: field by field. */
typedef struct {
    Floats     field[8]; /* o x y z, t_min, d x y z, t_max */
    const Ray *ray[LANES];
} Bundle;

/* --- into the packet ------------------------------------------------------------------------- */

/* Least and most of all values of lanes[i] in packet[i] at `field`. */
LANES_INLINE void packets_ends(const Packet *packet, const unsigned *lanes, unsigned count,
                               size_t field, float *least, float *most)
{
    Floats from = floats_all(INFINITY), to = -from;
    for (unsigned i = 0; i < count; i++) {
        const Floats x = *(const Floats *)(const void *)((const char *)&packet[i] + field);
        from = floats_min(from, floats_pick(lanes[i], x, from));
        to = floats_max(to, floats_pick(lanes[i], x, to));
    }
    *least = floats_least(from);
    *most = floats_most(to);
}

/* The ranges of `lanes` of `count` packets of one kind. */
LANES_INLINE void packets_range(const Packet *packet, const unsigned *lanes, unsigned count,
                                Range *r)
{
    float most;
    for (unsigned k = 0; k < 3; k++) {
        const unsigned axis = (unsigned)packet->axis[k];
        float from, to, margin;
        packets_ends(packet, lanes, count, offsetof(Packet, origin) + k * sizeof(Floats), &from,
                     &to);
        packets_ends(packet, lanes, count, offsetof(Packet, margin) + axis * sizeof(Floats),
                     &most, &margin);
        from -= margin;
        to += margin;
        const bool negative = packet->octant >> axis & 1;
        r->near_origin[axis] = negative ? from : to;
        r->far_origin[axis] = negative ? to : from;
        r->middle[k] = 0.5f * (from + to);
        r->width[k] = 0.5f * (to - from);
        packets_ends(packet, lanes, count, offsetof(Packet, inverse) + k * sizeof(Floats),
                     &r->inverse_from[k], &r->inverse_to[k]);
    }
    packets_ends(packet, lanes, count, offsetof(Packet, t_min), &r->t_min_least, &most);
    for (unsigned k = 0; k < 2; k++) {
        float from, to;
        packets_ends(packet, lanes, count, offsetof(Packet, shear) + k * sizeof(Floats), &from,
                     &to);
        r->shear_middle[k] = 0.5f * (from + to);
        r->shear_width[k] = 0.5f * (to - from);
    }
}

/* probe_init for all lanes; those of other kinds may come out as anything. */
LANES_INLINE void packet_init(Packet *p, const Bvh *bvh, const Bundle *b)
{
    Floats o[3], d[3], reach[3];
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
        p->margin[k] = floats_all(PROBE_MARGIN) * (floats_abs(o[k]) + reach[k] + reach[z]);
        const Floats wider = p->margin[k] * floats_abs(p->inverse[k]), at = o[k] * p->inverse[k];
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
    p->reach = floats_all(BEST_GRADIENT) * (p->margin[0] + p->margin[1] + p->margin[2])
               * floats_abs(p->inverse[z]);
    p->ranged = false;
    p->size = floats_abs(d[z]);

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
