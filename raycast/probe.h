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

#include "raycast/internal.h"

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
    unsigned octant;             /* bit k: the direction is negative along axis k */
} Probe;

/* The best so far. t is the limit before anything was hit. */
typedef struct {
    float    t;
    uint32_t tie; /* a hit at exactly t counts when its primitive is below this */
    float    u, v;
    uint32_t primitive;
} Best;

static inline Best best_none(float t_max)
{
    return (Best){ .t = t_max, .tie = 0, .u = 0, .v = 0, .primitive = RAY_MISS };
}

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
        const float margin = PROBE_MARGIN * (fabsf(o[k]) + reach[k] + reach_z) * fabsf(inverse);
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
}

/* Takes a hit that is nearer, or as near and of a smaller number. */
static inline bool best_offer(Best *best, const Probe *p, float t, uint32_t primitive)
{
    if (!(t > p->t_min) || !(t < best->t || (t == best->t && primitive < best->tie)))
        return false;
    best->t = t;
    best->tie = primitive;
    best->primitive = primitive;
    return true;
}

/* x, y, z of a corner, seen along the ray; z is not sheared. */
static inline void probe_shear(const Probe *p, const float corner[3], float *x, float *y, float *z)
{
    *z = corner[2] - p->origin[2];
    *x = (corner[0] - p->origin[0]) - p->shear[0] * *z;
    *y = (corner[1] - p->origin[1]) - p->shear[1] * *z;
}

/* corner[i] holds the coordinates along axis[0], axis[1], axis[2]. */
static inline bool probe_triangle(const Probe *p, const float corner[3][3], uint32_t primitive,
                                  Best *best)
{
    float ax, ay, az, bx, by, bz, cx, cy, cz;
    probe_shear(p, corner[0], &ax, &ay, &az);
    probe_shear(p, corner[1], &bx, &by, &bz);
    probe_shear(p, corner[2], &cx, &cy, &cz);

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
    if (!best_offer(best, p, (float)t, primitive))
        return false;
    best->u = (float)(b * scale);
    best->v = (float)(c * scale);
    return true;
}

/* The triangle in one lane of a group. */
static inline bool probe_lane(const Probe *p, const TriangleGroup *group, int lane, Best *best)
{
    float corner[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            corner[i][k] = group->vertex[i][p->axis[k]][lane];
    return probe_triangle(p, (const float(*)[3])corner, group->primitive[lane], best);
}

/* The shape is asked for the whole ray, not up to the best hit: the answer must not depend on what
 * was met before. A t that rounds onto an end of the range is moved inside. */
static inline bool probe_shape(const Ray *ray, const Probe *p, const Shape *shape,
                               uint32_t primitive, Best *best)
{
    ShapeHit hit;
    if (!shape_intersect(shape, vec3(ray->ox, ray->oy, ray->oz), vec3(ray->dx, ray->dy, ray->dz),
                         ray->t_min, ray->t_max, &hit))
        return false;
    float t = (float)hit.t;
    if (t <= ray->t_min)
        t = nextafterf(ray->t_min, INFINITY);
    if (t >= ray->t_max)
        t = nextafterf(ray->t_max, 0);
    if (!best_offer(best, p, t, primitive))
        return false;
    best->u = (float)hit.u;
    best->v = (float)hit.v;
    return true;
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

/* Writes the answer; of a miss, t is the ray's end and u, v are 0. A weight of -0 becomes 0. */
static inline bool best_to_hit(const Best *best, Hit *hit)
{
    *hit = (Hit){ .t = best->t, .u = best->u + 0.0f, .v = best->v + 0.0f,
                  .primitive = best->primitive };
    return best->primitive != RAY_MISS;
}

/* A ray outside the range of probe_init scaled into it: *scaled and the power of two `exponent`
 * with t of the scaled ray = t * 2^exponent. False: the ray is not one and misses everything. */
bool ray_rescale(const Ray *ray, Ray *scaled, int *exponent);
/* Turns t of a hit of the scaled ray back; false when it is too large for a float: a miss. */
bool hit_rescale(Hit *hit, int exponent);

#endif
