/* SPDX-License-Identifier: BSD-3-Clause */
/* math/tolerance.h -- every tolerance of the project, with its unit and where it comes from. */
#ifndef MATH_TOLERANCE_H
#define MATH_TOLERANCE_H

#include <float.h>
#include <math.h>

/* Relative error after n roundings in double is at most n u / (1 - n u) [higham02, ch. 3]. */
static inline double rounding_bound(int n)
{
    const double nu = n * (DBL_EPSILON / 2);
    return nu / (1 - nu);
}

/* The same in float. */
static inline float rounding_bound_float(int n)
{
    const float nu = (float)n * (FLT_EPSILON / 2);
    return nu / (1 - nu);
}

/* How far, in scene units, a ray's origin is moved off its surface so that its own surface and
 * faces coincident with it stay behind: a surface point stored in float is off by half an ulp of
 * its largest coordinate per axis, the vertices of the triangle it lies on likewise, and the
 * intersection shears them once more; 16 half-ulps cover the three with a factor 2 in hand. */
static inline double ray_offset(double largest_coordinate)
{
    return largest_coordinate * (double)rounding_bound_float(16);
}

/* Two positions no further apart than this mean one point, when the faces they belong to reach out
 * to `largest` (max |coordinate|): files hold floats, a coordinate is off by half an ulp; an object
 * placed by a transform in float adds three products and three sums, so 7 half-ulps; 8 serve. */
static inline double position_tolerance(double largest)
{
    return largest * (double)rounding_bound_float(8);
}

/* Unit normals whose cosine is above this lie in one smooth surface; below, the edge between them
 * is a crease: 30 degrees, the usual smoothing angle of modellers. */
#define TOLERANCE_CREASE_COSINE 0.86602540378443865

/* A reflectance of 1 or more is limited to this: light must die out. */
#define TOLERANCE_REFLECTANCE_MAX 0.99

#endif
