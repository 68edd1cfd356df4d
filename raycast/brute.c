/* SPDX-License-Identifier: BSD-3-Clause */
/* Every primitive asked in turn: what the tree must agree with. */
#include <assert.h>
#include <math.h>

#include "raycast/probe.h"

/* No boxes here, so the margin of the probe does not matter. */
static Best brute_trace(const Primitives *in, const Ray *ray)
{
    static const float nothing[3] = { 0, 0, 0 };
    Probe p;
    probe_init(&p, ray, nothing, nothing);
    Best best = best_none(ray->t_max);
    for (uint32_t i = 0; i < in->triangle_count; i++) {
        float corner[3][3], seen[3][3];
        if (!probe_corners(in, i, corner))
            continue;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                seen[c][k] = corner[c][p.axis[k]];
        probe_triangle(&p, (const float(*)[3])seen, i, &best);
    }
    for (uint32_t i = 0; i < in->shape_count; i++)
        probe_shape(ray, &p, &in->shape[i], in->triangle_count + i, &best);
    return best;
}

bool brute_nearest(const Primitives *primitives, const Ray *ray, Hit *hit)
{
    assert(primitives != NULL && ray != NULL && hit != NULL);
    Ray scaled = *ray;
    int exponent = 0;
    *hit = (Hit){ .t = ray->t_max, .primitive = RAY_MISS };
    if (!probe_takes(ray) && !ray_rescale(ray, &scaled, &exponent))
        return false;
    const Best best = brute_trace(primitives, &scaled);
    if (!best_to_hit(&best, hit))
        return false;
    return exponent == 0 || hit_rescale(hit, exponent);
}

bool brute_blocked(const Primitives *primitives, const Ray *ray)
{
    Hit hit;
    return brute_nearest(primitives, ray, &hit);
}
