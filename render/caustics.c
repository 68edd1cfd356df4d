/* SPDX-License-Identifier: BSD-3-Clause */
/* Photons on their way from lamps by mirrors and glass. */
#include "render/caustics.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "render/caustics_internal.h"
#include "render/normals.h"
#include "render/split.h"

enum { CHUNK = 4096 };
enum { SEED_START = 500, SEED_WAY, SEED_ROULETTE };
/* As in render/specular.c: steps without roulette, and those after which a ray is given up. */
enum { STEPS_FREE = 8, STEPS_MOST = 256 };
static const double SURVIVAL_MOST = 7.0 / 8;
/* Fewer photons than these tell nothing: noise of 3 % in what they come to. */
enum { PHOTONS_LEAST = 1024 };
/* Where more than this share of all light is thrown, as by a lamp in a globe of glass, photons
 * would light whole rooms, with blotches. */
static const double THROWN_MOST = 0.5;
/* Photons count within this share of the diagonal of what they lie in. */
static const double REACH_SHARE = 1.0 / 64;

/* What a chunk of rays left. */
typedef struct {
    Photon  *photon;
    size_t   count, capacity;
    uint64_t rays;
    double   thrown; /* flux that was thrown at first diffuse places */
    Error    err;
} Chunk;

typedef struct {
    const Gatherer     *gatherer;
    const CausticsWish *wish;
    double *below;   /* [lamps + lights + 1]  running sums of flux */
    Chunk  *chunk;
} Tracer;

/* A ray on its way. */
typedef struct {
    Ray      ray;
    Rgb      flux;
    double   carried;  /* share of the start's flux; roulette goes by it */
    double   medium;   /* n^2 of the body that it is in, of those that it has come into */
    uint32_t index, group;
    unsigned turns;
    bool     aimed;    /* lamp rays find the same way */
} Flight;

/* --- starts ---------------------------------------------------------------------------------- */

static double strength_of(Rgb flux)
{
    const double y = rgb_luminance(flux);
    return y > 0 ? y : rgb_max(flux);
}

static bool weigh_lamps(Tracer *t, Error *err)
{
    const Gatherer *g = t->gatherer;
    const size_t    lamps = g->lamps.count, all = lamps + g->room->light_count;
    t->below = array_create(all + 1, sizeof *t->below, "caustics", err);
    for (size_t i = 0; t->below != NULL && i < all; i++) {
        const double flux = i < lamps
            ? M_PI * g->lamps.lamp[i].area * g->lamps.lamp[i].strength
            : strength_of(light_flux(&g->room->lights[i - lamps]));
        t->below[i + 1] = t->below[i] + fmax(flux, 0);
    }
    return t->below != NULL;
}

/* Lamp number by u, which becomes its place within. */
static uint32_t pick(const double *below, uint32_t count, double *u, double *chance)
{
    const double total = below[count], x = *u * total;
    uint32_t     lo = 0, hi = count;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (below[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    const double width = below[lo + 1] - below[lo];
    *chance = width / total;
    *u = width > 0 ? fmin(fmax((x - below[lo]) / width, 0), 1) : 0;
    return lo;
}

static Vec3 turned_to(Vec3 axis, Vec3 d)
{
    Vec3 s, t;
    vec3_frame(axis, &s, &t);
    return vec3_mad(vec3_mad(vec3_scale(axis, d.z), d.x, s), d.y, t);
}

/* From a lamp, evenly over its area, by the cosine. */
static void start_at_lamp(const Tracer *t, const Lamp *lamp, double a, double b, const float u[4],
                          Flight *f)
{
    const Room *room = t->gatherer->room;
    Vec3        point, normal;
    double      area = lamp->area;
    if (lamp->facet.count > 0) {
        const Vec3 *c = lamp->facet.corner;
        if (lamp->facet.count == 3)
            sampling_triangle(a, b, &a, &b);
        point = vec3_mad(vec3_mad(c[0], a, vec3_sub(c[1], c[0])), b,
                         vec3_sub(c[lamp->facet.count - 1], c[0]));
        normal = lamp->facet.normal;
    } else {
        SurfacePoint p;
        surfaces_point(room->surfaces, lamp->surface, a, b, &p);
        point = p.point;
        normal = lamp->side == 0 ? p.normal : vec3_scale(p.normal, -1);
        area = p.density;
    }
    const Vec3 way = turned_to(normal, sampling_cosine((double)u[2], (double)u[3]));
    f->ray = ray_leaving(point, normal, room->offset, way, INFINITY);
    f->flux = rgb_scale(lamp->radiance, M_PI * area);
}

/* From a point light, evenly over the ways that it sends light. */
static void start_at_light(const Light *light, const float u[4], Flight *f)
{
    Vec3   way;
    double density;
    if (light->kind == LIGHT_COSINE) {
        const Vec3 d = sampling_cosine((double)u[2], (double)u[3]);
        way = turned_to(light->direction, d);
        density = d.z / M_PI;
    } else {
        const double least = light->kind == LIGHT_SPOT ? light->cos_outer : -1;
        const double z = 1 - (double)u[2] * (1 - least), angle = 2 * M_PI * (double)u[3];
        const double across = sqrt(fmax(1 - z * z, 0));
        const Vec3   d = vec3(across * cos(angle), across * sin(angle), z);
        way = light->kind == LIGHT_SPOT ? turned_to(light->direction, d) : d;
        density = 1 / (2 * M_PI * (1 - least));
    }
    f->ray = ray_leaving(light->position, vec3(0, 0, 0), 0, way, INFINITY);
    f->flux = rgb_scale(light->intensity,
                        density > 0 ? light_share(light, way) / density : 0);
}

static void start(const Tracer *t, uint32_t index, Flight *f)
{
    const Gatherer *g = t->gatherer;
    const uint32_t  lamps = g->lamps.count, all = lamps + (uint32_t)g->room->light_count;
    float           u[4], v[2];
    double          a, chance;
    *f = (Flight){ .index = index, .carried = 1, .medium = 1 };
    sampling_sobol4(index, sampling_seed(t->wish->seed, SEED_START, 0, 0), u);
    sampling_sobol2(index, sampling_seed(t->wish->seed, SEED_START, 1, 0), v);
    a = (double)u[0];
    const uint32_t k = pick(t->below, all, &a, &chance);
    if (k < lamps)
        start_at_lamp(t, &g->lamps.lamp[k], (double)v[0], (double)v[1], u, f);
    else
        start_at_light(&g->room->lights[k - lamps], u, f);
    f->flux = rgb_scale(f->flux, 1 / (chance * t->wish->photons));
    if (g->split != NULL)
        f->group = k < lamps ? split_emission(g->split, g->lamps.lamp[k].surface,
                                              g->lamps.lamp[k].side)
                             : g->split->first_light + k - lamps;
}

/* --- ways ------------------------------------------------------------------------------------ */

static double luck(const Tracer *t, const Flight *f, unsigned step, uint32_t purpose)
{
    const uint32_t key = sampling_seed(t->wish->seed, purpose, step, 0);
    return (sampling_mix(key ^ sampling_mix(f->index)) >> 8) * 0x1p-24;
}

static void leave_photon(const Flight *f, const RoomHit *at, unsigned first, Chunk *chunk)
{
    void *array = chunk->photon;
    if (!array_reserve(&array, &chunk->capacity, chunk->count + 1, sizeof *chunk->photon,
                       "caustics", &chunk->err))
        return;
    chunk->photon = array;
    const Rgb e = rgb_scale(f->flux, 1 / f->medium);
    chunk->photon[chunk->count++] = (Photon){
        .at = { (float)at->point.x, (float)at->point.y, (float)at->point.z },
        .face = { (float)at->normal.x, (float)at->normal.y, (float)at->normal.z },
        .flux = { (float)e.r, (float)e.g, (float)e.b }, .group = f->group };
    chunk->thrown += first == 0 ? rgb_luminance(f->flux) : 0;
}

/* Takes note of what the ray on does: turned, aimed at by lamp rays too, come into a body. */
static void note_turn(const Gatherer *g, const RoomHit *at, const Material *m, Flight *f)
{
    const Room *room = g->room;
    const bool  across = vec3_dot(vec3(f->ray.dx, f->ray.dy, f->ray.dz), at->normal) < 0;
    if (specular_is_straight(room, at, m, &f->ray)) {
        f->aimed = false; /* a pane between mirror and receiver */
        return;
    }
    f->turns++;
    f->aimed = f->turns == 1 && !(rgb_max(m->transmittance) > 0) &&
               images_of(&g->images, at->surface, at->side) < IMAGES_MOST;
    if (across)
        f->medium *= at->side == 0 ? m->ior * m->ior : 1 / (m->ior * m->ior);
}

/* One step on at a mirror or glass; false: it ends. */
static bool step_on(const Tracer *t, const RoomHit *at, const Material *m, unsigned step,
                    Flight *f)
{
    const Gatherer *g = t->gatherer;
    const Vec3      in = vec3_unit(vec3(f->ray.dx, f->ray.dy, f->ray.dz));
    Rgb             share;
    if (step == STEPS_MOST ||
        !specular_continue(g->room, at, normals_at(g->smooth, g->room, at, in), in,
                           (float)luck(t, f, step, SEED_WAY), &f->ray, &share))
        return false;
    f->flux = rgb_mul(f->flux, share);
    f->carried *= rgb_max(share);
    note_turn(g, at, m, f);
    const double survival = step < STEPS_FREE ? 1 : fmin(f->carried, SURVIVAL_MOST);
    if (!(luck(t, f, step, SEED_ROULETTE) < survival))
        return false;
    f->flux = rgb_scale(f->flux, 1 / survival);
    f->carried /= survival;
    return true;
}

static void trace(const Tracer *t, uint32_t index, Chunk *chunk)
{
    const Room *room = t->gatherer->room;
    Flight      f;
    unsigned    left = 0;
    start(t, index, &f);
    for (unsigned step = 0; rgb_max(f.flux) > 0; step++) {
        Hit      hit;
        RoomHit  at;
        Material scratch;
        chunk->rays++;
        if (!bvh_nearest(room->bvh, &f.ray, &hit))
            return;
        room_hit(room, &hit, vec3(f.ray.dx, f.ray.dy, f.ray.dz), &at);
        const Material *m = places_hit(room, &at, &scratch);
        if (f.turns > 0 && !f.aimed && rgb_max(mirrors_scattered(m, m->reflectance)) > 0)
            leave_photon(&f, &at, left++, chunk);
        if (!mirrors_is(m) || !specular_exists(m) || !step_on(t, &at, m, step, &f))
            return;
    }
}

static void trace_chunks(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Tracer *t = context;
    (void)thread;
    for (uint32_t c = begin; c < end; c++)
        for (uint32_t i = c * CHUNK; i < (c + 1) * CHUNK && i < t->wish->photons; i++)
            trace(t, i, &t->chunk[c]);
}

/* --- the map --------------------------------------------------------------------------------- */

static double diagonal_of(const Caustics *c)
{
    Vec3 lo = vec3(INFINITY, INFINITY, INFINITY), hi = vec3_scale(lo, -1);
    for (uint32_t i = 0; i < c->count; i++) {
        const float *p = c->photon[i].at;
        const Vec3   v = vec3((double)p[0], (double)p[1], (double)p[2]);
        lo = vec3_min(lo, v);
        hi = vec3_max(hi, v);
    }
    return vec3_length(vec3_sub(hi, lo));
}

/* All chunks' photons in one map; NULL: they are not worth it. */
static Caustics *join(const Tracer *t, uint32_t chunks, uint64_t *rays, Error *err)
{
    const size_t lamps = t->gatherer->lamps.count + t->gatherer->room->light_count;
    size_t       count = 0;
    double       thrown = 0;
    for (uint32_t c = 0; c < chunks; c++) {
        if (error_is_set(&t->chunk[c].err))
            *err = t->chunk[c].err;
        count += t->chunk[c].count;
        thrown += t->chunk[c].thrown;
        *rays += t->chunk[c].rays;
    }
    if (error_is_set(err) || count < PHOTONS_LEAST || count > UINT32_MAX / 2 ||
        thrown > THROWN_MOST * t->below[lamps])
        return NULL;
    Caustics *map = array_create(1, sizeof *map, "caustics", err);
    if (map == NULL)
        return NULL;
    map->photon = array_create(count, sizeof *map->photon, "caustics", err);
    map->axis = array_create(count, 1, "caustics", err);
    if (error_is_set(err))
        return caustics_destroy(map);
    for (uint32_t c = 0; c < chunks; c++) {
        const Chunk *chunk = &t->chunk[c];
        if (chunk->count > 0)
            memcpy(map->photon + map->count, chunk->photon, chunk->count * sizeof *map->photon);
        map->count += (uint32_t)chunk->count;
    }
    map->reach = REACH_SHARE * diagonal_of(map);
    caustics_sort(map);
    return map->reach > 0 ? map : caustics_destroy(map);
}

Caustics *caustics_create(const Gatherer *gatherer, const CausticsWish *wish, uint64_t *rays,
                          const Monitor *monitor, Error *err)
{
    Tracer         t = { .gatherer = gatherer, .wish = wish };
    const uint32_t chunks = (wish->photons + CHUNK - 1) / CHUNK;
    const size_t   lamps = gatherer->lamps.count + gatherer->room->light_count;
    Caustics      *map = NULL;
    assert(wish->photons > 0 && rays != NULL);
    if (error_is_set(err) || !weigh_lamps(&t, err))
        return NULL;
    t.chunk = array_create(chunks, sizeof *t.chunk, "caustics", err);
    if (t.chunk != NULL && lamps > 0 && t.below[lamps] > 0) {
        if (!parallel_for(chunks, 1, wish->threads, trace_chunks, &t, monitor, NULL))
            error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
        else
            map = join(&t, chunks, rays, err);
    }
    for (uint32_t c = 0; t.chunk != NULL && c < chunks; c++)
        array_free(t.chunk[c].photon);
    array_free(t.chunk);
    array_free(t.below);
    return map;
}

Caustics *caustics_destroy(Caustics *caustics)
{
    if (caustics == NULL)
        return NULL;
    array_free(caustics->photon);
    array_free(caustics->axis);
    return array_free(caustics);
}
