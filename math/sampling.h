/* SPDX-License-Identifier: BSD-3-Clause */
/* math/sampling.h -- scrambled low-discrepancy points and the maps that use them.
 *
 * Everything is a function of (index, seed): no state, so the same numbers whatever thread asks.
 * Method   Sobol' points, direction numbers by Joe and Kuo [joe08], nested uniform (Owen)
 *          scrambling by hashing [laine11], [burley20]; seeds are mixed by Philox4x32 [salmon11].
 */
#ifndef MATH_SAMPLING_H
#define MATH_SAMPLING_H

#include <stdint.h>

#include "math/vec3.h"

/* A 32-bit seed out of up to four keys, well mixed (counter-based). */
uint32_t sampling_seed(uint32_t a, uint32_t b, uint32_t c, uint32_t d);

/* Cheap 32-bit mix of one word, for deriving seeds inside a loop. */
uint32_t sampling_mix(uint32_t x);

/* Point `index` of a scrambled, shuffled 4-dimensional Sobol' sequence into out[4], each in [0,1).
 * Every power-of-two block of indices that starts at a multiple of itself is a digital net. */
void sampling_sobol4(uint32_t index, uint32_t seed, float out[4]);
/* The same in two dimensions: a scrambled (0,2)-sequence. Cheaper. */
void sampling_sobol2(uint32_t index, uint32_t seed, float out[2]);

/* Cosine-distributed direction in the frame where z is the normal: (x, y, z), z >= 0; concentric
 * map of the square [shirley97], so strata stay compact. z is at least 1e-4: no ray lies in its own
 * plane. */
Vec3 sampling_cosine(double a, double b);
/* Uniform point of the unit disc, concentric map. */
void sampling_disc(double a, double b, double *x, double *y);
/* Uniform barycentric weights (of corners 1 and 2) in a triangle, without folding the square
 * [heitz19]. */
void sampling_triangle(double a, double b, double *u, double *v);
/* Uniform direction on the sphere. */
Vec3 sampling_sphere(double a, double b);

#endif
