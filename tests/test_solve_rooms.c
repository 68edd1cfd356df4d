/* SPDX-License-Identifier: BSD-3-Clause */
/* All solvers on rooms whose factors were found by rays: against elimination, and a furnace against
 * its closed form; with one, two and eight bands. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

enum { MOST = 400, BANDS_MOST = 8, KRYLOV_STEPS_MOST = 60 };

static const unsigned BAND_COUNTS[] = { 1, 2, 8 };

/* A box with a block that stands in it. */
static Links *block_room(TestRoom *r)
{
    memset(r, 0, sizeof *r);
    const uint32_t wall = room_material(r, 0.5, 1);
    room_box(r, vec3(0, 0, 0), vec3(4, 3, 5), BOX_ALL, true, wall, "");
    room_box(r, vec3(1, 0, 1), vec3(2, 2, 3), BOX_ALL & ~BOX_Y0, false, wall, "block-");
    room_finish(r, 0.9, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_in_range(r->patches->count, 100, MOST);
    return room_links(r, 256, CLOSURE_BOTH);
}

/* (1 - rho F) B = E of one band by Gaussian elimination; pivots stay positive, for rows of rho F
 * sum to less than 1. */
static void eliminate(const Links *links, const SolveProblem *p, unsigned band, double *b)
{
    static double k[MOST][MOST];
    const uint32_t n = links->count;
    memset(k, 0, sizeof k);
    for (uint32_t i = 0; i < n; i++) {
        const size_t at = (size_t)i * p->bands + band;
        b[i] = p->emission[at];
        for (uint64_t l = links->first[i]; l < links->first[i + 1]; l++)
            k[i][links->source[l]] = -p->reflectance[at] * (double)links->form_factor[l];
        k[i][i] += 1;
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t r = i + 1; r < n; r++) {
            const double m = k[r][i] / k[i][i];
            for (uint32_t c = i; c < n && m != 0; c++)
                k[r][c] -= m * k[i][c];
            b[r] -= m * b[i];
        }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t c = i + 1; c < n; c++)
            b[i] -= k[i][c] * b[c];
        b[i] /= k[i][i];
    }
}

static SolveOptions options(const TestRoom *r, Solver solver, double tolerance)
{
    return (SolveOptions){ .solver = solver, .tolerance = tolerance, .bound = true,
                           .centre = r->patches->centre, .normal = r->patches->normal };
}

static double power(const Links *links, const SolveProblem *p, unsigned band)
{
    double sum = 0;
    for (uint32_t i = 0; i < links->count; i++)
        sum += links->area[i] * p->emission[(size_t)i * p->bands + band];
    return sum;
}

/* Nodes of a tree solve another system; all others agree with elimination to their bounds. */
static void agree(const TestRoom *r, const Links *links, const SolveProblem *p)
{
    static double exact[BANDS_MOST][MOST];
    Error err = { 0 };
    for (unsigned b = 0; b < p->bands; b++)
        eliminate(links, p, b, exact[b]);
    for (unsigned s = 0; s < SOLVER_COUNT; s++)
        for (int fine = 0; fine < 2 && s != SOLVER_HIERARCHICAL; fine++) {
            const SolveOptions o = options(r, (Solver)s, fine ? 1e-9 : 1e-3);
            Solution *solution = solve(links, p, &o, NULL, &err);
            assert_non_null(solution);
            assert_true(solution->converged && solution->residual <= o.tolerance);
            for (unsigned b = 0; b < p->bands; b++) {
                double error = 0;
                for (uint32_t i = 0; i < links->count; i++)
                    error += links->area[i] *
                             fabs(solution->radiosity[(size_t)i * p->bands + b] - exact[b][i]);
                assert_true(error <= (solution->error_bound + 1e-12) * power(links, p, b));
            }
            solution_destroy(solution);
        }
}

static void test_agreement(void **state)
{
    (void)state;
    TestRoom r;
    Links *links = block_room(&r);
    double e[MOST * BANDS_MOST], rho[MOST * BANDS_MOST];
    for (size_t c = 0; c < sizeof BAND_COUNTS / sizeof *BAND_COUNTS; c++) {
        const unsigned bands = BAND_COUNTS[c];
        for (size_t k = 0; k < (size_t)links->count * bands; k++) {
            const uint32_t surface = r.patches->surface[k / bands];
            e[k] = surface % 5 == 2 ? 1 + (double)(k % bands) : 0;
            rho[k] = 0.1 + 0.8 * (double)((surface * 7 + k % bands * 3) % 11) / 11;
        }
        const SolveProblem p = { .bands = bands, .emission = e, .reflectance = rho };
        agree(&r, links, &p);
    }
    links_destroy(links);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

/* Every patch sends out 1 and reflects 0.99: each ends at 1 / (1 - 0.99). Rows sum to 1 within
 * 1e-7 (links_close), which 1 / (1 - rho) multiplies, as it does the residual per patch; the tree
 * reaches that as well, for links of nodes fill a patch's view. */
static void test_bright_furnace(void **state)
{
    (void)state;
    TestRoom r;
    Links *links = block_room(&r);
    double e[MOST * BANDS_MOST], rho[MOST * BANDS_MOST];
    for (size_t k = 0; k < (size_t)links->count * BANDS_MOST; k++) {
        e[k] = 1;
        rho[k] = 0.99;
    }
    for (size_t c = 0; c < sizeof BAND_COUNTS / sizeof *BAND_COUNTS; c++)
        for (unsigned s = 0; s < SOLVER_COUNT; s++) {
            const SolveProblem p = { .bands = BAND_COUNTS[c], .emission = e, .reflectance = rho };
            const SolveOptions o = options(&r, (Solver)s, 1e-6);
            Error err = { 0 };
            Solution *solution = solve(links, &p, &o, NULL, &err);
            assert_non_null(solution);
            assert_true(solution->converged);
            double error = 0, area = 0;
            for (size_t k = 0; k < (size_t)links->count * p.bands; k++) {
                error += links->area[k / p.bands] * fabs(solution->radiosity[k] / 100 - 1);
                area += links->area[k / p.bands];
            }
            assert_true(error <= area * (1e-6 + 1e-7) / (1 - 0.99));
            if (s == SOLVER_CONJUGATE_GRADIENTS || s == SOLVER_GMRES || s == SOLVER_TWO_LEVEL)
                assert_in_range(solution->iterations, 1, KRYLOV_STEPS_MOST - 1);
            solution_destroy(solution);
        }
    links_destroy(links);
    room_clear(&r);
    assert_int_equal(array_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_agreement),
        cmocka_unit_test(test_bright_furnace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
