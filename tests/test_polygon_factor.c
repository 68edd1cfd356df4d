/* SPDX-License-Identifier: BSD-3-Clause */
/* Exact form factors between polygons: closed forms of the literature, sums over parts, cutting. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "math/polygon_factor.h"

/* Ten digits are what the closed forms keep after their own cancellation. */
static const double CLOSE = 1e-10;

static FlatPolygon rectangle(Vec3 o, Vec3 u, Vec3 v)
{
    return (FlatPolygon){ .count = 4, .corner = { o, vec3_add(o, u),
                                                  vec3_add(vec3_add(o, u), v), vec3_add(o, v) } };
}

/* Opposite equal rectangles a x b at distance c (Howell's catalogue C-11). */
static double opposite(double a, double b, double c)
{
    const double x = a / c, y = b / c, x1 = 1 + x * x, y1 = 1 + y * y;
    return 2 / (M_PI * x * y) *
           (0.5 * log(x1 * y1 / (x1 + y * y)) + x * sqrt(y1) * atan(x / sqrt(y1)) +
            y * sqrt(x1) * atan(y / sqrt(x1)) - x * atan(x) - y * atan(y));
}

/* Rectangles at a right angle with a common edge l: from w x l to h x l (C-14). */
static double perpendicular(double w, double h, double l)
{
    const double x = h / l, y = w / l, x2 = x * x, y2 = y * y, z2 = x2 + y2;
    const double a = (1 + x2) * (1 + y2) / (1 + z2);
    const double b = y2 * (1 + z2) / ((1 + y2) * z2), c = x2 * (1 + z2) / ((1 + x2) * z2);
    return (y * atan(1 / y) + x * atan(1 / x) - sqrt(z2) * atan(1 / sqrt(z2)) +
            0.25 * (log(a) + y2 * log(b) + x2 * log(c))) / (M_PI * y);
}

static void opposite_rectangles(void **state)
{
    (void)state;
    static const double cases[][3] = { { 1, 1, 1 }, { 2, 1, 1 }, { 1, 1, 0.01 }, { 1, 1, 100 },
                                       { 10, 0.1, 1 }, { 3, 4, 0.2 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double a = cases[i][0], b = cases[i][1], c = cases[i][2];
        const FlatPolygon p = rectangle(vec3(0, 0, 0), vec3(a, 0, 0), vec3(0, b, 0));
        const FlatPolygon q = rectangle(vec3(0, 0, c), vec3(0, b, 0), vec3(a, 0, 0));
        assert_float_equal(polygon_factor_area(&p, &q) / (a * b), opposite(a, b, c), CLOSE);
        assert_float_equal(polygon_factor_area(&q, &p) / (a * b), opposite(a, b, c), CLOSE);
    }
}

static void rectangles_with_a_common_edge(void **state)
{
    (void)state;
    static const double cases[][3] = { { 1, 1, 1 }, { 2, 1, 1 }, { 0.01, 1, 1 }, { 1, 100, 1 },
                                       { 1, 1, 0.05 }, { 1, 1, 50 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double w = cases[i][0], h = cases[i][1], l = cases[i][2];
        const FlatPolygon p = rectangle(vec3(0, 0, 0), vec3(w, 0, 0), vec3(0, l, 0));
        const FlatPolygon q = rectangle(vec3(0, 0, 0), vec3(0, l, 0), vec3(0, 0, h));
        assert_float_equal(polygon_factor_area(&p, &q) / (w * l), perpendicular(w, h, l), CLOSE);
    }
}

/* A wall that goes through the plane of the floor counts from the floor up. */
static void what_lies_behind_is_cut_away(void **state)
{
    (void)state;
    const FlatPolygon p = rectangle(vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0));
    const FlatPolygon q = rectangle(vec3(0, 0, -3), vec3(0, 1, 0), vec3(0, 0, 4));
    assert_float_equal(polygon_factor_area(&p, &q), perpendicular(1, 1, 1), CLOSE);
    const FlatPolygon below = rectangle(vec3(0, 0, -1), vec3(0, 1, 0), vec3(1, 0, 0));
    assert_float_equal(polygon_factor_area(&p, &below), 0, 0);
    const FlatPolygon same = rectangle(vec3(2, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0));
    assert_float_equal(polygon_factor_area(&p, &same), 0, 0);
}

/* An L is worth its two parts, and a slanted triangle pair the same after any turn and scale. */
static void parts_add_up(void **state)
{
    (void)state;
    const FlatPolygon whole = { .count = 6, .corner = { { 0, 0, 0 }, { 2, 0, 0 }, { 2, 1, 0 },
                                                        { 1, 1, 0 }, { 1, 2, 0 }, { 0, 2, 0 } } };
    const FlatPolygon one = rectangle(vec3(0, 0, 0), vec3(2, 0, 0), vec3(0, 1, 0));
    const FlatPolygon two = rectangle(vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 1, 0));
    const FlatPolygon roof = { .count = 3, .corner = { { 0.3, 0.2, 1 }, { 1.7, 2.2, 1.4 },
                                                       { 2.5, -0.4, -0.5 } } };
    const double parts = polygon_factor_area(&one, &roof) + polygon_factor_area(&two, &roof);
    assert_true(parts > 0.01);
    assert_float_equal(polygon_factor_area(&whole, &roof), parts, CLOSE);
    assert_float_equal(polygon_factor_area(&roof, &whole), parts, CLOSE);
}

/* Six faces of a box see all of each other: rows sum to 1. */
static void a_closed_box_sums_to_one(void **state)
{
    (void)state;
    const Vec3 x = vec3(3, 0, 0), y = vec3(0, 0.5, 0), z = vec3(0, 0, 7), o = vec3(0, 0, 0);
    const FlatPolygon face[6] = { rectangle(o, x, y), rectangle(z, y, x), rectangle(o, y, z),
                                  rectangle(x, z, y), rectangle(o, z, x), rectangle(y, x, z) };
    for (int i = 0; i < 6; i++) {
        Vec3 n;
        double sum = 0;
        for (int k = 0; k < 6; k++)
            sum += k == i ? 0 : polygon_factor_area(&face[i], &face[k]);
        assert_float_equal(sum / flat_polygon_area(&face[i], &n), 1, CLOSE);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opposite_rectangles),
        cmocka_unit_test(rectangles_with_a_common_edge),
        cmocka_unit_test(what_lies_behind_is_cut_away),
        cmocka_unit_test(parts_add_up),
        cmocka_unit_test(a_closed_box_sums_to_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
