/* SPDX-License-Identifier: BSD-3-Clause */
/* math/fresnel.h -- how much of unpolarised light clear matter sends back. */
#ifndef MATH_FRESNEL_H
#define MATH_FRESNEL_H

#include <assert.h>
#include <math.h>

/* Reflectance of one face; cosine: of the angle of incidence, 0..1; eta: index of the side entered
 * over that of the side left. 1 where nothing gets through. */
static inline double fresnel(double cosine, double eta)
{
    assert(eta > 0);
    const double square = 1 - (1 - cosine * cosine) / (eta * eta);
    if (square <= 0)
        return 1; /* total reflection */
    const double inner = sqrt(square);
    const double s = (cosine - eta * inner) / (cosine + eta * inner);
    const double p = (eta * cosine - inner) / (eta * cosine + inner);
    return (s * s + p * p) / 2;
}

/* Reflectance of a pane: both its faces, and all that goes to and fro between them. */
static inline double fresnel_pane(double cosine, double ior)
{
    const double f = fresnel(cosine, ior);
    return 2 * f / (1 + f);
}

#endif
