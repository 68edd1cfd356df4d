/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples go where noise is: rounds over the pixels of a tile, each as large as all before. */
#include "render/refine.h"

#include <assert.h>

#include "math/sampling.h"

enum { PIXELS = REFINE_TILE * REFINE_TILE };
static_assert(2 * PIXELS <= EYE_SUMS, "each half has sums of light groups");
enum { SEED_HALF = 400 };
/* Samples of each half in the first round: four in all tell a shadow's rim from light, together
 * with those of the eight neighbours. The smaller the error, the less may be missed: an edge that
 * covers a small share of a pixel. */
static uint32_t first_samples(double error)
{
    return error < 0.005 ? 8 : error < 0.01 ? 4 : 2;
}

/* Most pixels end well below the limit at which they stop, so the mean over the picture stays below
 * the error asked for when the limit is above it. */
static const double LIMIT = 1.25;

/* A tile under way. */
typedef struct {
    Eye              *eye;
    const RefineTile *tile;
    const Monitor    *monitor;
    Image            *image;
    Pixel    half[PIXELS][2];
    uint32_t done[PIXELS];      /* samples of each half */
    bool     active[PIXELS];
    double   variance[PIXELS];  /* over the square of level_of */
    EyeSample sample[WAVE_POINTS];
    uint32_t samples, groups;   /* collected */
    uint64_t total;
} Refine;

static void flush(Refine *r)
{
    if (r->samples > 0)
        eye_gather(r->eye, r->sample, r->samples);
    r->total += r->samples;
    r->samples = r->groups = 0;
}

/* `count` samples more of one half. */
static void add_samples(Refine *r, uint32_t i, int half, uint32_t count)
{
    const int width = r->tile->x1 - r->tile->x0;
    const int x = r->tile->x0 + (int)i % width, y = r->tile->y0 + (int)i / width;
    const uint32_t seed = sampling_seed((uint32_t)(x + r->image->left),
                                        (uint32_t)(y + r->image->top), r->eye->options->seed,
                                        SEED_HALF + (uint32_t)half);
    assert(count > 0 && half >= 0 && half < 2);
    for (uint32_t k = 0; k < count;) {
        uint32_t n = count - k < WAVE_POINTS ? count - k : WAVE_POINTS;
        if (r->samples + n > WAVE_POINTS)
            flush(r);
        for (uint32_t j = 0; j < n; j++)
            r->sample[r->samples++] =
                (EyeSample){ .x = x, .y = y, .index = r->done[i] + k + j, .seed = seed,
                             .group = r->groups, .pixel = &r->half[i][half] };
        r->groups++;
        k += n;
    }
}

static double luminance_of(const Refine *r, uint32_t i)
{
    return rgb_luminance(rgb_add(r->half[i][0].radiance, r->half[i][1].radiance)) /
           (2.0 * r->done[i]);
}

/* What a pixel's noise is held against. */
static double level_of(const Refine *r, uint32_t i)
{
    const double level = fmax(r->tile->mean, luminance_of(r, i));
    return level > 0 ? level : 1; /* all is black: so is its noise */
}

/* Of the mean of both halves, relative, smoothed over 3 x 3 pixels: a single difference of two
 * numbers says little. */
static void find_variances(Refine *r)
{
    const int w = r->tile->x1 - r->tile->x0, h = r->tile->y1 - r->tile->y0;
    double    own[PIXELS];
    for (int i = 0; i < w * h; i++) {
        const double d = rgb_luminance(r->half[i][0].radiance) -
                         rgb_luminance(r->half[i][1].radiance);
        const double share = d / (2.0 * r->done[i] * level_of(r, (uint32_t)i));
        own[i] = share * share;
    }
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            double sum = 0;
            int    n = 0;
            for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < h; j++)
                for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < w; i++, n++)
                    sum += own[j * w + i];
            r->variance[y * w + x] = sum / n;
        }
}

/* Marks the pixels that need more; returns whether any does. */
static bool choose_pixels(Refine *r, uint32_t pixels)
{
    bool any = false;
    find_variances(r);
    for (uint32_t i = 0; i < pixels; i++) {
        const double limit = LIMIT * r->eye->options->error;
        r->active[i] = r->variance[i] > limit * limit &&
                       4 * (uint64_t)r->done[i] <= r->eye->options->samples;
        any = any || r->active[i];
    }
    return any;
}

static void store(float *out, Rgb a, Rgb b, double scale)
{
    out[0] = (float)((a.r + b.r) * scale);
    out[1] = (float)((a.g + b.g) * scale);
    out[2] = (float)((a.b + b.b) * scale);
}

static void store_pixel(const Refine *r, uint32_t i)
{
    const int    width = r->tile->x1 - r->tile->x0;
    const int    x = r->tile->x0 + (int)i % width, y = r->tile->y0 + (int)i / width;
    const size_t at = (size_t)y * (size_t)r->image->width + (size_t)x;
    const double scale = 0.5 / r->done[i];
    const Pixel *a = &r->half[i][0], *b = &r->half[i][1];
    store(r->image->radiance + 3 * at, a->radiance, b->radiance, scale);
    store(r->image->direct + 3 * at, a->direct, b->direct, scale);
    store(r->image->indirect + 3 * at, a->indirect, b->indirect, scale);
    store(r->image->albedo + 3 * at, a->albedo, b->albedo, scale);
    store(r->image->irradiance + 3 * at, a->irradiance, b->irradiance, scale);
    for (uint32_t k = 0; k < r->image->group_count; k++)
        store(image_group(r->image, k) + 3 * at, a->split[k], b->split[k], scale);
    const double shared = scale * (a->deviation + b->deviation);
    const double level = level_of(r, i);
    r->image->deviation[at] = (float)sqrt(r->variance[i] * level * level + shared * shared);
}

uint64_t refine_tile(Eye *eye, const RefineTile *tile, Image *image, const Monitor *monitor)
{
    const uint32_t pixels = (uint32_t)((tile->x1 - tile->x0) * (tile->y1 - tile->y0));
    const uint32_t first = first_samples(eye->options->error);
    Refine         r = { .eye = eye, .tile = tile, .image = image };
    assert(pixels > 0 && pixels <= PIXELS && image->deviation != NULL);
    for (uint32_t i = 0; i < pixels; i++) {
        r.active[i] = true;
        for (uint32_t half = 0; half < 2; half++)
            r.half[i][half].split = eye_sums(eye, 2 * i + half);
    }
    do {
        for (uint32_t i = 0; i < pixels; i++) {
            const uint32_t more = r.done[i] > 0 ? r.done[i] : first;
            if (!r.active[i])
                continue;
            add_samples(&r, i, 0, more);
            add_samples(&r, i, 1, more);
            r.done[i] += more;
        }
        flush(&r);
    } while (choose_pixels(&r, pixels) && !monitor_stop(monitor));
    for (uint32_t i = 0; i < pixels; i++)
        store_pixel(&r, i);
    return r.total;
}

double refine_reached(const Image *image, double mean)
{
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    assert(image->deviation != NULL);
    double       sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        const float *c = image->radiance + 3 * i;
        const double level = fmax(mean, rgb_luminance(rgb(c[0], c[1], c[2])));
        const double share = level > 0 ? image->deviation[i] / level : 0;
        sum += share * share;
    }
    return sqrt(sum / (double)pixels);
}
