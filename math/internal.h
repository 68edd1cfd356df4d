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

/* First s in (s_min, s_max) at which origin + s direction meets the torus of ring radius 1 and
 * the given tube radius. direction is a unit vector perpendicular to origin; NaN gives false. */
bool torus_first(double tube, Vec3 origin, Vec3 direction, double s_min, double s_max, double *s);

#endif
