/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of paths: batches over all tiles until samples or error suffice. */
#include "render/path.h"

#include <assert.h>
#include <math.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "render/normals.h"
#include "render/path_internal.h"
#include "render/rough.h"

enum { TILE = 8, BATCH_MOST = PATH_WAVE / PATH_PIXELS, SAMPLES_DEFAULT = 64 };
static_assert(TILE * TILE == PATH_PIXELS, "a wave holds a tile");
/* The error is told from so many batches on; fewer say nothing. Tiles of a picture have thousands
 * of pixels, so that their mean square is known well even so. */
enum { BATCHES_LEAST = 4 };

enum { SEED_EYE = 7, SEED_LENS = 8 };

/* Of all paths of a pixel: sums, and the weighted variance of the batches' means of luminance
 * [west79]. */
typedef struct {
    PathSum  sum;
    double   mean, squares;
    uint32_t samples, batches;
} Pixel;

typedef struct {
    PathScene   scene;
    PathOptions options;   /* defaults filled in */
    CameraRays  camera;
    Image      *image;
    Pixel      *pixel;     /* [width * height] */
    PathWave  **wave;      /* [threads] */
    Error      *failed;    /* [threads] */
    uint64_t   *rays;      /* [tiles] */
    FilterTable filter;
    uint32_t    tiles_x, tiles;
    uint32_t    batch, begin, count; /* of samples: which, its first, how many */
    int         step_rough; /* edge of blocks that share a path when stopped early */
    double      done;      /* share of the work before this batch, */
    double      step;      /* and in it */
    const Monitor *monitor;
} Picture;

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool eye_ray(const CameraRays *camera, double x, double y, const float *lens, Ray *ray)
{
    Vec3 o, d;
    if (!camera_rays_at(camera, x, y, lens, &o, &d))
        return false;
    *ray = (Ray){ .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = 0,
                  .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
    return true;
}

/* --- a tile ---------------------------------------------------------------------------------- */

/* What the pixel's centre shows first. */
static void store_centre(const Picture *picture, int x, int y)
{
    Image       *image = picture->image;
    const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
    Ray          ray;
    InstanceHit  found;
    RoomHit      where;
    if (!eye_ray(&picture->camera, x + 0.5, y + 0.5, NULL, &ray) ||
        !path_nearest(&picture->scene, &ray, &found))
        return;
    const Room *room = path_place(&picture->scene, &found, vec3(ray.dx, ray.dy, ray.dz), &where);
    PathSurface surface;
    path_surface_init(&surface, &picture->scene, room, &found, &where,
                      vec3_unit(vec3(ray.dx, ray.dy, ray.dz)), true);
    const Rgb  albedo = surface.material->reflectance;
    const Vec3 normal = surface.at.normal;
    image->normal[3 * at] = (float)normal.x;
    image->normal[3 * at + 1] = (float)normal.y;
    image->normal[3 * at + 2] = (float)normal.z;
    image->albedo[3 * at] = (float)albedo.r;
    image->albedo[3 * at + 1] = (float)albedo.g;
    image->albedo[3 * at + 2] = (float)albedo.b;
    image->depth[at] = (float)vec3_length(vec3_sub(where.point, vec3(ray.ox, ray.oy, ray.oz)));
}

/* Paths of one pixel, picture->count of them, into the wave. */
static void add_paths(const Picture *picture, PathWave *wave, int x, int y, uint32_t pixel)
{
    const uint32_t seed = sampling_seed((uint32_t)(x + picture->image->left),
                                        (uint32_t)(y + picture->image->top),
                                        picture->options.seed, picture->batch);
    const uint32_t eye = sampling_mix(seed + SEED_EYE), glass = sampling_mix(seed + SEED_LENS);
    const bool     blur = camera_rays_blur(&picture->camera);
    for (uint32_t i = 0; i < picture->count; i++) {
        double at[2];
        float  u[2], lens[2];
        Ray    ray;
        sampling_sobol2(i, eye, u);
        if (blur)
            sampling_sobol2(i, glass, lens);
        filter_table_offset(&picture->filter, u, at);
        if (eye_ray(&picture->camera, x + at[0], y + at[1], blur ? lens : NULL, &ray))
            path_wave_add(wave, &ray, pixel, seed, i);
    }
}

static void add_batch(Pixel *pixel, const PathSum *sum, uint32_t count)
{
    const double mean = rgb_luminance(sum->radiance) / count, away = mean - pixel->mean;
    pixel->sum.radiance = rgb_add(pixel->sum.radiance, sum->radiance);
    pixel->sum.direct = rgb_add(pixel->sum.direct, sum->direct);
    pixel->sum.indirect = rgb_add(pixel->sum.indirect, sum->indirect);
    pixel->samples += count;
    pixel->batches++;
    pixel->mean += away * count / pixel->samples;
    pixel->squares += count * away * (mean - pixel->mean);
}

static void render_tile(const Picture *picture, PathWave *wave, uint32_t tile, Error *err)
{
    const int x0 = (int)(tile % picture->tiles_x) * TILE;
    const int y0 = (int)(tile / picture->tiles_x) * TILE;
    const int width = picture->image->width, height = picture->image->height;
    PathSum   sum[PATH_PIXELS] = { 0 };
    for (int k = 0; k < PATH_PIXELS; k++) {
        const int x = x0 + k % TILE, y = y0 + k / TILE;
        if (x >= width || y >= height)
            continue;
        if (picture->batch == 0)
            store_centre(picture, x, y);
        add_paths(picture, wave, x, y, (uint32_t)k);
    }
    assert(tile < picture->tiles);
    picture->rays[tile] += path_wave_run(wave, &picture->scene, sum, err);
    for (int k = 0; k < PATH_PIXELS; k++) {
        const int x = x0 + k % TILE, y = y0 + k / TILE;
        if (x < width && y < height)
            add_batch(&picture->pixel[(size_t)y * (size_t)width + (size_t)x], &sum[k],
                      picture->count);
    }
}

static void render_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Picture *picture = context;
    for (uint32_t tile = begin; tile < end; tile++)
        render_tile(picture, picture->wave[thread], tile, &picture->failed[thread]);
}

/* --- stopped early --------------------------------------------------------------------------- */

/* Paths that are made for pixels without any. */
enum { ROUGH_PATHS = 1 << 17 };

/* One path for each block of a tile that has none. */
static void fill_tile(const Picture *picture, PathWave *wave, uint32_t tile, Error *err)
{
    const int x0 = (int)(tile % picture->tiles_x) * TILE;
    const int y0 = (int)(tile / picture->tiles_x) * TILE;
    const int width = picture->image->width, height = picture->image->height;
    const int step = picture->step_rough;
    const size_t row = (size_t)width;
    PathSum   sum[PATH_PIXELS] = { 0 };
    if (picture->pixel[(size_t)y0 * row + (size_t)x0].samples > 0)
        return; /* tiles are made whole */
    for (int k = 0; k < PATH_PIXELS; k++) {
        const int x = x0 + k % TILE, y = y0 + k / TILE;
        if (x >= width || y >= height || (k % TILE) % step != 0 || (k / TILE) % step != 0)
            continue;
        store_centre(picture, x, y);
        add_paths(picture, wave, x, y, (uint32_t)k);
    }
    picture->rays[tile] += path_wave_run(wave, &picture->scene, sum, err);
    for (int k = 0; k < PATH_PIXELS; k++) {
        const int x = x0 + k % TILE, y = y0 + k / TILE;
        const int bx = x - x % step, by = y - y % step; /* tiles are whole blocks */
        if (x >= width || y >= height)
            continue;
        const size_t at = (size_t)y * row + (size_t)x, from = (size_t)by * row + (size_t)bx;
        rough_copy(picture->image, from, at);
        add_batch(&picture->pixel[at], &sum[(by - y0) * TILE + bx - x0], 1);
    }
}

static void fill_tiles(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Picture *picture = context;
    for (uint32_t tile = begin; tile < end; tile++)
        fill_tile(picture, picture->wave[thread], tile, &picture->failed[thread]);
}

/* Pixels that have no path yet get one, or share one. */
static void fill_up(Picture *picture, PathReport *report, Error *err)
{
    const size_t n = (size_t)picture->image->width * (size_t)picture->image->height;
    size_t missing = 0;
    for (size_t i = 0; i < n; i++)
        missing += picture->pixel[i].samples == 0;
    report->rough = (double)missing / (double)n;
    picture->step_rough = rough_step(missing, ROUGH_PATHS, TILE);
    picture->count = 1;
    if (missing > 0)
        parallel_for(picture->tiles, 1, picture->options.threads, fill_tiles, picture, NULL, NULL);
    for (unsigned i = 0; i < picture->options.threads; i++)
        if (error_is_set(&picture->failed[i]))
            *err = picture->failed[i];
}

/* --- batches --------------------------------------------------------------------------------- */

/* Progress of a batch as that of the whole. */
static void tell_progress(void *user, const Progress *progress)
{
    const Picture *picture = user;
    Progress       whole = *progress;
    whole.done = picture->done + picture->step * progress->done;
    monitor_progress(picture->monitor, &whole);
}

static bool tell_stop(void *user)
{
    return monitor_stop(((const Picture *)user)->monitor);
}

/* Square of the standard error of the pixel's mean. */
static double pixel_variance(const Pixel *pixel)
{
    return pixel->batches > 1 ? pixel->squares / (pixel->batches - 1.0) / pixel->samples : 0;
}

static double picture_error(const Picture *picture)
{
    const size_t n = (size_t)picture->image->width * (size_t)picture->image->height;
    double       mean = 0, square = 0;
    for (size_t i = 0; i < n; i++) {
        if (picture->pixel[i].batches < 2)
            return NAN;
        mean += picture->pixel[i].mean;
        square += pixel_variance(&picture->pixel[i]);
    }
    return mean > 0 ? sqrt(square / (double)n) / (mean / (double)n) : 0;
}

/* The largest power of two that leaves at least eight batches. */
static uint32_t batch_size(uint32_t samples)
{
    uint32_t size = BATCH_MOST;
    assert(samples > 0);
    while (size > 1 && 8 * size > samples)
        size /= 2;
    return size;
}

static void render_batches(Picture *picture, Error *err)
{
    const PathOptions *o = &picture->options;
    const uint32_t     size = batch_size(o->samples);
    const Monitor      inner = { .user = picture, .progress = tell_progress, .stop = tell_stop };
    const Progress     base = { .stage = "gather", .done = 1, .energy_left = -1 };
    while (picture->begin < o->samples) {
        const uint32_t left = o->samples - picture->begin;
        picture->count = size < left ? size : left;
        picture->step = fmin((double)picture->count / o->samples, 1 - picture->done);
        if (!parallel_for(picture->tiles, 1, o->threads, render_tiles, picture, &inner, &base)) {
            error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
            return;
        }
        for (unsigned i = 0; i < o->threads; i++)
            if (error_is_set(&picture->failed[i])) {
                *err = picture->failed[i];
                return;
            }
        picture->begin += picture->count;
        picture->batch++;
        picture->done = (double)picture->begin / o->samples;
        if (!(o->error > 0) || picture->batch < BATCHES_LEAST)
            continue;
        const double reached = picture_error(picture);
        if (reached <= o->error)
            return;
        picture->done = fmax(picture->done, o->error * o->error / (reached * reached));
    }
}

/* --- the picture ----------------------------------------------------------------------------- */

static void store(float *out, Rgb sum, double scale)
{
    out[0] = (float)(sum.r * scale);
    out[1] = (float)(sum.g * scale);
    out[2] = (float)(sum.b * scale);
}

static void fill_image(const Picture *picture, PathReport *report)
{
    Image       *image = picture->image;
    const size_t n = (size_t)image->width * (size_t)image->height;
    double       samples = 0;
    for (size_t i = 0; i < n; i++) {
        const Pixel *pixel = &picture->pixel[i];
        const double scale = pixel->samples > 0 ? 1.0 / pixel->samples : 0;
        store(image->radiance + 3 * i, pixel->sum.radiance, scale);
        store(image->direct + 3 * i, pixel->sum.direct, scale);
        store(image->indirect + 3 * i, pixel->sum.indirect, scale);
        image->deviation[i] = (float)sqrt(pixel_variance(pixel));
        samples += pixel->samples;
    }
    for (uint32_t i = 0; i < picture->tiles; i++)
        report->rays += picture->rays[i];
    report->samples = samples / (double)n;
    report->error = picture_error(picture);
}

static bool is_clear(const Room *room)
{
    bool clear = false;
    for (size_t i = 0; i < room->material_count; i++)
        clear = clear || rgb_max(room->materials[i].transmittance) > 0 ||
                room->materials[i].cut_out;
    return clear;
}

static bool picture_prepare(Picture *picture, Error *err)
{
    const Room  *room = picture->scene.room;
    PathOptions *o = &picture->options;
    o->samples = o->samples > 0 ? o->samples : SAMPLES_DEFAULT;
    o->threads = parallel_threads(o->threads);
    picture->image = image_create_part(o->width, o->height, o->crop, err);
    if (picture->image == NULL || !image_add_deviation(picture->image, err))
        return false;
    picture->image->empty = IMAGE_IRRADIANCE | IMAGE_PATCH;
    picture->tiles_x = ((uint32_t)picture->image->width + TILE - 1) / TILE;
    picture->tiles = picture->tiles_x * (((uint32_t)picture->image->height + TILE - 1) / TILE);
    picture->pixel = array_create((size_t)picture->image->width * (size_t)picture->image->height,
                                  sizeof *picture->pixel, "picture", err);
    picture->rays = array_create(picture->tiles, sizeof *picture->rays, "picture", err);
    picture->wave = array_create(o->threads, sizeof *picture->wave, "picture", err);
    picture->failed = array_create(o->threads, sizeof *picture->failed, "picture", err);
    for (unsigned i = 0; i < o->threads && !error_is_set(err); i++)
        picture->wave[i] = path_wave_create(err);
    if (!error_is_set(err))
        picture->scene.smooth = normals_create(room, err);
    picture->scene.panes = is_clear(room) && !o->diffuse_only;
    return !error_is_set(err) && path_lamps_init(&picture->scene.lamps, room, err);
}

static void picture_clear(Picture *picture)
{
    for (unsigned i = 0; picture->wave != NULL && i < picture->options.threads; i++)
        path_wave_destroy(picture->wave[i]);
    array_free(picture->wave);
    array_free(picture->failed);
    array_free(picture->rays);
    array_free(picture->pixel);
    array_free(picture->scene.smooth);
    path_lamps_clear(&picture->scene.lamps);
}

Image *render_path(const Room *room, const Camera *camera, const PathOptions *options,
                   PathReport *report, const Monitor *monitor, Error *err)
{
    assert(room != NULL && camera != NULL && options != NULL && err != NULL);
    assert(room->emitting != NULL && room->bvh != NULL);
    if (error_is_set(err))
        return NULL;
    const double start = seconds_now();
    PathReport   unused;
    Picture picture = { .scene = { .room = room, .copies = options->copies,
                                   .offset = options->copies != NULL
                                                 ? copies_offset(options->copies) : room->offset },
                        .options = *options, .monitor = monitor };
    report = report != NULL ? report : &unused;
    *report = (PathReport){ 0 };
    picture.scene.options = &picture.options;
    if (picture_prepare(&picture, err)) {
        camera_rays_init(&picture.camera, camera, options->width, options->height);
        camera_rays_crop(&picture.camera, picture.image->left, picture.image->top);
        filter_table_init(&picture.filter, options->filter);
        render_batches(&picture, err);
        if (err->code == ERROR_STOPPED)
            fill_up(&picture, report, err);
        fill_image(&picture, report);
    }
    picture_clear(&picture);
    report->seconds = seconds_now() - start;
    if (error_is_set(err) && err->code != ERROR_STOPPED)
        picture.image = image_destroy(picture.image);
    return picture.image;
}
