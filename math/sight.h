/* SPDX-License-Identifier: BSD-3-Clause */
/* math/sight.h -- what a point sees of a convex polygon past other convex polygons: exactly.
 *
 * Method   the factor from a point to a polygon is a sum over its edges [lambert1760]; blockers
 *          cast their shadows away from the point, and what is left of the polygon are convex
 *          pieces [walton02].
 * Threads  plain functions of their arguments.
 */
#ifndef MATH_SIGHT_H
#define MATH_SIGHT_H

#include <stdbool.h>
#include <stddef.h>

#include "math/vec3.h"

enum { SIGHT_CORNERS = 20, SIGHT_PIECES = 128 };

typedef struct {
    Vec3   corner[SIGHT_CORNERS];
    size_t count;               /* 0: nothing is left */
} ConvexPolygon;

/* Lists that a sight is worked out in. */
typedef struct {
    ConvexPolygon piece[SIGHT_PIECES], next[SIGHT_PIECES];
} SightScratch;

/* Cuts away what lies where dot(normal, p) < offset; false when it would take too many corners. */
bool convex_polygon_cut(ConvexPolygon *polygon, Vec3 normal, double offset);

/* The share of what a point on a surface with unit normal n sends out that meets the polygon, which
 * lies nowhere behind the surface. In [0, 1]. */
double sight_factor(Vec3 point, Vec3 n, const ConvexPolygon *polygon);

/* The same past blockers, each of which lies nowhere behind the surface and nowhere behind the
 * polygon. At most sight_factor. NAN when the scratch is too small. */
double sight_past(Vec3 point, Vec3 n, const ConvexPolygon *polygon, const ConvexPolygon *blocker,
                  size_t blockers, SightScratch *scratch);

#endif
