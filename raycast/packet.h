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
#define PACKET_ALONE (LANES / 4)
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

static __attribute__((noinline)) Best packet_best(const Packet *p, unsigned lane)
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

static __attribute__((noinline)) void packet_take(Packet *p, unsigned lane, const Best *best)
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

/* Walks the subtrees that wait, ray by ray in turns. */
static __attribute__((noinline)) void packet_walk_alone(Packet *p, const Bvh *bvh, const Bundle *b,
                                                        bool any)
{
    unsigned lane[LANES], walking = 0;
    for (unsigned left = p->waiting; left != 0; left &= left - 1) {
        const unsigned i = (unsigned)__builtin_ctz(left), bit = 1u << i;
        Walker *w = &p->walker[i];
        if ((p->probes & bit) == 0) {
            w->ray = b->ray[i];
            probe_init(&w->probe, w->ray, bvh->lo, bvh->hi);
            p->probes |= bit;
        }
        w->best = packet_best(p, i);
        /* They came near ones first: the stack has those on top. */
        for (uint32_t from = 0, to = w->top - 1; from < to; from++, to--) {
            const uint32_t child = w->child[from];
            const float near = w->near[from];
            w->child[from] = w->child[to];
            w->near[from] = w->near[to];
            w->child[to] = child;
            w->near[to] = near;
        }
        if (walker_pop(w, bvh))
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

/* --- triangles ------------------------------------------------------------------------------- */

/* best_offer for the lanes of `ok`, whose hits are at t > t_min and within the limit. */
LANES_INLINE void packet_offer(Packet *p, unsigned ok, unsigned back, uint32_t primitive,
                               uint32_t place, Floats t, Floats u, Floats v)
{
    const Words key = words_pick(back, words_all(primitive | BEST_BACK), words_all(primitive));
    unsigned before = floats_less(t, p->t);
    const unsigned same = floats_equal(t, p->t) & ok;
    if (__builtin_expect(same != 0, 0))
        before |= same & words_less(key, p->key);
    before &= ok;
    const unsigned displaced = before & back & p->front;
    if (displaced != 0) {
        p->facing_t = floats_pick(displaced, p->t, p->facing_t);
        p->facing_u = floats_pick(displaced, p->u, p->facing_u);
        p->facing_v = floats_pick(displaced, p->v, p->facing_v);
        p->facing_key = words_pick(displaced, p->key, p->facing_key);
        p->facing_place = words_pick(displaced, p->place, p->facing_place);
    }
    unsigned second = ok & ~before & ~back & p->back;
    if (second != 0) {
        second &= floats_less(t, p->facing_t)
                  | (floats_equal(t, p->facing_t) & words_less(key, p->facing_key));
        p->facing_t = floats_pick(second, t, p->facing_t);
        p->facing_u = floats_pick(second, u, p->facing_u);
        p->facing_v = floats_pick(second, v, p->facing_v);
        p->facing_key = words_pick(second, key, p->facing_key);
        p->facing_place = words_pick(second, words_all(place), p->facing_place);
    }
    p->t = floats_pick(before, t, p->t);
    p->u = floats_pick(before, u, p->u);
    p->v = floats_pick(before, v, p->v);
    p->key = words_pick(before, key, p->key);
    p->place = words_pick(before, words_all(place), p->place);
    p->front = (p->front & ~before) | (before & ~back);
    p->back = (p->back & ~before) | (before & back);
    p->limit = floats_pick(before, p->t, p->limit);
    if (p->back != 0)
        p->limit = floats_pick(p->back & (before | second),
                               floats_min(p->t + p->reach, p->facing_t), p->limit);
}

/* The three corners as the rays see them. */
typedef struct {
    Floats x[3], y[3], z[3];
} Seen;

/* What the float filter lets through is decided in double: probe_triangle, operation by operation.
 * Halves of the packet without candidates are left out. */
LANES_INLINE void packet_decide(Packet *p, const Seen *s, unsigned lanes, uint32_t primitive,
                                uint32_t place, bool any)
{
    Doubles td[2], ud[2], vd[2];
    unsigned one_sign = 0, back = 0;
    const Doubles zero = doubles_all(0);
    for (int half = 0; half < 2; half++) {
        td[half] = ud[half] = vd[half] = zero;
        if ((lanes >> half * (int)(LANES / 2) & ((1u << LANES / 2) - 1)) == 0)
            continue;
        const Doubles ax = doubles_of(s->x[0], half), ay = doubles_of(s->y[0], half);
        const Doubles bx = doubles_of(s->x[1], half), by = doubles_of(s->y[1], half);
        const Doubles cx = doubles_of(s->x[2], half), cy = doubles_of(s->y[2], half);
        const Doubles a = cx * by - cy * bx, b = ax * cy - ay * cx, c = bx * ay - by * ax;
        const Doubles sum = a + b + c, scale = doubles_all(1) / sum;
        const unsigned sign = doubles_less_equal(zero, doubles_min(doubles_min(a, b), c))
                              | doubles_less_equal(doubles_max(doubles_max(a, b), c), zero);
        one_sign |= sign << half * (int)(LANES / 2);
        back |= doubles_less_equal(sum, zero) << half * (int)(LANES / 2);
        const Doubles depth = a * doubles_of(s->z[0], half) + b * doubles_of(s->z[1], half)
                              + c * doubles_of(s->z[2], half);
        td[half] = depth * scale * p->inverse_z[half];
        ud[half] = b * scale;
        vd[half] = c * scale;
    }
    const Floats t = floats_of(td[0], td[1]);
    /* Without area t is NaN and out of range. */
    const unsigned ok = lanes & one_sign & floats_less(p->t_min, t)
                        & floats_less_equal(t, p->limit);
    if (ok == 0)
        return;
    if (any) {
        const unsigned done = ok & floats_less(t, p->t);
        p->blocked |= done;
        p->limit = floats_pick(done, floats_all(-INFINITY), p->limit);
        return;
    }
    packet_offer(p, ok, p->backward ? ~back : back, primitive, place, t, floats_of(ud[0], ud[1]),
                 floats_of(vd[0], vd[1]));
}

LANES_INLINE void packet_triangle(Packet *p, const TriangleGroup *group, unsigned i,
                                  uint32_t place, unsigned lanes, bool any)
{
    Seen s;
    for (int c = 0; c < 3; c++) {
        const Floats x = floats_all(group->vertex[c][p->axis[0]][i]) - p->origin[0];
        const Floats y = floats_all(group->vertex[c][p->axis[1]][i]) - p->origin[1];
        s.z[c] = floats_all(group->vertex[c][p->axis[2]][i]) - p->origin[2];
        s.x[c] = x - p->shear[0] * s.z[c];
        s.y[c] = y - p->shear[1] * s.z[c];
    }
    const Floats a = s.x[2] * s.y[1] - s.y[2] * s.x[1];
    const Floats b = s.x[0] * s.y[2] - s.y[0] * s.x[2];
    const Floats c = s.x[1] * s.y[0] - s.y[1] * s.x[0];
    const Floats zero = floats_all(0);
    lanes &= floats_less_equal(zero, floats_min(floats_min(a, b), c))
             | floats_less_equal(floats_max(floats_max(a, b), c), zero);
    if (lanes != 0)
        packet_decide(p, &s, lanes, group->primitive[i], place + i, any);
}

LANES_INLINE void packet_leaf(Packet *p, const Bvh *bvh, uint32_t leaf, unsigned lanes, bool any)
{
    const uint32_t begin = child_group(leaf), end = begin + child_group_count(leaf);
    for (uint32_t g = begin; g < end; g++) {
        const TriangleGroup *group = &bvh->group[g];
        for (unsigned i = 0; i < GROUP_WIDTH && group->primitive[i] != RAY_MISS; i++)
            packet_triangle(p, group, i, g * GROUP_WIDTH, any ? lanes & ~p->blocked : lanes, any);
    }
}

/* --- nodes ----------------------------------------------------------------------------------- */

/* Bits of the slots that any ray of the packet may reach, in the order of visits: bit 7 first. */
LANES_INLINE unsigned packet_slots(const Packet *p, const Node *node, float t_limit)
{
    __m256 t0 = _mm256_set1_ps(p->t_min_least), t1 = _mm256_set1_ps(t_limit);
    for (unsigned k = 0; k < 3; k++) {
        const unsigned negative = p->octant >> k & 1;
        const __m256 from = _mm256_set1_ps(p->inverse_from[k]);
        const __m256 to = _mm256_set1_ps(p->inverse_to[k]);
        const __m256 a = _mm256_sub_ps(_mm256_load_ps(node->plane[2 * k + negative]),
                                       _mm256_set1_ps(p->near_origin[k]));
        const __m256 b = _mm256_sub_ps(_mm256_load_ps(node->plane[2 * k + 1 - negative]),
                                       _mm256_set1_ps(p->far_origin[k]));
        t0 = _mm256_max_ps(t0, _mm256_min_ps(_mm256_mul_ps(a, from), _mm256_mul_ps(a, to)));
        t1 = _mm256_min_ps(t1, _mm256_max_ps(_mm256_mul_ps(b, from), _mm256_mul_ps(b, to)));
    }
    unsigned slots = (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(t0, t1, _CMP_LE_OQ));
    if (p->octant & 1)
        slots = (slots & 0xaa) >> 1 | (slots & 0x55) << 1;
    if (p->octant & 2)
        slots = (slots & 0xcc) >> 2 | (slots & 0x33) << 2;
    if (p->octant & 4)
        slots = (slots & 0xf0) >> 4 | (slots & 0x0f) << 4;
    return slots;
}

typedef struct {
    Floats   near[BVH_STACK]; /* NaN in lanes that do not go there: no limit is behind it */
    uint32_t child[BVH_STACK];
    uint32_t top;
} PacketStack;

/* Pushes the children that rays of `lanes` reach, far ones first. */
LANES_INLINE void packet_push(const Packet *p, const Bvh *bvh, const Node *node, unsigned lanes,
                              PacketStack *stack)
{
    const Floats outside = floats_all(NAN);
    const float most = floats_most(floats_pick(lanes, p->limit, floats_all(-INFINITY)));
    unsigned slots = packet_slots(p, node, most);
    Floats inverse[3], near_add[3], far_add[3];
    for (int k = 0; k < 3; k++) {
        inverse[k] = p->inverse[k];
        near_add[k] = p->near_add[k];
        far_add[k] = p->far_add[k];
    }
    const unsigned nx = p->octant & 1, ny = p->octant >> 1 & 1, nz = p->octant >> 2 & 1;
    for (; slots != 0; slots &= slots - 1) {
        const unsigned s = (unsigned)__builtin_ctz(slots) ^ p->octant;
        const Floats x0 = floats_fused(floats_all(node->plane[nx][s]), inverse[0], near_add[0]);
        const Floats y0 = floats_fused(floats_all(node->plane[2 + ny][s]), inverse[1], near_add[1]);
        const Floats z0 = floats_fused(floats_all(node->plane[4 + nz][s]), inverse[2], near_add[2]);
        const Floats x1 = floats_fused(floats_all(node->plane[1 - nx][s]), inverse[0], far_add[0]);
        const Floats y1 = floats_fused(floats_all(node->plane[3 - ny][s]), inverse[1], far_add[1]);
        const Floats z1 = floats_fused(floats_all(node->plane[5 - nz][s]), inverse[2], far_add[2]);
        const Floats t0 = floats_max(floats_max(x0, y0), floats_max(z0, p->t_min));
        const Floats t1 = floats_min(floats_min(x1, y1), floats_min(z1, p->limit));
        const unsigned hit = floats_less_equal(t0, t1) & lanes;
        stack->near[stack->top] = floats_pick(hit, t0, outside);
        stack->child[stack->top] = node->child[s];
        stack->top += hit != 0;
        if (hit != 0)
            child_prefetch(bvh, node->child[s]);
    }
}

LANES_INLINE void packet_walk(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes, bool any)
{
    PacketStack stack;
    stack.top = 1;
    stack.child[0] = 0;
    stack.near[0] = floats_pick(lanes, p->t_min, floats_all(NAN));
    while (stack.top > 0 || p->tasks > 0) {
        if (stack.top == 0) {
            packet_walk_alone(p, bvh, b, any);
            continue;
        }
        stack.top--;
        /* Not <: an equally near hit that comes before may be in there. */
        unsigned here = floats_less_equal(stack.near[stack.top], p->limit);
        if (any)
            here &= ~p->blocked;
        const uint32_t child = stack.child[stack.top];
        if (here == 0)
            continue;
        if ((unsigned)__builtin_popcount(here) <= PACKET_ALONE || child_is_shape(child))
            packet_alone(p, bvh, b, child, &stack.near[stack.top], here, any);
        else if (child_is_leaf(child))
            packet_leaf(p, bvh, child, here, any);
        else
            packet_push(p, bvh, &bvh->node[child], here, &stack);
        if (any && (lanes & ~p->blocked) == 0)
            return;
    }
}

/* --- many rays ------------------------------------------------------------------------------- */

/* Lanes like lane `first`: the same major axis and signs; sets those in *p. */
LANES_INLINE unsigned packet_kind(Packet *p, const Bundle *b, unsigned lanes)
{
    const unsigned first = (unsigned)__builtin_ctz(lanes);
    const Floats d[3] = { b->field[4], b->field[5],
                          b->field[6] };
    p->octant = 0;
    unsigned alike = lanes;
    for (unsigned k = 0; k < 3; k++) {
        const unsigned negative = floats_signs(d[k]);
        p->octant |= (negative >> first & 1) << k;
        alike &= negative >> first & 1 ? negative : ~negative;
    }
    /* As probe_init chooses the axis. */
    const Floats x = floats_abs(d[0]), y = floats_abs(d[1]), z = floats_abs(d[2]);
    const unsigned yx = floats_less(y, x), zx = floats_less(z, x), zy = floats_less(z, y);
    const unsigned on[3] = { yx & zx, ~yx & zy, ~((yx & zx) | (~yx & zy)) };
    const int axis = on[0] >> first & 1 ? 0 : on[1] >> first & 1 ? 1 : 2;
    p->axis[2] = axis;
    p->axis[0] = axis == 2 ? 0 : axis + 1;
    p->axis[1] = p->axis[0] == 2 ? 0 : p->axis[0] + 1;
    p->backward = p->octant >> axis & 1;
    return alike & on[axis];
}

/* Returns the lanes that probe_init can take and that have a range at all. */
LANES_INLINE unsigned bundle_fill(Bundle *b, const Ray *ray, const uint32_t *order, size_t count)
{
    for (unsigned i = 0; i < LANES; i++) {
        const size_t at = i < count ? i : 0;
        b->ray[i] = &ray[order != NULL ? order[at] : at];
    }
    floats_fields((const float *const *)(const void *)b->ray, b->field);
    const Floats length = floats_abs(b->field[4]) + floats_abs(b->field[5])
                          + floats_abs(b->field[6]);
    const Floats reach = floats_abs(b->field[0]) + floats_abs(b->field[1])
                         + floats_abs(b->field[2]);
    const unsigned good = floats_less_equal(floats_all(PROBE_LENGTH_MIN), length)
                          & floats_less_equal(length, floats_all(PROBE_LENGTH_MAX))
                          & floats_less_equal(reach, floats_all(PROBE_COORDINATE_MAX))
                          & floats_less_equal(b->field[3], b->field[7]);
    return count < LANES ? good & ((1u << count) - 1) : good;
}

LANES_INLINE void packet_answers(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes,
                                 Hit *hit, const uint32_t *order)
{
    const unsigned found = p->front | p->back;
    const Floats zero = floats_all(0);
    const Words primitive = words_pick(found, words_without(p->key, BEST_BACK),
                                       words_all(RAY_MISS));
    Hit *out[LANES];
    for (unsigned i = 0; i < LANES; i++)
        out[i] = &hit[order != NULL ? order[lanes >> i & 1 ? i : 0] : i];
    floats_scatter((float *const *)(void *)out, lanes, p->t, p->u + zero, p->v + zero,
                   floats_bits(primitive));
    unsigned open = lanes & p->back & floats_less_equal(p->facing_t, p->limit);
    for (; __builtin_expect(open != 0, 0); open &= open - 1) {
        const unsigned i = (unsigned)__builtin_ctz(open);
        const Best best = packet_best(p, i);
        Probe probe;
        probe_init(&probe, b->ray[i], bvh->lo, bvh->hi);
        if (best_is_open(&best))
            best_to_hit(&best, first_or_facing(bvh, b->ray[i], &probe, &best), out[i]);
    }
}

/* The next up to LANES rays; `order` NULL: one after the other. Returns how many subtrees were
 * walked by one ray alone. */
LANES_INLINE unsigned packet_some(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                  size_t count, Hit *hit, bool *blocked)
{
    Bundle b;
    Packet p;
    unsigned alone = 0;
    const unsigned all = count < LANES ? (1u << count) - 1 : (unsigned)((UINT64_C(1) << LANES) - 1);
    const unsigned good = bundle_fill(&b, ray, order, count);
    for (unsigned left = good; left != 0;) {
        const unsigned lanes = packet_kind(&p, &b, left);
        left &= ~lanes;
        packet_init(&p, bvh, &b, lanes);
        packet_walk(&p, bvh, &b, lanes, hit == NULL);
        alone += p.alone;
        if (hit != NULL)
            packet_answers(&p, bvh, &b, lanes, hit, order);
        else
            for (unsigned l = lanes; l != 0; l &= l - 1) {
                const unsigned i = (unsigned)__builtin_ctz(l);
                blocked[order != NULL ? order[i] : i] = p.blocked >> i & 1;
            }
    }
    for (unsigned odd = all & ~good; odd != 0; odd &= odd - 1) {
        const unsigned i = (unsigned)__builtin_ctz(odd);
        const uint32_t at = order != NULL ? order[i] : i;
        Hit one;
        const bool found = nearest_one(bvh, &ray[at], hit != NULL ? &hit[at] : &one);
        if (hit == NULL)
            blocked[at] = found;
    }
    return alone;
}

/* Rays order[begin..end-1] in packets; subtrees walked alone. */
LANES_INLINE unsigned packet_run(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                 size_t begin, size_t end, Hit *hit, bool *blocked)
{
    unsigned alone = 0;
    for (size_t i = begin; i < end; i += LANES) {
        if (order == NULL) {
            alone += packet_some(bvh, ray + i, NULL, end - i, hit != NULL ? hit + i : NULL,
                                 hit != NULL ? NULL : blocked + i);
            continue;
        }
        for (size_t j = i + 2 * LANES; j < i + 3 * LANES && j < end; j++) {
            const uint32_t soon = order[j];
            __builtin_prefetch(&ray[soon]);
            __builtin_prefetch(hit != NULL ? (const void *)&hit[soon]
                                           : (const void *)&blocked[soon], 1);
        }
        alone += packet_some(bvh, ray, order + i, end - i, hit, blocked);
    }
    return alone;
}

/* Where the first rays of a stretch went their own ways, the rest of it is traced one by one. */
LANES_INLINE void packets_trace(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                size_t count, Hit *hit, bool *blocked)
{
    for (size_t i = 0; i < count; i += STRETCH) {
        const size_t end = count - i < STRETCH ? count : i + STRETCH;
        const size_t trial = end - i < STRETCH_TRIAL ? end : i + STRETCH_TRIAL;
        const unsigned alone = packet_run(bvh, ray, order, i, trial, hit, blocked);
        if (trial == end)
            continue;
        if (alone <= STRETCH_ALONE)
            packet_run(bvh, ray, order, trial, end, hit, blocked);
        else if (order != NULL)
            stream_trace(bvh, ray, order + trial, end - trial, hit, blocked);
        else
            stream_trace(bvh, ray + trial, NULL, end - trial, hit != NULL ? hit + trial : NULL,
                         hit != NULL ? NULL : blocked + trial);
    }
}

static void packets_nearest(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                            Hit *hit)
{
    packets_trace(bvh, ray, order, count, hit, NULL);
}

static void packets_blocked(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                            bool *blocked)
{
    packets_trace(bvh, ray, order, count, NULL, blocked);
}

/* --- sorting --------------------------------------------------------------------------------- */

/* Keys of LANES rays at ray[0], ray[1] ...: kind above, cell below (sort.h). */
LANES_INLINE void keys_some(const Cells *cells, const float *const row[LANES], uint32_t key[LANES])
{
    Floats f[8];
    floats_fields(row, f);
    const Floats x = floats_abs(f[4]), y = floats_abs(f[5]), z = floats_abs(f[6]);
    const unsigned yx = floats_less(y, x), zx = floats_less(z, x), zy = floats_less(z, y);
    const unsigned on_x = yx & zx, on_y = ~yx & zy;
    const Floats major = floats_pick(on_x, x, floats_pick(on_y, y, z));
    const Floats first = floats_pick(on_x, y, floats_pick(on_y, z, x));
    const Floats second = floats_pick(on_x, z, floats_pick(on_y, x, y));
    const Floats scale = floats_all(cells->scale[0]) / major;
    const Words most = words_all((1u << CELL_LEVELS) - 1), least = words_all(0);
    _Alignas(64) uint32_t place[CELL_DIMENSIONS][LANES];
    /* NaN too ends somewhere. */
    words_store(place[0], words_max(words_min(words_of(first * scale), most), least));
    words_store(place[1], words_max(words_min(words_of(second * scale), most), least));
    for (int k = 0; k < 3; k++) {
        const Floats at = (f[k] - floats_all(cells->lo[k])) * floats_all(cells->scale[2 + k]);
        words_store(place[2 + k], words_max(words_min(words_of(at), most), least));
    }
    const unsigned sx = floats_signs(f[4]), sy = floats_signs(f[5]), sz = floats_signs(f[6]);
    for (unsigned i = 0; i < LANES; i++) {
        const unsigned axis = on_x >> i & 1 ? 0 : on_y >> i & 1 ? 1 : 2;
        const unsigned kind = axis * 8 + (sx >> i & 1) + 2 * (sy >> i & 1) + 4 * (sz >> i & 1);
        key[i] = kind << cells->bits | cells->spread[0][place[0][i]]
                 | cells->spread[1][place[1][i]] | cells->spread[2][place[2][i]]
                 | cells->spread[3][place[3][i]] | cells->spread[4][place[4][i]];
    }
}

static void packets_keys(const Cells *cells, const Ray *ray, size_t count, uint32_t *key)
{
    for (size_t i = 0; i < count; i += LANES) {
        const float *row[LANES];
        uint32_t some[LANES];
        const size_t n = count - i < LANES ? count - i : LANES;
        for (size_t j = 0; j < LANES; j++)
            row[j] = (const float *)&ray[i + (j < n ? j : 0)];
        keys_some(cells, row, n == LANES ? key + i : some);
        for (size_t j = 0; n < LANES && j < n; j++)
            key[i + j] = some[j];
    }
}

#endif
