/* SPDX-License-Identifier: BSD-3-Clause */
/* math/polygon_factor.h -- the exact form factor between two flat polygons with nothing between.
 *
 * Method   Stokes' theorem turns the double area integral into one along both outlines,
 *          A_p F_pq = 1/(2 pi) sum over pairs of edges of cos(edges) * integral of ln r ds dt
 *          [sparrow63]; the inner integral is done in closed form, the outer one by Gauss-Legendre
 *          where the edges are well apart, by the double exponential rule [takahasi74] where they
 *          come near or touch, cut at the places where the integrand has a kink. What of either
 *          polygon lies behind the other's plane is cut away first.
 * Units    any length; the result is an area.
 * Accuracy about 1e-10 of the smaller area; outlines that touch or share edges included.
 */
#ifndef MATH_POLYGON_FACTOR_H
#define MATH_POLYGON_FACTOR_H

#include <stddef.h>

#include "math/vec3.h"

enum { POLYGON_FACTOR_CORNERS = 64 }; /* most corners of a polygon */

typedef struct {
    Vec3   corner[POLYGON_FACTOR_CORNERS]; /* counter-clockwise seen from the side that counts */
    size_t count;                          /* 3 or more; convex or not */
} FlatPolygon;

/* A_p F_pq = A_q F_qp between the fronts of p and q; 0 when they cannot see each other. */
double polygon_factor_area(const FlatPolygon *p, const FlatPolygon *q);

/* Area and unit normal; the normal is 0 for a polygon without area. */
double flat_polygon_area(const FlatPolygon *p, Vec3 *normal);

#endif
