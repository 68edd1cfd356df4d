/* SPDX-License-Identifier: BSD-3-Clause */
/* Weights of a polygon's corners: known values, and linear functions reproduced. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "math/mean_value.h"
#include "math/tolerance.h"

static const uint32_t corners[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
static const Vec3 up = { 0, 0, 1 };
/* A dozen sums of numbers near 1, a few divisions. */
#define CLOSE rounding_bound(64)

static const Vec3 square[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
/* A rectangle with three more corners on its edges, as beside finer neighbours. */
static const Vec3 hung[7] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 2, 0.25, 0 }, { 2, 0.5, 0 },
                              { 2, 1, 0 }, { 0, 1, 0 } };

static double sum_up(const Vec3 *p, uint32_t n, const double *weight, Vec3 *at)
{
    double sum = 0;
    *at = vec3(0, 0, 0);
    for (uint32_t k = 0; k < n; k++) {
        sum += weight[k];
        *at = vec3_mad(*at, weight[k], p[k]);
    }
    return sum;
}

static void near_point(Vec3 a, Vec3 b) { assert_true(vec3_length(vec3_sub(a, b)) < 2 * CLOSE); }

static void known_weights(void **state)
{
    (void)state;
    const IndexPolygon four = { square, corners, 4 }, three = { square, corners, 3 };
    double w[4];
    mean_value_weights(&four, up, vec3(0.5, 0.5, 0), w);
    for (int k = 0; k < 4; k++)
        assert_true(fabs(w[k] - 0.25) < CLOSE);
    /* On a triangle: barycentric coordinates. */
    mean_value_weights(&three, up, vec3(0.7, 0.2, 0), w);
    assert_true(fabs(w[0] - 0.3) < CLOSE && fabs(w[1] - 0.5) < CLOSE && fabs(w[2] - 0.2) < CLOSE);
    /* The height over the plane does not count. */
    mean_value_weights(&three, up, vec3(0.7, 0.2, 3), w);
    assert_true(fabs(w[0] - 0.3) < CLOSE && fabs(w[1] - 0.5) < CLOSE && fabs(w[2] - 0.2) < CLOSE);
    /* Nearer to corner 0, on the diagonal: symmetric, and falling with distance. */
    mean_value_weights(&four, up, vec3(0.25, 0.25, 0), w);
    assert_true(fabs(w[1] - w[3]) < CLOSE && w[0] > w[1] && w[1] > w[2] && w[2] > 0);
}

static void on_edges_and_corners(void **state)
{
    (void)state;
    const IndexPolygon polygon = { hung, corners, 7 };
    double w[7];
    for (uint32_t k = 0; k < 7; k++) {
        const uint32_t next = (k + 1) % 7;
        for (int i = 0; i <= 8; i++) {
            const double along = i / 8.0;
            mean_value_weights(&polygon, up, vec3_lerp(hung[k], hung[next], along), w);
            for (uint32_t m = 0; m < 7; m++) {
                const double wanted = m == k ? 1 - along : m == next ? along : 0;
                assert_true(fabs(w[m] - wanted) < CLOSE);
            }
        }
    }
}

static void linear_functions(void **state)
{
    (void)state;
    const IndexPolygon polygon = { hung, corners, 7 };
    double w[7], before[7] = { 0 };
    for (int i = 0; i <= 40; i++)
        for (int j = 0; j <= 20; j++) {
            const Vec3 p = vec3(i / 20.0, j / 20.0, 0);
            Vec3 at;
            mean_value_weights(&polygon, up, p, w);
            assert_true(fabs(sum_up(hung, 7, w, &at) - 1) < CLOSE);
            near_point(at, p);
            for (int k = 0; k < 7; k++)
                assert_true(w[k] >= 0);
        }
    /* Continuous up to the edge: a millionth off it, weights are a millionth off those on it. */
    mean_value_weights(&polygon, up, vec3(0.3, 0, 0), before);
    mean_value_weights(&polygon, up, vec3(0.3, 1e-6, 0), w);
    for (int k = 0; k < 7; k++)
        assert_true(fabs(w[k] - before[k]) < 1e-5);
}

static void averages(void **state)
{
    (void)state;
    const Vec3 tilted[5] = { { 0, 0, 0 }, { 2, 0, 2 }, { 2, 0.5, 2 }, { 2, 1, 2 }, { 0, 1, 0 } };
    const struct {
        const Vec3 *p;
        uint32_t    n;
        Vec3        centre;
    } cases[] = { { square, 4, { 0.5, 0.5, 0 } }, { square, 3, { 2.0 / 3, 1.0 / 3, 0 } },
                  { hung, 7, { 1, 0.5, 0 } }, { tilted, 5, { 1, 0.5, 1 } } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const IndexPolygon polygon = { cases[i].p, corners, cases[i].n };
        double w[7];
        Vec3 at;
        mean_value_average(&polygon, w);
        assert_true(fabs(sum_up(cases[i].p, cases[i].n, w, &at) - 1) < CLOSE);
        near_point(at, cases[i].centre);
    }
    const IndexPolygon polygon = { hung, corners, 7 };
    near_point(polygon_area(&polygon), vec3(0, 0, 2));
}

static void without_area(void **state)
{
    (void)state;
    const Vec3 flat[3] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    const IndexPolygon polygon = { flat, corners, 3 };
    double w[3];
    Vec3 at;
    mean_value_average(&polygon, w);
    assert_true(fabs(sum_up(flat, 3, w, &at) - 1) < CLOSE);
    mean_value_weights(&polygon, vec3(0, 0, 0), vec3(2, 2, 2), w);
    assert_true(fabs(sum_up(flat, 3, w, &at) - 1) < CLOSE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_weights),    cmocka_unit_test(on_edges_and_corners),
        cmocka_unit_test(linear_functions), cmocka_unit_test(averages),
        cmocka_unit_test(without_area),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
