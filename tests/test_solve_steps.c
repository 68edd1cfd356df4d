/* SPDX-License-Identifier: BSD-3-Clause */
/* Solvers step by step, from other starts, with any number of bands and threads: against solutions
 * that were chosen first and the light then made to fit. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/solve.h"

enum { NEIGHBOURS = 6 };

/* Numbers of bands that are worked on in ways of their own. */
static const unsigned BAND_COUNTS[] = { 1, 2, 5, 8 };
enum { BAND_KINDS = sizeof BAND_COUNTS / sizeof *BAND_COUNTS };

/* A closed ring of patches that see those up to NEIGHBOURS away on either side, areas 1 and 2. */
typedef struct {
    Links        links;
    double      *emission, *reflectance, *exact;
    SolveProblem problem;
} Case;

static void ring(Links *links, uint32_t count)
{
    Error err = { 0 };
    const uint32_t row = 2 * NEIGHBOURS;
    *links = (Links){ .count = count };
    links->first = array_create(count + 1, sizeof *links->first, "test", &err);
    links->source = array_create((size_t)count * row, sizeof *links->source, "test", &err);
    links->form_factor = array_create((size_t)count * row, sizeof(float), "test", &err);
    links->escape = array_create(count, sizeof *links->escape, "test", &err);
    links->area = array_create(count, sizeof *links->area, "test", &err);
    assert_false(error_is_set(&err));
    for (uint32_t i = 0; i < count; i++) {
        /* Exchange 1 / 16 with each: A_i F_ij = A_j F_ji exactly, rows sum to 3/4 or 3/8. */
        links->area[i] = 1 + i % 2;
        links->escape[i] = (float)(1 - row / 16.0 / links->area[i]);
        links->first[i + 1] = (uint64_t)(i + 1) * row;
        uint32_t *source = &links->source[(size_t)i * row];
        for (uint32_t k = 0; k < row; k++) {
            const uint32_t step = k < NEIGHBOURS ? k + 1 : count - (k - NEIGHBOURS + 1);
            source[k] = (i + step) % count;
            links->form_factor[(size_t)i * row + k] = (float)(1 / 16.0 / links->area[i]);
        }
        for (uint32_t k = 1; k < row; k++) /* rising */
            for (uint32_t at = k; at > 0 && source[at - 1] > source[at]; at--) {
                const uint32_t swap = source[at];
                source[at] = source[at - 1];
                source[at - 1] = swap;
            }
    }
    assert_true(links_check(links));
}

/* Radiosities from 1 to 2 and what each patch must emit for them: rows sum to at most 3/4, so that
 * is never below 1 - 3/4 rho 2 > 0 for rho < 2/3. */
static void case_create(Case *c, uint32_t count, unsigned bands)
{
    Error err = { 0 };
    const size_t n = (size_t)count * bands;
    ring(&c->links, count);
    c->emission = array_create(n, sizeof(double), "test", &err);
    c->reflectance = array_create(n, sizeof(double), "test", &err);
    c->exact = array_create(n, sizeof(double), "test", &err);
    assert_false(error_is_set(&err));
    for (size_t k = 0; k < n; k++) {
        c->exact[k] = 1 + (double)(k * 7919 % 1009) / 1009;
        c->reflectance[k] = 0.65 * (double)(k * 104729 % 997) / 997;
    }
    for (size_t k = 0; k < n; k++) {
        const uint32_t i = (uint32_t)(k / bands);
        double received = 0;
        for (uint64_t l = c->links.first[i]; l < c->links.first[i + 1]; l++)
            received += (double)c->links.form_factor[l] *
                        c->exact[(size_t)c->links.source[l] * bands + k % bands];
        c->emission[k] = c->exact[k] - c->reflectance[k] * received;
        assert_true(c->emission[k] > 0);
    }
    c->problem = (SolveProblem){ .bands = bands, .emission = c->emission,
                                 .reflectance = c->reflectance };
}

static void case_clear(Case *c)
{
    array_free(c->links.first);
    array_free(c->links.source);
    array_free(c->links.form_factor);
    array_free(c->links.escape);
    array_free(c->links.area);
    array_free(c->emission);
    array_free(c->reflectance);
    array_free(c->exact);
    assert_int_equal(array_live(), 0);
}

/* sum A |B - exact| / sum A E of the worst band. */
static double true_error(const Case *c, const double *radiosity)
{
    double worst = 0;
    for (unsigned b = 0; b < c->problem.bands; b++) {
        double off = 0, power = 0;
        for (uint32_t i = 0; i < c->links.count; i++) {
            const size_t at = (size_t)i * c->problem.bands + b;
            off += c->links.area[i] * fabs(radiosity[at] - c->exact[at]);
            power += c->links.area[i] * c->emission[at];
        }
        worst = fmax(worst, off / power);
    }
    return worst;
}

static const SolveOptions WAYS[] = {
    { .solver = SOLVER_JACOBI },
    { .solver = SOLVER_GAUSS_SEIDEL },
    { .solver = SOLVER_SOR },
    { .solver = SOLVER_SOR, .relaxation = 1.2 },
    { .solver = SOLVER_PROGRESSIVE },
    { .solver = SOLVER_PROGRESSIVE, .no_ambient = true },
    { .solver = SOLVER_PROGRESSIVE, .overshoot = true },
    { .solver = SOLVER_CONJUGATE_GRADIENTS },
    { .solver = SOLVER_GMRES },
    { .solver = SOLVER_TWO_LEVEL },
};
enum { WAYS_COUNT = sizeof WAYS / sizeof *WAYS };

typedef struct {
    const Case *c;
    uint32_t    steps;
    double      before; /* seconds */
} Watch;

/* Rounding of sums over some 1000 patches: 1e-13 of the power, far below what steps leave. */
static const double SUM_ROUNDING = 1e-13;

/* The bound is one, at every step, and what is told of the step is true. */
static void watch_step(void *user, const SolveStep *step)
{
    Watch *w = user;
    const double error = true_error(w->c, step->radiosity);
    assert_true(isfinite(step->error_bound));
    assert_true(error <= step->error_bound + SUM_ROUNDING);
    assert_true(step->residual <= step->error_bound);
    assert_true(step->seconds >= w->before && step->passes >= 0);
    w->before = step->seconds;
    w->steps++;
}

static void bound_at_each_step(unsigned bands, double tolerance)
{
    Case c;
    case_create(&c, 1000, bands);
    for (int k = 0; k < WAYS_COUNT; k++) {
        Error err = { 0 };
        Watch watch = { .c = &c };
        SolveOptions o = WAYS[k];
        o.tolerance = tolerance;
        o.trace = watch_step;
        o.trace_user = &watch;
        Solution *s = solve(&c.links, &c.problem, &o, NULL, &err);
        assert_non_null(s);
        assert_true(s->converged);
        assert_true(watch.steps > 1);
        assert_true(true_error(&c, s->radiosity) <= s->error_bound + SUM_ROUNDING);
        assert_true(s->error_bound < 10 * tolerance);
        /* Nobody watching changes nothing. */
        o.trace = NULL;
        Solution *alone = solve(&c.links, &c.problem, &o, NULL, &err);
        assert_memory_equal(s->radiosity, alone->radiosity,
                            sizeof(double) * bands * c.links.count);
        assert_true(isnan(alone->error_bound));
        solution_destroy(s);
        solution_destroy(alone);
    }
    case_clear(&c);
}

/* The coarse tolerance is one that single precision reaches. */
static void test_bound_at_each_step(void **state)
{
    (void)state;
    for (int k = 0; k < BAND_KINDS; k++)
        bound_at_each_step(BAND_COUNTS[k], k == 1 ? 1e-3 : 1e-10);
}

/* Rows of 3/4 at most and rho < 0.65: q < 1/2 for patches of area 1, whose columns sum to 3/4. */
static void test_bound_is_sharp(void **state)
{
    (void)state;
    Case c;
    case_create(&c, 200, 5);
    for (size_t k = 0; k < 200 * 5; k++)
        c.reflectance[k] = 0.5;
    Error err = { 0 };
    const SolveOptions o = { .bound = true, .max_iterations = 1 };
    Solution *s = solve(&c.links, &c.problem, &o, NULL, &err);
    assert_non_null(s);
    assert_true(fabs(s->error_bound * (1 - 0.5 * 0.75) - s->residual) < 1e-12);
    solution_destroy(s);
    case_clear(&c);
}

/* From the exact solution nothing is left to do; from one that is too bright or too dark all
 * solvers come to the same. */
static void starts(unsigned bands)
{
    Case c;
    case_create(&c, 1000, bands);
    const size_t n = (size_t)bands * c.links.count;
    Error err = { 0 };
    double *start = array_create(n, sizeof *start, "test", &err);
    for (int k = 0; k < WAYS_COUNT; k++)
        for (int way = 0; way < 3; way++) {
            for (size_t i = 0; i < n; i++)
                start[i] = c.exact[i] * (way == 0 ? 1 : way == 1 ? 1.5 : 0.5 + (double)(i % 2));
            SolveOptions o = WAYS[k];
            o.tolerance = 1e-11;
            o.bound = true;
            o.start = start;
            Solution *s = solve(&c.links, &c.problem, &o, NULL, &err);
            assert_non_null(s);
            assert_true(s->converged);
            assert_true(true_error(&c, s->radiosity) <= s->error_bound + SUM_ROUNDING);
            if (way == 0)
                assert_true(s->iterations <= 1);
            solution_destroy(s);
        }
    array_free(start);
    case_clear(&c);
}

static void test_starts(void **state)
{
    (void)state;
    for (int k = 0; k < BAND_KINDS; k++)
        starts(BAND_COUNTS[k]);
}

/* Long enough for the parallel sums: the same bits for 1 and 3 threads. */
static void test_threads(void **state)
{
    (void)state;
    Case c;
    case_create(&c, 20000, 5);
    for (int k = 0; k < WAYS_COUNT; k++) {
        Error err = { 0 };
        SolveOptions o = WAYS[k];
        if (o.solver == SOLVER_PROGRESSIVE)
            o.max_iterations = 20000;
        o.tolerance = 1e-5;
        o.threads = 1;
        Solution *one = solve(&c.links, &c.problem, &o, NULL, &err);
        o.threads = 3;
        Solution *three = solve(&c.links, &c.problem, &o, NULL, &err);
        assert_non_null(one);
        assert_non_null(three);
        const size_t size = sizeof(double) * 5 * c.links.count;
        assert_memory_equal(one->radiosity, three->radiosity, size);
        assert_memory_equal(one->irradiance, three->irradiance, size);
        assert_int_equal(one->iterations, three->iterations);
        solution_destroy(one);
        solution_destroy(three);
    }
    case_clear(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bound_at_each_step),
        cmocka_unit_test(test_bound_is_sharp),
        cmocka_unit_test(test_starts),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
