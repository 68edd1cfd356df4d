/* SPDX-License-Identifier: BSD-3-Clause */
/* math/affine.h -- affine maps: p -> M p + t. */
#ifndef MATH_AFFINE_H
#define MATH_AFFINE_H

#include <stdbool.h>

#include "math/vec3.h"

typedef struct {
    Vec3 x, y, z; /* images of the three axes: the columns of M */
    Vec3 t;       /* image of the origin */
} Affine;

static inline Affine affine_identity(void)
{
    return (Affine){ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };
}
static inline Vec3 affine_vector(const Affine *a, Vec3 v)
{
    return vec3(a->x.x * v.x + a->y.x * v.y + a->z.x * v.z,
                a->x.y * v.x + a->y.y * v.y + a->z.y * v.z,
                a->x.z * v.x + a->y.z * v.y + a->z.z * v.z);
}
static inline Vec3 affine_point(const Affine *a, Vec3 p)
{
    return vec3_add(affine_vector(a, p), a->t);
}
/* The map that does `first`, then `second`. */
Affine affine_then(const Affine *first, const Affine *second);
/* Degrees, right-handed, about the x, y or z axis (0, 1, 2). */
Affine affine_rotation(int axis, double degrees);
double affine_determinant(const Affine *a);
/* How many times longer a vector becomes at most; off by rounding only, never too small. */
double affine_stretch(const Affine *a);
/* The inverse; false, and *out untouched, when the map has none (or one that is not finite). */
bool affine_invert(const Affine *a, Affine *out);
/* Transforms a normal: M^-T n, not normalised, given the inverse of the map. */
static inline Vec3 affine_normal(const Affine *inverse, Vec3 n)
{
    return vec3(vec3_dot(inverse->x, n), vec3_dot(inverse->y, n), vec3_dot(inverse->z, n));
}
/* The same direction without the inverse, by cofactors; 0 where the map leaves none. */
static inline Vec3 affine_cofactor(const Affine *a, Vec3 n)
{
    const Vec3   x = vec3_cross(a->y, a->z), y = vec3_cross(a->z, a->x);
    const Vec3   m = vec3_mad(vec3_mad(vec3_scale(x, n.x), n.y, y), n.z, vec3_cross(a->x, a->y));
    return vec3_scale(m, vec3_dot(a->x, x) < 0 ? -1 : 1);
}

#endif
