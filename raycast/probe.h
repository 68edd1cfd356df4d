/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/probe.h -- one ray made ready, and the tests against one triangle and one shape.
 *
 * Every kernel and the brute-force twin decide hits with these functions and no others, so their
 * answers are equal bit for bit. Kernels only differ in how they leave primitives out.
 *
 * Triangle [woop13]: the vertices are sheared, in float, so that the ray becomes the z axis. The
 *   sign of an edge function a*b - c*d of floats is exact in double (both products are exact, and
 *   a rounded difference keeps its sign), and two triangles at one edge compute it from the same
 *   numbers: no ray passes between them. In float the sign is right too unless the result is 0,
 *   so kernels throw away in float what has two strict signs and let double decide the rest.
 *
 * Boxes: with u = 2^-24 and D the largest distance, axis by axis, from the origin to a corner of
 *   the scene, the hit of a sheared triangle lies on a triangle whose vertices are moved by at most
 *   u (2 D_x + 4 D_z) along x (and y), u D_z along z: subtraction of the origin, 1/d_z, d_x/d_z,
 *   its product, the last difference. The slab test `plane * inverse + add` is off by at most
 *   u (3 |o_x| + 3 D_x) of the plane's place, the hit's t rounded to float by u D_x. So no box of a
 *   hit is missed when all boxes are widened by 8 u (|o_x| + D_x + D_z); this is done by moving
 *   `add`. The same margin makes it harmless to lift direction components to 2^-30 of the largest.
 */
#ifndef RAYCAST_PROBE_H
#define RAYCAST_PROBE_H

#include <assert.h>
#include <math.h>

#include "raycast/best.h"

/* Half an ulp of 1 in float. */
#define PROBE_ROUNDING 0x1p-24f
#define PROBE_MARGIN (8 * PROBE_ROUNDING)
/* Directions shorter or longer are scaled first, so that nothing overflows on the way. */
#define PROBE_LENGTH_MIN 0x1p-40f
#define PROBE_LENGTH_MAX 0x1p40f
/* Coordinates beyond are refused in a scene and make a ray miss. */
#define PROBE_COORDINATE_MAX 0x1p40f
#define PROBE_SMALLEST_SLOPE 0x1p-30f

typedef struct {
    float  inverse[3];           /* 1 / direction, always finite */
    float  near_add[3];          /* t at the near side of a slab: plane * inverse + near_add */
    float  far_add[3];
    float  t_min, t_max;
    int    axis[3];              /* the largest component of the direction is axis[2] */
    float  origin[3];            /* along axis[0], axis[1], axis[2] */
    float  shear[2];             /* direction along axis[0], axis[1], over that along axis[2] */
    double inverse_z;
    float  margin[3];            /* how much boxes are widened; see best.h */
    float  reach;                /* how far along the ray faces in one place may lie apart */
    unsigned octant;             /* bit k: the direction is negative along axis k */
} Probe;

/* False for a ray that probe_init cannot take: bvh_odd_ray (bvh.c) makes it one or a miss. */
static inline bool probe_takes(const Ray *ray)
{
    const float length = fabsf(ray->dx) + fabsf(ray->dy) + fabsf(ray->dz);
    const float reach = fabsf(ray->ox) + fabsf(ray->oy) + fabsf(ray->oz);
    return length >= PROBE_LENGTH_MIN && length <= PROBE_LENGTH_MAX
           && reach <= PROBE_COORDINATE_MAX;
}

static inline void probe_init(Probe *p, const Ray *ray, const float lo[3], const float hi[3])
{
    const float o[3] = { ray->ox, ray->oy, ray->oz }, d[3] = { ray->dx, ray->dy, ray->dz };
    const float ax = fabsf(d[0]), ay = fabsf(d[1]), az = fabsf(d[2]);
    const int z = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    const int x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
    const float largest = fabsf(d[z]), smallest = largest * PROBE_SMALLEST_SLOPE;
    float reach[3];
    for (int k = 0; k < 3; k++) {
        const float a = fabsf(lo[k] - o[k]), b = fabsf(hi[k] - o[k]);
        reach[k] = a > b ? a : b;
    }
    const float reach_z = reach[z];

    p->octant = 0;
    for (int k = 0; k < 3; k++) {
        const float size = fabsf(d[k]) < smallest ? smallest : fabsf(d[k]);
        const float inverse = copysignf(1 / size, d[k]);
        p->margin[k] = PROBE_MARGIN * (fabsf(o[k]) + reach[k] + reach_z);
        const float margin = p->margin[k] * fabsf(inverse);
        const float at = o[k] * inverse;
        p->inverse[k] = inverse;
        p->near_add[k] = -at - margin;
        p->far_add[k] = margin - at;
        p->octant |= (unsigned)(inverse < 0) << k;
    }
    p->t_min = ray->t_min;
    p->t_max = ray->t_max;
    p->axis[0] = x;
    p->axis[1] = y;
    p->axis[2] = z;
    p->origin[0] = o[x];
    p->origin[1] = o[y];
    p->origin[2] = o[z];
    p->shear[0] = d[x] * p->inverse[z];
    p->shear[1] = d[y] * p->inverse[z];
    p->inverse_z = 1 / (double)d[z];
    p->reach = BEST_GRADIENT * (p->margin[0] + p->margin[1] + p->margin[2]) * fabsf(p->inverse[z]);
}

/* x, y, z of a corner, seen along the ray; z is not sheared. */
static inline void probe_shear(const Probe *p, const float corner[3], float *x, float *y, float *z)
{
    *z = corner[2] - p->origin[2];
    *x = (corner[0] - p->origin[0]) - p->shear[0] * *z;
    *y = (corner[1] - p->origin[1]) - p->shear[1] * *z;
}

/* A triangle whose corners are sheared: x, y, z of each. */
static inline bool probe_sheared(const Probe *p, float ax, float ay, float az, float bx, float by,
                                 float bz, float cx, float cy, float cz, uint32_t primitive,
                                 uint32_t place, Best *best)
{
    const double a = (double)cx * by - (double)cy * bx;
    const double b = (double)ax * cy - (double)ay * cx;
    const double c = (double)bx * ay - (double)by * ax;
    if ((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0))
        return false;
    const double sum = a + b + c;
    if (sum == 0)
        return false;
    const double scale = 1 / sum;
    const double t = (a * az + b * bz + c * cz) * scale * p->inverse_z;
    /* sum is twice the area in the frame of the ray, with the sign of -normal_z. */
    const uint32_t side = (sum > 0) == (p->inverse_z > 0) ? 0 : BEST_BACK;
    const Candidate hit = { .t = (float)t, .u = (float)(b * scale), .v = (float)(c * scale),
                            .key = primitive | side, .place = place };
    return hit.t > p->t_min && hit.t <= best->limit && best_offer(best, p->reach, &hit);
}

/* corner[i] holds the coordinates along axis[0], axis[1], axis[2]. */
static inline bool probe_triangle(const Probe *p, const float corner[3][3], uint32_t primitive,
                                  uint32_t place, Best *best)
{
    float ax, ay, az, bx, by, bz, cx, cy, cz;
    probe_shear(p, corner[0], &ax, &ay, &az);
    probe_shear(p, corner[1], &bx, &by, &bz);
    probe_shear(p, corner[2], &cx, &cy, &cz);
    return probe_sheared(p, ax, ay, az, bx, by, bz, cx, cy, cz, primitive, place, best);
}

/* The triangle in one lane of a group, whose first lane is at `place`. */
static inline bool probe_lane(const Probe *p, const TriangleGroup *group, int lane, uint32_t place,
                              Best *best)
{
    float corner[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            corner[i][k] = group->vertex[i][p->axis[k]][lane];
    return probe_triangle(p, (const float(*)[3])corner, group->primitive[lane],
                          place + (uint32_t)lane, best);
}

/* The shape is asked for the whole ray, not up to the best hit: the answer must not depend on what
 * was met before. A t that rounds onto an end of the range is moved inside. With `any` nobody asks
 * where on the shape. */
static inline bool probe_shape(const Ray *ray, const Probe *p, const Shape *shape,
                               uint32_t primitive, bool any, Best *best)
{
    ShapeMeeting hit;
    double       u = 0, v = 0;
    if (!shape_meet(shape, vec3(ray->ox, ray->oy, ray->oz), vec3(ray->dx, ray->dy, ray->dz),
                    ray->t_min, ray->t_max, &hit))
        return false;
    float t = (float)hit.t;
    if (t <= ray->t_min)
        t = nextafterf(ray->t_min, INFINITY);
    if (t >= ray->t_max)
        t = nextafterf(ray->t_max, 0);
    if (!(t > ray->t_min && t <= best->limit))
        return false;
    const uint32_t side = hit.front ? 0 : BEST_BACK;
    if (!any)
        shape_meeting_parameters(shape, &hit, &u, &v);
    const Candidate found = { .t = t, .u = (float)u, .v = (float)v,
                              .key = primitive | side, .place = 0 };
    return best_offer(best, p->reach, &found);
}

/* The corners of a triangle in float.
 * Returns false when it has no area: such a triangle is never hit. */
static inline bool probe_corners(const Primitives *in, uint32_t triangle, float corner[3][3])
{
    for (int i = 0; i < 3; i++) {
        const Vec3 p = in->position[in->corner[3 * (size_t)triangle + (size_t)i]];
        corner[i][0] = (float)p.x;
        corner[i][1] = (float)p.y;
        corner[i][2] = (float)p.z;
    }
    double e[2][3];
    for (int k = 0; k < 3; k++) {
        e[0][k] = (double)corner[1][k] - corner[0][k];
        e[1][k] = (double)corner[2][k] - corner[0][k];
    }
    return e[0][1] * e[1][2] != e[0][2] * e[1][1] || e[0][2] * e[1][0] != e[0][0] * e[1][2]
           || e[0][0] * e[1][1] != e[0][1] * e[1][0];
}

/* --- the answer ------------------------------------------------------------------------------ */

/* How far behind best->first, on a face with this normal, another face in the same place may be
 * hit (best.h), but never more than p->reach. Normal and ray as they are in the scene. */
static inline float probe_slack(const Probe *p, const Ray *ray, Vec3 normal)
{
    const double inverse = fabs(p->inverse_z);
    const double along = fabs(vec3_dot(normal, vec3(ray->dx, ray->dy, ray->dz))) * inverse;
    const double side = fabs(vec3_axis(normal, p->axis[0])) * (double)p->margin[p->axis[0]]
                        + fabs(vec3_axis(normal, p->axis[1])) * (double)p->margin[p->axis[1]];
    const double slack = ((double)p->margin[p->axis[2]] + side / along) * inverse;
    return slack < (double)p->reach ? (float)slack : p->reach;
}

/* The normal of a triangle, of any length, from its corners in float. */
static inline Vec3 probe_normal(const float a[3], const float b[3], const float c[3])
{
    const Vec3 p = vec3((double)a[0], (double)a[1], (double)a[2]);
    return vec3_cross(vec3_sub(vec3((double)b[0], (double)b[1], (double)b[2]), p),
                      vec3_sub(vec3((double)c[0], (double)c[1], (double)c[2]), p));
}

/* Which of the two is the answer, when `first` lies on a face with this normal. */
static inline const Candidate *best_choose(const Best *best, const Probe *p, const Ray *ray,
                                           Vec3 normal)
{
    /* Rounded like best->limit: whatever is chosen here was not cut off before. */
    const float end = best->first.t + probe_slack(p, ray, normal);
    return best->facing.t <= end ? &best->facing : &best->first;
}

/* A ray outside the range of probe_init scaled into it: *scaled and the power of two `exponent`
 * with t of the scaled ray = t * 2^exponent. False: the ray is not one and misses everything. */
bool ray_rescale(const Ray *ray, Ray *scaled, int *exponent);
/* Turns t of a hit of the scaled ray back; false when it is too large for a float: a miss. */
bool hit_rescale(Hit *hit, int exponent);

#endif
