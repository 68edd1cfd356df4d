/* SPDX-License-Identifier: BSD-3-Clause */
/* The walk with SSE4.2: a node in two halves, a group at once. */
#include "raycast/internal.h"
#include "raycast/probe.h"

#ifdef ISOLUX_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("sse4.2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("sse4.2")
#endif

#include <smmintrin.h>

#include "raycast/group_sse.h"

static inline uint32_t node_push(const Node *node, const Probe *p, float t_limit, bool any,
                                 float *near, uint32_t *child, uint32_t *next)
{
    float from[NODE_WIDTH];
    unsigned hits = 0;
    for (unsigned half = 0; half < NODE_WIDTH; half += 4) {
        __m128 t0 = _mm_set1_ps(p->t_min), t1 = _mm_set1_ps(t_limit);
        for (unsigned k = 0; k < 3; k++) {
            const unsigned negative = p->octant >> k & 1;
            const __m128 inverse = _mm_set1_ps(p->inverse[k]);
            const __m128 a = _mm_loadu_ps(&node->plane[2 * k + negative][half]);
            const __m128 b = _mm_loadu_ps(&node->plane[2 * k + 1 - negative][half]);
            t0 = _mm_max_ps(t0, _mm_add_ps(_mm_mul_ps(a, inverse), _mm_set1_ps(p->near_add[k])));
            t1 = _mm_min_ps(t1, _mm_add_ps(_mm_mul_ps(b, inverse), _mm_set1_ps(p->far_add[k])));
        }
        _mm_storeu_ps(from + half, t0);
        hits |= (unsigned)_mm_movemask_ps(_mm_cmple_ps(t0, t1)) << half;
    }
    uint32_t count = 0;
    (void)any;
    for (unsigned i = 0; i < NODE_WIDTH; i++) {
        const unsigned slot = i ^ p->octant;
        near[count] = from[slot];
        child[count] = node->child[slot];
        count += hits >> slot & 1;
    }
    *next = count > 0 ? child[count - 1] : CHILD_NONE;
    return count > 0 ? count - 1 : 0;
}

static inline bool group_test(const TriangleGroup *group, const Probe *p, uint32_t place,
                              Best *best)
{
    const Sheared s = group_shear(group, p);
    bool found = false;
    for (unsigned lanes = group_filter(group, &s); lanes != 0; lanes &= lanes - 1)
        found |= probe_lane(p, group, __builtin_ctz(lanes), place, best);
    return found;
}

static inline bool groups_test(const TriangleGroup *group, uint32_t count, const Probe *p,
                               uint32_t place, bool any, Best *best)
{
    bool found = false;
    for (uint32_t g = 0; g < count && !(any && found); g++)
        found |= group_test(&group[g], p, place + g * GROUP_WIDTH, best);
    return found;
}

#include "raycast/trace.h"

const Kernel kernel_sse42 = KERNEL_TABLE("sse4.2", singles_nearest, singles_blocked, NULL,
                                          singles_nearest, singles_blocked);

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#else
typedef int trace_sse42_is_empty_here; /* a file must declare something */
#endif
