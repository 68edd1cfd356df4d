/* SPDX-License-Identifier: BSD-3-Clause */
/* Errors between two pictures: luminance planes, masks, and three sums. */
#include "render/compare.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>

#include "base/array.h"
#include "math/rgb.h"

enum { LAMP_RIM = 2, BLOCK = 8 };
static const double LAMP_DEFAULT = 5;
static const double SMOOTH_SPAN = 0.25;

enum { MASK_COUNT = 1, MASK_SMOOTH = 2 };

typedef struct {
    double low, high, mean;
} Window;

static int clamp(int i, int n) { return i < 0 ? 0 : i >= n ? n - 1 : i; }

/* Least, greatest and mean value around a pixel; the picture's rim is repeated outwards. */
static Window window_at(const double *y, int width, int height, int px, int py, int radius)
{
    Window w = { INFINITY, -INFINITY, 0 };
    for (int j = py - radius; j <= py + radius; j++)
        for (int i = px - radius; i <= px + radius; i++) {
            const double v = y[(size_t)clamp(j, height) * (size_t)width + (size_t)clamp(i, width)];
            w.low = fmin(w.low, v);
            w.high = fmax(w.high, v);
            w.mean += v;
        }
    w.mean /= (2 * radius + 1) * (2 * radius + 1);
    return w;
}

static uint8_t mask_at(const double *y, int width, int height, int px, int py, double lamp)
{
    if (window_at(y, width, height, px, py, LAMP_RIM).high > lamp)
        return 0;
    const Window w = window_at(y, width, height, px, py, 1);
    if (!(w.low > 0))
        return 0;
    return w.high - w.low < SMOOTH_SPAN * w.mean ? MASK_COUNT | MASK_SMOOTH : MASK_COUNT;
}

/* Root mean square of the mean differences of blocks that are more than half smooth. */
static double block_rms(const double *difference, const uint8_t *mask, int width, int height)
{
    double   square = 0;
    unsigned blocks = 0;
    for (int y = 0; y + BLOCK <= height; y += BLOCK)
        for (int x = 0; x + BLOCK <= width; x += BLOCK) {
            double   sum = 0;
            unsigned n = 0;
            for (int j = y; j < y + BLOCK; j++)
                for (int i = x; i < x + BLOCK; i++) {
                    const size_t k = (size_t)j * (size_t)width + (size_t)i;
                    if (mask[k] & MASK_SMOOTH) {
                        sum += difference[k];
                        n++;
                    }
                }
            if (n > BLOCK * BLOCK / 2) {
                square += sum / n * (sum / n);
                blocks++;
            }
        }
    return blocks ? sqrt(square / blocks) : 0;
}

static void sum_up(const double *reference, const double *difference, const uint8_t *mask,
                   size_t pixels, Comparison *out)
{
    double all = 0, smooth = 0, bias = 0, mean = 0, peak = 0;
    size_t counted = 0, smooths = 0;
    for (size_t k = 0; k < pixels; k++) {
        const double d = difference[k];
        if (mask[k] & MASK_COUNT) {
            counted++;
            all += d * d;
            mean += reference[k];
            peak = fmax(peak, reference[k]);
        }
        if (mask[k] & MASK_SMOOTH) {
            smooths++;
            smooth += d * d;
            bias += d;
        }
    }
    out->mean = counted ? mean / (double)counted : 0;
    out->counted = (double)counted / (double)pixels;
    out->smooth = (double)smooths / (double)pixels;
    out->all_error = counted ? sqrt(all / (double)counted) / out->mean : 0;
    out->smooth_error = smooths ? sqrt(smooth / (double)smooths) / out->mean : 0;
    out->bias = smooths ? bias / (double)smooths / out->mean : 0;
    out->psnr = counted ? 10 * log10(peak * peak * (double)counted / all) : 0;
}

static double luminance_of(const float *p) { return rgb_luminance(rgb(p[0], p[1], p[2])); }

bool image_compare(const float *reference, const float *picture, int width, int height,
                   double lamp, Comparison *out, Error *err)
{
    assert(reference != NULL && picture != NULL && width > 0 && height > 0 && out != NULL);
    const size_t pixels = (size_t)width * (size_t)height;
    double  *y = array_create(pixels, sizeof *y, "luminance", err);
    double  *difference = array_create(pixels, sizeof *difference, "differences", err);
    uint8_t *mask = array_create(pixels, sizeof *mask, "pixel mask", err);
    *out = (Comparison){ 0 };
    if (!error_is_set(err)) {
        for (size_t k = 0; k < pixels; k++) {
            y[k] = luminance_of(reference + 3 * k);
            difference[k] = luminance_of(picture + 3 * k) - y[k];
        }
        for (int j = 0; j < height; j++)
            for (int i = 0; i < width; i++)
                mask[(size_t)j * (size_t)width + (size_t)i] =
                    mask_at(y, width, height, i, j, lamp > 0 ? lamp : LAMP_DEFAULT);
        sum_up(y, difference, mask, pixels, out);
        out->block_error =
            out->mean > 0 ? block_rms(difference, mask, width, height) / out->mean : 0;
        if (!(out->mean > 0))
            error_set(err, ERROR_INPUT, "no pixel to compare: the reference is black or all lamp");
    }
    array_free(mask);
    array_free(difference);
    array_free(y);
    return !error_is_set(err);
}
