/* SPDX-License-Identifier: BSD-3-Clause */
/* math/shape.h -- exact curved surfaces: rays meet them as they are, patches lie on them.
 *
 * A shape is a unit form in its own space and an affine map to the world, so that ellipsoids,
 * elliptic cylinders and sheared cones come for free. Each has parameters (u, v) in [0,1]^2:
 *
 *   SPHERE   |p| = 1                u: longitude / 2 pi about z, v: (1 + z) / 2 (equal areas)
 *   DISC     z = 0, x^2+y^2 <= 1    u: angle / 2 pi, v: radius^2 (equal areas)
 *   FRUSTUM  z in [0,1], radius 1 + (ratio - 1) z: cylinder coat (1), cone (0), stump; no lids
 *                                   u: angle / 2 pi, v: z
 *   TORUS    circle of radius 1 about z, tube radius `ratio` < 1
 *                                   u: angle about z / 2 pi, v: angle about the tube / 2 pi
 *
 * Normals point out of the solid (disc: along +z of its space), also under mirroring maps.
 * Units    scene units. Rays are double: quadrics and quartics lose too much in float.
 * Method   rays are moved to the point nearest to the centre, so that coefficients stay small;
 *          torus: the quartic's turning points bracket its roots, Newton with bisection finds them
 *          on the distance to the ring, which does not cancel for thin tubes.
 */
#ifndef MATH_SHAPE_H
#define MATH_SHAPE_H

#include <stdbool.h>

#include "base/error.h"
#include "math/affine.h"

typedef enum { SHAPE_SPHERE, SHAPE_DISC, SHAPE_FRUSTUM, SHAPE_TORUS } ShapeKind;

typedef struct {
    ShapeKind kind;
    double    ratio;    /* frustum: top radius / bottom radius >= 0; torus: tube / ring, (0, 1) */
    Affine    to_world; /* unit form -> world */
    Affine    to_local; /* its inverse */
} Shape;

/* Fills *shape. fails  false and ERROR_INPUT when the map is singular or ratio is out of range. */
bool shape_init(Shape *shape, ShapeKind kind, double ratio, const Affine *to_world, Error *err);

/* The point in the world with these parameters. */
Vec3 shape_point(const Shape *shape, double u, double v);
/* Unit normal in the world. At a cone's tip: the limit along u. */
Vec3 shape_normal(const Shape *shape, double u, double v);
/* |dP/du x dP/dv|: area per unit of (u, v). */
double shape_density(const Shape *shape, double u, double v);
/* The first two, or all three, at once, bit for bit: sooner. */
void shape_place_at(const Shape *shape, double u, double v, Vec3 *point, Vec3 *normal);
void shape_all_at(const Shape *shape, double u, double v, Vec3 *point, Vec3 *normal,
                  double *density);
/* Area of the part u0..u1, v0..v1 by adaptive Gauss-Legendre quadrature, relative error < 1e-9. */
double shape_area(const Shape *shape, double u0, double u1, double v0, double v1);
/* How far p is outside of the shape, measured in its unit form: < 0 inside. A frustum's coat goes
 * on without end (but not beyond its tip), a disc is its whole plane with the normal outwards.
 * Never more than the distance there, and over a way of length 1 there it changes by no more than
 * 1. */
double shape_outside(const Shape *shape, Vec3 p);
/* Radius of a ball, in the world, about the point in the middle of u0..u1, v0..v1 that holds this
 * part of the shape. */
double shape_reach(const Shape *shape, double u0, double u1, double v0, double v1);
/* Corners of the axis-parallel box around the whole shape. */
void shape_bounds(const Shape *shape, Vec3 *lo, Vec3 *hi);
/* Parameters of the point of the shape nearest to p, p on it up to rounding. */
void shape_parameters(const Shape *shape, Vec3 p, double *u, double *v);

typedef struct {
    double t, u, v;
    bool   front; /* the ray goes against the normal there */
} ShapeHit;

/* Nearest hit with t_min < t < t_max; both sides count; a NaN gives no hit. */
bool shape_intersect(const Shape *shape, Vec3 origin, Vec3 direction, double t_min, double t_max,
                     ShapeHit *hit);

/* The same without (u, v), whose angle takes long and which only a ray's nearest hit needs. */
typedef struct {
    double t;
    bool   front;
    Vec3   local; /* point of the unit form, for shape_meeting_parameters */
} ShapeMeeting;
bool shape_meet(const Shape *shape, Vec3 origin, Vec3 direction, double t_min, double t_max,
                ShapeMeeting *meeting);
void shape_meeting_parameters(const Shape *shape, const ShapeMeeting *meeting, double *u,
                              double *v);

#endif
