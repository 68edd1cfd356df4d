/* SPDX-License-Identifier: BSD-3-Clause */
/* math/mean_value.h -- values between the corners of a polygon: mean value coordinates [floater03].
 *
 * Linear along each edge, exact for linear functions, smooth inside; corners may lie on the
 * straight line between their neighbours. On a triangle they are the barycentric coordinates.
 */
#ifndef MATH_MEAN_VALUE_H
#define MATH_MEAN_VALUE_H

#include <stdint.h>

#include "math/vec3.h"

/* A polygon whose corners are numbers into a list of positions. */
typedef struct {
    const Vec3     *position;
    const uint32_t *corner;   /* [count] */
    uint32_t        count;    /* >= 3 */
} IndexPolygon;

/* Half the sum of cross products: along the normal that the polygon is counter-clockwise from, as
 * long as the area. */
Vec3 polygon_area(const IndexPolygon *polygon);

/* Weights [count] of the corners at `point`, sum 1, seen along the unit normal; all >= 0 inside a
 * convex polygon. A polygon without area gets equal weights. */
void mean_value_weights(const IndexPolygon *polygon, Vec3 normal, Vec3 point, double *weight);

/* Weights [count], sum 1, of the mean over the polygon: of triangles between a point inside and the
 * edges; exact for linear functions on flat convex polygons. */
void mean_value_average(const IndexPolygon *polygon, double *weight);

#endif
