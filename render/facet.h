/* SPDX-License-Identifier: BSD-3-Clause */
/* render/facet.h -- a flat lamp: how much of it a point sees, and points on it to aim at.
 *
 * Knows    math/ only. A facet is a triangle or a parallelogram that shines from its front.
 * Method   irradiance: Lambert's formula for polygons, after cutting away what lies below the
 *          receiver's horizon [arvo95-thesis]; samples uniform in solid angle: rectangles
 *          [urena13], triangles [arvo95]; uniform in area when the facet is seen small.
 */
#ifndef RENDER_FACET_H
#define RENDER_FACET_H

#include <stdbool.h>

#include "math/vec3.h"

typedef struct {
    int    count;      /* corners: 3 or 4 */
    bool   rectangle;
    Vec3   corner[4];  /* counter-clockwise seen from the front */
    Vec3   normal;     /* unit, to the front */
    double area;
    Vec3   x, y;       /* rectangle: unit vectors from corner 0 to 1 and 3 */
    double width, height;
} Facet;

/* count corners, counter-clockwise seen from the front; 4 corners must make a parallelogram. */
void facet_init(Facet *facet, const Vec3 *corner, int count);

/* How far p is in front of the facet's plane. */
static inline double facet_height(const Facet *facet, Vec3 p)
{
    return vec3_dot(facet->normal, vec3_sub(p, facet->corner[0]));
}

/* Irradiance at p with unit normal n when the facet has radiance 1 and nothing is in the way: the
 * integral of the cosine over the solid angle, 0..pi. p must lie in front of the facet. */
double facet_irradiance(const Facet *facet, Vec3 p, Vec3 n);

/* A point of the facet for (a, b) in [0,1)^2. Returns 1 / density, per solid angle, with which it
 * is chosen, > 0; p must lie in front of the facet. */
double facet_sample(const Facet *facet, Vec3 p, double a, double b, Vec3 *point);
/* The same 1 / density for a point of the facet however found. */
double facet_spread(const Facet *facet, Vec3 p, Vec3 point);

#endif
