/* SPDX-License-Identifier: BSD-3-Clause */
/* Light at the points of a work plane, read from a snapshot. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "math/tolerance.h"
#include "render/facet.h"
#include "viewer/measure_plane.h"

/* Lamps of more triangles than this are left to the cosine-weighted rays: together they are large,
 * and so many rays for each point would take seconds. */
enum { MOST_LAMPS = 512 };

/* Rays to lamps for each point, shared among their triangles, at least 4 for each. */
enum { LAMP_RAYS = 512, LEAST_LAMP_RAYS = 4 };

typedef struct {
    Facet facet;
    Rgb   radiosity;        /* mean over the triangle */
} LampFacet;

typedef struct {
    const Snapshot *snapshot;
    Plane          *plane;
    LampFacet      *lamp;
    uint32_t        lamp_count;
    uint32_t        lamp_rays;
    uint32_t        rays;
    bool            first;
} Gathering;

static Rgb at_vertex(const Snapshot *s, uint32_t vertex)
{
    const float *v = s->vertex + 3 * (size_t)vertex;
    return rgb((double)v[0], (double)v[1], (double)v[2]);
}

static bool is_lamp(const ShownMesh *mesh, uint32_t triangle)
{
    return mesh->patch[mesh->triangle_patch[triangle]].lamp;
}

static bool find_lamps(const Snapshot *s, Gathering *g, Error *err)
{
    const ShownMesh *mesh = s->mesh;
    uint32_t count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        count += is_lamp(mesh, t);
    g->lamp = array_create(count <= MOST_LAMPS ? count : 0, sizeof *g->lamp, "lamps", err);
    if (g->lamp == NULL)
        return false;
    for (uint32_t t = 0; count <= MOST_LAMPS && t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->corner + 3 * (size_t)t;
        const Vec3 corner[3] = { mesh->position[c[0]], mesh->position[c[1]],
                                 mesh->position[c[2]] };
        if (!is_lamp(mesh, t))
            continue;
        LampFacet *lamp = &g->lamp[g->lamp_count++];
        facet_init(&lamp->facet, corner, 3);
        for (unsigned k = 0; k < 3; k++)
            lamp->radiosity = rgb_mad(lamp->radiosity, 1 / 3.0, at_vertex(s, c[k]));
    }
    return true;
}

static double scene_offset(const ShownMesh *mesh)
{
    const Vec3 far = vec3_max(mesh->hi, vec3_scale(mesh->lo, -1));
    return ray_offset(fmax(far.x, fmax(far.y, far.z)));
}

/* Share of a lamp that is seen, by rays to places chosen evenly in solid angle. */
static double seen_share(const Gathering *g, const LampFacet *lamp, Vec3 p, double offset,
                         uint32_t seed)
{
    uint32_t seen = 0;
    for (uint32_t k = 0; k < g->lamp_rays; k++) {
        float at[2];
        Vec3  q;
        sampling_sobol2(k, seed, at);
        facet_sample(&lamp->facet, p, (double)at[0], (double)at[1], &q);
        const Ray ray = ray_between(p, g->plane->up, q, lamp->facet.normal, offset);
        seen += !bvh_blocked(g->snapshot->mesh->bvh, &ray);
    }
    return (double)seen / g->lamp_rays;
}

static Rgb from_lamps(const Gathering *g, uint32_t point, double offset)
{
    const Vec3 p = g->plane->point[point];
    Rgb sum = rgb(0, 0, 0);
    for (uint32_t i = 0; i < g->lamp_count; i++) {
        const LampFacet *lamp = &g->lamp[i];
        if (facet_height(&lamp->facet, p) <= offset)
            continue;
        const double open = facet_irradiance(&lamp->facet, p, g->plane->up) / M_PI;
        if (open > 0)
            sum = rgb_mad(sum, open * seen_share(g, lamp, p, offset,
                                                 sampling_seed(point, i, 1, 0)), lamp->radiosity);
    }
    return sum;
}

static Rgb from_lights(const Gathering *g, uint32_t point)
{
    const ShownMesh *mesh = g->snapshot->mesh;
    Rgb sum = rgb(0, 0, 0);
    for (uint32_t i = 0; i < mesh->light_count; i++) {
        const Light *light = &snapshot_lights(g->snapshot)[i];
        const Vec3   to = vec3_sub(light->position, g->plane->point[point]);
        const double distance = vec3_length(to);
        const double cosine = vec3_dot(to, g->plane->up) / distance;
        const Ray ray = ray_leaving(g->plane->point[point], g->plane->up, 0, to, 1);
        if (!(cosine > 0) || bvh_blocked(mesh->bvh, &ray))
            continue;
        const double share = light_share(light, vec3_scale(to, -1 / distance));
        sum = rgb_mad(sum, share * cosine / (distance * distance), light->intensity);
    }
    return sum;
}

/* Radiosity where a ray ends, of a front that is not a lamp found otherwise. */
static Rgb radiosity_met(const Gathering *g, const Ray *ray, Vec3 d)
{
    const ShownMesh *mesh = g->snapshot->mesh;
    Hit hit;
    if (!bvh_nearest(mesh->bvh, ray, &hit))
        return rgb(0, 0, 0);
    const ShownPatch *patch = &mesh->patch[mesh->triangle_patch[hit.primitive]];
    if (vec3_dot(patch->normal, d) >= 0 || (patch->lamp && g->lamp_count > 0))
        return rgb(0, 0, 0);
    const uint32_t *c = mesh->corner + 3 * (size_t)hit.primitive;
    const double u = (double)hit.u, v = (double)hit.v;
    return rgb_mad(rgb_mad(rgb_scale(at_vertex(g->snapshot, c[0]), 1 - u - v), u,
                           at_vertex(g->snapshot, c[1])), v, at_vertex(g->snapshot, c[2]));
}

static void gather_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Gathering *g = context;
    Plane *plane = g->plane;
    const double offset = scene_offset(g->snapshot->mesh);
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        if (plane->inside[i])
            continue;
        if (g->first)
            plane->direct[i] = rgb_add(from_lamps(g, i, offset), from_lights(g, i));
        for (uint32_t k = 0; k < g->rays; k++) {
            float at[2];
            sampling_sobol2(plane->rays + k, sampling_seed(i, 0, 0, 0), at);
            const Vec3 s = sampling_cosine((double)at[0], (double)at[1]);
            const Vec3 d = vec3_mad(vec3_mad(vec3_scale(plane->along, s.x), s.y, plane->across),
                                    s.z, plane->up);
            const Ray ray = ray_leaving(plane->point[i], plane->up, 0, d, INFINITY);
            plane->sum[i] = rgb_add(plane->sum[i], radiosity_met(g, &ray, d));
        }
    }
}

bool plane_gather(Plane *plane, const Snapshot *snapshot, uint32_t rays, unsigned threads,
                  Error *err)
{
    assert(rays > 0 && plane->rays % rays == 0);
    Gathering g = { .snapshot = snapshot, .plane = plane, .rays = rays,
                    .first = plane->rays == 0 };
    if (!find_lamps(snapshot, &g, err))
        return false;
    g.lamp_rays = g.lamp_count > 0 ? LAMP_RAYS / g.lamp_count : 0;
    if (g.lamp_rays < LEAST_LAMP_RAYS)
        g.lamp_rays = LEAST_LAMP_RAYS;
    parallel_for(plane->count, 8, threads, gather_chunk, &g, NULL, NULL);
    plane->rays += rays;
    array_free(g.lamp);
    return true;
}
