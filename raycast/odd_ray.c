/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays with very long, very short or no direction, far origins, NaN and infinity. */
#include <assert.h>
#include <math.h>

#include "raycast/probe.h"

/* Powers of two only: what is in range stays exact. */
bool ray_rescale(const Ray *ray, Ray *scaled, int *exponent)
{
    assert(ray != NULL && scaled != NULL && exponent != NULL);
    const float largest = fmaxf(fmaxf(fabsf(ray->dx), fabsf(ray->dy)), fabsf(ray->dz));
    if (!isfinite(ray->dx) || !isfinite(ray->dy) || !isfinite(ray->dz) || largest == 0)
        return false;
    const float reach = fabsf(ray->ox) + fabsf(ray->oy) + fabsf(ray->oz);
    if (!(reach <= PROBE_COORDINATE_MAX))
        return false;
    *exponent = ilogbf(largest);
    *scaled = *ray;
    scaled->dx = ldexpf(ray->dx, -*exponent);
    scaled->dy = ldexpf(ray->dy, -*exponent);
    scaled->dz = ldexpf(ray->dz, -*exponent);
    scaled->t_min = ldexpf(ray->t_min, *exponent);
    scaled->t_max = ldexpf(ray->t_max, *exponent);
    assert(probe_takes(scaled));
    return true;
}

bool hit_rescale(Hit *hit, int exponent)
{
    assert(hit != NULL);
    hit->t = ldexpf(hit->t, -exponent);
    if (hit->t < INFINITY)
        return true;
    *hit = (Hit){ .t = INFINITY, .primitive = RAY_MISS };
    return false;
}
