/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/group_avx2.h -- one ray against two groups of triangles at once, with AVX2.
 *
 * The same float operations as probe_shear. What they settle is not asked again in double: edge
 * functions of two strict signs, or of one (probe.h); and, as a hit is a mean of the corners, a
 * triangle whose corners lie all beyond or all within the ray's range. No fused operations here:
 * triangles must come out as in the other kernels.
 */
#ifndef RAYCAST_GROUP_AVX2_H
#define RAYCAST_GROUP_AVX2_H

#include <float.h>
#include <immintrin.h>

#include "raycast/probe.h"

/* z / d_z in float is off by three roundings, in double and then rounded by one: within
 * (1 +- SURE_ROUNDING), but for what is smaller than FLT_MIN. */
#define SURE_ROUNDING (8 * PROBE_ROUNDING)

/* Corners as the ray sees them, [corner], and the range of their z / d_z. */
typedef struct {
    __m256 x[3], y[3], z[3], from, to;
} Sheared;

static inline __m256 groups_load(const TriangleGroup *a, const TriangleGroup *b, int corner,
                                 int axis)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(a->vertex[corner][axis])),
                                _mm_loadu_ps(b->vertex[corner][axis]), 1);
}

/* Two groups side by side: corner, axis as the ray counts them. */
typedef struct {
    __m256 at[3][3];
} Corners;

static inline Corners groups_corners(const TriangleGroup *a, const TriangleGroup *b,
                                     const int axis[3])
{
    Corners c;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c.at[i][k] = groups_load(a, b, i, axis[k]);
    return c;
}

static inline void groups_shear(Sheared *s, const Corners *c, const Probe *p)
{
    const __m256 inverse = _mm256_set1_ps(p->inverse[p->axis[2]]);
    __m256 t[3];
    for (int i = 0; i < 3; i++) {
        const __m256 x = _mm256_sub_ps(c->at[i][0], _mm256_set1_ps(p->origin[0]));
        const __m256 y = _mm256_sub_ps(c->at[i][1], _mm256_set1_ps(p->origin[1]));
        s->z[i] = _mm256_sub_ps(c->at[i][2], _mm256_set1_ps(p->origin[2]));
        s->x[i] = _mm256_sub_ps(x, _mm256_mul_ps(_mm256_set1_ps(p->shear[0]), s->z[i]));
        s->y[i] = _mm256_sub_ps(y, _mm256_mul_ps(_mm256_set1_ps(p->shear[1]), s->z[i]));
        t[i] = _mm256_mul_ps(s->z[i], inverse);
    }
    s->from = _mm256_min_ps(_mm256_min_ps(t[0], t[1]), t[2]);
    s->to = _mm256_max_ps(_mm256_max_ps(t[0], t[1]), t[2]);
}

static inline __m256 edge_avx2(const Sheared *s, int i, int j)
{
    return _mm256_sub_ps(_mm256_mul_ps(s->x[i], s->y[j]), _mm256_mul_ps(s->y[i], s->x[j]));
}

/* Bits of the lanes that hold a triangle; of b none when it is a once more. */
static inline unsigned groups_used(const TriangleGroup *a, const TriangleGroup *b)
{
    const __m128i low = _mm_loadu_si128((const __m128i *)(const void *)a->primitive);
    const __m128i high = _mm_loadu_si128((const __m128i *)(const void *)b->primitive);
    const unsigned unused = (unsigned)_mm_movemask_ps(_mm_castsi128_ps(low))
                            | (unsigned)_mm_movemask_ps(_mm_castsi128_ps(high)) << 4;
    return ~unused & (a == b ? 0x0fu : 0xffu);
}

/* Triangles of which float is not sure, one by one. */
static inline bool groups_decide(const TriangleGroup *group, const Sheared *s, const Probe *p,
                                 unsigned lanes, uint32_t place, Best *best)
{
    float x[3][8], y[3][8], z[3][8];
    for (int i = 0; i < 3; i++) {
        _mm256_storeu_ps(x[i], s->x[i]);
        _mm256_storeu_ps(y[i], s->y[i]);
        _mm256_storeu_ps(z[i], s->z[i]);
    }
    bool found = false;
    for (; lanes != 0; lanes &= lanes - 1) {
        const unsigned i = (unsigned)__builtin_ctz(lanes);
        found |= probe_sheared(p, x[0][i], y[0][i], z[0][i], x[1][i], y[1][i], z[1][i], x[2][i],
                               y[2][i], z[2][i], group[i / GROUP_WIDTH].primitive[i % GROUP_WIDTH],
                               place + i, best);
    }
    return found;
}

static inline __m256 abs_avx2(__m256 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }

/* On which side of `end` hits lie: positive beyond, negative before, 0 where float does not know.
 * With q_i the corners' t less `end` and edge functions e_i of one sign, t - end has the sign of
 * the sum of e_i q_i over that of e_i. In float an e_i is off by 4 u |x| |y|, the largest there
 * are, q_i and the sum with its products by 8 u |e_i| (|t_i| + end), t itself by u end: both
 * bounds are doubled. What is smaller than FLT_MIN may have lost digits, t too. */
#define SIDE_T_MIN 0x1p-100f

static inline __m256 groups_side(const __m256 e[3], const __m256 t[3], __m256 area, __m256 off,
                                 float end)
{
    const __m256 sign = _mm256_set1_ps(-0.0f), at = _mm256_set1_ps(end);
    __m256 q[3];
    for (int i = 0; i < 3; i++)
        q[i] = _mm256_sub_ps(t[i], at);
    const __m256 sum = _mm256_fmadd_ps(e[0], q[0], _mm256_fmadd_ps(e[1], q[1],
                                                                   _mm256_mul_ps(e[2], q[2])));
    const __m256 far = _mm256_add_ps(_mm256_add_ps(abs_avx2(q[0]), abs_avx2(q[1])),
                                     abs_avx2(q[2]));
    /* |t_i| + end <= |q_i| + 2 end; with the factor below, FLT_MIN and more of t. */
    const __m256 reach = _mm256_add_ps(far, _mm256_set1_ps(2 * end + SIDE_T_MIN));
    const __m256 rounding = _mm256_mul_ps(abs_avx2(area), _mm256_set1_ps(2 * SURE_ROUNDING));
    const __m256 width = _mm256_fmadd_ps(off, far, _mm256_fmadd_ps(rounding, reach,
                                                                   _mm256_set1_ps(FLT_MIN)));
    const __m256 known = _mm256_cmp_ps(abs_avx2(sum), width, _CMP_GT_OQ);
    const __m256 side = _mm256_xor_ps(sum, _mm256_and_ps(sign, area));
    return _mm256_and_ps(known, side);
}

/* Of `lanes`, whose edge functions are of one strict sign, those that are left to be decided; adds
 * those that are hit between t_min and `limit` to *sure. */
static inline unsigned groups_settle(const Sheared *s, const __m256 e[3], const Probe *p,
                                     unsigned lanes, float limit, unsigned *sure)
{
    const __m256 zero = _mm256_setzero_ps(), inverse = _mm256_set1_ps(p->inverse[p->axis[2]]);
    __m256 t[3], x = zero, y = zero;
    for (int i = 0; i < 3; i++) {
        t[i] = _mm256_mul_ps(s->z[i], inverse);
        x = _mm256_max_ps(x, abs_avx2(s->x[i]));
        y = _mm256_max_ps(y, abs_avx2(s->y[i]));
    }
    const __m256 area = _mm256_add_ps(_mm256_add_ps(e[0], e[1]), e[2]);
    const __m256 off = _mm256_fmadd_ps(_mm256_set1_ps(8 * PROBE_ROUNDING), _mm256_mul_ps(x, y),
                                       _mm256_set1_ps(FLT_MIN));
    const __m256 begin = groups_side(e, t, area, off, p->t_min);
    const __m256 end = groups_side(e, t, area, off, limit);
    const __m256 out = _mm256_or_ps(_mm256_cmp_ps(begin, zero, _CMP_LT_OQ),
                                    _mm256_cmp_ps(end, zero, _CMP_GT_OQ));
    const __m256 in = _mm256_and_ps(_mm256_cmp_ps(begin, zero, _CMP_GT_OQ),
                                    _mm256_cmp_ps(end, zero, _CMP_LT_OQ));
    *sure |= (unsigned)_mm256_movemask_ps(in) & lanes;
    return lanes & ~(unsigned)_mm256_movemask_ps(_mm256_or_ps(in, out));
}

/* What float says of eight triangles: bits of those that may be hit, and with `any` of those that
 * surely are. */
static inline unsigned groups_filter(const Sheared *s, const Probe *p, unsigned used, bool any,
                                     float limit, unsigned *sure)
{
    const __m256 zero = _mm256_setzero_ps();
    const __m256 e0 = edge_avx2(s, 2, 1), e1 = edge_avx2(s, 0, 2), e2 = edge_avx2(s, 1, 0);
    const __m256 least = _mm256_min_ps(_mm256_min_ps(e0, e1), e2);
    const __m256 most = _mm256_max_ps(_mm256_max_ps(e0, e1), e2);
    const __m256 apart = _mm256_and_ps(_mm256_cmp_ps(least, zero, _CMP_LT_OQ),
                                       _mm256_cmp_ps(most, zero, _CMP_GT_OQ));
    const float end = limit * (1 + SURE_ROUNDING) + FLT_MIN;
    const __m256 beyond = _mm256_cmp_ps(s->from, _mm256_set1_ps(end), _CMP_GT_OQ);
    const unsigned out = (unsigned)_mm256_movemask_ps(_mm256_or_ps(apart, beyond));
    const unsigned lanes = ~out & used;
    if (lanes == 0 || !any)
        return lanes;
    const float begin = (p->t_min + FLT_MIN) * (1 + SURE_ROUNDING);
    const __m256 strict = _mm256_or_ps(_mm256_cmp_ps(least, zero, _CMP_GT_OQ),
                                       _mm256_cmp_ps(most, zero, _CMP_LT_OQ));
    const __m256 inside = _mm256_and_ps(
        _mm256_cmp_ps(s->from, _mm256_set1_ps(begin), _CMP_GT_OQ),
        _mm256_cmp_ps(s->to, _mm256_set1_ps(limit * (1 - SURE_ROUNDING)), _CMP_LT_OQ));
    *sure = (unsigned)_mm256_movemask_ps(_mm256_and_ps(strict, inside)) & lanes;
    const unsigned left = lanes & ~*sure, clear = (unsigned)_mm256_movemask_ps(strict) & left;
    if (*sure != 0 || clear == 0)
        return lanes;
    const __m256 e[3] = { e0, e1, e2 };
    return (left & ~clear) | groups_settle(s, e, p, clear, limit, sure) | *sure;
}

static inline bool groups_test(const TriangleGroup *group, uint32_t count, const Probe *p,
                               uint32_t place, bool any, Best *best)
{
    bool found = false;
    for (uint32_t g = 0; g < count; g += 2) {
        const TriangleGroup *a = &group[g], *b = a + (g + 1 < count);
        const Corners corners = groups_corners(a, b, p->axis);
        Sheared s;
        groups_shear(&s, &corners, p);
        unsigned sure = 0;
        const unsigned lanes = groups_filter(&s, p, groups_used(a, b), any, best->limit, &sure);
        if (lanes == 0)
            continue;
        if (sure != 0) {
            best->first.place = place;
            return true;
        }
        found |= groups_decide(a, &s, p, lanes, place + g * GROUP_WIDTH, best);
        if (any && found)
            return true;
    }
    return found;
}

/* Which of `rays`, whose major axes are the same, meet any of the triangles. */
static inline uint64_t groups_block(const TriangleGroup *group, uint32_t count,
                                    const Probe *probe, uint64_t rays)
{
    uint64_t blocked = 0;
    for (uint32_t g = 0; g < count; g += 2) {
        const TriangleGroup *a = &group[g], *b = a + (g + 1 < count);
        const Corners corners = groups_corners(a, b, probe->axis);
        const unsigned used = groups_used(a, b);
        for (uint64_t left = rays & ~blocked; left != 0; left &= left - 1) {
            const Probe *p = &probe[__builtin_ctzll(left)];
            Sheared s;
            groups_shear(&s, &corners, p);
            unsigned sure = 0;
            const unsigned lanes = groups_filter(&s, p, used, true, p->t_max, &sure);
            if (lanes == 0)
                continue;
            Best best = best_none(p->t_max);
            if (sure != 0 || groups_decide(a, &s, p, lanes, 0, &best))
                blocked |= left & -left;
        }
    }
    return blocked;
}

/* Offers the triangles to the best hits of `rays`, whose major axes are the same. */
static inline void groups_meet(const TriangleGroup *group, uint32_t count, Probe *probe,
                               Best *best, uint64_t rays, uint32_t place)
{
    for (uint32_t g = 0; g < count; g += 2) {
        const TriangleGroup *a = &group[g], *b = a + (g + 1 < count);
        const Corners corners = groups_corners(a, b, probe->axis);
        const unsigned used = groups_used(a, b);
        for (uint64_t left = rays; left != 0; left &= left - 1) {
            const unsigned i = (unsigned)__builtin_ctzll(left);
            Probe *p = &probe[i];
            Sheared s;
            groups_shear(&s, &corners, p);
            unsigned sure = 0;
            const unsigned lanes = groups_filter(&s, p, used, false, p->t_max, &sure);
            if (lanes != 0
                && groups_decide(a, &s, p, lanes, place + g * GROUP_WIDTH, &best[i]))
                p->t_max = best[i].limit;
        }
    }
}

#endif
