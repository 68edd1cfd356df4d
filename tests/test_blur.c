/* SPDX-License-Identifier: BSD-3-Clause */
/* Motion blur of the whole program ($ISOLUX) against closed forms. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "render/image.h"

enum { WIDTH = 120, HEIGHT = 16, MOMENTS = 16 };

static const char *folder(void)
{
    const char *name = getenv("TMPDIR");
    return name != NULL ? name : "/tmp";
}

/* Renders the scene with --shutter 0,1; the layer, or NULL: R G B, of its EXR. The caller frees. */
static float *render(const char *text, const char *options, const char *layer, int size[2])
{
    char  path[2][512], command[2048];
    Error err = { 0 };
    const char *program = getenv("ISOLUX");
    if (program == NULL)
        skip(); /* run.sh names it */
    snprintf(path[0], sizeof path[0], "%s/blur.msd", folder());
    snprintf(path[1], sizeof path[1], "%s/blur.exr", folder());
    FILE *file = fopen(path[0], "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    snprintf(command, sizeof command, "'%s' render '%s' --shutter 0,1 --time-samples %d "
             "--quality draft --progress none -o '%s' %s 2>/dev/null",
             program, path[0], (int)MOMENTS, path[1], options);
    assert_int_equal(system(command), 0);
    float *values = image_read_layer(path[1], layer, &size[0], &size[1], &err);
    assert_non_null(values);
    remove(path[0]);
    remove(path[1]);
    snprintf(path[1], sizeof path[1], "%s/blur.png", folder());
    remove(path[1]);
    return values;
}

/* Share of the time that a square of half side 1 whose centre goes from -2 to 2 covers x. */
static double ramp(double x)
{
    return fmax(fmin(x + 1, 2) - fmax(x - 1, -2), 0) / 4;
}

/* A picture of 20 pixels a unit, x from -3 to 3: a step each 5 pixels, half a step above and below
 * the ramp at most, and on it in the mean over 5 pixels; but at its ends, where half of these lie
 * on the ramp and have no step yet: an eighth of a step. */
static void check_ramp(const char *text, const char *options)
{
    int    size[2];
    char   all[512];
    snprintf(all, sizeof all, "--projection orthographic --view-height 0.8 --size %dx%d %s",
             (int)WIDTH, (int)HEIGHT, options);
    float *light = render(text, all, NULL, size);
    assert_int_equal(size[0], WIDTH);
    for (int k = 0; k + 5 <= WIDTH; k++) {
        const float *row = light + 3 * (size_t)WIDTH * (HEIGHT / 2) + 3 * (size_t)k;
        const double x = (k + 0.5 - WIDTH / 2) / 20;
        double mean = 0;
        for (int i = 0; i < 5; i++)
            mean += row[3 * i + 2] / 3 / 5;
        /* Pixels that an edge goes through are known by a few samples: one in five, and half a step
         * off at most. */
        assert_true(fabs(row[2] / 3 - ramp(x)) < 0.5 / MOMENTS + 0.5 / MOMENTS);
        assert_true(fabs(mean - ramp(x + 0.1)) < 0.125 / MOMENTS + 0.5 / MOMENTS / 5);
        assert_true(fabs(row[2] - 3 * row[0]) < 1e-5 && fabs(row[1] - 2 * row[0]) < 1e-5);
    }
    array_free(light);
}

#define FEW "--patches 50 --rays 16"
#define SQUARE "PARALLEL 1 (-1, -1, 0) (1, -1, 0) (-1, 1, 0)\n"
#define REST "SURFACE 1 0 ; (0,0,0) 1 ; (0,0,0) 0, 1 EMISSIVE (1, 2, 3)\n" \
             "SURFACE 2 0 ; (0,0,0) 1 ; (0,0,0) 0, 1\n" \
             "QUADRANGLE 2 (-9, -9, -1) (9, -9, -1) (9, 9, -1) (-9, 9, -1)\n"

static void what_moves_leaves_a_ramp(void **state)
{
    static const char *const ways[] = { FEW, FEW " --spp 64", "--renderer path --spp 64",
                                        "--renderer whitted --spp 64" };
    (void)state;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        check_ramp("SCREEN <120, 16> EYEP (0, 0, 5) LOOKP (0, 0, 0) UP (0, 1, 0) FOV <20>\n" REST
                   "TRANS(4 * TIME - 2, 0, 0) " SQUARE, ways[i]);
}

static void a_moving_camera_leaves_it_too(void **state)
{
    (void)state;
    check_ramp("SCREEN <120, 16> EYEP (4 * TIME - 2, 0, 5) LOOKP (4 * TIME - 2, 0, 0) UP (0, 1, 0)"
               " FOV <20>\n" REST SQUARE, FEW);
}

/* A light that goes by: the mean of its irradiance at 16 places, I h / d^3, and of the light that
 * a floor of 1/2 sends back. */
static void a_light_that_goes_by(void **state)
{
    static const char text[] =
        "SCREEN <8, 8> EYEP (0, 0, 1) LOOKP (0, 0, 0) UP (0, 1, 0) FOV <20>\n"
        "ATT_POS_LIGHT (4, 8, 12) (6 * TIME - 1, 0, 2)\n"
        "SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1\n"
        "QUADRANGLE 1 (-9, -9, 0) (9, -9, 0) (9, 9, 0) (-9, 9, 0)\n";
    double exact = 0;
    (void)state;
    for (int k = 0; k < MOMENTS; k++) {
        const double x = 6 * (k + 0.5) / MOMENTS - 1;
        exact += 2 * pow(x * x + 4, -1.5) / MOMENTS;
    }
    for (int i = 0; i < 2; i++) {
        int    size[2];
        float *e = render(text, "--projection orthographic --view-height 1e-4 --size 8x8 " FEW,
                          i == 0 ? "irradiance" : NULL, size);
        const double share = i == 0 ? 1 : 0.5 / M_PI;
        for (int k = 0; k < 64; k++)
            assert_true(fabs(e[3 * k + 1] / (share * 8 * exact) - 1) < 1e-4);
        array_free(e);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_moves_leaves_a_ramp),
        cmocka_unit_test(a_moving_camera_leaves_it_too),
        cmocka_unit_test(a_light_that_goes_by),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
