/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/single_avx512.h -- one ray against a node at once, where AVX-512 can pack by a mask. */
#ifndef RAYCAST_SINGLE_AVX512_H
#define RAYCAST_SINGLE_AVX512_H

#include <immintrin.h>

#include "raycast/group_avx2.h"
#include "raycast/reach.h"

static inline uint32_t node_push(const Node *node, const Probe *p, float t_limit, bool any,
                                 float *near, uint32_t *child, uint32_t *next)
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
    t0 = _mm256_permutevar8x32_ps(t0, slots);
    t1 = _mm256_permutevar8x32_ps(t1, slots);
    const __mmask8 hit = _mm256_cmp_ps_mask(t0, t1, _CMP_LE_OQ);
    const unsigned mask = hit;
    if (mask == 0) {
        *next = CHILD_NONE;
        return 0;
    }
    /* Not by way of the stack: a load that waits for a store is slow. */
    *next = node->child[(31u - (unsigned)__builtin_clz(mask)) ^ p->octant];
    const __m256i children = _mm256_load_si256((const __m256i *)node->child);
    const __m256i ordered = _mm256_permutevar8x32_epi32(children, slots);
    _mm256_storeu_si256((__m256i *)child, _mm256_maskz_compress_epi32(hit, ordered));
    if (!any)
        _mm256_storeu_ps(near, _mm256_maskz_compress_ps(hit, t0));
    return (uint32_t)__builtin_popcount(mask) - 1;
}

/* Of each slot the rays that reach its box, one bit each (crowd.h). */
typedef struct {
    __m512i rays;
} Reach;

static inline Reach reach_none(void) { return (Reach){ _mm512_setzero_si512() }; }

static inline void reach_add(Reach *r, const Node *node, const Probe *p, unsigned octant,
                             uint64_t bit)
{
    const __mmask8 hit = _mm256_cmp_ps_mask(node_near(node, p, octant), node_far(node, p, octant),
                                            _CMP_LE_OQ);
    r->rays = _mm512_mask_or_epi64(r->rays, hit, r->rays, _mm512_set1_epi64((long long)bit));
}

/* Writes the slots that any ray reaches, far ones first; may write 8. Returns how many. */
static inline uint32_t reach_push(const Reach *r, const Node *node, unsigned octant,
                                  uint64_t *rays, uint32_t *child)
{
    const __m256i slots = _mm256_xor_si256(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
                                           _mm256_set1_epi32((int)octant));
    const __m512i ordered = _mm512_permutexvar_epi64(_mm512_cvtepu32_epi64(slots), r->rays);
    const __mmask8 some = _mm512_test_epi64_mask(ordered, ordered);
    const __m256i children = _mm256_permutevar8x32_epi32(
        _mm256_load_si256((const __m256i *)node->child), slots);
    _mm512_storeu_si512(rays, _mm512_maskz_compress_epi64(some, ordered));
    _mm256_storeu_si256((__m256i *)child, _mm256_maskz_compress_epi32(some, children));
    return (uint32_t)__builtin_popcount(some);
}

#endif
