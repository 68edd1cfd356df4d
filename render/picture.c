/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture, tile by tile: a fixed number of samples per pixel, or as many as noise asks for.
 *
 * A pixel is the mean over its square, or of more around it. Tiles are independent, so threads
 * change nothing.
 */
#include <assert.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "render/eye.h"
#include "render/internal.h"
#include "render/kept_tiles.h"
#include "render/normals.h"
#include "render/records_fill.h"
#include "render/refine.h"
#include "render/rough.h"
#include "render/split.h"

enum { TILE = REFINE_TILE, RAYS_MAX = 1 << 20 };
static_assert(TILE * TILE <= GUIDES_POINTS,
              "the centres of a tile are what guides are trained for");
enum { SEED_MEAN = 500, SEED_PHOTONS };

typedef struct {
    const Gatherer      *gatherer;
    Caustics            *caustics;  /* NULL: none */
    const RenderOptions *options; /* defaults filled in */
    CameraRays           camera;
    FilterTable          filter;
    Image               *image;
    uint32_t             tiles_x, tiles;
    uint64_t            *rays;    /* [tiles] */
    uint64_t            *samples; /* [tiles]  of camera rays, where noise decides how many */
    uint8_t             *known;   /* [pixels]  has samples; with options->whole */
    int                  step;    /* edge of the blocks that share a sample when stopped */
    double              *bright;  /* [2 * tiles]  luminance seen, and by how many rays */
    double               mean;    /* luminance of the picture, roughly */
    struct Worker       *worker;  /* [threads] */
    const Monitor       *monitor;
} Render;

typedef struct Worker {
    Eye      eye;
    Receiver centre[TILE * TILE]; /* what the pixels' centres show */
    double   reach[TILE * TILE];  /* about the tile's width there */
    EyeSample sample[WAVE_POINTS];
} Worker;

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
    worker->eye.wave.rays++;
    if (!bvh_nearest(room->bvh, &ray, &h))
        return false;
    room_hit(room, &h, vec3(ray.dx, ray.dy, ray.dz), &hit);
    *centre = normals_receive(render->gatherer->smooth, room, &hit);
    image->normal[3 * at] = (float)centre->normal.x;
    image->normal[3 * at + 1] = (float)centre->normal.y;
    image->normal[3 * at + 2] = (float)centre->normal.z;
    image->depth[at] = (float)vec3_length(vec3_sub(hit.point, vec3(ray.ox, ray.oy, ray.oz)));
    image->patch[at] = hit.patch;
    return true;
}

static void store_pixel(const Render *render, size_t at, const Pixel *pixel, double scale)
{
    Image *image = render->image;
    store(image->radiance + 3 * at, pixel->radiance, scale);
    store(image->direct + 3 * at, pixel->direct, scale);
    store(image->indirect + 3 * at, pixel->indirect, scale);
    store(image->albedo + 3 * at, pixel->albedo, scale);
    store(image->irradiance + 3 * at, pixel->irradiance, scale);
    for (uint32_t k = 0; k < image->group_count; k++)
        store(image_group(image, k) + 3 * at, pixel->split[k], scale);
    if (render->known != NULL)
        render->known[at] = 1;
}

static void render_pixel(const Render *render, Worker *worker, int x, int y)
{
    const uint32_t samples = render->options->samples;
    const size_t   at = (size_t)y * (size_t)render->image->width + (size_t)x;
    const uint32_t seed = sampling_seed((uint32_t)(x + render->image->left),
                                              (uint32_t)(y + render->image->top),
                                              render->options->seed, 1);
    Pixel          pixel = { .split = eye_sums(&worker->eye, 0) };
    uint32_t       done = 0;
    /* Asked to stop, a pixel keeps the samples it has: a tile with thousands each takes long. */
    while (done < samples && !monitor_stop(render->monitor)) {
        const uint32_t left = samples - done, count = left < WAVE_POINTS ? left : WAVE_POINTS;
        for (uint32_t i = 0; i < count; i++)
            worker->sample[i] = (EyeSample){ .x = x, .y = y, .index = done + i, .seed = seed,
                                             .pixel = &pixel };
        eye_gather(&worker->eye, worker->sample, count);
        done += count;
    }
    if (done > 0)
        store_pixel(render, at, &pixel, 1.0 / done);
}

static int smaller(int a, int b) { return a < b ? a : b; }

/* Where records know the light there are too few rays for guides to be worth it. */
static uint32_t rays_per_pixel(const RenderOptions *o)
{
    if (o->records != NULL)
        return 0;
    const uint64_t rays = (uint64_t)o->samples * o->gather_rays;
    return rays < RAYS_MAX ? (uint32_t)rays : RAYS_MAX;
}

/* The number that the whole picture's tile has there, so that a part whose corner is a tile's has
 * the same pixels. */
static uint32_t number_in_whole(const Render *render, int x0, int y0)
{
    const Image *image = render->image;
    const int    width = image->whole_width > 0 ? image->whole_width : image->width;
    return (uint32_t)((y0 + image->top) / TILE) * (uint32_t)((width + TILE - 1) / TILE) +
           (uint32_t)((x0 + image->left) / TILE);
}

/* All pixels of a tile have samples. */
static void know_tile(const Render *render, uint32_t tile)
{
    const int x0 = (int)(tile % render->tiles_x) * TILE, y0 = (int)(tile / render->tiles_x) * TILE;
    const int x1 = smaller(x0 + TILE, render->image->width);
    const int y1 = smaller(y0 + TILE, render->image->height);
    for (int y = y0; render->known != NULL && y < y1; y++)
        memset(render->known + (size_t)y * (size_t)render->image->width + x0, 1,
               (size_t)(x1 - x0));
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
    guides_train(&worker->eye.guides, &worker->eye.wave, worker->centre, worker->reach, centres,
                 rays_per_pixel(render->options),
                 sampling_seed(number_in_whole(render, x0, y0), 0, render->options->seed, 2));
    if (render->options->error > 0) {
        const RefineTile refine = { x0, y0, x1, y1, render->mean };
        render->samples[tile] = refine_tile(&worker->eye, &refine, render->image,
                                            render->monitor);
        know_tile(render, tile);
        return;
    }
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            render_pixel(render, worker, x, y);
}

/* Shows a finished tile to who wants to see it. */
static void show_tile(const Render *render, uint32_t tile)
{
    const int x = (int)(tile % render->tiles_x) * TILE, y = (int)(tile / render->tiles_x) * TILE;
    const int part[4] = { x, y, smaller(x + TILE, render->image->width),
                          smaller(y + TILE, render->image->height) };
    render->options->tile(render->options->tile_user, render->image, part);
}

static void render_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Render *render = context;
    Worker       *worker = &render->worker[thread];
    KeptTiles *kept = render->options->kept;
    for (uint32_t tile = begin; tile < end; tile++) {
        if (kept != NULL && kept_tiles_has(kept, tile))
            continue;
        worker->eye.wave.rays = 0;
        render_tile(render, worker, tile);
        render->rays[tile] = worker->eye.wave.rays;
        /* Asked to stop, pixels may have fewer samples. */
        if (kept != NULL && !monitor_stop(render->monitor))
            kept_tiles_add(kept, tile);
        if (render->options->tile != NULL && !monitor_stop(render->monitor))
            show_tile(render, tile);
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
        Eye *eye = &render->worker[i].eye;
        eye->gatherer = eye->wave.gatherer = g;
        eye->wave.caustics = render->caustics;
        eye->options = render->options;
        eye->camera = &render->camera;
        eye->filter = &render->filter;
        eye_split_create(eye, err);
    }
    return !error_is_set(err);
}

static void workers_destroy(Render *render)
{
    for (unsigned i = 0; render->worker != NULL && i < render->options->threads; i++)
        eye_split_destroy(&render->worker[i].eye);
    array_free(render->worker);
}

/* --- the mean --------------------------------------------------------------------------------- */

/* A few samples of a tile: what is no lamp counts. */
static void mean_of_tile(const Render *render, Worker *worker, uint32_t tile)
{
    enum { STEP = TILE / 2 };
    const Image *image = render->image;
    const int x0 = (int)(tile % render->tiles_x) * TILE, y0 = (int)(tile / render->tiles_x) * TILE;
    Pixel    pixel[4] = { 0 };
    uint32_t n = 0;
    worker->eye.guides.count = 0;
    for (int k = 0; k < 4; k++) {
        const int x = x0 + STEP / 2 + STEP * (k % 2), y = y0 + STEP / 2 + STEP * (k / 2);
        if (x >= image->width || y >= image->height)
            continue;
        worker->sample[n] = (EyeSample){ .x = x, .y = y, .group = n, .pixel = &pixel[n],
                                         .seed = sampling_seed((uint32_t)(x + image->left),
                                                               (uint32_t)(y + image->top),
                                                               render->options->seed, SEED_MEAN) };
        n++;
    }
    eye_gather(&worker->eye, worker->sample, n);
    for (uint32_t i = 0; i < n; i++) {
        const double reflected = rgb_luminance(rgb_add(pixel[i].direct, pixel[i].indirect));
        render->bright[2 * tile] += reflected > 0 ? rgb_luminance(pixel[i].radiance) : 0;
        render->bright[2 * tile + 1] += reflected > 0;
    }
}

static void mean_of_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Render *render = context;
    for (uint32_t tile = begin; tile < end; tile++) {
        Worker *worker = &render->worker[thread];
        worker->eye.wave.rays = 0;
        mean_of_tile(render, worker, tile);
        render->rays[tile] = worker->eye.wave.rays;
    }
}

static bool find_mean(Render *render, RenderReport *report, Error *err)
{
    render->bright = array_create(2 * (size_t)render->tiles, sizeof(double), "picture", err);
    if (render->bright == NULL)
        return false;
    if (!parallel_for(render->tiles, 16, render->options->threads, mean_of_tiles, render,
                      render->monitor, NULL))
        return true; /* there is less to do soon */
    double sum = 0, number = 0;
    for (uint32_t i = 0; i < render->tiles; i++) {
        sum += render->bright[2 * i];
        number += render->bright[2 * i + 1];
        report->rays += render->rays[i];
    }
    render->mean = number > 0 ? sum / number : 0;
    return true;
}

/* --- stopped early ---------------------------------------------------------------------------- */

/* Samples that are taken for pixels without any. */
enum { ROUGH_SAMPLES = 1 << 16 };

/* The first pixel of the block that is not known gets a sample, and others have the same. */
static void fill_block(const Render *render, Worker *worker, int x0, int y0)
{
    const Image *image = render->image;
    const size_t width = (size_t)image->width;
    size_t       first = SIZE_MAX;
    for (int y = y0; y < smaller(y0 + render->step, image->height); y++)
        for (int x = x0; x < smaller(x0 + render->step, image->width); x++) {
            const size_t at = (size_t)y * width + (size_t)x;
            Receiver     centre;
            if (render->known[at] != 0)
                continue;
            if (first != SIZE_MAX) {
                rough_copy(render->image, first, at);
                continue;
            }
            Pixel pixel = { .split = eye_sums(&worker->eye, 0) };
            worker->sample[0] = (EyeSample){
                .x = x, .y = y, .pixel = &pixel,
                .seed = sampling_seed((uint32_t)(x + image->left), (uint32_t)(y + image->top),
                                      render->options->seed, 1) };
            store_centre(render, worker, x, y, &centre);
            eye_gather(&worker->eye, worker->sample, 1);
            store_pixel(render, at, &pixel, 1);
            if (image->deviation != NULL) /* one sample says no more */
                image->deviation[at] = (float)rgb_luminance(pixel.radiance);
            first = at;
        }
}

static void fill_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Render *render = context;
    Worker       *worker = &render->worker[thread];
    worker->eye.guides.count = 0;
    worker->eye.wave.rays = 0;
    for (uint32_t tile = begin; tile < end; tile++) {
        const int x0 = (int)(tile % render->tiles_x) * TILE;
        const int y0 = (int)(tile / render->tiles_x) * TILE;
        for (int k = 0; k < TILE * TILE; k += render->step)
            if (k / TILE % render->step == 0)
                fill_block(render, worker, x0 + k % TILE, y0 + k / TILE);
        render->rays[tile] += worker->eye.wave.rays;
        worker->eye.wave.rays = 0;
    }
}

/* Records may be half made: they are not read. */
static void fill_up(Render *render, RenderReport *report)
{
    const size_t  pixels = (size_t)render->image->width * (size_t)render->image->height;
    RenderOptions rough = *render->options;
    size_t        missing = 0;
    for (size_t i = 0; i < pixels; i++)
        missing += render->known[i] == 0;
    report->rough = (double)missing / (double)pixels;
    if (missing == 0)
        return;
    rough.records = NULL;
    for (unsigned i = 0; i < rough.threads; i++)
        render->worker[i].eye.options = &rough;
    render->step = rough_step(missing, ROUGH_SAMPLES, TILE);
    parallel_for(render->tiles, 1, rough.threads, fill_tiles, render, NULL, NULL);
}

/* --- running ---------------------------------------------------------------------------------- */

static RecordsWish wish_of(const Render *render)
{
    const RenderOptions *o = render->options;
    return (RecordsWish){ .width = render->image->width, .height = render->image->height,
                          .rays = o->record_rays, .clear = !o->diffuse_only,
                          .seed = o->seed, .threads = o->threads,
                          .caustics = render->caustics };
}

/* Rays from lamps for each pixel of the whole picture, and how many in all. */
enum { PHOTONS_EACH = 16, PHOTONS_LEAST = 1 << 16, PHOTONS_MOST = 1 << 22 };

/* Light that mirrors and bent glass throw. */
static bool trace_caustics(Render *render, uint64_t *rays, Error *err)
{
    const RenderOptions *o = render->options;
    const Gatherer      *g = render->gatherer;
    const double pixels = (double)o->width * o->height * PHOTONS_EACH;
    const CausticsWish wish = {
        .photons = (uint32_t)fmin(fmax(pixels, PHOTONS_LEAST), PHOTONS_MOST),
        .seed = sampling_seed(o->seed, SEED_PHOTONS, 0, 0), .threads = o->threads
    };
    if (!o->diffuse_only && g->clear && g->room->mirrors &&
        (g->split == NULL || g->split->count < RECORDS_GROUPS_MOST))
        render->caustics = caustics_create(g, &wish, rays, render->monitor, err);
    return !error_is_set(err);
}

/* What reading between records does to the picture, where its error is asked for. */
static bool check_records(const Render *render, RenderReport *report, Error *err)
{
    const RenderOptions *o = render->options;
    const RecordsWish    wish = wish_of(render);
    double               error;
    if (o->records == NULL || !(render->mean > 0))
        return true;
    if (!records_check(o->records, render->gatherer, &render->camera, &wish, &error, &report->rays,
                       render->monitor, err))
        return false;
    report->records_error = error / render->mean;
    return true;
}

static bool fill_records(const Render *render, uint64_t *rays, Error *err)
{
    const RenderOptions *o = render->options;
    const RecordsWish    wish = wish_of(render);
    return o->records == NULL || records_fill(o->records, render->gatherer, &render->camera, &wish,
                                              rays, render->monitor, err);
}

/* What comes before the tiles: records of light, the mean, tiles of an earlier run. */
static bool prepare(Render *render, RenderReport *report, Error *err)
{
    const RenderOptions *o = render->options;
    render->rays = array_create(render->tiles, sizeof *render->rays, "picture", err);
    render->samples = array_create(render->tiles, sizeof *render->samples, "picture", err);
    if (o->whole)
        render->known = array_create((size_t)render->image->width * (size_t)render->image->height,
                                     1, "picture", err);
    if (!trace_caustics(render, &report->rays, err) || !workers_create(render, err) ||
        !fill_records(render, &report->rays, err))
        return false;
    if (o->error > 0 &&
        (!image_add_deviation(render->image, err) || !find_mean(render, report, err) ||
         !check_records(render, report, err)))
        return false;
    memset(render->rays, 0, render->tiles * sizeof *render->rays);
    if (o->kept != NULL)
        kept_tiles_begin(o->kept, render->image, TILE, render->rays, err);
    for (uint32_t k = 0; o->kept != NULL && !error_is_set(err) && k < render->tiles; k++)
        if (kept_tiles_has(o->kept, k))
            know_tile(render, k);
    return !error_is_set(err);
}

static void sum_up(const Render *render, RenderReport *report)
{
    const Image *image = render->image;
    const double pixels = (double)image->width * image->height;
    uint64_t     samples = 0;
    for (uint32_t i = 0; i < render->tiles; i++) {
        report->rays += render->rays[i];
        samples += render->samples[i];
    }
    report->samples = render->options->error > 0 ? (double)samples / pixels
                                                 : render->options->samples;
    report->error = render->options->error > 0 ? refine_reached(image, render->mean) : 0;
}

/* Runs the tiles; the scratch space of threads is made and freed here. */
static void render_run(Render *render, RenderReport *report, Error *err)
{
    const RenderOptions *o = render->options;
    const double         start = seconds_now();
    *report = (RenderReport){ 0 };
    if (prepare(render, report, err)) {
        const Progress base = { .stage = "gather", .done = 1, .energy_left = -1 };
        if (!parallel_for(render->tiles, 1, o->threads, render_tiles, render, render->monitor,
                          &base) || monitor_stop(render->monitor))
            error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
        sum_up(render, report);
    }
    if (err->code == ERROR_STOPPED && render->known != NULL && render->worker != NULL)
        fill_up(render, report);
    if (o->kept != NULL)
        kept_tiles_end(o->kept);
    report->seconds = seconds_now() - start;
    workers_destroy(render);
    caustics_destroy(render->caustics);
    array_free(render->rays);
    array_free(render->samples);
    array_free(render->known);
    array_free(render->bright);
}

/* All but what running makes; with an image unless *err is set. */
static void render_init(Render *render, const Gatherer *gatherer, const Camera *camera,
                        const RenderOptions *o, const Monitor *monitor, Error *err)
{
    *render = (Render){ .gatherer = gatherer, .options = o, .monitor = monitor,
                        .image = image_create_part(o->width, o->height, o->crop, err) };
    if (render->image == NULL)
        return;
    const Split *split = gatherer->split;
    if (split != NULL) {
        const bool rest = split->rest || rgb_max(o->background) > 0;
        if (!image_add_groups(render->image, split->name, split->count + rest, err)) {
            render->image = image_destroy(render->image);
            return;
        }
    }
    render->tiles_x = ((uint32_t)render->image->width + TILE - 1) / TILE;
    render->tiles = render->tiles_x * (((uint32_t)render->image->height + TILE - 1) / TILE);
    camera_rays_init(&render->camera, camera, o->width, o->height);
    camera_rays_crop(&render->camera, render->image->left, render->image->top);
    filter_table_init(&render->filter, o->filter);
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
    Render              render;
    render_init(&render, gatherer, camera, &o, monitor, err);
    if (render.image == NULL)
        return NULL;
    render_run(&render, report != NULL ? report : &unused, err);
    return error_is_set(err) && err->code != ERROR_STOPPED ? image_destroy(render.image)
                                                           : render.image;
}

bool render_records(const Gatherer *gatherer, const Camera *camera, const RenderOptions *options,
                    const Monitor *monitor, Error *err)
{
    assert(gatherer != NULL && camera != NULL && options != NULL && err != NULL);
    if (error_is_set(err))
        return false;
    const RenderOptions o = with_defaults(options);
    Render              render;
    uint64_t            rays = 0;
    render_init(&render, gatherer, camera, &o, monitor, err);
    const bool filled = render.image != NULL && trace_caustics(&render, &rays, err) &&
                        fill_records(&render, &rays, err);
    caustics_destroy(render.caustics);
    image_destroy(render.image);
    return filled;
}
