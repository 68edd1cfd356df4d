/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture: eye's rays through every pixel, mirrors and glass on the way, light where they end.
 *
 * A pixel is the mean over its square, or of more around it, sampled at points of a scrambled
 * Sobol' sequence; each kind of choice has a sequence of its own that runs on through all samples
 * of the pixel. Tiles are independent, so threads change nothing.
 */
#include <assert.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/places.h"
#include "render/internal.h"
#include "render/kept_tiles.h"
#include "render/normals.h"
#include "render/specular.h"
#include "render/wave.h"

enum { TILE = 16, BOUNCES = 8, RAYS_MAX = 1 << 20 };
static_assert(TILE * TILE <= GUIDES_POINTS,
              "the centres of a tile are what guides are trained for");
enum { SEED_PIXEL = 100, SEED_SPECULAR, SEED_LENS, SEED_WAVE = 200 }; /* + bounce for the last */

static const double PI = 3.14159265358979323846;

/* One sample of a pixel on its way. */
typedef struct {
    Ray  ray;
    Rgb  weight;
    uint32_t index;
} EyeRay;

typedef struct {
    const Gatherer      *gatherer;
    const RenderOptions *options; /* defaults filled in */
    CameraRays           camera;
    FilterTable          filter;
    Image               *image;
    uint32_t             tiles_x;
    uint64_t            *rays;    /* [tiles] */
    struct Worker       *worker;  /* [threads] */
    const Monitor       *monitor;
} Render;

typedef struct Worker {
    Wave     wave;
    Guides   guides;
    double  *lamp_shares;         /* [lamps + 1] where lamps are many */
    Receiver centre[TILE * TILE]; /* what the pixels' centres show */
    double   reach[TILE * TILE];  /* about the tile's width there */
    EyeRay  eye[WAVE_POINTS];
    Ray     ray[WAVE_POINTS];
    Hit     hit[WAVE_POINTS];
    Rgb     throughput[WAVE_POINTS]; /* of the receiving points: weight * albedo / pi */
    Rgb     albedo[WAVE_POINTS];
} Worker;

/* Sums over a pixel's samples. */
typedef struct {
    Rgb radiance, direct, indirect, albedo, irradiance;
} Pixel;

/* false: nothing is shown there. */
static bool eye_ray(const CameraRays *camera, double x, double y, const float *lens, Ray *ray)
{
    Vec3 o, d;
    if (!camera_rays_at(camera, x, y, lens, &o, &d))
        return false;
    *ray = (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = 0,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
    return true;
}

static bool emits(const Room *room, const RoomHit *hit)
{
    return room->emitting[hit->surface] >> hit->side & 1;
}

/* Handles one end of an eye's ray: what it shows by itself, a receiving point, a ray further on.
 * Returns whether eye[*next] was filled. */
static bool end_of_ray(const Render *render, Worker *worker, uint32_t i, unsigned bounce,
                       uint32_t *points, uint32_t pixel_seed, Pixel *pixel, EyeRay *on)
{
    const Room   *room = render->gatherer->room;
    const EyeRay *eye = &worker->eye[i];
    if (worker->hit[i].primitive == RAY_MISS) {
        pixel->radiance = rgb_add(pixel->radiance,
                                  rgb_mul(eye->weight, render->options->background));
        return false;
    }
    const Vec3 in = vec3(eye->ray.dx, eye->ray.dy, eye->ray.dz);
    RoomHit    hit;
    room_hit(room, &worker->hit[i], in, &hit);
    Material        scratch;
    const Material *m = places_hit(room, &hit, &scratch);
    if (emits(room, &hit))
        pixel->radiance = rgb_add(pixel->radiance, rgb_mul(eye->weight, m->emission));
    if (bounce == 0 || rgb_max(m->reflectance) > 0) {
        const uint32_t k = (*points)++;
        const Receiver at = { hit.point, hit.normal };
        worker->wave.point[0][k] = (WavePoint){ .at = at, .index = eye->index,
                                                .guide = guides_find(&worker->guides, &at) };
        worker->albedo[k] = m->reflectance;
        worker->throughput[k] = rgb_scale(rgb_mul(eye->weight, m->reflectance), 1 / PI);
    }
    if (render->options->diffuse_only || bounce == BOUNCES || !specular_exists(m))
        return false;
    float u[4];
    Rgb   weight;
    sampling_sobol4(eye->index, sampling_seed(pixel_seed, SEED_SPECULAR, bounce, 0), u);
    *on = (EyeRay){ .index = eye->index };
    const Vec3 way = vec3_unit(in);
    const Vec3 normal = normals_at(render->gatherer->smooth, room, &hit, way);
    if (!specular_continue(room, &hit, normal, way, u, &on->ray, &weight))
        return false;
    on->weight = rgb_mul(eye->weight, weight);
    return rgb_max(on->weight) > 0;
}

/* Adds what the receiving points of one bounce found. */
static void add_points(const Worker *worker, uint32_t points, unsigned bounce, Pixel *pixel)
{
    for (uint32_t k = 0; k < points; k++) {
        const Rgb direct = worker->wave.direct[k], indirect = worker->wave.indirect[k];
        const Rgb e = rgb_add(direct, indirect);
        pixel->radiance = rgb_add(pixel->radiance, rgb_mul(worker->throughput[k], e));
        if (bounce > 0)
            continue;
        pixel->direct = rgb_add(pixel->direct, rgb_mul(worker->throughput[k], direct));
        pixel->indirect = rgb_add(pixel->indirect, rgb_mul(worker->throughput[k], indirect));
        pixel->albedo = rgb_add(pixel->albedo, worker->albedo[k]);
        pixel->irradiance = rgb_add(pixel->irradiance, e);
    }
}

/* Samples begin..begin+count-1 of the pixel, count <= WAVE_POINTS. */
static void render_samples(const Render *render, Worker *worker, int x, int y, uint32_t begin,
                           uint32_t count, uint32_t pixel_seed, Pixel *pixel)
{
    const RenderOptions *o = render->options;
    const uint32_t       seed = sampling_mix(pixel_seed + SEED_PIXEL);
    const uint32_t       lens_seed = sampling_mix(pixel_seed + SEED_LENS);
    const bool           blur = camera_rays_blur(&render->camera);
    uint32_t             seen = 0;
    for (uint32_t i = begin; i < begin + count; i++) {
        float   u[2], lens[2];
        double  at[2];
        EyeRay *eye = &worker->eye[seen];
        sampling_sobol2(i, seed, u);
        if (blur)
            sampling_sobol2(i, lens_seed, lens);
        *eye = (EyeRay){ .weight = { 1, 1, 1 }, .index = i };
        filter_table_offset(&render->filter, u, at);
        seen += eye_ray(&render->camera, x + at[0], y + at[1], blur ? lens : NULL, &eye->ray);
    }
    count = seen;
    for (unsigned bounce = 0; count > 0; bounce++) {
        uint32_t points = 0, next = 0;
        assert(bounce <= BOUNCES);
        for (uint32_t i = 0; i < count; i++)
            worker->ray[i] = worker->eye[i].ray;
        bvh_nearest_many(render->gatherer->room->bvh, worker->ray, worker->hit, count);
        worker->wave.rays += count;
        for (uint32_t i = 0; i < count; i++) {
            EyeRay on;
            if (end_of_ray(render, worker, i, bounce, &points, pixel_seed, pixel, &on))
                worker->eye[next++] = on;
        }
        const WaveOptions wave = { .gather_rays = o->gather_rays, .lamp_rays = o->light_rays,
                                   .seed = sampling_mix(pixel_seed + SEED_WAVE + bounce),
                                   .lights = true, .clear = !o->diffuse_only,
                                   .lamp_shares = worker->lamp_shares,
                                   .guides = &worker->guides };
        wave_gather(&worker->wave, points, &wave);
        add_points(worker, points, bounce, pixel);
        count = next;
    }
}

static void store(float *out, Rgb sum, double scale)
{
    out[0] = (float)(sum.r * scale);
    out[1] = (float)(sum.g * scale);
    out[2] = (float)(sum.b * scale);
}

/* What the pixel's centre shows first: normal, distance, patch. false: nothing. */
static bool store_centre(const Render *render, Worker *worker, int x, int y, Receiver *centre)
{
    const Room  *room = render->gatherer->room;
    Image       *image = render->image;
    const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
    Ray          ray;
    Hit          h;
    RoomHit      hit;
    if (!eye_ray(&render->camera, x + 0.5, y + 0.5, NULL, &ray))
        return false;
    worker->wave.rays++;
    if (!bvh_nearest(room->bvh, &ray, &h))
        return false;
    room_hit(room, &h, vec3(ray.dx, ray.dy, ray.dz), &hit);
    image->normal[3 * at] = (float)hit.normal.x;
    image->normal[3 * at + 1] = (float)hit.normal.y;
    image->normal[3 * at + 2] = (float)hit.normal.z;
    image->depth[at] = (float)vec3_length(vec3_sub(hit.point, vec3(ray.ox, ray.oy, ray.oz)));
    image->patch[at] = hit.patch;
    *centre = (Receiver){ hit.point, hit.normal };
    return true;
}

static void render_pixel(const Render *render, Worker *worker, int x, int y)
{
    const uint32_t samples = render->options->samples;
    const size_t   at = (size_t)y * (size_t)render->image->width + (size_t)x;
    const uint32_t seed = sampling_seed((uint32_t)(x + render->image->left),
                                              (uint32_t)(y + render->image->top),
                                              render->options->seed, 1);
    Pixel          pixel = { 0 };
    uint32_t       done = 0;
    /* Asked to stop, a pixel keeps the samples it has: a tile with thousands each takes long. */
    while (done < samples && !monitor_stop(render->monitor)) {
        const uint32_t left = samples - done, count = left < WAVE_POINTS ? left : WAVE_POINTS;
        render_samples(render, worker, x, y, done, count, seed, &pixel);
        done += count;
    }
    if (done == 0)
        return;
    Image       *image = render->image;
    const double scale = 1.0 / done;
    store(image->radiance + 3 * at, pixel.radiance, scale);
    store(image->direct + 3 * at, pixel.direct, scale);
    store(image->indirect + 3 * at, pixel.indirect, scale);
    store(image->albedo + 3 * at, pixel.albedo, scale);
    store(image->irradiance + 3 * at, pixel.irradiance, scale);
}

static int smaller(int a, int b) { return a < b ? a : b; }

/* Receivers of a tile that decide which of many lamps matter there. */
enum { AIM_RECEIVERS = 8 };

static void aim_lamps(const Render *render, Worker *worker, uint32_t centres)
{
    Receiver       some[AIM_RECEIVERS];
    const uint32_t n = centres < AIM_RECEIVERS ? centres : AIM_RECEIVERS;
    const Lamps   *lamps = &render->gatherer->lamps;
    if (worker->lamp_shares == NULL)
        return;
    if (n == 0) { /* not what the last tile left: that depends on threads */
        memcpy(worker->lamp_shares, lamps->below, ((size_t)lamps->count + 1) * sizeof(double));
        return;
    }
    for (uint32_t i = 0; i < n; i++)
        some[i] = worker->centre[(2 * i + 1) * centres / (2 * n)];
    lamps_aim(lamps, some, n, worker->lamp_shares);
}

static uint32_t rays_per_pixel(const RenderOptions *o)
{
    const uint64_t rays = (uint64_t)o->samples * o->gather_rays;
    return rays < RAYS_MAX ? (uint32_t)rays : RAYS_MAX;
}

static void render_tile(const Render *render, Worker *worker, uint32_t tile)
{
    const int x0 = (int)(tile % render->tiles_x) * TILE, y0 = (int)(tile / render->tiles_x) * TILE;
    const int x1 = smaller(x0 + TILE, render->image->width);
    const int y1 = smaller(y0 + TILE, render->image->height);
    uint32_t  centres = 0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            Receiver *centre = &worker->centre[centres];
            if (!store_centre(render, worker, x, y, centre))
                continue;
            const double distance = vec3_length(vec3_sub(centre->point, render->camera.eye));
            worker->reach[centres++] = TILE * camera_rays_footprint(&render->camera, distance);
        }
    guides_train(&worker->guides, &worker->wave, worker->centre, worker->reach, centres,
                 rays_per_pixel(render->options),
                 sampling_seed(tile, 0, render->options->seed, 2));
    aim_lamps(render, worker, centres);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            render_pixel(render, worker, x, y);
}

static void render_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Render *render = context;
    Worker       *worker = &render->worker[thread];
    KeptTiles *kept = render->options->kept;
    for (uint32_t tile = begin; tile < end; tile++) {
        if (kept != NULL && kept_tiles_has(kept, tile))
            continue;
        worker->wave.rays = 0;
        render_tile(render, worker, tile);
        render->rays[tile] = worker->wave.rays;
        /* Asked to stop, pixels may have fewer samples. */
        if (kept != NULL && !monitor_stop(render->monitor))
            kept_tiles_add(kept, tile);
    }
}

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static RenderOptions with_defaults(const RenderOptions *options)
{
    RenderOptions o = *options;
    o.samples = o.samples > 0 ? o.samples : 64;
    o.gather_rays = o.gather_rays > 0 ? o.gather_rays : 4;
    o.light_rays = o.light_rays > 0 ? o.light_rays : 1;
    /* Far more than is of any use, and indices of rays stay below 2^32. */
    o.gather_rays = o.gather_rays < RAYS_MAX ? o.gather_rays : RAYS_MAX;
    o.light_rays = o.light_rays < RAYS_MAX ? o.light_rays : RAYS_MAX;
    o.threads = parallel_threads(o.threads);
    return o;
}

/* Scratch space, one for each thread. */
static bool workers_create(Render *render, Error *err)
{
    const Gatherer *g = render->gatherer;
    const unsigned  n = render->options->threads;
    render->worker = array_create(n, sizeof *render->worker, "picture", err);
    for (unsigned i = 0; i < n && !error_is_set(err); i++) {
        render->worker[i].wave.gatherer = g;
        if (g->lamps.below == NULL)
            continue;
        render->worker[i].lamp_shares =
            array_create((size_t)g->lamps.count + 1, sizeof(double), "picture", err);
    }
    return !error_is_set(err);
}

static void workers_destroy(Render *render)
{
    for (unsigned i = 0; render->worker != NULL && i < render->options->threads; i++)
        array_free(render->worker[i].lamp_shares);
    array_free(render->worker);
}

/* Runs the tiles; the scratch space of threads is made and freed here. */
static void render_run(Render *render, RenderReport *report, const Monitor *monitor, Error *err)
{
    const uint32_t tiles_y = ((uint32_t)render->image->height + TILE - 1) / TILE;
    const uint32_t tiles = render->tiles_x * tiles_y;
    const double   start = seconds_now();
    *report = (RenderReport){ 0 };
    render->rays = array_create(tiles, sizeof *render->rays, "picture", err);
    if (workers_create(render, err)) {
        const Progress base = { .stage = "gather", .done = 1, .energy_left = -1 };
        render->monitor = monitor;
        if (render->options->kept != NULL)
            kept_tiles_begin(render->options->kept, render->image, TILE, render->rays, err);
        if (!error_is_set(err) &&
            (!parallel_for(tiles, 1, render->options->threads, render_tiles, render, monitor,
                           &base) || monitor_stop(monitor)))
            error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
        if (render->options->kept != NULL)
            kept_tiles_end(render->options->kept);
        for (uint32_t i = 0; i < tiles; i++)
            report->rays += render->rays[i];
    }
    report->seconds = seconds_now() - start;
    workers_destroy(render);
    array_free(render->rays);
}

Image *render_gather(const Gatherer *gatherer, const Camera *camera, const RenderOptions *options,
                     RenderReport *report, const Monitor *monitor, Error *err)
{
    assert(camera != NULL && options != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
    assert(gatherer != NULL);
    const RenderOptions o = with_defaults(options);
    RenderReport        unused;
    Render render = { .gatherer = gatherer, .options = &o,
                      .image = image_create_part(o.width, o.height, o.crop, err) };
    if (render.image == NULL)
        return NULL;
    render.tiles_x = ((uint32_t)render.image->width + TILE - 1) / TILE;
    camera_rays_init(&render.camera, camera, o.width, o.height);
    camera_rays_crop(&render.camera, render.image->left, render.image->top);
    filter_table_init(&render.filter, o.filter);
    render_run(&render, report != NULL ? report : &unused, monitor, err);
    return error_is_set(err) && err->code != ERROR_STOPPED ? image_destroy(render.image)
                                                           : render.image;
}
