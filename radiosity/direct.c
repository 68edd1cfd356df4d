/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/direct.c -- light that point and spot lights send straight to the patches. */
#include "radiosity/direct.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/internal.h"
#include "radiosity/mirrors.h"
#include "radiosity/visible.h"

static const uint32_t DEFAULT_SAMPLES = 64;

/* Rays from each light that tell how much of its flux escapes: to 1 in 10^3 of it and better. */
enum { ESCAPE_RAYS = 16384, ESCAPE_CHUNK = 1024, PATCH_CHUNK = 64 };

/* Scratch of one thread. */
typedef struct {
    RowCast cast;     /* tells positions inside solids, where a patch has such */
    Ray    *ray;      /* [samples] */
    bool   *blocked;  /* [samples] */
    double *value;    /* [samples] */
    uint64_t rays;
} DirectScratch;

typedef struct {
    const Room    *room;
    const Links   *links;
    const Light   *light;
    uint32_t       samples, seed, index; /* index: of the light */
    DirectScratch *scratch;  /* [threads] */
    double        *share;    /* [patches]  irradiance per intensity */
    double        *sent, *lost; /* [escape chunks] */
} DirectPass;

double light_arriving(const Light *light, Vec3 p, Vec3 n)
{
    const Vec3 way = vec3_sub(light->position, p);
    const double square = vec3_dot(way, way), facing = vec3_dot(way, n);
    if (!(facing > 0))
        return 0;
    const double distance = sqrt(square);
    return light_share(light, vec3_scale(way, -1 / distance)) * facing / (square * distance);
}

Ray ray_to_light(const Room *room, const Light *light, Vec3 p, Vec3 n)
{
    const Vec3 start = vec3_mad(p, room->offset, n), way = vec3_sub(light->position, start);
    return (Ray){ .ox = (float)start.x, .oy = (float)start.y, .oz = (float)start.z, .t_min = 0,
                  .dx = (float)way.x, .dy = (float)way.y, .dz = (float)way.z, .t_max = 1 };
}

/* Sums what arrives at points of the patch unblocked, times their weights; `total` gets the sum of
 * weights. Only points outside solids count: `cast` non-NULL holds them. */
static double sum_arriving(DirectPass *d, DirectScratch *s, uint32_t patch, const RowCast *cast,
                           double *total)
{
    const Room *room = d->room;
    const uint32_t count = cast != NULL ? cast->valid_count : d->samples;
    const uint32_t seed = sampling_seed(d->seed, room_patch_key(room, patch), SEED_LIGHTS,
                                        d->index);
    uint32_t aimed = 0;
    *total = 0;
    for (uint32_t k = 0; k < count; k++) {
        PatchPoint at;
        float x[2];
        if (cast != NULL) {
            at = cast->position[cast->valid[k]].at;
        } else {
            sampling_sobol2(k, seed, x);
            patches_point(room->patches, room->surfaces, patch, x[0], x[1], &at);
            visible_move(room, &at);
        }
        *total += at.weight;
        const double value = light_arriving(d->light, at.point.point, at.point.normal);
        if (!(value > 0))
            continue;
        s->ray[aimed] = ray_to_light(room, d->light, at.point.point, at.point.normal);
        s->value[aimed++] = value * at.weight;
    }
    bvh_blocked_many(room->bvh, s->ray, s->blocked, aimed);
    s->rays += aimed;
    double sum = 0;
    for (uint32_t k = 0; k < aimed; k++) {
        if (!s->blocked[k])
            sum += s->value[k];
        else if (room->mirrors)
            sum += s->value[k] * mirrors_between(room, s->ray[k]);
    }
    return sum;
}

static void patch_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    DirectPass *d = context;
    DirectScratch *s = &d->scratch[worker];
    for (uint32_t i = begin; i < end; i++) {
        /* Only where something is hidden must positions be told apart, which costs rays. */
        const bool hidden = d->links->area[i] < d->room->patches->area[i];
        double total = 0;
        d->share[i] = 0;
        if (!(d->links->area[i] > 0))
            continue;
        if (hidden)
            row_cast_positions(&s->cast, d->room, i, d->seed);
        const double sum = sum_arriving(d, s, i, hidden ? &s->cast : NULL, &total);
        d->share[i] = total > 0 ? sum / total : 0;
    }
}

/* --- what escapes ----------------------------------------------------------------------------- */

/* Directions that a light sends into, evenly over the sphere's part it lights. */
static Vec3 light_direction(const Light *light, double a, double b)
{
    if (light->kind == LIGHT_POINT)
        return sampling_sphere(a, b);
    const double lowest = light->kind == LIGHT_SPOT ? light->cos_outer : 0;
    const double z = 1 - a * (1 - lowest), r = sqrt(fmax(0, 1 - z * z)), angle = 2 * M_PI * b;
    Vec3 u, v;
    vec3_frame(light->direction, &u, &v);
    return vec3_mad(vec3_mad(vec3_scale(light->direction, z), r * cos(angle), u), r * sin(angle),
                    v);
}

/* Whether light on its way from a light without size reaches no patch, or one by way of a mirror or
 * bent by glass, which no ray from there finds. */
static bool is_lost(const Room *room, Ray *ray, uint32_t seed)
{
    bool     straight = true;
    uint32_t surface;
    double   s, t;
    Hit      hit;
    for (uint32_t step = 0; bvh_nearest(room->bvh, ray, &hit); step++) {
        const double choice = sampling_mix(seed + step) * 0x1p-32;
        if (!room->mirrors || step == MIRRORS_MOST ||
            !mirrors_step(room, &hit, choice, ray, &straight))
            return !straight || room_patch(room, &hit, vec3(ray->dx, ray->dy, ray->dz), &surface,
                                           &s, &t) == PATCH_NONE;
    }
    return true;
}

static void escape_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    DirectPass *d = context;
    const uint32_t seed = sampling_seed(d->seed, UINT32_MAX, SEED_LIGHTS, d->index);
    const Vec3 o = d->light->position;
    double sent = 0, lost = 0;
    for (uint32_t k = begin; k < end; k++) {
        float x[2];
        sampling_sobol2(k, seed, x);
        const Vec3 w = light_direction(d->light, x[0], x[1]);
        Ray ray = { .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = 0,
                          .dx = (float)w.x, .dy = (float)w.y, .dz = (float)w.z,
                          .t_max = INFINITY };
        const double share = light_share(d->light, w);
        sent += share;
        if (is_lost(d->room, &ray, sampling_seed(seed, k, SEED_MIRRORS, 0)))
            lost += share;
    }
    d->sent[begin / ESCAPE_CHUNK] = sent;
    d->lost[begin / ESCAPE_CHUNK] = lost;
    d->scratch[worker].rays += end - begin;
}

/* --- all lights ------------------------------------------------------------------------------- */

typedef struct {
    double sent, arrived; /* luminance of power */
} DirectTotals;

/* Puts what is missing of (or too much in) the light that arrived at patches in proportion to how
 * much their estimates can be off: light varies over a patch by about its area over the squared
 * distance, so those near the light answer for nearly all. */
static void spread_gap(const DirectPass *d, double arrived, double gap)
{
    const Links *links = d->links;
    double near = 0;
    for (uint32_t pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < links->count; i++) {
            const Vec3 way = vec3_sub(d->light->position, d->room->patches->centre[i]);
            const double weight = fmin(1, links->area[i] / fmax(vec3_dot(way, way), DBL_MIN));
            if (pass == 0)
                near += links->area[i] * d->share[i] * weight;
            else if (gap > -near)
                d->share[i] *= 1 + gap * weight / near;
            else
                d->share[i] *= 1 + gap / arrived; /* more is too much than the near ones have */
        }
}

/* Makes arrived + escaped = sent, all as flux per intensity; returns the share that escapes. In the
 * open what escapes is the rest; where nothing does, patches are corrected. */
static double balance_light(const DirectPass *d, double whole, double arrived, double escaped)
{
    if (escaped > 0 && arrived <= whole)
        return 1 - arrived / whole;
    if (arrived > 0)
        spread_gap(d, arrived, whole - arrived);
    return 0;
}

/* Adds one light's share to the result, corrected so that it arrives whole when that is wanted. */
static void add_light(const DirectPass *d, bool balance, Direct *direct, DirectTotals *totals)
{
    const Rgb flux = light_flux(d->light), intensity = d->light->intensity;
    double sent = 0, lost = 0, arrived = 0;
    for (uint32_t k = 0; k < ESCAPE_RAYS / ESCAPE_CHUNK; k++) {
        sent += d->sent[k];
        lost += d->lost[k];
    }
    double escaped = sent > 0 ? lost / sent : 0;
    for (uint32_t i = 0; i < d->links->count; i++)
        arrived += d->links->area[i] * d->share[i];
    /* Flux per intensity; the same in all bands. */
    const double brightest = rgb_max(intensity);
    const double whole = brightest > 0 ? rgb_max(flux) / brightest : 0;
    totals->sent += rgb_luminance(flux);
    totals->arrived += rgb_luminance(intensity) * arrived + rgb_luminance(flux) * escaped;
    if (balance && whole > 0)
        escaped = balance_light(d, whole, arrived, escaped);
    for (uint32_t i = 0; i < d->links->count; i++) {
        double *out = &direct->irradiance[(size_t)i * ROOM_BANDS];
        out[0] += intensity.r * d->share[i];
        out[1] += intensity.g * d->share[i];
        out[2] += intensity.b * d->share[i];
    }
    direct->flux = rgb_add(direct->flux, flux);
    direct->escaped = rgb_mad(direct->escaped, escaped, flux);
}

static bool pass_init(DirectPass *d, unsigned threads, Error *err)
{
    static const char what[] = "direct light";
    d->scratch = array_create(threads, sizeof *d->scratch, what, err);
    d->share = array_create(d->links->count, sizeof *d->share, what, err);
    d->sent = array_create(ESCAPE_RAYS / ESCAPE_CHUNK, sizeof *d->sent, what, err);
    d->lost = array_create(ESCAPE_RAYS / ESCAPE_CHUNK, sizeof *d->lost, what, err);
    for (unsigned k = 0; k < threads && d->scratch != NULL; k++) {
        DirectScratch *s = &d->scratch[k];
        row_cast_create(&s->cast, d->samples * RAYS_PER_POSITION, 0, err);
        s->ray = array_create(d->samples, sizeof *s->ray, what, err);
        s->blocked = array_create(d->samples, sizeof *s->blocked, what, err);
        s->value = array_create(d->samples, sizeof *s->value, what, err);
    }
    return !error_is_set(err);
}

static void pass_clear(DirectPass *d, unsigned threads)
{
    for (unsigned k = 0; k < threads && d->scratch != NULL; k++) {
        row_cast_clear(&d->scratch[k].cast);
        array_free(d->scratch[k].ray);
        array_free(d->scratch[k].blocked);
        array_free(d->scratch[k].value);
    }
    array_free(d->scratch);
    array_free(d->share);
    array_free(d->sent);
    array_free(d->lost);
}

static bool run_lights(DirectPass *d, const DirectOptions *options, unsigned threads,
                       Direct *direct, const Monitor *monitor, Error *err)
{
    const Room *room = d->room;
    DirectTotals totals = { 0 };
    for (size_t k = 0; k < room->light_count; k++) {
        const Progress progress = { .stage = "factors", .done = 0, .energy_left = -1 };
        if (options->only != NULL && !options->only[k])
            continue;
        d->light = &room->lights[k];
        d->index = (uint32_t)k;
        if (!parallel_for(ESCAPE_RAYS, ESCAPE_CHUNK, threads, escape_chunk, d, monitor,
                          &progress) ||
            !parallel_for(d->links->count, PATCH_CHUNK, threads, patch_chunk, d, monitor,
                          &progress))
            return error_set(err, ERROR_STOPPED, "stopped while casting direct light");
        add_light(d, options->balance, direct, &totals);
    }
    for (unsigned k = 0; k < threads; k++)
        direct->rays += d->scratch[k].rays + d->scratch[k].cast.cast;
    if (totals.sent > 0)
        direct->balance_error = fabs(totals.arrived - totals.sent) / totals.sent;
    return true;
}

bool direct_create(const Room *room, const Links *links, const DirectOptions *options,
                   Direct *direct, const Monitor *monitor, Error *err)
{
    *direct = (Direct){ 0 };
    if (error_is_set(err))
        return false;
    assert(room != NULL && links != NULL && options != NULL);
    assert(links->count == room->patches->count);
    const unsigned threads = parallel_threads(options->threads);
    DirectPass pass = { .room = room, .links = links, .seed = options->seed,
                        .samples = options->samples > 0 ? options->samples : DEFAULT_SAMPLES };
    direct->irradiance = array_create((size_t)links->count * ROOM_BANDS,
                                      sizeof *direct->irradiance, "direct light", err);
    bool done = direct->irradiance != NULL;
    if (done && room->light_count > 0)
        done = pass_init(&pass, threads, err) &&
               run_lights(&pass, options, threads, direct, monitor, err);
    pass_clear(&pass, threads);
    if (!done)
        direct->irradiance = array_free(direct->irradiance);
    return done;
}
