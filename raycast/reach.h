/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/reach.h -- where one ray enters and leaves the boxes of a node, for crowd.h. */
#ifndef RAYCAST_REACH_H
#define RAYCAST_REACH_H

#include <immintrin.h>

#include "raycast/probe.h"

static inline __m256 node_near(const Node *node, const Probe *p, unsigned octant)
{
    const unsigned x = octant & 1, y = octant >> 1 & 1, z = octant >> 2 & 1;
    const __m256 a = _mm256_fmadd_ps(_mm256_load_ps(node->plane[x]), _mm256_set1_ps(p->inverse[0]),
                                     _mm256_set1_ps(p->near_add[0]));
    const __m256 b = _mm256_fmadd_ps(_mm256_load_ps(node->plane[2 + y]),
                                     _mm256_set1_ps(p->inverse[1]),
                                     _mm256_set1_ps(p->near_add[1]));
    const __m256 c = _mm256_fmadd_ps(_mm256_load_ps(node->plane[4 + z]),
                                     _mm256_set1_ps(p->inverse[2]),
                                     _mm256_set1_ps(p->near_add[2]));
    return _mm256_max_ps(_mm256_max_ps(a, b), _mm256_max_ps(c, _mm256_set1_ps(p->t_min)));
}

static inline __m256 node_far(const Node *node, const Probe *p, unsigned octant)
{
    const unsigned x = octant & 1, y = octant >> 1 & 1, z = octant >> 2 & 1;
    const __m256 a = _mm256_fmadd_ps(_mm256_load_ps(node->plane[1 - x]),
                                     _mm256_set1_ps(p->inverse[0]), _mm256_set1_ps(p->far_add[0]));
    const __m256 b = _mm256_fmadd_ps(_mm256_load_ps(node->plane[3 - y]),
                                     _mm256_set1_ps(p->inverse[1]), _mm256_set1_ps(p->far_add[1]));
    const __m256 c = _mm256_fmadd_ps(_mm256_load_ps(node->plane[5 - z]),
                                     _mm256_set1_ps(p->inverse[2]), _mm256_set1_ps(p->far_add[2]));
    return _mm256_min_ps(_mm256_min_ps(a, b), _mm256_min_ps(c, _mm256_set1_ps(p->t_max)));
}

#endif
