/* SPDX-License-Identifier: BSD-3-Clause */
/* From scene light to display bytes: exposure, tone curve, sRGB, dither; and the exposure itself.
 *
 * Curves   work on each channel, so that very bright colours fade to white as they do on film.
 *   shoulder  linear up to KNEE, so that mid greys and all below keep their value; above it
 *                 y = KNEE + (1 - KNEE) (1 - exp(-(v - KNEE) / (1 - KNEE)))
 *             which leaves the line with the same slope and reaches white only at infinity
 *   linear    cut off at white
 *   reinhard  y = v (1 + v / WHITE^2) / (1 + v) [reinhard02]
 *   filmic    a quotient of two parabolas with a toe and a shoulder [narkowicz16], its input
 *             scaled so that mid grey stays
 * Dither   an 8 x 8 ordered pattern of one step, the same for each picture and the three channels:
 *          no banding on large soft walls, and the same bytes each time.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/rgb.h"
#include "render/internal.h"

static const double KNEE = 0.25;     /* above mid grey, so that greys are kept */
static const double MID_GREY = 0.18; /* reflectance of a photographer's grey card */

double tonemap_curve(double v)
{
    assert(KNEE > MID_GREY && KNEE < 1);
    if (!(v > 0)) /* NaN too: a picture file must not hold garbage */
        return 0;
    return v <= KNEE ? v : KNEE + (1 - KNEE) * -expm1(-(v - KNEE) / (1 - KNEE));
}

static const double REINHARD_WHITE = 4; /* shown as white: more than four stops above mid grey */

static double reinhard(double v)
{
    return fmin(1, v * (1 + v / (REINHARD_WHITE * REINHARD_WHITE)) / (1 + v));
}

static double filmic(double v)
{
    /* The published fit, and where it gives MID_GREY: the root of
     * (A - G C) x^2 + (B - G D) x - G E. */
    static const double A = 2.51, B = 0.03, C = 2.43, D = 0.59, E = 0.14;
    const double G = MID_GREY, a = A - G * C, b = B - G * D, c = -G * E;
    const double grey = (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
    const double x = fmin(v, 1e6) * grey / MID_GREY; /* beyond is white; squares stay finite */
    return fmin(1, x * (A * x + B) / (x * (C * x + D) + E));
}

double tonemap_by(ToneCurve curve, double v)
{
    if (!(v > 0))
        return 0;
    switch (curve) {
    case TONE_LINEAR:
        return fmin(1, v);
    case TONE_REINHARD:
        return reinhard(fmin(v, 1e6));
    case TONE_FILMIC:
        return filmic(v);
    case TONE_SHOULDER:
        break;
    }
    return tonemap_curve(v);
}

double tonemap_srgb(double v)
{
    /* IEC 61966-2-1 */
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* Rank 0..63 of a pixel in the 8 x 8 Bayer pattern: bits of x ^ y and y, interleaved, reversed. */
static unsigned dither_rank(unsigned x, unsigned y)
{
    unsigned rank = 0;
    for (unsigned bit = 0; bit < 3; bit++) {
        const unsigned a = (x ^ y) >> bit & 1, b = y >> bit & 1;
        rank |= (a << 1 | b) << 2 * (2 - bit);
    }
    return rank;
}

void tonemap_row(const float *radiance, int width, int y, const ImageTone *tone, uint8_t *out)
{
    assert(radiance != NULL && out != NULL && width > 0);
    const double scale = exp2(tone->exposure);
    for (int x = 0; x < width; x++) {
        const double threshold = (dither_rank((unsigned)x & 7, (unsigned)y & 7) + 0.5) / 64;
        for (int k = 0; k < 3; k++) {
            const double shown = tonemap_by(tone->curve, scale * radiance[3 * x + k]);
            const double level = 255 * tonemap_srgb(shown);
            const double byte = floor(level + threshold);
            out[3 * x + k] = (uint8_t)(byte > 255 ? 255 : byte);
        }
    }
}

/* A lamp is told from a bright wall by being far above what is usual: this many times the
 * log-average of the picture, a little over six stops. */
static const double LAMP_RATIO = 100;

/* Log-average luminance of the pixels with 0 < luminance <= limit; 0 when there are none. */
static double log_average(const Image *image, double limit)
{
    double       sum = 0;
    size_t       count = 0;
    const size_t n = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < n; i++) {
        const float *p = image->radiance + 3 * i;
        const double y = rgb_luminance(rgb(p[0], p[1], p[2]));
        if (y > 0 && isfinite(y) && y <= limit) {
            sum += log(y);
            count++;
        }
    }
    return count ? exp(sum / (double)count) : 0;
}

/* Whether part of a pixel's light is neither direct nor indirect reflection: then it shows a lamp,
 * unless a mirror or glass is there, which is left out just as well. */
static bool pixel_emits(const Image *image, size_t i)
{
    static const double SHARE = 0.5; /* of the light: pixels at a lamp's rim still count as lamp */
    const float *p = image->radiance + 3 * i, *d = image->direct + 3 * i,
                *r = image->indirect + 3 * i;
    const double all = rgb_luminance(rgb(p[0], p[1], p[2]));
    const double reflected = rgb_luminance(rgb(d[0] + r[0], d[1] + r[1], d[2] + r[2]));
    return all - reflected > SHARE * all;
}

double image_auto_exposure(const Image *image)
{
    assert(image != NULL);
    double       sum = 0;
    size_t       count = 0;
    const double limit = LAMP_RATIO * log_average(image, INFINITY);
    const size_t n = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < n; i++) {
        const float *p = image->radiance + 3 * i;
        const double y = rgb_luminance(rgb(p[0], p[1], p[2]));
        if (!(y > 0) || !isfinite(y) || y > limit || pixel_emits(image, i))
            continue;
        sum += log(y);
        count++;
    }
    /* Nothing but lamps and mirrors: what they show must do. */
    const double average = count ? exp(sum / (double)count) : log_average(image, INFINITY);
    return average > 0 ? log2(MID_GREY / average) : 0;
}
