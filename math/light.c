/* SPDX-License-Identifier: BSD-3-Clause */
/* Point, spot and cosine lights: where their light goes, and how much it is in all. */
#include "math/light.h"

#include <assert.h>
#include <stddef.h>

static double spot_share(const Light *light, double c)
{
    assert(light->cos_outer <= light->cos_inner);
    if (c >= light->cos_inner)
        return 1;
    if (c <= light->cos_outer)
        return 0;
    const double ramp = (c - light->cos_outer) / (light->cos_inner - light->cos_outer);
    return ramp * ramp;
}

double light_share(const Light *light, Vec3 w)
{
    assert(light != NULL);
    if (light->kind == LIGHT_POINT)
        return 1;
    /* Rounding may lift the cosine of two unit vectors above 1. */
    const double c = fmin(vec3_dot(light->direction, w), 1);
    return light->kind == LIGHT_SPOT ? spot_share(light, c) : fmax(c, 0);
}

Rgb light_flux(const Light *light)
{
    assert(light != NULL);
    assert(light->kind != LIGHT_SPOT || light->cos_outer <= light->cos_inner);
    double solid_angle = 4 * M_PI; /* integral of light_share over all directions */

    if (light->kind == LIGHT_COSINE)
        solid_angle = M_PI;
    else if (light->kind == LIGHT_SPOT) /* cap of the inner cone + integral of the squared ramp */
        solid_angle = 2 * M_PI * ((1 - light->cos_inner) +
                                  (light->cos_inner - light->cos_outer) / 3);
    return rgb_scale(light->intensity, solid_angle);
}
