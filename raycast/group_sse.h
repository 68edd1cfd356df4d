/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/group_sse.h -- the float filter for four triangles at once, for the x86 kernels.
 *
 * The same float operations as probe_shear; a lane is thrown away when its edge functions have two
 * strict signs, which double would find too (probe.h).
 */
#ifndef RAYCAST_GROUP_SSE_H
#define RAYCAST_GROUP_SSE_H

#include <emmintrin.h>

#include "raycast/probe.h"

/* Corners as the ray sees them, [corner]. */
typedef struct {
    __m128 x[3], y[3], z[3];
} Sheared;

static inline Sheared group_shear(const TriangleGroup *group, const Probe *p)
{
    Sheared s;
    for (int i = 0; i < 3; i++) {
        const __m128 a = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][p->axis[0]]),
                                    _mm_set1_ps(p->origin[0]));
        const __m128 b = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][p->axis[1]]),
                                    _mm_set1_ps(p->origin[1]));
        s.z[i] = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][p->axis[2]]),
                            _mm_set1_ps(p->origin[2]));
        s.x[i] = _mm_sub_ps(a, _mm_mul_ps(_mm_set1_ps(p->shear[0]), s.z[i]));
        s.y[i] = _mm_sub_ps(b, _mm_mul_ps(_mm_set1_ps(p->shear[1]), s.z[i]));
    }
    return s;
}

static inline __m128 edge_sse(__m128 ax, __m128 ay, __m128 bx, __m128 by)
{
    return _mm_sub_ps(_mm_mul_ps(ax, by), _mm_mul_ps(ay, bx));
}

/* Bits of the lanes that probe_triangle may accept. */
static inline unsigned group_filter(const TriangleGroup *group, const Sheared *s)
{
    const __m128 a = edge_sse(s->x[2], s->y[2], s->x[1], s->y[1]);
    const __m128 b = edge_sse(s->x[0], s->y[0], s->x[2], s->y[2]);
    const __m128 c = edge_sse(s->x[1], s->y[1], s->x[0], s->y[0]);
    const __m128 least = _mm_min_ps(_mm_min_ps(a, b), c);
    const __m128 most = _mm_max_ps(_mm_max_ps(a, b), c);
    const __m128 one_sign = _mm_or_ps(_mm_cmpge_ps(least, _mm_setzero_ps()),
                                      _mm_cmple_ps(most, _mm_setzero_ps()));
    const __m128 unused = _mm_castsi128_ps(_mm_loadu_si128((const __m128i *)group->primitive));
    return (unsigned)_mm_movemask_ps(_mm_andnot_ps(unused, one_sign));
}

#endif
