/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/single_avx2.h -- one ray against a node at once and a group at once, with AVX2. Fused
 * operations only where boxes are tested: their margin covers any rounding, and triangles must come
 * out as in the other kernels. */
#ifndef RAYCAST_SINGLE_AVX2_H
#define RAYCAST_SINGLE_AVX2_H

#include <immintrin.h>

#include "raycast/group_sse.h"

/* The hits are brought into the ray's order of slots and packed by a permutation whose indices
 * are bytes picked by the mask: no branch depends on how many there are. */
static inline uint32_t node_push(const Node *node, const Probe *p, float t_limit, float *near,
                                 uint32_t *child, uint32_t *next)
{
    __m256 t0 = _mm256_set1_ps(p->t_min), t1 = _mm256_set1_ps(t_limit);
    for (unsigned k = 0; k < 3; k++) {
        const unsigned negative = p->octant >> k & 1;
        const __m256 inverse = _mm256_set1_ps(p->inverse[k]);
        const __m256 a = _mm256_load_ps(node->plane[2 * k + negative]);
        const __m256 b = _mm256_load_ps(node->plane[2 * k + 1 - negative]);
        t0 = _mm256_max_ps(t0, _mm256_fmadd_ps(a, inverse, _mm256_set1_ps(p->near_add[k])));
        t1 = _mm256_min_ps(t1, _mm256_fmadd_ps(b, inverse, _mm256_set1_ps(p->far_add[k])));
    }
    const __m256i slots = _mm256_xor_si256(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
                                           _mm256_set1_epi32((int)p->octant));
    const __m256 hit = _mm256_permutevar8x32_ps(_mm256_cmp_ps(t0, t1, _CMP_LE_OQ), slots);
    const unsigned mask = (unsigned)_mm256_movemask_ps(hit);
    if (mask == 0) {
        *next = CHILD_NONE;
        return 0;
    }
    /* Not by way of the stack: a load that waits for a store is slow. */
    *next = node->child[(31u - (unsigned)__builtin_clz(mask)) ^ p->octant];
    const uint64_t bytes = _pdep_u64(mask, UINT64_C(0x0101010101010101)) * 0xff;
    const uint64_t picked = _pext_u64(UINT64_C(0x0706050403020100), bytes);
    const __m256i packed = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)picked));
    const __m256i order = _mm256_permutevar8x32_epi32(slots, packed);
    const __m256i children = _mm256_load_si256((const __m256i *)node->child);
    _mm256_storeu_ps(near, _mm256_permutevar8x32_ps(t0, order));
    _mm256_storeu_si256((__m256i *)child, _mm256_permutevar8x32_epi32(children, order));
    return (uint32_t)__builtin_popcount(mask) - 1;
}

/* probe_triangle for four at once, operation by operation: the same bits. */
static inline bool group_test(const TriangleGroup *group, const Probe *p, uint32_t place,
                              Best *best)
{
    const Sheared s = group_shear(group, p);
    const unsigned lanes = group_filter(group, &s);
    if (lanes == 0)
        return false;
    const __m256d ax = _mm256_cvtps_pd(s.x[0]), ay = _mm256_cvtps_pd(s.y[0]);
    const __m256d bx = _mm256_cvtps_pd(s.x[1]), by = _mm256_cvtps_pd(s.y[1]);
    const __m256d cx = _mm256_cvtps_pd(s.x[2]), cy = _mm256_cvtps_pd(s.y[2]);
    const __m256d a = _mm256_sub_pd(_mm256_mul_pd(cx, by), _mm256_mul_pd(cy, bx));
    const __m256d b = _mm256_sub_pd(_mm256_mul_pd(ax, cy), _mm256_mul_pd(ay, cx));
    const __m256d c = _mm256_sub_pd(_mm256_mul_pd(bx, ay), _mm256_mul_pd(by, ax));
    const __m256d zero = _mm256_setzero_pd();
    const __m256d least = _mm256_min_pd(_mm256_min_pd(a, b), c);
    const __m256d most = _mm256_max_pd(_mm256_max_pd(a, b), c);
    const __m256d one_sign = _mm256_or_pd(_mm256_cmp_pd(least, zero, _CMP_GE_OQ),
                                          _mm256_cmp_pd(most, zero, _CMP_LE_OQ));
    const __m256d sum = _mm256_add_pd(_mm256_add_pd(a, b), c);
    const __m256d scale = _mm256_div_pd(_mm256_set1_pd(1), sum);
    const __m256d depth = _mm256_add_pd(
        _mm256_add_pd(_mm256_mul_pd(a, _mm256_cvtps_pd(s.z[0])),
                      _mm256_mul_pd(b, _mm256_cvtps_pd(s.z[1]))),
        _mm256_mul_pd(c, _mm256_cvtps_pd(s.z[2])));
    const __m128 t = _mm256_cvtpd_ps(_mm256_mul_pd(_mm256_mul_pd(depth, scale),
                                                   _mm256_set1_pd(p->inverse_z)));
    /* Without area t is NaN and out of range. */
    const __m128 in_range = _mm_and_ps(_mm_cmpgt_ps(t, _mm_set1_ps(p->t_min)),
                                       _mm_cmple_ps(t, _mm_set1_ps(best->limit)));
    unsigned left = lanes & (unsigned)_mm256_movemask_pd(one_sign)
                    & (unsigned)_mm_movemask_ps(in_range);
    if (left == 0)
        return false;
    float ts[4], us[4], vs[4];
    _mm_storeu_ps(ts, t);
    _mm_storeu_ps(us, _mm256_cvtpd_ps(_mm256_mul_pd(b, scale)));
    _mm_storeu_ps(vs, _mm256_cvtpd_ps(_mm256_mul_pd(c, scale)));
    /* Signs of sum and of the direction: probe_triangle. */
    const unsigned back = (unsigned)_mm256_movemask_pd(sum) ^ (p->inverse_z < 0 ? 0xf : 0);
    bool found = false;
    for (; left != 0; left &= left - 1) {
        const unsigned i = (unsigned)__builtin_ctz(left);
        const Candidate hit = { .t = ts[i], .u = us[i], .v = vs[i], .place = place + i,
                                .key = group->primitive[i] | (back >> i & 1) << 31 };
        found |= best_offer(best, p->reach, &hit);
    }
    return found;
}

#endif
