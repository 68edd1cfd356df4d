/* SPDX-License-Identifier: BSD-3-Clause */
/* math/internal.h -- what only math/ needs to know about its shapes. */
#ifndef MATH_INTERNAL_H
#define MATH_INTERNAL_H

#include <stdbool.h>

#include "math/shape.h"

/* Point of the unit form, before the map to the world. */
Vec3 shape_local_point(const Shape *shape, double u, double v);
/* Its outward direction there: length 1, for the frustum length sqrt(1 + (ratio - 1)^2). */
Vec3 shape_local_normal(const Shape *shape, double u, double v);
/* |dP/du x dP/dv| of the unit form is this times the length of shape_local_normal. */
double shape_local_weight(const Shape *shape, double v);
/* Parameters of a point on the unit form, up to rounding. */
void shape_local_parameters(const Shape *shape, Vec3 p, double *u, double *v);

/* Area vectors under the map: the cofactor matrix of M times n, = det(M) M^-T n. */
Vec3 shape_cofactor(const Affine *map, Vec3 n);

/* A ray in the space of the unit form. Its point is origin + s direction, t = shift + s. */
typedef struct {
    Vec3   origin, direction; /* origin is the point nearest to the form's centre */
    double square;            /* of the direction's length, > 0 */
    double shift;             /* t of that origin */
    double t_min, t_max;
} LocalRay;

/* Whether s is in the ray's range, as the sum that is handed back rounds. */
static inline bool local_ray_allows(const LocalRay *ray, double s)
{
    const double t = ray->shift + s;
    return t > ray->t_min && t < ray->t_max;
}

/* First allowed s at which the ray meets the torus of ring radius 1 and the given tube radius. NaN
 * gives false. */
bool torus_first(const LocalRay *ray, double tube, double *s);

#endif
