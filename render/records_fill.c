/* SPDX-License-Identifier: BSD-3-Clause */
/* Where records of indirect light are wanted, and the light there. */
#include "render/records_fill.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/places.h"
#include "render/normals.h"
#include "render/split.h"
#include "render/wave.h"

/* Pixels between the records of the coarsest and the finest grid. */
enum { STRIDE_FIRST = 16, STRIDE_MIDDLE = 8, STRIDE_LAST = 4 };
enum { RECORDS_BLOCK = WAVE_POINTS / 2 }; /* each is gathered twice, to know its noise */
enum { BLOCK_SIDE = 6 };  /* about its square root */
enum { SEED_RECORD = 300, SEED_RECORD_TWIN, SEED_GUIDE };

/* A point is served when a record is this near (records.h): two thirds of the radius are left. */
static const double NEAR_ENOUGH = 0.65;
/* The radius is at most this share of the distance to what is nearest, so that light is not carried
 * past what hides it, and of the distance over which the kernel of light's transport changes by as
 * much as itself: linear in the first place, second order in the second. */
static const double NEAREST_SHARE = 0.6, CHANGE_SHARE = 0.3;
/* In pixels: records do not lie closer than eye can tell, nor farther than the grids look. */
static const double RADIUS_LEAST = 5, RADIUS_MOST = 16;
/* What is seen more aslant than this is taken for no more so. */
static const double SLANT_MOST = 3;
/* Cosine beyond which rounding in float would tell which way a surface is seen aslant. */
static const double STRAIGHT = 1 - 1e-4;

typedef struct {
    Receiver at;
    double   pixel;  /* width that a pixel covers there, across the view */
    Vec3     along;  /* unit, on the surface: the way it is seen aslant */
    double   slant;  /* >= 1: a pixel is as many times wider that way */
    double   albedo; /* luminance of its reflectance */
    uint32_t order;  /* neighbours in the picture have near numbers */
    bool     wanted;
} Place;

typedef struct {
    const Records     *records;
    const Gatherer    *gatherer;
    const CameraRays  *camera;
    const RecordsWish *wish;
    const Monitor     *monitor;
    Wave     *wave;      /* [threads] */
    Place    *place;     /* [across * down], then the first `wanted` of them */
    Record   *record;    /* [wanted] */
    Rgb      *light;     /* [wanted * groups]  of those; */
    Rgb      *split;     /* [threads * WAVE_POINTS * groups]  NULL: no groups */
    uint32_t  groups;
    uint64_t *rays;      /* [blocks] */
    uint32_t  across, down, wanted;
    int       stride;
    bool      checking; /* what is wanted are places that records serve */
} Fill;

/* --- where ----------------------------------------------------------------------------------- */

static void find_slant(Vec3 view, Place *place)
{
    const double cosine = fabs(vec3_dot(view, place->at.normal));
    const Vec3   flat = vec3_mad(view, -vec3_dot(view, place->at.normal), place->at.normal);
    Vec3         unused;
    vec3_frame(place->at.normal, &place->along, &unused);
    if (cosine < STRAIGHT)
        place->along = vec3_unit(flat);
    place->slant = 1 / fmin(fmax(cosine, 1 / SLANT_MOST), 1);
}

/* Where in a pixel is looked. Not in its middle: views of rooms are often symmetric, and would put
 * middles on the very edge of two walls, half of whose rays leave the room. */
static const double LOOK_X = 0.382, LOOK_Y = 0.573;

/* What pixel (x, y) shows, if that receives light and no record serves it; or if one does, where
 * records are checked. */
static bool look_at(const Fill *fill, int x, int y, Place *place)
{
    const Room *room = fill->gatherer->room;
    Vec3    o, d;
    Hit     h;
    RoomHit hit;
    Recorded recorded;
    if (!camera_rays_at(fill->camera, x + LOOK_X, y + LOOK_Y, NULL, &o, &d))
        return false;
    const Ray ray = { .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z, .t_min = 0,
                      .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
    if (!bvh_nearest(room->bvh, &ray, &h))
        return false;
    room_hit(room, &h, d, &hit);
    Material scratch;
    const Rgb albedo = places_hit(room, &hit, &scratch)->reflectance;
    if (!(rgb_max(albedo) > 0))
        return false;
    const double distance = vec3_length(vec3_sub(hit.point, o));
    *place = (Place){ .at = normals_receive(fill->gatherer->smooth, room, &hit), .wanted = true,
                      .albedo = rgb_luminance(albedo),
                      .pixel = camera_rays_footprint(fill->camera, distance) };
    find_slant(d, place);
    const bool found = records_find(fill->records, &place->at, &recorded);
    return fill->checking ? found : !found || recorded.nearness < NEAR_ENOUGH;
}

/* Bits of i and j in turns (a Z-shaped curve). */
static uint32_t interleave(uint32_t i, uint32_t j)
{
    uint32_t z = 0;
    for (unsigned bit = 0; bit < 16; bit++)
        z |= (i >> bit & 1) << 2 * bit | (j >> bit & 1) << (2 * bit + 1);
    return z;
}

static void look_rows(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Fill *fill = context;
    (void)thread;
    for (uint32_t j = begin; j < end; j++)
        for (uint32_t i = 0; i < fill->across; i++) {
            Place    *place = &fill->place[(size_t)j * fill->across + i];
            const int x = (int)i * fill->stride + fill->stride / 2;
            const int y = (int)j * fill->stride + fill->stride / 2;
            *place = (Place){ .wanted = false };
            if (x < fill->wish->width && y < fill->wish->height)
                place->wanted = look_at(fill, x, y, place);
            place->order = interleave(i, j);
        }
}

/* --- the light there ------------------------------------------------------------------------- */

/* The ellipse of a record: what geometry allows either way, within what pixels allow. */
static void find_ellipse(const WaveView *one, const WaveView *two, const Place *place,
                         Record *record)
{
    const double pixel = place->pixel, wide = pixel * place->slant;
    const double closeness = one->closeness + two->closeness, bright = one->bright + two->bright;
    const double nearest = fmin(one->nearest, two->nearest);
    const double change = closeness > 0 ? sqrt(bright / closeness) : INFINITY;
    const double radius = fmin(NEAREST_SHARE * nearest, CHANGE_SHARE * change);
    record->along = place->along;
    record->radius = fmin(fmax(radius, RADIUS_LEAST * pixel), RADIUS_MOST * pixel);
    record->stretch = fmin(fmax(radius, RADIUS_LEAST * wide), RADIUS_MOST * wide) /
                      record->radius;
}

/* Hemisphere rays of each record of the grid. The fewest rays for the same noise per pixel are
 * those that go with the root of the number of pixels that a record serves. */
static uint32_t rays_of(const Fill *fill)
{
    const uint32_t rays = fill->wish->rays * (uint32_t)fill->stride / STRIDE_MIDDLE;
    return rays > 2 ? rays : 2;
}

/* Where light comes from, as the points of a block learn together. */
static void train_block(const Fill *fill, Wave *wave, Guides *guides, uint32_t begin,
                        uint32_t end)
{
    Receiver at[RECORDS_BLOCK];
    double   reach[RECORDS_BLOCK];
    for (uint32_t i = begin; i < end; i++) {
        at[i - begin] = fill->place[i].at;
        reach[i - begin] = BLOCK_SIDE * fill->stride * fill->place[i].pixel;
    }
    guides_train(guides, wave, at, reach, end - begin, rays_of(fill),
                 sampling_seed(begin, (uint32_t)fill->stride, fill->wish->seed, SEED_GUIDE));
}

/* A thread's space for light by groups; NULL: there are none. */
static Rgb *split_of(const Fill *fill, const Wave *wave)
{
    const size_t thread = (size_t)(wave - fill->wave);
    return fill->split == NULL ? NULL : fill->split + thread * WAVE_POINTS * fill->groups;
}

/* Means of the twins' light by groups. */
static void store_apart(const Fill *fill, const Wave *wave, uint32_t begin, uint32_t end)
{
    const size_t groups = fill->groups;
    const Rgb   *split = split_of(fill, wave);
    for (uint32_t i = begin; split != NULL && i < end; i++)
        for (size_t g = 0; g < groups; g++) {
            const Rgb *one = split + 2 * (i - begin) * groups + g;
            fill->light[i * groups + g] = rgb_scale(rgb_add(one[0], one[groups]), 0.5);
        }
}

static void gather_block(const Fill *fill, Wave *wave, uint32_t begin, uint32_t end)
{
    Guides guides;
    const RecordsWish *wish = fill->wish;
    const uint32_t     rays = rays_of(fill);
    const WaveOptions  options = { .gather_rays = rays / 2, .lamp_rays = 1,
                                   .clear = wish->clear, .indirect_only = true,
                                   .guides = &guides, .split = split_of(fill, wave) };
    train_block(fill, wave, &guides, begin, end);
    /* Neighbours go on in one sequence where the one before them left off, so that the mean of
     * some of them is that of a finer net; twins know nothing of each other. */
    for (uint32_t twin = 0; twin < 2; twin++) {
        const uint32_t seed = sampling_seed(begin, (uint32_t)fill->stride, wish->seed,
                                            SEED_RECORD + twin);
        for (uint32_t i = begin; i < end; i++)
            wave->point[0][2 * (i - begin) + twin] = (WavePoint){
                .at = fill->place[i].at, .guide = guides_find(&guides, &fill->place[i].at),
                .index = i - begin, .seed = seed
            };
    }
    wave_gather(wave, 2 * (end - begin), 2 * (end - begin), &options);
    for (uint32_t i = begin; i < end; i++) {
        const uint32_t k = 2 * (i - begin);
        /* Light straight from lamps is what mirrors pass on: who reads records does not see it. */
        const Rgb one = rgb_add(wave->indirect[k], wave->direct[k]);
        const Rgb two = rgb_add(wave->indirect[k + 1], wave->direct[k + 1]);
        fill->record[i] = (Record){
            .at = fill->place[i].at,
            .irradiance = rgb_scale(rgb_add(one, two), 0.5),
            .deviation = fabs(rgb_luminance(one) - rgb_luminance(two)) / 2
        };
        find_ellipse(&wave->view[k], &wave->view[k + 1], &fill->place[i], &fill->record[i]);
    }
    store_apart(fill, wave, begin, end);
}

static void gather_blocks(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    const Fill *fill = context;
    Wave       *wave = &fill->wave[thread];
    assert(fill->record != NULL);
    for (uint32_t b = begin; b < end; b++) {
        const uint32_t from = b * RECORDS_BLOCK, left = fill->wanted - from;
        wave->rays = 0;
        gather_block(fill, wave, from, from + (left < RECORDS_BLOCK ? left : RECORDS_BLOCK));
        fill->rays[b] = wave->rays;
    }
}

/* --- in rounds ------------------------------------------------------------------------------- */

static int compare_order(const void *a, const void *b)
{
    const uint32_t one = ((const Place *)a)->order, two = ((const Place *)b)->order;
    return one < two ? -1 : one > two;
}

static void keep_wanted(Fill *fill)
{
    const uint32_t places = fill->across * fill->down;
    fill->wanted = 0;
    for (uint32_t i = 0; i < places; i++)
        if (fill->place[i].wanted)
            fill->place[fill->wanted++] = fill->place[i];
    qsort(fill->place, fill->wanted, sizeof *fill->place, compare_order);
}

static bool stopped(Error *err)
{
    return error_set(err, ERROR_STOPPED, "the picture was stopped before it was complete");
}

/* Light at what is wanted of one grid of pixels. */
static bool gather_round(Fill *fill, uint64_t *rays, Error *err)
{
    const unsigned threads = fill->wish->threads;
    const Progress base = { .stage = "records", .done = 1, .energy_left = -1 };
    fill->across = (uint32_t)((fill->wish->width + fill->stride - 1) / fill->stride);
    fill->down = (uint32_t)((fill->wish->height + fill->stride - 1) / fill->stride);
    fill->place = array_create((size_t)fill->across * fill->down, sizeof(Place), "records", err);
    if (fill->place == NULL)
        return false;
    if (!parallel_for(fill->down, 1, threads, look_rows, fill, fill->monitor, NULL))
        return stopped(err);
    *rays += (uint64_t)fill->across * fill->down;
    keep_wanted(fill);
    const uint32_t blocks = (fill->wanted + RECORDS_BLOCK - 1) / RECORDS_BLOCK;
    fill->record = array_create((size_t)fill->wanted + 1, sizeof(Record), "records", err);
    if (fill->groups > 0)
        fill->light = array_create(((size_t)fill->wanted + 1) * fill->groups, sizeof(Rgb),
                                   "records", err);
    fill->rays = array_create((size_t)blocks + 1, sizeof *fill->rays, "records", err);
    if (error_is_set(err))
        return false;
    if (!parallel_for(blocks, 1, threads, gather_blocks, fill, fill->monitor, &base))
        return stopped(err);
    for (uint32_t b = 0; b < blocks; b++)
        *rays += fill->rays[b];
    return true;
}

static void end_round(Fill *fill)
{
    fill->place = array_free(fill->place);
    fill->record = array_free(fill->record);
    fill->light = array_free(fill->light);
    fill->rays = array_free(fill->rays);
}

static void fit_range(void *context, uint32_t begin, uint32_t end, unsigned thread)
{
    (void)thread;
    records_fit(context, begin, end);
}

/* Defaults of the wish, and scratch space for each thread. */
static void begin_fill(Fill *fill, RecordsWish *w, Error *err)
{
    w->rays = w->rays > 1 ? w->rays : 1024;
    assert(w->width > 0 && w->height > 0);
    w->threads = parallel_threads(w->threads);
    fill->wave = array_create(w->threads, sizeof *fill->wave, "records", err);
    for (unsigned i = 0; fill->wave != NULL && i < w->threads; i++) {
        fill->wave[i].gatherer = fill->gatherer;
        fill->wave[i].caustics = w->caustics;
    }
}

bool records_fill(Records *records, const Gatherer *gatherer, const CameraRays *camera,
                  const RecordsWish *wish, uint64_t *rays, const Monitor *monitor, Error *err)
{
    RecordsWish w = *wish;
    Fill        fill = { .records = records, .gatherer = gatherer, .camera = camera, .wish = &w,
                         .monitor = monitor };
    assert(records != NULL && gatherer != NULL);
    if (error_is_set(err))
        return false;
    begin_fill(&fill, &w, err);
    fill.groups = records_groups(records);
    assert(fill.groups == (gatherer->split != NULL ? gatherer->split->count + 1 : 0));
    if (fill.groups > 0)
        fill.split = array_create((size_t)w.threads * WAVE_POINTS * fill.groups, sizeof(Rgb),
                                  "records", err);
    if (error_is_set(err))
        fill.wave = array_free(fill.wave);
    for (fill.stride = STRIDE_FIRST; fill.wave != NULL && fill.stride >= STRIDE_LAST;
         fill.stride /= 2) {
        const bool done = gather_round(&fill, rays, err) &&
                          records_add_apart(records, fill.record, fill.light, fill.wanted, err);
        end_round(&fill);
        if (!done)
            break;
    }
    array_free(fill.wave);
    array_free(fill.split);
    if (!error_is_set(err) &&
        !parallel_for(records_count(records), 256, w.threads, fit_range, records, monitor, NULL))
        stopped(err);
    return !error_is_set(err);
}

/* --- how well it is read --------------------------------------------------------------------- */

/* About so many places are looked at: 1/16 of the mean square is its standard error then, were the
 * errors normal numbers of one size; and their rays add a tenth to those of records or so. */
enum { CHECKS = 256, SEED_CHECK = 320 };

/* With two gathers of one place, m + h and m - h, and r read there, (m + h - r)(m - h - r) has the
 * mean of (truth - r)^2, whatever the gathers' noise. */
static double mean_square(const Fill *fill)
{
    double sum = 0;
    for (uint32_t i = 0; i < fill->wanted; i++) {
        const double h = fill->record[i].deviation, factor = fill->place[i].albedo / M_PI;
        Recorded     read;
        if (!records_find(fill->records, &fill->place[i].at, &read))
            continue;
        const double d = rgb_luminance(fill->record[i].irradiance) -
                         rgb_luminance(read.irradiance);
        sum += factor * factor * (d * d - h * h);
    }
    return fill->wanted > 0 ? fmax(sum, 0) / fill->wanted : 0;
}

bool records_check(const Records *records, const Gatherer *gatherer, const CameraRays *camera,
                   const RecordsWish *wish, double *error, uint64_t *rays, const Monitor *monitor,
                   Error *err)
{
    RecordsWish w = *wish;
    Fill        fill = { .records = records, .gatherer = gatherer, .camera = camera, .wish = &w,
                         .monitor = monitor, .checking = true };
    assert(records != NULL && gatherer != NULL && error != NULL);
    *error = 0;
    if (error_is_set(err))
        return false;
    begin_fill(&fill, &w, err);
    w.seed = sampling_seed(w.seed, 0, 0, SEED_CHECK);
    fill.stride = (int)fmax(ceil(sqrt((double)w.width * w.height / CHECKS)), 1);
    if (fill.wave != NULL && gather_round(&fill, rays, err))
        *error = sqrt(mean_square(&fill));
    end_round(&fill);
    array_free(fill.wave);
    return !error_is_set(err);
}
