/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/single_avx2.h -- one ray against a node at once, with AVX2. */
#ifndef RAYCAST_SINGLE_AVX2_H
#define RAYCAST_SINGLE_AVX2_H

#include <immintrin.h>

#include "raycast/group_avx2.h"
#include "raycast/reach.h"

/* The hits are brought into the ray's order of slots and packed by a permutation whose indices
 * are bytes picked by the mask: no branch depends on how many there are. */
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
    if (!any)
        _mm256_storeu_ps(near, _mm256_permutevar8x32_ps(t0, order));
    _mm256_storeu_si256((__m256i *)child, _mm256_permutevar8x32_epi32(children, order));
    return (uint32_t)__builtin_popcount(mask) - 1;
}

/* Of each slot the rays that reach its box, one bit each (crowd.h). */
typedef struct {
    __m256i rays[2];
} Reach;

static inline Reach reach_none(void)
{
    return (Reach){ { _mm256_setzero_si256(), _mm256_setzero_si256() } };
}

static inline void reach_add(Reach *r, const Node *node, const Probe *p, unsigned octant,
                             uint64_t bit)
{
    const __m256i all = _mm256_set1_epi64x((long long)bit);
    const __m256i hit = _mm256_castps_si256(_mm256_cmp_ps(
        node_near(node, p, octant), node_far(node, p, octant), _CMP_LE_OQ));
    const __m256i low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(hit));
    const __m256i high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256(hit, 1));
    r->rays[0] = _mm256_or_si256(r->rays[0], _mm256_and_si256(low, all));
    r->rays[1] = _mm256_or_si256(r->rays[1], _mm256_and_si256(high, all));
}

/* Writes the slots that any ray reaches, far ones first; may write 8. Returns how many. */
static inline uint32_t reach_push(const Reach *r, const Node *node, unsigned octant,
                                  uint64_t *rays, uint32_t *child)
{
    _Alignas(32) uint64_t all[NODE_WIDTH];
    uint32_t count = 0;
    _mm256_store_si256((__m256i *)(void *)&all[0], r->rays[0]);
    _mm256_store_si256((__m256i *)(void *)&all[4], r->rays[1]);
    for (unsigned i = 0; i < NODE_WIDTH; i++) {
        rays[count] = all[i ^ octant];
        child[count] = node->child[i ^ octant];
        count += all[i ^ octant] != 0;
    }
    return count;
}

#endif
