/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/packet_leaf.h -- a packet of rays against the triangles of a leaf.
 *
 * Hits are decided with the same operations as in probe.h, lane by lane, so they are the same bits.
 */
#ifndef RAYCAST_PACKET_LEAF_H
#define RAYCAST_PACKET_LEAF_H

#include <float.h>

#include "raycast/packet.h"

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

/* What probe_triangle computes in double, operation by operation. */
typedef struct {
    Floats   t, u, v;
    unsigned one_sign; /* lanes whose edge functions have not two signs */
    unsigned back;     /* those whose sum is negative or 0 */
} Solved;

/* Halves of the packet without `lanes` are left out. */
LANES_INLINE void packet_solve(Solved *out, const Seen *s, const Doubles inverse_z[2],
                               unsigned lanes)
{
    Doubles td[2], ud[2], vd[2];
    const Doubles zero = doubles_all(0);
    out->one_sign = out->back = 0;
    for (int half = 0; half < 2; half++) {
        td[half] = ud[half] = vd[half] = zero;
        if ((lanes >> half * (int)(LANES / 2) & ((1u << LANES / 2) - 1)) == 0)
            continue;
        const Doubles ax = doubles_of(s->x[0], half), ay = doubles_of(s->y[0], half);
        const Doubles bx = doubles_of(s->x[1], half), by = doubles_of(s->y[1], half);
        const Doubles cx = doubles_of(s->x[2], half), cy = doubles_of(s->y[2], half);
        /* Products of floats are exact: fused or not, the same. */
        const Doubles a = doubles_less_product(cx * by, cy, bx);
        const Doubles b = doubles_less_product(ax * cy, ay, cx);
        const Doubles c = doubles_less_product(bx * ay, by, ax);
        const Doubles sum = a + b + c, scale = doubles_all(1) / sum;
        const unsigned sign = doubles_less_equal(zero, doubles_min(doubles_min(a, b), c))
                              | doubles_less_equal(doubles_max(doubles_max(a, b), c), zero);
        out->one_sign |= sign << half * (int)(LANES / 2);
        out->back |= doubles_less_equal(sum, zero) << half * (int)(LANES / 2);
        const Doubles depth = a * doubles_of(s->z[0], half) + b * doubles_of(s->z[1], half)
                              + c * doubles_of(s->z[2], half);
        td[half] = depth * scale * inverse_z[half];
        ud[half] = b * scale;
        vd[half] = c * scale;
    }
    out->t = floats_of(td[0], td[1]);
    out->u = floats_of(ud[0], ud[1]);
    out->v = floats_of(vd[0], vd[1]);
}

/* What the float filter lets through is decided in double. */
LANES_INLINE void packet_decide(Packet *p, const Seen *s, unsigned lanes, uint32_t primitive,
                                uint32_t place, bool any)
{
    Solved at;
    packet_solve(&at, s, p->inverse_z, lanes);
    /* Without area t is NaN and out of range. */
    const unsigned ok = lanes & at.one_sign & floats_less(p->t_min, at.t)
                        & floats_less_equal(at.t, p->limit);
    if (ok == 0)
        return;
    if (any) {
        const unsigned done = ok & floats_less(at.t, p->t);
        p->blocked |= done;
        p->limit = floats_pick(done, floats_all(-INFINITY), p->limit);
        return;
    }
    packet_offer(p, ok, p->backward ? ~at.back : at.back, primitive, place, at.t, at.u, at.v);
}

/* A hit's t in float, and how far from it that of packet_solve may be. With M the largest sheared
 * coordinate and u = 2^-24, the edge functions in float are off by at most 4 u M^2 each, their sum
 * by 22 u M^2 with its own roundings. So z_0 + (b (z_1 - z_0) + c (z_2 - z_0)) / sum is off by
 * (10 + 22) u M^2 D / |sum|, D the sum of the two differences, and terms of higher order while that
 * is a small part of D; what is left of 40 covers them. Then three roundings to t. Of sums below
 * 2^-100 the products may have lost digits to underflow. */
#define ESTIMATE_WEIGHTS (40 * PROBE_ROUNDING)
#define ESTIMATE_SMALL 0.25f
#define ESTIMATE_SCALE_MAX 0x1p100f
#define ESTIMATE_T (8 * PROBE_ROUNDING)

typedef struct {
    Floats   from, to;
    unsigned good; /* lanes for which this holds */
} Estimate;

LANES_INLINE Estimate packet_estimate(const Seen *s, const Floats edge[3], Floats inverse)
{
    Floats most = floats_abs(s->x[0]);
    for (int i = 0; i < 3; i++)
        most = floats_max(most, floats_max(floats_abs(s->x[i]), floats_abs(s->y[i])));
    const Floats scale = floats_all(1) / (edge[0] + edge[1] + edge[2]);
    const Floats d1 = s->z[1] - s->z[0], d2 = s->z[2] - s->z[0];
    const Floats off = most * most * floats_abs(scale) * floats_all(ESTIMATE_WEIGHTS);
    const Floats along = floats_fused(edge[1], d1, edge[2] * d2);
    const Floats t = floats_fused(along, scale, s->z[0]) * inverse;
    const Floats deep = (floats_abs(d1) + floats_abs(d2)) * floats_abs(inverse);
    const Floats width = floats_fused(off, deep, floats_abs(t) * floats_all(ESTIMATE_T));
    return (Estimate){ .from = t - width, .to = t + width,
                       .good = floats_less(off, floats_all(ESTIMATE_SMALL))
                               & floats_less(floats_abs(scale), floats_all(ESTIMATE_SCALE_MAX)) };
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
    const Floats e[3] = { s.x[2] * s.y[1] - s.y[2] * s.x[1], s.x[0] * s.y[2] - s.y[0] * s.x[2],
                          s.x[1] * s.y[0] - s.y[1] * s.x[0] };
    const Floats zero = floats_all(0), least = floats_min(floats_min(e[0], e[1]), e[2]);
    const Floats most = floats_max(floats_max(e[0], e[1]), e[2]);
    lanes &= floats_less_equal(zero, least) | floats_less_equal(most, zero);
    if (any && lanes != 0) {
        const Estimate t = packet_estimate(&s, e, p->inverse[p->axis[2]]);
        const unsigned strict = floats_less(zero, least) | floats_less(most, zero);
        const unsigned sure = lanes & t.good & strict & floats_less(p->t_min, t.from)
                              & floats_less(t.to, p->t);
        lanes &= ~t.good | (floats_less_equal(p->t_min, t.to) & floats_less_equal(t.from, p->t));
        lanes &= ~sure;
        p->blocked |= sure;
        p->limit = floats_pick(sure, floats_all(-INFINITY), p->limit);
    }
    if (lanes != 0)
        packet_decide(p, &s, lanes, group->primitive[i], place + i, any);
}

/* Bits of the triangles that are there. */
LANES_INLINE unsigned group_used(const TriangleGroup *group)
{
    const __m128i unused = _mm_loadu_si128((const __m128i *)(const void *)group->primitive);
    return ~(unsigned)_mm_movemask_ps(_mm_castsi128_ps(unused)) & 0xf;
}

/* a b - c d of numbers known up to half widths: its middle, and *width. */
LANES_INLINE __m128 edge_range(const __m128 x[2][3], const __m128 r[2][3], int i, int j,
                               __m128 *width)
{
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 xi = _mm_andnot_ps(sign, x[0][i]), yi = _mm_andnot_ps(sign, x[1][i]);
    const __m128 xj = _mm_andnot_ps(sign, x[0][j]), yj = _mm_andnot_ps(sign, x[1][j]);
    const __m128 a = _mm_add_ps(_mm_mul_ps(xi, r[1][j]),
                                _mm_mul_ps(_mm_add_ps(yj, r[1][j]), r[0][i]));
    const __m128 b = _mm_add_ps(_mm_mul_ps(yi, r[0][j]),
                                _mm_mul_ps(_mm_add_ps(xj, r[0][j]), r[1][i]));
    *width = _mm_add_ps(a, b);
    return _mm_sub_ps(_mm_mul_ps(x[0][i], x[1][j]), _mm_mul_ps(x[1][i], x[0][j]));
}

/* Bits of the triangles that any ray of the packet may hit: a triangle is left out when one edge
 * function is positive and another negative for all rays within the packet's ranges. The margin
 * in width[] (eight half-ulps of all distances) covers the roundings here and in packet_triangle.
 */
LANES_INLINE unsigned packet_filter(const Range *p, const int axis[3],
                                    const TriangleGroup *group)
{
    const __m128 sign = _mm_set1_ps(-0.0f), deep = _mm_set1_ps(p->width[2]);
    __m128 x[2][3], r[2][3];
    for (int i = 0; i < 3; i++) {
        const __m128 z = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][axis[2]]),
                                    _mm_set1_ps(p->middle[2]));
        const __m128 far = _mm_add_ps(_mm_andnot_ps(sign, z), deep);
        for (int k = 0; k < 2; k++) {
            const __m128 shear = _mm_set1_ps(p->shear_middle[k]);
            const __m128 at = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][axis[k]]),
                                         _mm_set1_ps(p->middle[k]));
            x[k][i] = _mm_sub_ps(at, _mm_mul_ps(shear, z));
            const float wide = p->width[k] + fabsf(p->shear_middle[k]) * p->width[2];
            r[k][i] = _mm_add_ps(_mm_set1_ps(wide),
                                 _mm_mul_ps(far, _mm_set1_ps(p->shear_width[k])));
        }
    }
    __m128 positive = _mm_setzero_ps(), negative = _mm_setzero_ps();
    for (int i = 0; i < 3; i++) {
        __m128 width;
        const __m128 edge = edge_range((const __m128(*)[3])x, (const __m128(*)[3])r, i,
                                       (i + 1) % 3, &width);
        positive = _mm_or_ps(positive, _mm_cmpgt_ps(edge, width));
        negative = _mm_or_ps(negative, _mm_cmplt_ps(edge, _mm_xor_ps(sign, width)));
    }
    return ~(unsigned)_mm_movemask_ps(_mm_and_ps(positive, negative)) & group_used(group);
}

/* How deep, along the major axis in the rays' direction, hits of the triangles lie at the least;
 * *behind: bits of those whose hits all lie before the rays begin.
 * A hit is a mean of the corners as probe.h moves them, by less than the margin in width[], so it
 * lies that near to the plane, whose normal in float is off by at most 8 u E^2 in each component,
 * E the largest extent of two edges: the first from the differences, two products, their
 * difference. Four times as much covers the roundings of what it is multiplied with, FLT_MIN what
 * underflows. */
#define DEPTH_NORMAL (32 * PROBE_ROUNDING)
#define DEPTH_SLACK (16 * PROBE_ROUNDING)

LANES_INLINE __m128 packet_depths(const Range *p, const int axis[3], bool backward,
                                  const TriangleGroup *group, unsigned *behind)
{
    const __m128 sign = _mm_set1_ps(-0.0f), zero = _mm_setzero_ps();
    __m128 e[2][3], at[3], extent = zero, far = zero;
    for (int k = 0; k < 3; k++) {
        const __m128 corner = _mm_loadu_ps(group->vertex[0][axis[k]]);
        for (int i = 0; i < 2; i++) {
            e[i][k] = _mm_sub_ps(_mm_loadu_ps(group->vertex[i + 1][axis[k]]), corner);
            extent = _mm_max_ps(extent, _mm_andnot_ps(sign, e[i][k]));
        }
        at[k] = _mm_sub_ps(corner, _mm_set1_ps(p->middle[k]));
        far = _mm_add_ps(far, _mm_add_ps(_mm_andnot_ps(sign, at[k]), _mm_set1_ps(p->width[k])));
    }
    const __m128 least_off = _mm_set1_ps(FLT_MIN);
    const __m128 off = _mm_fmadd_ps(_mm_set1_ps(DEPTH_NORMAL), _mm_mul_ps(extent, extent),
                                    least_off);
    __m128 n[3], high = zero, wide = _mm_fmadd_ps(off, far, least_off);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = _mm_fmsub_ps(e[0][i], e[1][j], _mm_mul_ps(e[0][j], e[1][i]));
        high = _mm_fmadd_ps(n[k], at[k], high);
        wide = _mm_fmadd_ps(_mm_andnot_ps(sign, n[k]), _mm_set1_ps(p->width[k]), wide);
    }
    __m128 slope = n[2], around = _mm_mul_ps(off, _mm_set1_ps(4));
    for (int k = 0; k < 2; k++) {
        slope = _mm_fmadd_ps(n[k], _mm_set1_ps(p->shear_middle[k]), slope);
        around = _mm_fmadd_ps(_mm_andnot_ps(sign, n[k]), _mm_set1_ps(p->shear_width[k]), around);
    }
    /* Depths are |high| / |slope| in the rays' direction, or nothing is there. */
    const __m128 turn = _mm_xor_ps(_mm_and_ps(sign, slope), _mm_set1_ps(backward ? -0.0f : 0.0f));
    const __m128 ahead = _mm_xor_ps(high, turn), size = _mm_andnot_ps(sign, slope);
    const __m128 least = _mm_max_ps(_mm_sub_ps(ahead, wide), zero);
    const __m128 most = _mm_add_ps(size, around);
    *behind = (unsigned)_mm_movemask_ps(_mm_and_ps(
        _mm_cmplt_ps(_mm_add_ps(ahead, wide), zero), _mm_cmplt_ps(around, size)));
    /* Of two numbers max gives the second when the first is NaN, after overflow. */
    return _mm_max_ps(_mm_mul_ps(_mm_div_ps(least, most), _mm_set1_ps(1 - DEPTH_SLACK)), zero);
}

LANES_INLINE void packet_leaf(Packet *p, const Bvh *bvh, uint32_t leaf, unsigned lanes, bool any)
{
    const uint32_t begin = child_group(leaf), end = begin + child_group_count(leaf);
    for (uint32_t g = begin; g < end; g++) {
        const TriangleGroup *group = &bvh->group[g];
        unsigned left = (unsigned)__builtin_popcount(lanes) >= PACKET_FILTER
                            ? packet_filter(&p->range, p->axis, group)
                            : group_used(group);
        for (; left != 0; left &= left - 1)
            packet_triangle(p, group, (unsigned)__builtin_ctz(left), g * GROUP_WIDTH,
                            any ? lanes & ~p->blocked : lanes, any);
    }
}

LANES_INLINE void packet_answers(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes,
                                 Hit *hit, const uint32_t *order)
{
    const unsigned found = p->front | p->back;
    const Floats zero = floats_all(0);
    const Words primitive = words_pick(found, words_without(p->key, BEST_BACK),
                                       words_all(RAY_MISS));
    float *out[LANES]; /* each a Hit */
    for (unsigned i = 0; i < LANES; i++)
        out[i] = (float *)(void *)&hit[order != NULL ? order[lanes >> i & 1 ? i : 0] : i];
    floats_scatter(out, lanes, p->t, p->u + zero, p->v + zero,
                   floats_bits(primitive));
    unsigned open = lanes & p->back & floats_less_equal(p->facing_t, p->limit);
    for (; __builtin_expect(open != 0, 0); open &= open - 1) {
        const unsigned i = (unsigned)__builtin_ctz(open);
        const Best best = packet_best(p, i);
        Probe probe;
        probe_init(&probe, b->ray[i], bvh->lo, bvh->hi);
        if (best_is_open(&best))
            best_to_hit(&best, first_or_facing(bvh, b->ray[i], &probe, &best),
                        &hit[order != NULL ? order[i] : i]);
    }
}

#endif
