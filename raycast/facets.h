/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/facets.h -- a group of triangles as seen by many rays from one origin.
 *
 * With a common origin the edge functions of a triangle are linear in a ray's shears: a + b s_x
 * + c s_y, (b, c, a) the cross product of two corners. Four triangles are made ready at once, in
 * double; then two fused operations an edge tell on which side a ray passes, and intervals of the
 * shears tell it of many rays. What these say is sure or nothing is said.
 *
 * Rounding, u = 2^-24: the numbers a, b, c in float and two fused operations are off by at most
 *   u (3 |a| + 2 |b| + 3 |c|). probe.h computes from corners that are sheared in float: with m the
 *   largest sheared coordinate and z the largest depth, each is off by u (z + m), so its edge
 *   functions by 4 m u (z + m) and terms of u^2. `unsure` is more than the sum of both.
 *   A hit's depth is the mean of the corners' depths with the edge functions as weights. With the
 *   exact ones it lies on the plane; each of those of probe.h is off by less than `unsure`, which
 *   moves the mean by at most 3 unsure / sum of the depths' range.
 */
#ifndef RAYCAST_FACETS_H
#define RAYCAST_FACETS_H

#include <float.h>

#include "raycast/packet_leaf.h"

/* More than all roundings of a few operations in a row. */
#define FACETS_SLACK (16 * PROBE_ROUNDING)

/* Rays from one origin, between which shears they lie, and how deep they look. Depths are along the
 * major axis in the rays' direction: t times the direction's size there. */
typedef struct {
    int      axis[3];
    float    origin[3];          /* along axis[] */
    float    middle[2], half[2]; /* of the shears */
    float    forward;            /* 1, or -1 when the rays go down axis[2] */
    float    t_min, limit;       /* depths: nothing before, nothing behind counts */
} Beam;

typedef struct {
    __m128   a[3], b[3], c[3]; /* edges as probe_sheared counts them */
    __m128   unsure;           /* edge functions of less than this size have no sign */
    __m128   from, to;         /* depths of all hits */
    unsigned left;             /* bits of the triangles that the beam may hit */
} Facets;

typedef struct {
    __m128  x[3], y[3], z[3];    /* from the origin */
    __m256d xd[3], yd[3], zd[3];
} FacetCorners;

static inline __m128 sse_abs(__m128 a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }

LANES_INLINE void facets_corners(FacetCorners *v, const Beam *beam, const TriangleGroup *group)
{
    for (int i = 0; i < 3; i++) {
        v->x[i] = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][beam->axis[0]]),
                             _mm_set1_ps(beam->origin[0]));
        v->y[i] = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][beam->axis[1]]),
                             _mm_set1_ps(beam->origin[1]));
        v->z[i] = _mm_sub_ps(_mm_loadu_ps(group->vertex[i][beam->axis[2]]),
                             _mm_set1_ps(beam->origin[2]));
        v->xd[i] = _mm256_cvtps_pd(v->x[i]);
        v->yd[i] = _mm256_cvtps_pd(v->y[i]);
        v->zd[i] = _mm256_cvtps_pd(v->z[i]);
    }
}

/* a b - c d */
LANES_INLINE __m256d facets_cross(__m256d a, __m256d b, __m256d c, __m256d d)
{
    return _mm256_sub_pd(_mm256_mul_pd(a, b), _mm256_mul_pd(c, d));
}

/* Fills the edges; returns six times the volume over the origin. */
LANES_INLINE __m128 facets_edges(Facets *f, const FacetCorners *v)
{
    static const int from[3] = { 2, 0, 1 }, to[3] = { 1, 2, 0 };
    __m256d volume = _mm256_setzero_pd();
    for (int k = 0; k < 3; k++) {
        const int i = from[k], j = to[k];
        const __m256d a = facets_cross(v->xd[i], v->yd[j], v->yd[i], v->xd[j]);
        f->a[k] = _mm256_cvtpd_ps(a);
        f->b[k] = _mm256_cvtpd_ps(facets_cross(v->yd[i], v->zd[j], v->zd[i], v->yd[j]));
        f->c[k] = _mm256_cvtpd_ps(facets_cross(v->zd[i], v->xd[j], v->xd[i], v->zd[j]));
        volume = _mm256_fmadd_pd(a, v->zd[k], volume);
    }
    return _mm256_cvtpd_ps(volume);
}

/* The size of an edge function that is surely not of the other sign. */
LANES_INLINE __m128 facets_unsure(const Facets *f, const FacetCorners *v, const Beam *beam)
{
    const __m128 sx = _mm_set1_ps(beam->middle[0]), sy = _mm_set1_ps(beam->middle[1]);
    const __m128 wx = _mm_set1_ps(beam->half[0]), wy = _mm_set1_ps(beam->half[1]);
    __m128 size = _mm_setzero_ps(), wide = size, deep = size;
    for (int k = 0; k < 3; k++) {
        const __m128 sum = _mm_add_ps(_mm_add_ps(sse_abs(f->a[k]), sse_abs(f->b[k])),
                                      sse_abs(f->c[k]));
        const __m128 z = sse_abs(v->z[k]);
        const __m128 x = sse_abs(_mm_fnmadd_ps(sx, v->z[k], v->x[k]));
        const __m128 y = sse_abs(_mm_fnmadd_ps(sy, v->z[k], v->y[k]));
        size = _mm_max_ps(size, sum);
        deep = _mm_max_ps(deep, z);
        wide = _mm_max_ps(wide, _mm_max_ps(_mm_fmadd_ps(wx, z, x), _mm_fmadd_ps(wy, z, y)));
    }
    wide = _mm_fmadd_ps(deep, _mm_set1_ps(FACETS_SLACK), wide);
    const __m128 moved = _mm_mul_ps(_mm_mul_ps(_mm_set1_ps(8 * PROBE_ROUNDING), wide),
                                    _mm_add_ps(wide, deep));
    const __m128 sum = _mm_fmadd_ps(_mm_set1_ps(4 * PROBE_ROUNDING), size, moved);
    return _mm_add_ps(sum, _mm_set1_ps(8 * FLT_MIN));
}

/* Between which depths the hits lie: those of the corners, and those of the plane where the rays
 * meet it. `sum`, `half`: the sum of the edge functions and how far it may be from that. */
LANES_INLINE void facets_depth(Facets *f, const FacetCorners *v, const Beam *beam, __m128 volume,
                               __m128 sum, __m128 half)
{
    const __m128 sign = _mm_set1_ps(-0.0f), forward = _mm_set1_ps(beam->forward);
    const __m128 z0 = _mm_mul_ps(v->z[0], forward), z1 = _mm_mul_ps(v->z[1], forward);
    const __m128 z2 = _mm_mul_ps(v->z[2], forward);
    const __m128 least = _mm_min_ps(_mm_min_ps(z0, z1), z2);
    const __m128 most = _mm_max_ps(_mm_max_ps(z0, z1), z2);
    const __m128 size = sse_abs(sum), low = _mm_sub_ps(size, half), high = _mm_add_ps(size, half);
    const __m128 height = _mm_mul_ps(_mm_xor_ps(volume, _mm_and_ps(sum, sign)), forward);
    const __m128 a = _mm_div_ps(height, high), inverse = _mm_div_ps(_mm_set1_ps(1), low);
    const __m128 b = _mm_mul_ps(height, inverse);
    const __m128 moved = _mm_mul_ps(_mm_mul_ps(_mm_set1_ps(4), f->unsure),
                                    _mm_mul_ps(_mm_sub_ps(most, least), inverse));
    const __m128 slack = _mm_set1_ps(FACETS_SLACK);
    const __m128 around = _mm_fmadd_ps(slack, sse_abs(b), moved);
    /* Of two numbers min and max give the second when the first is NaN. */
    const __m128 plane_from = _mm_max_ps(_mm_sub_ps(_mm_min_ps(a, b), around), least);
    const __m128 plane_to = _mm_min_ps(_mm_add_ps(_mm_max_ps(a, b), around), most);
    const __m128 clear = _mm_cmpgt_ps(low, _mm_setzero_ps());
    const __m128 from = _mm_blendv_ps(least, plane_from, clear);
    const __m128 to = _mm_blendv_ps(most, plane_to, clear);
    f->from = _mm_fnmadd_ps(slack, sse_abs(from), from);
    f->to = _mm_fmadd_ps(slack, sse_abs(to), to);
}

LANES_INLINE void facets_fill(Facets *f, const Beam *beam, const TriangleGroup *group)
{
    FacetCorners v;
    facets_corners(&v, beam, group);
    const __m128 volume = facets_edges(f, &v);
    f->unsure = facets_unsure(f, &v, beam);
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 sx = _mm_set1_ps(beam->middle[0]), sy = _mm_set1_ps(beam->middle[1]);
    const __m128 wx = _mm_set1_ps(beam->half[0]), wy = _mm_set1_ps(beam->half[1]);
    __m128 positive = _mm_setzero_ps(), negative = positive, sum = positive, half = f->unsure;
    for (int k = 0; k < 3; k++) {
        const __m128 edge = _mm_fmadd_ps(f->b[k], sx, _mm_fmadd_ps(f->c[k], sy, f->a[k]));
        const __m128 width = _mm_fmadd_ps(sse_abs(f->b[k]), wx,
                                          _mm_fmadd_ps(sse_abs(f->c[k]), wy, f->unsure));
        positive = _mm_or_ps(positive, _mm_cmpgt_ps(edge, width));
        negative = _mm_or_ps(negative, _mm_cmplt_ps(edge, _mm_xor_ps(sign, width)));
        sum = _mm_add_ps(sum, edge);
        half = _mm_add_ps(half, width);
    }
    facets_depth(f, &v, beam, volume, sum, half);
    const __m128 beyond = _mm_or_ps(_mm_cmpgt_ps(f->from, _mm_set1_ps(beam->limit)),
                                    _mm_cmplt_ps(f->to, _mm_set1_ps(beam->t_min)));
    const __m128 out = _mm_or_ps(_mm_and_ps(positive, negative), beyond);
    f->left = ~(unsigned)_mm_movemask_ps(out) & group_used(group);
}

#endif
