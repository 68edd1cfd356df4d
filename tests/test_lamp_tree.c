/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of lamps: chances add up, none is lost, and sums of light come out as by hand. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>

#include "render/lamp_tree.h"

enum { LAMPS = 1000, PLACES = 50 };

static double next(uint32_t *state)
{
    *state = *state * 1664525 + 1013904223;
    return *state / 4294967296.0;
}

static Vec3 direction(uint32_t *state)
{
    const double z = 2 * next(state) - 1, turn = 2 * M_PI * next(state), r = sqrt(1 - z * z);
    return vec3(r * cos(turn), r * sin(turn), z);
}

/* Small lamps all over a cube: facets that face all ways, and some that shine all around; or, as
 * under a ceiling, all facing down, among which far ones are chosen by strength alone. */
static void make_lamps(TreeLamp *lamp, uint32_t count, bool ceiling, LampTree *tree)
{
    uint32_t state = 1;
    Error    err = { 0 };
    for (uint32_t i = 0; i < count; i++) {
        lamp[i] = (TreeLamp){ .centre = vec3(next(&state), next(&state), next(&state)),
                              .radius = 0.01 * next(&state), .axis = direction(&state),
                              .around = i % 10 == 0, .strength = next(&state) };
        if (ceiling)
            lamp[i] = (TreeLamp){ .centre = vec3(lamp[i].centre.x, lamp[i].centre.y, 1),
                                  .radius = lamp[i].radius, .axis = vec3(0, 0, -1),
                                  .strength = lamp[i].strength };
    }
    assert_true(lamp_tree_init(tree, lamp, count, &err));
}

/* What a lamp sends to a place, taken as a point: exact for what the tree is asked for here. */
static double light_of(const TreeLamp *lamp, Vec3 point, Vec3 normal)
{
    const Vec3   d = vec3_sub(lamp->centre, point);
    const double square = vec3_dot(d, d), length = sqrt(square);
    const double lit = vec3_dot(d, normal) / length;
    const double shine = lamp->around ? 1 : -vec3_dot(d, lamp->axis) / length;
    return lit > 0 && shine > 0 ? lamp->strength * lit * shine / square : 0;
}

/* Every lamp that lights the place has a chance; all chances together are at most 1, less by
 * what loose bounds lead astray. */
static void expect_none_lost(bool ceiling)
{
    TreeLamp lamp[LAMPS];
    LampTree tree;
    uint32_t state = 7;
    make_lamps(lamp, LAMPS, ceiling, &tree);
    for (int i = 0; i < PLACES; i++) {
        const Vec3 p = vec3(next(&state), next(&state), next(&state)), n = direction(&state);
        double     sum = 0;
        for (uint32_t k = 0; k < LAMPS; k++) {
            const double chance = lamp_tree_chance(&tree, p, n, k);
            assert_true(chance > 0 || light_of(&lamp[k], p, n) == 0);
            sum += chance;
        }
        assert_true(sum <= 1 + LAMPS * DBL_EPSILON);
    }
    lamp_tree_clear(&tree);
}

static void no_lamp_is_lost(void **unused)
{
    (void)unused;
    expect_none_lost(false);
    expect_none_lost(true);
}

/* The sum of all lamps' light is the mean of what the chosen ones give over their chances; each
 * chance is the one that is told when asked for the lamp. */
static void expect_sums(bool ceiling)
{
    enum { SAMPLES = 4096 };
    TreeLamp lamp[LAMPS];
    LampTree tree;
    uint32_t state = 3;
    make_lamps(lamp, LAMPS, ceiling, &tree);
    for (int i = 0; i < PLACES; i++) {
        const Vec3 p = vec3(3 * next(&state) - 1, next(&state), next(&state));
        const Vec3 n = direction(&state);
        double     exact = 0, sum = 0, square = 0;
        for (uint32_t k = 0; k < LAMPS; k++)
            exact += light_of(&lamp[k], p, n);
        for (int s = 0; s < SAMPLES; s++) {
            double         x = next(&state), chance;
            const uint32_t k = lamp_tree_choose(&tree, p, n, &x, &chance);
            assert_true(x >= 0 && x < 1);
            if (k == LAMP_TREE_NONE)
                continue;
            assert_true(chance > 0);
            const double told = lamp_tree_chance(&tree, p, n, k);
            /* The same factors in another order: two roundings for each of at most 100. */
            assert_true(fabs(told - chance) <= 200 * DBL_EPSILON * chance);
            const double value = light_of(&lamp[k], p, n) / chance;
            sum += value;
            square += value * value;
        }
        const double mean = sum / SAMPLES;
        const double error = sqrt(fmax(square / SAMPLES - mean * mean, 0) / SAMPLES);
        assert_true(fabs(mean - exact) <= 5 * error + 1e-9 * exact); /* 5 sigma: 1 in 10^6 */
    }
    lamp_tree_clear(&tree);
}

static void sums_of_light(void **unused)
{
    (void)unused;
    expect_sums(false);
    expect_sums(true);
}

/* Two far equal lamps side by side are chosen alike; one that faces away never. */
static void plain_cases(void **unused)
{
    (void)unused;
    TreeLamp lamp[3] = { { .centre = vec3(-1, 0, 100), .axis = vec3(0, 0, -1), .strength = 2 },
                         { .centre = vec3(1, 0, 100), .axis = vec3(0, 0, -1), .strength = 2 },
                         { .centre = vec3(0, 0, 100), .axis = vec3(0, 0, 1), .strength = 9 } };
    LampTree tree;
    Error    err = { 0 };
    const Vec3 up = vec3(0, 0, 1), here = vec3(0, 0, 0);
    assert_true(lamp_tree_init(&tree, lamp, 2, &err));
    assert_true(fabs(lamp_tree_chance(&tree, here, up, 0) - 0.5) < 4 * DBL_EPSILON);
    assert_true(fabs(lamp_tree_chance(&tree, here, up, 1) - 0.5) < 4 * DBL_EPSILON);
    assert_true(lamp_tree_chance(&tree, here, vec3(0, 0, -1), 0) == 0);
    double x = 0.5, chance;
    assert_int_equal(lamp_tree_choose(&tree, here, vec3(0, 0, -1), &x, &chance), LAMP_TREE_NONE);
    lamp_tree_clear(&tree);
    assert_true(lamp_tree_init(&tree, lamp, 3, &err));
    assert_true(lamp_tree_chance(&tree, here, up, 2) == 0);
    lamp_tree_clear(&tree);
    assert_true(lamp_tree_init(&tree, lamp, 1, &err));
    assert_true(lamp_tree_chance(&tree, here, up, 0) == 1);
    lamp_tree_clear(&tree);
}

/* All at one place, and in a row of sizes that double: no cut helps, yet the tree is made. */
static void odd_heaps(void **unused)
{
    (void)unused;
    TreeLamp lamp[LAMPS];
    LampTree tree;
    Error    err = { 0 };
    for (int kind = 0; kind < 2; kind++) {
        for (int i = 0; i < LAMPS; i++)
            lamp[i] = (TreeLamp){ .centre = vec3(kind == 0 ? 1 : ldexp(1, i - 500), 0, 0),
                                  .around = true, .strength = 1 };
        assert_true(lamp_tree_init(&tree, lamp, LAMPS, &err));
        for (uint32_t k = 0; k < LAMPS && kind == 0; k++)
            assert_true(lamp_tree_chance(&tree, vec3(0, 0, 0), vec3(1, 0, 0), k) > 0);
        lamp_tree_clear(&tree);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_lamp_is_lost),
        cmocka_unit_test(sums_of_light),
        cmocka_unit_test(plain_cases),
        cmocka_unit_test(odd_heaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
