/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/point_factors.c -- rays from points, counted by the class of what they meet. */
#include "radiosity/point_factors.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/internal.h"

/* Points a thread takes at a time; nets that the spread is taken from; rays traced in one call. */
enum { POINT_CHUNK = 4, NETS = 16, RAYS_AT_ONCE = 1024 };

typedef struct {
    Ray   ray[RAYS_AT_ONCE];
    Hit   hit[RAYS_AT_ONCE];
    uint32_t *seen;            /* [classes + 2]  rays of one net */
} PointScratch;

typedef struct {
    const Room                *room;
    const Vec3                *point, *normal;
    const PointFactorsOptions *options;
    double                    *factor, *error;
    PointScratch              *scratch; /* [threads] */
    uint32_t                   net_rays;
} PointCast;

static uint32_t column_of(const PointCast *cast, const Hit *hit, const Ray *ray)
{
    uint32_t surface;
    double s, t;
    if (hit->primitive == RAY_MISS)
        return cast->options->classes;
    const uint32_t patch = room_patch(cast->room, hit, vec3(ray->dx, ray->dy, ray->dz), &surface,
                                      &s, &t);
    return patch == PATCH_NONE ? cast->options->classes + 1 : cast->options->class_of[patch];
}

static void cast_net(const PointCast *cast, uint32_t i, uint32_t net, PointScratch *scratch)
{
    const Vec3 n = cast->normal[i];
    const uint32_t seed = sampling_seed(cast->options->seed, i, net, SEED_POINTS);
    Vec3 u, v;
    vec3_frame(n, &u, &v);
    for (uint32_t begin = 0; begin < cast->net_rays; begin += RAYS_AT_ONCE) {
        const uint32_t left = cast->net_rays - begin;
        const uint32_t count = left < RAYS_AT_ONCE ? left : RAYS_AT_ONCE;
        for (uint32_t k = 0; k < count; k++) {
            float x[2];
            sampling_sobol2(begin + k, seed, x);
            const Vec3 local = sampling_cosine(x[0], x[1]);
            const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, local.z), local.x, u), local.y, v);
            scratch->ray[k] = ray_leaving(cast->point[i], n, cast->room->offset, d, INFINITY);
        }
        bvh_nearest_many(cast->room->bvh, scratch->ray, scratch->hit, count);
        for (uint32_t k = 0; k < count; k++)
            scratch->seen[column_of(cast, &scratch->hit[k], &scratch->ray[k])]++;
    }
}

static void cast_points(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    PointCast *cast = context;
    PointScratch *scratch = &cast->scratch[worker];
    const uint32_t columns = cast->options->classes + 2;
    for (uint32_t i = begin; i < end; i++) {
        double *factor = &cast->factor[(size_t)i * columns];
        double *error = &cast->error[(size_t)i * columns];
        for (uint32_t net = 0; net < NETS; net++) {
            cast_net(cast, i, net, scratch);
            for (uint32_t c = 0; c < columns; c++) {
                const double share = (double)scratch->seen[c] / cast->net_rays;
                factor[c] += share;
                error[c] += share * share;
                scratch->seen[c] = 0;
            }
        }
        for (uint32_t c = 0; c < columns; c++) {
            factor[c] /= NETS;
            const double variance = fmax(error[c] / NETS - factor[c] * factor[c], 0);
            error[c] = sqrt(variance / (NETS - 1));
        }
    }
}

bool point_factors(const Room *room, const Vec3 *point, const Vec3 *normal, uint32_t count,
                   const PointFactorsOptions *options, double *factor, double *error,
                   const Monitor *monitor, Error *err)
{
    assert(room != NULL && options != NULL && options->rays > 0 && factor != NULL);
    const unsigned threads = parallel_threads(options->threads);
    const size_t columns = (size_t)options->classes + 2;
    PointCast cast = { .room = room, .point = point, .normal = normal, .options = options,
                       .factor = factor, .error = error,
                       .net_rays = (options->rays + NETS - 1) / NETS };
    const Progress progress = { .stage = "factors", .done = 1, .energy_left = -1 };
    cast.scratch = array_create(threads, sizeof *cast.scratch, "points", err);
    for (unsigned k = 0; k < threads && !error_is_set(err); k++)
        cast.scratch[k].seen = array_create(columns, sizeof *cast.scratch->seen, "points", err);
    for (size_t k = 0; k < count * columns; k++)
        factor[k] = error[k] = 0;
    if (!error_is_set(err) &&
        !parallel_for(count, POINT_CHUNK, threads, cast_points, &cast, monitor, &progress))
        error_set(err, ERROR_STOPPED, "stopped while casting from points");
    for (unsigned k = 0; k < threads && cast.scratch != NULL; k++)
        array_free(cast.scratch[k].seen);
    array_free(cast.scratch);
    return !error_is_set(err);
}
