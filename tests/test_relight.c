/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting against closed forms: furnaces, and two surfaces of an enclosure with each alight. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/relight.h"

/* Surface 1 within surface 2: F12 = 1, F21 = A1 / A2 = 1/4, F22 = 3/4: exact as floats. */
static uint64_t first[] = { 0, 1, 3 };
static uint32_t source[] = { 1, 0, 1 };
static float    factor[] = { 1, 0.25f, 0.75f }, escape[] = { 0, 0 };
static double   area[] = { 1, 4 };
static const Links LINKS = { .count = 2, .first = first, .source = source, .form_factor = factor,
                             .escape = escape, .area = area };

/* B1 = e1 + r1 B2, B2 = e2 + r2 (B1 / 4 + 3 B2 / 4), by hand. */
static void exact(const double e[2], const double r[2], double b[2])
{
    b[1] = (e[1] + r[1] * e[0] / 4) / (1 - r[1] * (r[0] + 3) / 4);
    b[0] = e[0] + r[0] * b[1];
}

/* Residuals of 1e-12 of a power below 10, over 1 - rho >= 0.1. */
static const double WITHIN = 1e-9;

static const Solver SOLVERS[] = { SOLVER_GAUSS_SEIDEL, SOLVER_PROGRESSIVE,
                                  SOLVER_CONJUGATE_GRADIENTS, SOLVER_GMRES, SOLVER_TWO_LEVEL };

static void test_changes(void **state)
{
    (void)state;
    static const struct {
        double e[2], r[2];
    } lights[] = {
        { { 1, 0 }, { 0.5, 0.3 } }, { { 0.2, 0 }, { 0.5, 0.3 } }, { { 0, 1 }, { 0.5, 0.3 } },
        { { 0, 1 }, { 0.1, 0.9 } }, { { 0, 0 }, { 0.1, 0.9 } },   { { 2, 3 }, { 0, 0.9 } },
    };
    const size_t solvers = sizeof SOLVERS / sizeof *SOLVERS;
    for (size_t s = 0; s < solvers; s++) {
        Solution *now = NULL;
        Error err = { 0 };
        const SolveOptions o = { .solver = SOLVERS[s], .tolerance = 1e-12 };
        for (size_t k = 0; k < sizeof lights / sizeof *lights; k++) {
            const SolveProblem p = { .bands = 1, .emission = lights[k].e,
                                     .reflectance = lights[k].r };
            Solution *next = now == NULL ? solve(&LINKS, &p, &o, NULL, &err)
                                         : relight(&LINKS, &p, now, NULL, &o, NULL, &err);
            double b[2];
            assert_non_null(next);
            exact(lights[k].e, lights[k].r, b);
            for (int i = 0; i < 2; i++)
                assert_true(fabs(next->radiosity[i] - b[i]) < WITHIN);
            solution_destroy(now);
            now = next;
        }
        solution_destroy(now);
    }
    assert_int_equal(array_live(), 0);
}

enum { GROUPS = 11, BANDS = 3 };

/* Eleven groups of three bands, more than go into a pass: any mix is the solution of the mix. */
static void test_groups(void **state)
{
    (void)state;
    double emission[GROUPS][2 * BANDS] = { { 0 } }, received[2 * BANDS] = { 0 };
    double rho[2 * BANDS], dimmer[GROUPS * BANDS], total[2 * BANDS] = { 0 };
    double from_outside[2 * BANDS] = { 0 };
    LightGroup group[GROUPS];
    Error err = { 0 };
    for (int k = 0; k < GROUPS; k++) {
        group[k] = (LightGroup){ .emission = emission[k] };
        for (int b = 0; b < BANDS; b++) {
            emission[k][k % 2 * BANDS + b] = 1 + k + b;
            dimmer[k * BANDS + b] = k == 3 ? 0 : 0.1 * k + 0.3 * b;
            total[k % 2 * BANDS + b] += dimmer[k * BANDS + b] * emission[k][k % 2 * BANDS + b];
        }
    }
    /* The last one is a lamp outside: irradiance, no emission. */
    for (int b = 0; b < BANDS; b++) {
        rho[b] = 0.2 + 0.1 * b;
        rho[BANDS + b] = 0.8 - 0.2 * b;
        received[b] = 2;
        total[b] -= dimmer[(GROUPS - 1) * BANDS + b] * emission[GROUPS - 1][b];
        from_outside[b] = 2 * dimmer[(GROUPS - 1) * BANDS + b];
    }
    group[GROUPS - 1] = (LightGroup){ .received = received };
    const SolveOptions o = { .tolerance = 1e-12 };
    LightGroups *groups = light_groups_solve(&LINKS, BANDS, rho, group, GROUPS, &o, NULL, &err);
    assert_non_null(groups);
    assert_true(groups->converged);
    double radiosity[2 * BANDS], irradiance[2 * BANDS];
    Solution mixed = { .count = 2, .bands = BANDS, .radiosity = radiosity,
                       .irradiance = irradiance };
    light_groups_mix(groups, dimmer, 2, &mixed);
    for (int b = 0; b < BANDS; b++) {
        const double r[2] = { rho[b], rho[BANDS + b] };
        const double e[2] = { total[b] + r[0] * from_outside[b], total[BANDS + b] };
        double exact_b[2];
        exact(e, r, exact_b);
        for (int i = 0; i < 2; i++)
            assert_true(fabs(radiosity[i * BANDS + b] - exact_b[i]) < GROUPS * WITHIN);
        /* What arrives, reflected, and what is emitted make what leaves. */
        assert_true(fabs(radiosity[BANDS + b] - total[BANDS + b] -
                         r[1] * irradiance[BANDS + b]) < GROUPS * WITHIN);
    }
    light_groups_destroy(groups);
    assert_int_equal(array_live(), 0);
}

/* The bound after a change of paint is that of the new paint: q is the larger of the columns of
 * A rho F over A, r2 / 4 * 4 / 1 for surface 1 and (r1 + 3 r2) / 4 for surface 2. From rows of what
 * has changed alone, for one surface, the other, both and neither. */
static void test_bound(void **state)
{
    (void)state;
    static const double paints[][2] = { { 0.5, 0.3 }, { 0.9, 0.3 }, { 0.9, 0.6 }, { 0.1, 0.2 },
                                        { 0.1, 0.2 } };
    const double e[2] = { 1, 2 };
    Error err = { 0 };
    const SolveOptions o = { .solver = SOLVER_TWO_LEVEL, .tolerance = 1e-4, .bound = true };
    Solution *now = NULL;
    for (size_t k = 0; k < sizeof paints / sizeof *paints; k++) {
        const double *r = paints[k];
        const SolveProblem p = { .bands = 1, .emission = e, .reflectance = r };
        Solution *next = now == NULL ? solve(&LINKS, &p, &o, NULL, &err)
                                     : relight(&LINKS, &p, now, NULL, &o, NULL, &err);
        assert_non_null(next);
        assert_true(next->converged && next->residual <= 1e-4);
        const double q = fmax(r[1], (r[0] + 3 * r[1]) / 4);
        assert_true(fabs(next->error_bound * (1 - q) - next->residual) < 1e-15);
        double b[2];
        exact(e, r, b);
        const double error = fabs(next->radiosity[0] - b[0]) +
                             4 * fabs(next->radiosity[1] - b[1]);
        assert_true(error / (e[0] + 4 * e[1]) <= next->error_bound);
        solution_destroy(now);
        now = next;
    }
    /* Groups dimmed: the paint is as before, so is q. */
    const LightGroup group = { .emission = e };
    const double *r = paints[4], q = fmax(r[1], (r[0] + 3 * r[1]) / 4), half = 0.5;
    LightGroups *groups = light_groups_solve(&LINKS, 1, r, &group, 1, &(SolveOptions){
        .tolerance = 1e-3 }, NULL, &err);
    assert_non_null(groups);
    light_groups_mix(groups, &half, 1, now);
    assert_true(fabs(now->error_bound * (1 - q) - now->residual) < 1e-15);
    light_groups_destroy(groups);
    solution_destroy(now);
    assert_int_equal(array_live(), 0);
}

static bool stop_now(void *user)
{
    (void)user;
    return true;
}

static void test_edges(void **state)
{
    (void)state;
    const double rho[2] = { 0.5, 0.9 }, e[2] = { 1, 0 };
    const LightGroup group = { .emission = e };
    const Monitor monitor = { .stop = stop_now };
    const SolveOptions o = { .tolerance = 1e-9 };
    Error err = { 0 };
    assert_null(light_groups_solve(&LINKS, 1, rho, &group, 1, &o, &monitor, &err));
    assert_int_equal(err.code, ERROR_STOPPED);
    /* No group: darkness. */
    err = (Error){ 0 };
    LightGroups *none = light_groups_solve(&LINKS, 1, rho, NULL, 0, &o, NULL, &err);
    assert_non_null(none);
    double b[2] = { 7, 7 }, h[2] = { 7, 7 };
    Solution dark = { .count = 2, .bands = 1, .radiosity = b, .irradiance = h };
    light_groups_mix(none, (double[]){ 0 }, 1, &dark);
    assert_true(b[0] == 0 && b[1] == 0 && h[0] == 0 && h[1] == 0 && dark.converged);
    light_groups_destroy(none);
    for (long n = 0; n < 50; n++) {
        array_fail_after(n);
        LightGroups *g = light_groups_solve(&LINKS, 1, rho, &group, 1, &o, NULL, &err);
        array_fail_after(-1);
        if (g != NULL) {
            light_groups_destroy(g);
            break;
        }
        assert_int_equal(err.code, ERROR_MEMORY);
        err = (Error){ 0 };
        assert_int_equal(array_live(), 0);
        assert_true(n < 49);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changes),
        cmocka_unit_test(test_groups), cmocka_unit_test(test_bound),
        cmocka_unit_test(test_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
