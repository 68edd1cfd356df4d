/* SPDX-License-Identifier: BSD-3-Clause */
/* False colours: even steps of lightness, ranges and round values, the drawn picture. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/array.h"
#include "render/false_colour.h"

/* CIE L* of sRGB bytes, relative to white: an independent measure of lightness. */
static double lightness(const uint8_t rgb[3])
{
    double linear[3];
    for (int k = 0; k < 3; k++) {
        const double v = rgb[k] / 255.0;
        linear[k] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    }
    const double y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    return y > 0.008856 ? 116 * cbrt(y) - 16 : 903.3 * y;
}

/* Twenty steps: each lighter than the last, none more than twice the mean step. */
static void scale_gets_lighter_evenly(void **state)
{
    (void)state;
    uint8_t first[3], last[3], rgb[3];
    false_colour_at(0, first);
    false_colour_at(1, last);
    const double mean = (lightness(last) - lightness(first)) / 20;
    assert_true(lightness(first) < 25 && lightness(last) > 90);
    double before = lightness(first);
    for (int k = 1; k <= 20; k++) {
        false_colour_at(k / 20.0, rgb);
        assert_true(lightness(rgb) > before && lightness(rgb) - before < 2 * mean);
        before = lightness(rgb);
    }
    false_colour_at(NAN, rgb);
    assert_memory_equal(rgb, first, 3);
    false_colour_at(7, rgb);
    assert_memory_equal(rgb, last, 3);
}

static void ranges_are_round_and_leave_outliers(void **state)
{
    (void)state;
    float values[1000];
    for (int i = 0; i < 1000; i++)
        values[i] = (float)(i + 1) * 0.83F;
    values[999] = 1e9F; /* one lamp */
    FalseColour scale = { 0 };
    false_colour_range(values, 1000, &scale);
    assert_true(scale.low == 0 && scale.high == 1000);
    values[0] = NAN;
    values[1] = INFINITY;
    values[2] = -5;
    scale.logarithmic = true;
    false_colour_range(values, 1000, &scale);
    assert_true(fabs(scale.high - 1000) < 1e-6 && scale.low <= 4.2 && scale.low >= 2);
    const float dark[2] = { 0, NAN };
    false_colour_range(dark, 2, &scale);
    assert_true(scale.low == 0.1 && scale.high == 1);
}

static void legend_values_are_round(void **state)
{
    (void)state;
    static const struct {
        FalseColour scale;
        int         count;
        double      first, second, last;
    } cases[] = {
        { { .low = 0, .high = 1000 }, 6, 0, 200, 1000 },
        { { .low = 0, .high = 15 }, 8, 0, 2, 14 },
        { { .low = 0, .high = 0.3 }, 7, 0, 0.05, 0.3 },
        { { .low = -1, .high = 1 }, 5, -1, -0.5, 1 },
        { { .low = 10, .high = 1000, .logarithmic = true }, 7, 10, 20, 1000 },
        { { .low = 0.001, .high = 1e6, .logarithmic = true }, 5, 0.001, 0.1, 1e5 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double ticks[9];
        const int n = false_colour_ticks(&cases[i].scale, 9, ticks);
        assert_int_equal(n, cases[i].count);
        assert_true(fabs(ticks[0] - cases[i].first) < 1e-9);
        assert_true(fabs(ticks[1] - cases[i].second) < 1e-9);
        assert_true(fabs(ticks[n - 1] - cases[i].last) < 1e-6 * cases[i].last + 1e-9);
    }
}

static void places_follow_the_range(void **state)
{
    (void)state;
    const FalseColour even = { .low = 100, .high = 300 };
    const FalseColour log = { .low = 1, .high = 10000, .logarithmic = true };
    assert_true(fabs(false_colour_place(&even, 150) - 0.25) < 1e-12);
    assert_true(fabs(false_colour_place(&log, 100) - 0.5) < 1e-12);
    assert_true(false_colour_place(&log, 0) < 0);
}

static const uint8_t *pixel(const uint8_t *pixels, int width, int x, int y)
{
    return pixels + 3 * ((size_t)y * (size_t)width + (size_t)x);
}

/* Runs of rows with letters right of the legend's bar, below its unit. */
static int labels(const uint8_t *pixels, int width, int height, int picture)
{
    enum { UNIT = 22, BAR = 8 + 20 }; /* rows that the unit takes; columns up to the bar's end */
    int  runs = 0;
    bool before = false;
    for (int y = UNIT; y < height; y++) {
        bool here = false;
        for (int x = picture + BAR; x < width; x++)
            here = here || pixel(pixels, width, x, y)[0] == 235;
        runs += here && !before;
        before = here;
    }
    return runs;
}

/* A ramp from left to right: its colours stand where the scale says, an isoline crosses where the
 * legend's middle value is, what is nowhere is grey, and the legend is beside it. */
static void picture_shows_values_lines_and_legend(void **state)
{
    (void)state;
    enum { W = 101, H = 60 };
    char path[] = "/tmp/false-colour-XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
    static float values[W * H];
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            values[y * W + x] = y < 4 ? NAN : (float)x;
    const FalseColour scale = { .low = 0, .high = 100, .isolines = true };
    Error err = { 0 };
    assert_true(false_colour_write(values, W, H, &scale, "lux", NULL, path, &err));
    png_image png = { .version = PNG_IMAGE_VERSION };
    assert_true(png_image_begin_read_from_file(&png, path));
    png.format = PNG_FORMAT_RGB;
    assert_true(png.width > W + 30 && png.height == H);
    uint8_t *pixels = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, pixels, 0, NULL));
    const int width = (int)png.width;
    uint8_t want[3];
    false_colour_at(0.33, want);
    for (int k = 0; k < 3; k++) /* colours come from a table of a quarter of a byte's step */
        assert_true(abs(pixel(pixels, width, 33, 40)[k] - want[k]) <= 1);
    assert_memory_equal(pixel(pixels, width, 33, 1), ((uint8_t[]){ 96, 96, 96 }), 3);
    int black = 0, white = 0;
    for (int x = 58; x <= 61; x++) /* the tick at 60 */
        black += pixel(pixels, width, x, 40)[0] == 0 && pixel(pixels, width, x, 40)[2] == 0;
    for (int y = 0; y < H; y++)
        for (int x = W; x < width; x++)
            white += pixel(pixels, width, x, y)[0] == 235;
    assert_int_equal(black, 1);
    assert_true(white > 100); /* letters */
    /* A bar of 24 rows has room for three numbers of 7 rows and gaps, not for six. */
    assert_int_equal(labels(pixels, width, H, W), 3);
    free(pixels);
    unlink(path);
    assert_false(false_colour_write(values, W, H, &scale, "lux", NULL, "/nonexistent/x.png", &err));
    assert_int_equal(err.code, ERROR_FAILED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scale_gets_lighter_evenly),
        cmocka_unit_test(ranges_are_round_and_leave_outliers),
        cmocka_unit_test(legend_values_are_round),
        cmocka_unit_test(places_follow_the_range),
        cmocka_unit_test(picture_shows_values_lines_and_legend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
