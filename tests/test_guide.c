/* SPDX-License-Identifier: BSD-3-Clause */
/* Guided samples keep every mean and go where the light is; Fresnel's reflectance. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "math/sampling.h"
#include "render/guide.h"
#include "math/fresnel.h"

enum { COUNT = 1 << 14 };

typedef double Cells[GUIDE_SIDE][GUIDE_SIDE];

static void fill(Cells light, int kind)
{
    for (int y = 0; y < GUIDE_SIDE; y++)
        for (int x = 0; x < GUIDE_SIDE; x++)
            light[y][x] = kind == 0 ? 1 : kind == 1 ? x == 3 && y == 12 : (double)(x * x + 7 * y);
}

/* Mean of worth * f over guided points is the integral of f over the square: 1, 1/4, 1/9 for
 * 1, x y, x^2 y^2. A scrambled net of N points misjudges an area with a sharp rim by about N^-3/4,
 * 7e-4 for 2^14, and points weigh up to 4. */
static void guided_means_are_plain_means(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        Cells light;
        Guide guide;
        fill(light, kind);
        assert_true(guide_init(&guide, (const double(*)[GUIDE_SIDE])light));
        double one = 0, xy = 0, xxyy = 0;
        for (uint32_t i = 0; i < COUNT; i++) {
            float u[2];
            sampling_sobol2(i, 5, u);
            const double w = guide_map(&guide, u) / COUNT;
            assert_true(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
            assert_true(w > 0 && w * COUNT < 1 / GUIDE_PLAIN * 1.001);
            one += w;
            xy += w * u[0] * u[1];
            xxyy += w * u[0] * u[0] * u[1] * u[1];
        }
        assert_true(fabs(one - 1) < 3e-3);
        assert_true(fabs(xy - 0.25) < 3e-3);
        assert_true(fabs(xxyy - 1.0 / 9) < 3e-3);
    }
}

/* Even light: points stay where they were. One bright cell: what the blur leaves there, a quarter
 * of its light, and the plain share, are drawn there: 3/4 * 1/4 + 1/4 * 1/256. */
static void guided_points_go_to_the_light(void **state)
{
    (void)state;
    Cells light;
    Guide guide;
    fill(light, 0);
    assert_true(guide_init(&guide, (const double(*)[GUIDE_SIDE])light));
    float u[2] = { 0.3125F, 0.71F };
    assert_true(fabs(guide_map(&guide, u) - 1) < 1e-5);
    assert_true(fabs(u[0] - 0.3125) < 1e-5 && fabs(u[1] - 0.71) < 1e-5);
    fill(light, 1);
    assert_true(guide_init(&guide, (const double(*)[GUIDE_SIDE])light));
    int inside = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        sampling_sobol2(i, 6, u);
        guide_map(&guide, u);
        inside += (int)(u[0] * GUIDE_SIDE) == 12 && (int)(u[1] * GUIDE_SIDE) == 3;
    }
    assert_true(fabs(inside / (double)COUNT - (0.75 * 0.25 + 0.25 / 256)) < 2e-3);
    light[12][3] = 0;
    assert_false(guide_init(&guide, (const double(*)[GUIDE_SIDE])light));
}

/* Straight on ((n-1)/(n+1))^2; at Brewster's angle half of the s part, ((n^2-1)/(n^2+1))^2 / 2; all
 * beyond the critical angle; none without a change of index. */
static void fresnel_known_angles(void **state)
{
    (void)state;
    const double n = 1.5, brewster = 1 / sqrt(1 + n * n);
    assert_true(fabs(fresnel(1, n) - 0.04) < 1e-12);
    assert_true(fabs(fresnel(1, 1 / n) - 0.04) < 1e-12);
    assert_true(fabs(fresnel(brewster, n) - pow((n * n - 1) / (n * n + 1), 2) / 2) <
                1e-12);
    assert_true(fresnel(0.5, 1 / n) == 1); /* 60 degrees, critical angle 41.8 */
    assert_true(fabs(fresnel(1e-9, n) - 1) < 1e-6);
    assert_true(fresnel(0.3, 1) < 1e-30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(guided_means_are_plain_means),
        cmocka_unit_test(guided_points_go_to_the_light),
        cmocka_unit_test(fresnel_known_angles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
