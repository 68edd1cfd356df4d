/* SPDX-License-Identifier: BSD-3-Clause */
/* Every primitive asked in turn: what the tree must agree with. */
#include <assert.h>
#include <math.h>

#include "raycast/build.h"
#include "raycast/probe.h"

static void join(float lo[3], float hi[3], const float from[3], const float to[3])
{
    for (int k = 0; k < 3; k++) {
        lo[k] = fminf(lo[k], from[k]);
        hi[k] = fmaxf(hi[k], to[k]);
    }
}

/* The box that a tree would have: the margins of a probe come from it. Asked for only where they
 * matter, which is seldom. */
static void scene_box(const Primitives *in, float lo[3], float hi[3])
{
    bool any = false;
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < in->triangle_count; i++) {
        float corner[3][3];
        if (!probe_corners(in, i, corner))
            continue;
        any = true;
        for (int c = 0; c < 3; c++)
            join(lo, hi, corner[c], corner[c]);
    }
    for (uint32_t i = 0; i < in->shape_count; i++) {
        float from[3], to[3];
        any = true;
        if (shape_box(&in->shape[i], from, to))
            join(lo, hi, from, to);
    }
    for (int k = 0; !any && k < 3; k++)
        lo[k] = hi[k] = 0;
}

static Best brute_trace(const Primitives *in, const Ray *ray)
{
    static const float nothing[3] = { 0, 0, 0 };
    Probe probe, *p = &probe;
    probe_init(p, ray, nothing, nothing);
    p->reach = INFINITY; /* nothing is cut off here */
    Best best = best_none(ray->t_max);
    for (uint32_t i = 0; i < in->triangle_count; i++) {
        float corner[3][3], seen[3][3];
        if (!probe_corners(in, i, corner))
            continue;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                seen[c][k] = corner[c][p->axis[k]];
        probe_triangle(p, (const float(*)[3])seen, i, i, &best);
    }
    for (uint32_t i = 0; i < in->shape_count; i++)
        probe_shape(ray, p, &in->shape[i], in->triangle_count + i, false, &best);
    return best;
}

static const Candidate *choose(const Primitives *in, const Ray *ray, const Best *best)
{
    const uint32_t primitive = best->first.key & ~BEST_BACK;
    if (!best_is_open(best))
        return &best->first;
    float lo[3], hi[3];
    Probe probe, *p = &probe;
    scene_box(in, lo, hi);
    probe_init(p, ray, lo, hi);
    if (primitive >= in->triangle_count)
        return best_choose(best, p, ray, shape_normal(&in->shape[primitive - in->triangle_count],
                                                      (double)best->first.u,
                                                      (double)best->first.v));
    float corner[3][3];
    probe_corners(in, primitive, corner);
    return best_choose(best, p, ray, probe_normal(corner[0], corner[1], corner[2]));
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
    if (!best_to_hit(&best, choose(primitives, &scaled, &best), hit))
        return false;
    return exponent == 0 || hit_rescale(hit, exponent);
}

bool brute_blocked(const Primitives *primitives, const Ray *ray)
{
    Hit hit;
    return brute_nearest(primitives, ray, &hit);
}
