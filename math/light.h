/* SPDX-License-Identifier: BSD-3-Clause */
/* math/light.h -- point and spot lights: intensity I in a direction, irradiance H = I cos / d^2.
 *
 * Units    intensity in cd (lm/sr) or W/sr, as the scene says; distances in scene units, so that
 *          illuminance is per square scene unit.
 */
#ifndef MATH_LIGHT_H
#define MATH_LIGHT_H

#include "math/rgb.h"
#include "math/vec3.h"

typedef enum {
    LIGHT_POINT, /* the same intensity all round */
    LIGHT_SPOT,  /* full inside the inner cone, smooth to 0 at the outer one */
    LIGHT_COSINE /* intensity * cos(angle to the axis) on the front side: a small flat source */
} LightKind;

typedef struct {
    LightKind kind;
    Vec3      position;
    Vec3      direction;  /* unit axis; spot and cosine only */
    Rgb       intensity;  /* on the axis */
    double    cos_inner;  /* spot: cosine of the half angle up to which intensity is full */
    double    cos_outer;  /* spot: cosine of the half angle from which it is 0; <= cos_inner */
    char      name[64];   /* for messages; may be "" */
} Light;

/* Share of the axis' intensity sent in the unit direction w away from the light, in [0, 1].
 * Spot: ((cos - outer)/(inner - outer))^2 clamped, the fall-off KHR_lights_punctual recommends. */
double light_share(const Light *light, Vec3 w);

/* All it sends out: integral of intensity over directions, closed form, lm or W. */
Rgb light_flux(const Light *light);

#endif
