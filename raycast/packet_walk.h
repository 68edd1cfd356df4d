/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/packet_walk.h -- packets of rays through the tree, and what they ask of sort.h. */
#ifndef RAYCAST_PACKET_WALK_H
#define RAYCAST_PACKET_WALK_H

#include <string.h>

#include "raycast/packet_leaf.h"

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
LANES_INLINE void packet_push(const Packet *p, const Node *node, unsigned lanes,
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
            packet_push(p, &bvh->node[child], here, &stack);
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
LANES_INLINE unsigned bundle_fill(Bundle *b, const Ray *ray, size_t count)
{
    for (unsigned i = 0; i < LANES; i++)
        b->ray[i] = &ray[i < count ? i : 0];
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
    const unsigned good = bundle_fill(&b, ray, count);
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
        const bool found = nearest_one(bvh, &ray[i], hit != NULL ? &hit[at] : &one);
        if (hit == NULL)
            blocked[at] = found;
    }
    return alone;
}

/* Rays begin..end-1 in packets; subtrees walked alone. */
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
        for (size_t j = i + 2 * LANES; j < i + 3 * LANES && j < end; j++)
            __builtin_prefetch(hit != NULL ? (const void *)&hit[order[j]]
                                           : (const void *)&blocked[order[j]], 1);
        alone += packet_some(bvh, ray + i, order + i, end - i, hit, blocked);
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
            stream_trace(bvh, ray + trial, order + trial, end - trial, hit, blocked);
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
    const Words axis = words_pick(on_x, least, words_pick(on_y, words_all(8), words_all(16)));
    Words kind = words_or(axis, words_sign(f[4]));
    kind = words_or(kind, words_left(words_sign(f[5]), 1));
    kind = words_or(kind, words_left(words_sign(f[6]), 2));
    Words all = words_left(kind, cells->bits);
    for (int k = 0; k < CELL_DIMENSIONS; k++) {
        const Floats at = k == 0   ? first * scale
                          : k == 1 ? second * scale
                                   : (f[k - 2] - floats_all(cells->lo[k - 2]))
                                         * floats_all(cells->scale[k]);
        /* NaN too ends somewhere. */
        const Words place = words_max(words_min(words_of(at), most), least);
        all = words_or(all, words_lookup(cells->spread[k], place));
    }
    words_store(key, all);
}

static void packets_keys(const Cells *cells, const Ray *ray, size_t count, uint32_t *key)
{
    for (size_t i = 0; i < count; i += LANES) {
        const float *row[LANES];
        _Alignas(64) uint32_t some[LANES];
        const size_t n = count - i < LANES ? count - i : LANES;
        for (size_t j = 0; j < LANES; j++)
            row[j] = (const float *)&ray[i + (j < n ? j : 0)];
        keys_some(cells, row, some);
        memcpy(key + i, some, n * sizeof *some);
    }
}

#endif
