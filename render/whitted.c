/* SPDX-License-Identifier: BSD-3-Clause */
/* Recursive ray tracing, the rays of a tile and a depth at a time. */
#include "render/whitted.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "render/clear.h"
#include "render/internal.h"
#include "render/normals.h"
#include "render/rough.h"
#include "render/specular.h"
#include "render/whitted_spot.h"

enum { TILE = 16, BATCH = TILE * TILE, DEPTH_DEFAULT = 5, SEED_LENS = 8 };

/* A branch that counts less is not followed: a 64th of a step of an 8-bit picture. */
static const double WEIGHT_LEAST = 1.0 / 16384;

typedef struct {
    Ray      ray;
    Rgb      weight;
    uint32_t pixel; /* of the tile */
} Branch;

/* Space of one thread: what one batch of each depth leaves for the next. */
typedef struct {
    Ray      ray[BATCH];
    Hit      hit[BATCH];
    bool     blocked[BATCH];
    Rgb      light[BATCH];
    uint32_t owner[BATCH];
    WhittedSpot spot[BATCH];
    Material made[BATCH];  /* by images, for spot */
    Rgb      sum[BATCH];
    float    depth[BATCH];
    Branch  *branch; /* [(depth + 2) * 2 * BATCH] */
    uint64_t rays;
} Worker;

typedef struct {
    const Room    *room;
    WhittedOptions options;
    Light         *light;  /* [lights] */
    size_t         lights;
    float         *smooth;
    uint8_t       *kind;   /* [materials]  whitted_spot_kind */
    bool           clear;
    CameraRays     camera;
    FilterTable    filter;
    Image         *image;
    Worker        *worker; /* [threads] */
    uint32_t       tiles_x, tiles;
    uint8_t       *done;   /* [tiles] */
    uint32_t       samples; /* per pixel that gets any, */
    int            step;   /* of a block of step x step pixels one; more than 1: stopped early */
    const Monitor *monitor;
} Picture;

/* --- lights ---------------------------------------------------------------------------------- */

/* A surface that emits as a light in its middle, just off it. */
static Light light_of(const Room *room, uint32_t surface, unsigned side)
{
    SurfacePoint at;
    const double third = room->surfaces->surface[surface].kind == SURFACE_TRIANGLE ? 1.0 / 3 : 0.5;
    surfaces_point(room->surfaces, surface, third, third, &at);
    const Vec3 n = vec3_scale(at.normal, side == 0 ? 1 : -1);
    const Rgb  emission =
        room->materials[surfaces_material(room->surfaces, surface, side)].emission;
    return (Light){ .kind = LIGHT_COSINE, .direction = n,
                    .position = vec3_mad(at.point, 2 * room->offset, n),
                    .intensity = rgb_scale(emission, room->surfaces->surface[surface].area) };
}

static bool emits(const Room *room, uint32_t surface, unsigned side)
{
    return room->emitting[surface] >> side & 1;
}

static bool collect_lights(Picture *picture, Error *err)
{
    const Room *room = picture->room;
    size_t      count = room->light_count;
    for (uint32_t i = 0; i < room->surfaces->count; i++)
        count += (size_t)emits(room, i, 0) + emits(room, i, 1);
    picture->light = array_create(count, sizeof *picture->light, "lights", err);
    if (picture->light == NULL)
        return false;
    for (size_t i = 0; i < room->light_count; i++)
        picture->light[picture->lights++] = room->lights[i];
    for (uint32_t i = 0; i < room->surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++)
            if (emits(room, i, side))
                picture->light[picture->lights++] = light_of(room, i, side);
    return true;
}

/* --- shading --------------------------------------------------------------------------------- */

/* Adds one light to all places of the batch. */
static void add_light(const Picture *picture, Worker *w, const Light *light, const Branch *branch,
                      const uint32_t *place, uint32_t count)
{
    const Room *room = picture->room;
    uint32_t    n = 0;
    for (uint32_t i = 0; i < count; i++) {
        const WhittedSpot *s = &w->spot[i];
        const Vec3   d = vec3_sub(light->position, s->at.point);
        const double square = vec3_dot(d, d), facing = vec3_dot(d, s->at.face);
        if (!(facing > 0))
            continue;
        const Vec3 way = vec3_scale(d, 1 / sqrt(square));
        const Rgb  value = whitted_spot_value(s, way);
        const double share = light_share(light, vec3_scale(way, -1)) / square;
        w->light[n] = rgb_scale(rgb_mul(rgb_mul(branch[place[i]].weight, value),
                                        light->intensity), share);
        if (!(rgb_max(w->light[n]) > 0))
            continue;
        w->owner[n] = branch[place[i]].pixel;
        w->ray[n++] = ray_between(s->at.point, s->at.face, light->position, vec3(0, 0, 0),
                                  room->offset);
    }
    bvh_blocked_beam(room->bvh, w->ray, w->blocked, n);
    w->rays += n;
    for (uint32_t i = 0; i < n; i++) {
        Rgb pass = { 1, 1, 1 };
        if (w->blocked[i] && !picture->clear)
            continue;
        if (w->blocked[i])
            pass = clear_between(room, &w->ray[i]);
        w->sum[w->owner[i]] = rgb_add(w->sum[w->owner[i]], rgb_mul(pass, w->light[i]));
    }
}

/* Adds the ways on from a mirror or glass: one or two. */
static uint32_t branch_on(const Picture *picture, const WhittedSpot *s, const Branch *from,
                          Branch *out, uint32_t count)
{
    Rgb weight[2];
    Ray ray[2];
    if (!(s->kind & (SPOT_MIRROR | SPOT_CLEAR)))
        return count;
    const unsigned ways = specular_ways(picture->room, s->material, &s->hit, s->normal, s->in, ray,
                                        weight);
    for (unsigned k = 0; k < ways; k++) {
        const Rgb all = rgb_mul(from->weight, weight[k]);
        if (rgb_max(all) >= WEIGHT_LEAST)
            out[count++] = (Branch){ ray[k], all, from->pixel };
    }
    return count;
}

/* What it shows whatever lights there are. */
static Rgb own_light(const Picture *picture, const WhittedSpot *s)
{
    const Rgb own = rgb_mul(s->material->reflectance, picture->options.ambient);
    return emits(picture->room, s->hit.surface, s->hit.side) ? rgb_add(own, s->material->emission)
                                                              : own;
}

static void trace(const Picture *picture, Worker *w, const Branch *branch, uint32_t count,
                  uint32_t depth)
{
    const Room *room = picture->room;
    Branch     *next = w->branch + (size_t)(depth + 1) * 2 * BATCH;
    uint32_t    place[BATCH], places = 0, on = 0;
    assert(count <= BATCH && depth <= picture->options.depth);
    for (uint32_t i = 0; i < count; i++)
        w->ray[i] = branch[i].ray;
    if (depth == 0)
        bvh_nearest_beam(room->bvh, w->ray, w->hit, count);
    else
        bvh_nearest_many(room->bvh, w->ray, w->hit, count);
    w->rays += count;
    for (uint32_t i = 0; i < count; i++) {
        const Branch *b = &branch[i];
        WhittedSpot  *s = &w->spot[places];
        Rgb          *sum = &w->sum[b->pixel];
        if (w->hit[i].primitive == RAY_MISS) {
            *sum = rgb_add(*sum, rgb_mul(b->weight, picture->options.background));
            continue;
        }
        whitted_spot_init(s, room, picture->kind, picture->smooth, &w->hit[i],
                          vec3_unit(vec3(b->ray.dx, b->ray.dy, b->ray.dz)), &w->made[places]);
        *sum = rgb_add(*sum, rgb_mul(b->weight, own_light(picture, s)));
        if (depth == 0)
            w->depth[b->pixel] = w->hit[i].t;
        if (depth < picture->options.depth)
            on = branch_on(picture, s, b, next, on);
        if (s->kind & (SPOT_DIFFUSE | SPOT_LOBE))
            place[places++] = i;
    }
    for (size_t k = 0; k < picture->lights; k++)
        add_light(picture, w, &picture->light[k], branch, place, places);
    for (uint32_t begin = 0; begin < on; begin += BATCH)
        trace(picture, w, next + begin, on - begin < BATCH ? on - begin : BATCH, depth + 1);
}

/* --- the picture ----------------------------------------------------------------------------- */

/* Where in the pixel and on the lens a sample's ray passes. */
static void choose_place(const Picture *picture, int x, int y, uint32_t sample, double at[2],
                         float lens[2])
{
    const bool blur = camera_rays_blur(&picture->camera);
    at[0] = at[1] = 0.5;
    if (picture->samples == 1 && !blur)
        return;
    const uint32_t seed = sampling_seed((uint32_t)(x + picture->image->left),
                                        (uint32_t)(y + picture->image->top),
                                        picture->options.seed, 3);
    if (picture->samples > 1) {
        float u[2];
        sampling_sobol2(sample, seed, u);
        filter_table_offset(&picture->filter, u, at);
    }
    if (blur)
        sampling_sobol2(sample, sampling_mix(seed + SEED_LENS), lens);
}

static uint32_t add_rays(const Picture *picture, Worker *w, int x0, int y0, uint32_t sample)
{
    const Image *image = picture->image;
    const bool   blur = camera_rays_blur(&picture->camera);
    uint32_t     count = 0;
    for (uint32_t k = 0; k < BATCH; k++) {
        const int x = x0 + (int)k % TILE, y = y0 + (int)k / TILE;
        float     lens[2];
        double    at[2];
        Vec3      o, d;
        if (x >= image->width || y >= image->height || x % picture->step != 0 ||
            y % picture->step != 0)
            continue;
        choose_place(picture, x, y, sample, at, lens);
        if (!camera_rays_at(&picture->camera, x + at[0], y + at[1], blur ? lens : NULL, &o, &d))
            continue;
        w->branch[count++] = (Branch){
            .ray = { .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .dx = (float)d.x,
                     .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY },
            .weight = { 1, 1, 1 }, .pixel = k };
    }
    return count;
}

static void render_tile(const Picture *picture, Worker *w, uint32_t tile)
{
    Image    *image = picture->image;
    const int x0 = (int)(tile % picture->tiles_x) * TILE;
    const int y0 = (int)(tile / picture->tiles_x) * TILE;
    memset(w->sum, 0, sizeof w->sum);
    for (uint32_t k = 0; k < BATCH; k++)
        w->depth[k] = INFINITY;
    for (uint32_t sample = 0; sample < picture->samples; sample++)
        trace(picture, w, w->branch, add_rays(picture, w, x0, y0, sample), 0);
    for (int k = 0; k < BATCH; k++) {
        const int x = x0 + k % TILE, y = y0 + k / TILE;
        if (x >= image->width || y >= image->height)
            continue;
        const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
        const double scale = 1.0 / picture->samples;
        const int from = k - y % picture->step * TILE - x % picture->step;
        image->radiance[3 * at] = (float)(w->sum[from].r * scale);
        image->radiance[3 * at + 1] = (float)(w->sum[from].g * scale);
        image->radiance[3 * at + 2] = (float)(w->sum[from].b * scale);
        image->depth[at] = w->depth[from];
    }
}

static void render_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Picture *picture = context;
    for (uint32_t tile = begin; tile < end; tile++) {
        if (picture->done[tile] != 0)
            continue;
        render_tile(picture, &picture->worker[thread], tile);
        picture->done[tile] = 1;
    }
}

/* Rays that are cast for pixels without any when it is stopped. */
enum { ROUGH_RAYS = 1 << 20 };

static void fill_up(Picture *picture, WhittedReport *report)
{
    uint64_t missing = 0;
    for (uint32_t i = 0; i < picture->tiles; i++)
        missing += picture->done[i] == 0;
    report->rough = (double)missing / picture->tiles;
    picture->samples = 1;
    picture->step = rough_step(missing * BATCH, ROUGH_RAYS, TILE);
    parallel_for(picture->tiles, 1, picture->options.threads, render_tiles, picture, NULL, NULL);
}

static bool picture_prepare(Picture *picture, const Camera *camera, Error *err)
{
    WhittedOptions *o = &picture->options;
    const Room     *room = picture->room;
    o->samples = o->samples > 0 ? o->samples : 1;
    o->depth = o->depth > 0 ? o->depth : DEPTH_DEFAULT;
    o->threads = parallel_threads(o->threads);
    assert(o->depth <= WHITTED_DEPTH_MOST);
    picture->image = image_create_part(o->width, o->height, o->crop, err);
    if (picture->image != NULL)
        picture->image->empty = IMAGE_DIRECT | IMAGE_INDIRECT | IMAGE_ALBEDO | IMAGE_IRRADIANCE |
                                IMAGE_NORMAL | IMAGE_PATCH;
    picture->worker = array_create(o->threads, sizeof *picture->worker, "picture", err);
    for (unsigned i = 0; i < o->threads && !error_is_set(err); i++)
        picture->worker[i].branch = array_create(((size_t)o->depth + 2) * 2 * BATCH,
                                                 sizeof(Branch), "picture", err);
    if (error_is_set(err) || !collect_lights(picture, err))
        return false;
    for (size_t i = 0; i < room->material_count; i++)
        picture->clear = picture->clear || room->materials[i].cut_out ||
                         rgb_max(room->materials[i].transmittance) > 0;
    picture->smooth = normals_create(room, err);
    picture->kind = array_create(room->material_count, 1, "materials", err);
    for (size_t i = 0; i < room->material_count && !error_is_set(err); i++)
        picture->kind[i] = (uint8_t)whitted_spot_kind(&room->materials[i]);
    camera_rays_init(&picture->camera, camera, o->width, o->height);
    camera_rays_crop(&picture->camera, picture->image->left, picture->image->top);
    filter_table_init(&picture->filter, o->filter);
    picture->tiles_x = ((uint32_t)picture->image->width + TILE - 1) / TILE;
    picture->tiles = picture->tiles_x * (((uint32_t)picture->image->height + TILE - 1) / TILE);
    picture->done = array_create(picture->tiles, 1, "picture", err);
    picture->samples = o->samples;
    picture->step = 1;
    return !error_is_set(err);
}

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

Image *render_whitted(const Room *room, const Camera *camera, const WhittedOptions *options,
                      WhittedReport *report, const Monitor *monitor, Error *err)
{
    assert(room != NULL && camera != NULL && options != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    Picture picture = { .room = room, .options = *options, .monitor = monitor };
    WhittedReport unused;
    report = report != NULL ? report : &unused;
    *report = (WhittedReport){ 0 };
    if (picture_prepare(&picture, camera, err)) {
        const Progress base = { .stage = "gather", .done = 1, .energy_left = -1 };
        const double   start = seconds_now();
        if (!parallel_for(picture.tiles, 1, picture.options.threads, render_tiles, &picture,
                          monitor, &base)) {
            error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
            fill_up(&picture, report);
        }
        report->seconds = seconds_now() - start;
    }
    for (unsigned i = 0; picture.worker != NULL && i < picture.options.threads; i++) {
        report->rays += picture.worker[i].rays;
        array_free(picture.worker[i].branch);
    }
    array_free(picture.worker);
    array_free(picture.light);
    array_free(picture.smooth);
    array_free(picture.kind);
    array_free(picture.done);
    return error_is_set(err) && err->code != ERROR_STOPPED ? image_destroy(picture.image)
                                                           : picture.image;
}
