/* SPDX-License-Identifier: BSD-3-Clause */
/* Form factors of one patch, for the eye: cast when it is picked. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"
#include "math/tolerance.h"
#include "viewer/layers.h"

/* The patch's triangles, and up to where each reaches in their common area. */
typedef struct {
    uint32_t *triangle;     /* [count] */
    double   *until;        /* [count]  rising to the whole area */
    uint32_t  count;
} PatchTriangles;

static Vec3 corner_of(const ShownMesh *mesh, uint32_t triangle, unsigned k)
{
    return mesh->position[mesh->corner[3 * (size_t)triangle + k]];
}

static Vec3 twice_area(const ShownMesh *mesh, uint32_t t)
{
    const Vec3 a = corner_of(mesh, t, 0);
    return vec3_cross(vec3_sub(corner_of(mesh, t, 1), a), vec3_sub(corner_of(mesh, t, 2), a));
}

static bool find_triangles(const ShownMesh *mesh, uint32_t patch, PatchTriangles *own, Error *err)
{
    uint32_t count = 0;
    double   area = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        count += mesh->triangle_patch[t] == patch;
    own->triangle = array_create(count, sizeof *own->triangle, "factors", err);
    own->until = array_create(count, sizeof *own->until, "factors", err);
    if (error_is_set(err))
        return false;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->triangle_patch[t] != patch)
            continue;
        area += vec3_length(twice_area(mesh, t));
        own->triangle[own->count] = t;
        own->until[own->count++] = area;
    }
    return true;
}

/* A ray from the place that two shares of 1 name, in the direction that two more do. */
static Ray ray_from(const ShownMesh *mesh, const PatchTriangles *own, const float at[4],
                    double offset)
{
    double   wanted = (double)at[0] * own->until[own->count - 1], u, v;
    uint32_t k = 0;
    while (k + 1 < own->count && own->until[k] <= wanted)
        k++;
    const double before = k > 0 ? own->until[k - 1] : 0;
    const uint32_t t = own->triangle[k];
    sampling_triangle((wanted - before) / (own->until[k] - before), (double)at[1], &u, &v);
    const Vec3 a = corner_of(mesh, t, 0), n = vec3_unit(twice_area(mesh, t));
    const Vec3 p = vec3_mad(vec3_mad(a, u, vec3_sub(corner_of(mesh, t, 1), a)), v,
                            vec3_sub(corner_of(mesh, t, 2), a));
    const Vec3 s = sampling_cosine((double)at[2], (double)at[3]);
    Vec3 x, y;
    vec3_frame(n, &x, &y);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(x, s.x), s.y, y), s.z, n);
    return ray_leaving(p, n, offset, d, INFINITY);
}

bool layer_factors(const ShownMesh *mesh, uint32_t patch, uint32_t rays, float *out, Error *err)
{
    assert(patch < mesh->patch_count && rays > 0);
    const Vec3 far = vec3_max(mesh->hi, vec3_scale(mesh->lo, -1));
    const double offset = ray_offset(fmax(far.x, fmax(far.y, far.z)));
    PatchTriangles own = { 0 };
    memset(out, 0, mesh->patch_count * sizeof *out);
    Ray *ray = array_create(rays, sizeof *ray, "factors", err);
    Hit *hit = array_create(rays, sizeof *hit, "factors", err);
    const bool ready = find_triangles(mesh, patch, &own, err) && !error_is_set(err);
    if (ready && own.count > 0 && own.until[own.count - 1] > 0) {
        for (uint32_t k = 0; k < rays; k++) {
            float at[4];
            sampling_sobol4(k, sampling_mix(patch), at);
            ray[k] = ray_from(mesh, &own, at, offset);
        }
        bvh_nearest_many(mesh->bvh, ray, hit, rays);
        for (uint32_t k = 0; k < rays; k++)
            if (hit[k].primitive != RAY_MISS)
                out[mesh->triangle_patch[hit[k].primitive]] += 1.0F / (float)rays;
    }
    array_free(own.triangle);
    array_free(own.until);
    array_free(ray);
    array_free(hit);
    return ready;
}
