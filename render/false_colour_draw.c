/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture in false colours: pixels, isolines, legend. Letters come from stb_easy_font, included
 * here alone. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define STB_EASY_FONT_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

#include "base/array.h"
#include "render/false_colour.h"
#include "render/internal.h"

enum { TICKS = 9, BAR = 20, GAP = 8, LETTER = 12 /* its height */, BACK = 32, NOTHING = 96 };

typedef struct {
    int      width, height, picture; /* picture: width without the legend */
    int      zoom;                   /* of letters and bar */
    uint8_t *pixels;
    const FalseColour *scale;
} Canvas;

static void put(Canvas *canvas, int x, int y, const uint8_t rgb[3])
{
    if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height)
        return;
    memcpy(canvas->pixels + 3 * ((size_t)y * (size_t)canvas->width + (size_t)x), rgb, 3);
}

static void put_box(Canvas *canvas, int x0, int y0, int x1, int y1, const uint8_t rgb[3])
{
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            put(canvas, x, y, rgb);
}

/* --- letters ---------------------------------------------------------------------------------- */

enum { QUADS = 512, TEXT_MOST = 32 };

/* The font's functions take texts that are not const, though they only read. */
static int text_width(const char *text, int zoom)
{
    char copy[TEXT_MOST];
    snprintf(copy, sizeof copy, "%.31s", text);
    return zoom * stb_easy_font_width(copy);
}

static void put_text(Canvas *canvas, int x, int y, const char *text)
{
    static const uint8_t white[3] = { 235, 235, 235 };
    struct { float x, y, z; uint8_t colour[4]; } corner[4 * QUADS];
    char copy[TEXT_MOST];
    snprintf(copy, sizeof copy, "%.31s", text);
    const int quads = stb_easy_font_print(0, 0, copy, NULL, corner, (int)sizeof corner);
    for (int q = 0; q < quads; q++) {
        const int z = canvas->zoom;
        put_box(canvas, x + z * (int)corner[4 * q].x, y + z * (int)corner[4 * q].y,
                x + z * (int)corner[4 * q + 2].x, y + z * (int)corner[4 * q + 2].y, white);
    }
}

/* --- legend ----------------------------------------------------------------------------------- */

static int tick_texts(const FalseColour *scale, char text[TICKS][TEXT_MOST], double ticks[TICKS])
{
    const int n = false_colour_ticks(scale, TICKS, ticks);
    for (int k = 0; k < n; k++)
        snprintf(text[k], TEXT_MOST, "%.6g", ticks[k]);
    return n;
}

static int legend_width(const FalseColour *scale, const char *label, int zoom)
{
    char   text[TICKS][TEXT_MOST];
    double ticks[TICKS];
    const int n = tick_texts(scale, text, ticks);
    int widest = text_width(label, zoom);
    for (int k = 0; k < n; k++) {
        const int w = text_width(text[k], zoom) + zoom * (BAR + GAP / 2);
        widest = w > widest ? w : widest;
    }
    return widest + 2 * zoom * GAP;
}

static void put_legend(Canvas *canvas, const char *label)
{
    static const uint8_t back[3] = { BACK, BACK, BACK }, white[3] = { 235, 235, 235 };
    char   text[TICKS][TEXT_MOST];
    double ticks[TICKS];
    const int z = canvas->zoom, left = canvas->picture + z * GAP;
    const int top = z * (GAP + LETTER + GAP), bottom = canvas->height - z * GAP - 1;
    put_box(canvas, canvas->picture, 0, canvas->width, canvas->height, back);
    put_text(canvas, left, z * GAP, label);
    if (bottom <= top)
        return;
    for (int y = top; y <= bottom; y++) {
        uint8_t rgb[3];
        false_colour_of(canvas->scale, (double)(bottom - y) / (bottom - top), rgb);
        put_box(canvas, left, y, left + z * BAR, y + 1, rgb);
    }
    const int n = tick_texts(canvas->scale, text, ticks);
    int       free = canvas->height; /* letters stand above it */
    for (int k = 0; k < n; k++) {
        const double place = false_colour_place(canvas->scale, ticks[k]);
        const int y = bottom - (int)lround(place * (bottom - top));
        put_box(canvas, left + z * (BAR - 4), y, left + z * BAR, y + 1, white);
        /* The font's digits are 7 high, 1 below the top; in small pictures some find no room. */
        if (y + 4 * z > free)
            continue;
        put_text(canvas, left + z * (BAR + GAP / 2), y - 4 * z, text[k]);
        free = y - 4 * z;
    }
}

/* --- isolines --------------------------------------------------------------------------------- */

/* Mean of the values around a pixel; NAN where the pixel has none. */
static double smoothed(const float *values, int width, int height, int x, int y)
{
    enum { REACH = 2 };
    double sum = 0;
    int    n = 0;
    if (isnan(values[(size_t)y * (size_t)width + (size_t)x]))
        return NAN;
    for (int j = y - REACH; j <= y + REACH; j++)
        for (int i = x - REACH; i <= x + REACH; i++) {
            if (i < 0 || j < 0 || i >= width || j >= height)
                continue;
            const double v = values[(size_t)j * (size_t)width + (size_t)i];
            if (isnan(v))
                continue;
            sum += v;
            n++;
        }
    return sum / n;
}

/* How many of the legend's values lie below; -1 where nothing is. */
static int level_of(double v, const double *ticks, int n)
{
    int level = 0;
    if (isnan(v))
        return -1;
    while (level < n && v >= ticks[level])
        level++;
    return level;
}

static bool put_isolines(Canvas *canvas, const float *values, Error *err)
{
    static const uint8_t black[3] = { 0, 0, 0 };
    const int w = canvas->picture, h = canvas->height;
    double    ticks[TICKS];
    const int n = false_colour_ticks(canvas->scale, TICKS, ticks);
    int8_t   *level = array_create((size_t)w * (size_t)h, 1, "isolines", err);
    if (level == NULL)
        return false;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            level[(size_t)y * (size_t)w + (size_t)x] =
                (int8_t)level_of(smoothed(values, w, h, x, y), ticks, n);
    for (int y = 0; y + 1 < h; y++)
        for (int x = 0; x + 1 < w; x++) {
            const int8_t *here = level + (size_t)y * (size_t)w + (size_t)x;
            if ((here[0] != here[1] && here[0] >= 0 && here[1] >= 0) ||
                (here[0] != here[w] && here[0] >= 0 && here[w] >= 0))
                put(canvas, x, y, black);
        }
    array_free(level);
    return true;
}

/* --- the whole -------------------------------------------------------------------------------- */

static void put_values(Canvas *canvas, const float *values)
{
    enum { STEPS = 1024 }; /* four to a byte's step */
    static const uint8_t grey[3] = { NOTHING, NOTHING, NOTHING };
    uint8_t table[STEPS + 1][3];
    for (int k = 0; k <= STEPS; k++)
        false_colour_of(canvas->scale, (double)k / STEPS, table[k]);
    for (int y = 0; y < canvas->height; y++)
        for (int x = 0; x < canvas->picture; x++) {
            const double v = values[(size_t)y * (size_t)canvas->picture + (size_t)x];
            const double place = false_colour_place(canvas->scale, v);
            const int    k = place > 0 ? (int)lround(fmin(place, 1) * STEPS) : 0;
            put(canvas, x, y, isnan(v) ? grey : table[k]);
        }
}

bool false_colour_write(const float *values, int width, int height, const FalseColour *scale,
                        const char *label, const ImageInfo *info, const char *path, Error *err)
{
    enum { SMALL = 400 }; /* below this height letters are not enlarged */
    assert(values != NULL && width > 0 && height > 0 && scale->high > scale->low);
    if (error_is_set(err))
        return false;
    Canvas canvas = { .height = height, .picture = width, .scale = scale,
                      .zoom = height < SMALL ? 1 : height / SMALL < 4 ? 2 : height / SMALL };
    canvas.width = width + legend_width(scale, label, canvas.zoom);
    canvas.pixels = array_create(3 * (size_t)canvas.width * (size_t)height, 1, "picture", err);
    if (canvas.pixels == NULL)
        return false;
    put_values(&canvas, values);
    put_legend(&canvas, label);
    const bool ok = (!scale->isolines || put_isolines(&canvas, values, err)) &&
                    png_write_pixels(canvas.pixels, canvas.width, height, NAN, info, path, err);
    array_free(canvas.pixels);
    return ok;
}
