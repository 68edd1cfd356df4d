/* SPDX-License-Identifier: BSD-3-Clause */
/* Solvers against enclosures whose radiosity is known in closed form, iterate by iterate. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/solve.h"

enum { FACES_MAX = 8 };

/* Closed forms are given to 12 digits, but Links stores factors as float: 2^-24 relative each, and
 * the solution's relative error is at most (1/(1-rho)) times that; rho <= 0.9 here. */
static const double FLOAT_FACTORS = 1e-6;

typedef struct {
    Links    links;
    uint64_t first[FACES_MAX + 1];
    uint32_t source[FACES_MAX * FACES_MAX];
    float    form_factor[FACES_MAX * FACES_MAX];
    float    escape[FACES_MAX];
    double   area[FACES_MAX];
} HandMade;

static void hand_made(HandMade *h, uint32_t n, const double *factors, const double *area,
                      const double *escape)
{
    *h = (HandMade){ 0 };
    h->links = (Links){ .count = n, .first = h->first, .source = h->source,
                        .form_factor = h->form_factor, .escape = h->escape, .area = h->area };
    uint64_t filled = 0;
    for (uint32_t i = 0; i < n; i++) {
        h->area[i] = area[i];
        h->escape[i] = escape != NULL ? (float)escape[i] : 0;
        for (uint32_t j = 0; j < n; j++)
            if (factors[i * n + j] > 0) {
                h->source[filled] = j;
                h->form_factor[filled++] = (float)factors[i * n + j];
            }
        h->first[i + 1] = filled;
    }
    assert_true(links_check(&h->links));
}

static const Solver SOLVERS[] = { SOLVER_GAUSS_SEIDEL, SOLVER_JACOBI, SOLVER_PROGRESSIVE,
                                  SOLVER_SOR, SOLVER_CONJUGATE_GRADIENTS, SOLVER_GMRES,
                                  SOLVER_TWO_LEVEL };
enum { SOLVER_TOTAL = sizeof SOLVERS / sizeof *SOLVERS };

static Solution *solved(const Links *links, const SolveProblem *problem, Solver solver,
                        double tolerance)
{
    Error err = { 0 };
    Solution *s = solve(links, problem, &(SolveOptions){ .solver = solver, .tolerance = tolerance },
                        NULL, &err);
    assert_non_null(s);
    return s;
}

/* --- two surfaces ----------------------------------------------------------------------------- */

static void test_two_surfaces(void **state)
{
    (void)state;
    /* Surface 1 sees only 2; F21 = A1/A2. Two-surface enclosure algebra. */
    static const struct {
        const char *what;
        double f21, e[2], rho[2], b[2];
    } cases[] = {
        { "spheres", 0.25, { 1, 0 }, { 0.5, 0.3 }, { 1.05084745763, 0.101694915254 } },
        { "cylinders", 0.5, { 1, 0 }, { 0.5, 0.3 }, { 1.09677419355, 0.193548387097 } },
        { "plates", 1, { 1, 0 }, { 0.5, 0.3 }, { 1.17647058824, 0.352941176471 } },
        { "cone over disk", 0.4472135955, { 1, 0 }, { 0.5, 0.3 },
          { 1.08745093209, 0.174901864171 } },
        { "spheres, outer lit", 0.444444444444, { 0, 2 }, { 0.2, 0.9 },
          { 0.952380952381, 4.7619047619 } },
        { "plates, one lit", 1, { 0, 2 }, { 0.2, 0.9 }, { 0.487804878049, 2.43902439024 } },
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const double factors[4] = { 0, 1, cases[c].f21, 1 - cases[c].f21 };
        const double area[2] = { 1, 1 / cases[c].f21 };
        HandMade h;
        hand_made(&h, 2, factors, area, NULL);
        const SolveProblem p = { .bands = 1, .emission = cases[c].e, .reflectance = cases[c].rho };
        for (size_t k = 0; k < SOLVER_TOTAL; k++) {
            Solution *s = solved(&h.links, &p, SOLVERS[k], 1e-9);
            assert_true(s->converged);
            for (int i = 0; i < 2; i++) {
                const double exact = cases[c].b[i];
                assert_true(fabs(s->radiosity[i] - exact) < FLOAT_FACTORS * exact);
                const double received = (exact - cases[c].e[i]) / cases[c].rho[i];
                assert_true(fabs(s->irradiance[i] - received) < 10 * FLOAT_FACTORS * exact);
            }
            solution_destroy(s);
        }
    }
}

/* --- three surfaces, one of them the open sky ------------------------------------------------- */

static void test_triangle_channel(void **state)
{
    (void)state;
    /* A long channel with the section of a right triangle, sides 3 4 5: crossed strings give
     * F12 = (L1 + L2 - L3) / (2 L1). Side 3 is left open: its share escapes. */
    const double len[3] = { 3, 4, 5 };
    const double f12 = (3 + 4 - 5) / 6.0, f21 = f12 * 3 / 4;
    const double factors[4] = { 0, f12, f21, 0 }, escape[2] = { 1 - f12, 1 - f21 };
    const double e[2] = { 2, 0 }, rho[2] = { 0.6, 0.4 };
    HandMade h;
    hand_made(&h, 2, factors, len, escape);
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    /* Two equations by hand: B1 = 2 + 0.6 f12 B2, B2 = 0.4 f21 B1. */
    const double b1 = 2 / (1 - 0.6 * f12 * 0.4 * f21), b2 = 0.4 * f21 * b1;
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        Solution *s = solved(&h.links, &p, SOLVERS[k], 1e-9);
        assert_true(fabs(s->radiosity[0] - b1) < FLOAT_FACTORS * b1);
        assert_true(fabs(s->radiosity[1] - b2) < FLOAT_FACTORS * b1);
        Energy energy;
        solution_energy(s, &h.links, &p, 0, 0, 0, &energy);
        assert_true(fabs(energy.emitted - 6) < 1e-12);
        assert_true(energy.error < FLOAT_FACTORS);
        const double escaped = 3 * b1 * (1 - f12) + 4 * b2 * (1 - f21);
        assert_true(fabs(energy.escaped - escaped) < FLOAT_FACTORS * escaped);
        solution_destroy(s);
    }
}

/* --- the box of six faces --------------------------------------------------------------------- */

/* Faces x0 x1 y0 y1 z0 z1 of the unit cube: closed forms for opposite and adjacent squares. */
static void cube(HandMade *h)
{
    double factors[36], area[6];
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            factors[6 * i + j] = i == j ? 0 : i / 2 == j / 2 ? 0.199824895698 : 0.200043776075;
    for (int i = 0; i < 6; i++)
        area[i] = 1;
    hand_made(h, 6, factors, area, NULL);
}

typedef struct {
    Solver   solver;
    uint32_t step;
    double   b[6];
} Iterate;

static void test_iterates(void **state)
{
    (void)state;
    static const Iterate iterates[] = {
        { SOLVER_JACOBI, 1, { 0.100021888038, 0.100021888038, 0.100021888038, 0.100021888038,
                              0.0999124478492, 1.0 } },
        { SOLVER_JACOBI, 2, { 0.140017507556, 0.140017507556, 0.140017507556, 0.140017507556,
                              0.139929960196, 1.05000000958 } },
        { SOLVER_JACOBI, 5, { 0.176628088308, 0.176628088308, 0.176628088308, 0.176628088308,
                              0.176537639584, 1.08570000719 } },
        { SOLVER_JACOBI, 10, { 0.181673508528, 0.181673508528, 0.181673508528, 0.181673508528,
                               0.18158306569, 1.0907463377 } },
        { SOLVER_GAUSS_SEIDEL, 1, { 0.100021888038, 0.11001531971, 0.121030206115,
                                    0.133122630271, 0.146341612472, 1.06105051335 } },
        { SOLVER_GAUSS_SEIDEL, 3, { 0.175137378262, 0.176460899909, 0.177509849526,
                                    0.178333812488, 0.178922525265, 1.08863626601 } },
        { SOLVER_PROGRESSIVE, 1, { 0.100021888038, 0.100021888038, 0.100021888038, 0.100021888038,
                                   0.0999124478492, 1.0 } },
        { SOLVER_PROGRESSIVE, 2, { 0.100021888038, 0.11001531971, 0.110026266124, 0.110026266124,
                                   0.109916825936, 1.01000437809 } },
        { SOLVER_PROGRESSIVE, 4, { 0.123118362775, 0.121020354582, 0.122130950481, 0.133123944057,
                                   0.133026545164, 1.03311409731 } },
        { SOLVER_PROGRESSIVE, 12, { 0.172983871016, 0.172104612992, 0.172511925425, 0.171775466628,
                                    0.171457589865, 1.08257615681 } },
    };
    HandMade h;
    cube(&h);
    const double e[6] = { 0, 0, 0, 0, 0, 1 }, rho[6] = { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t c = 0; c < sizeof iterates / sizeof *iterates; c++) {
        Error err = { 0 };
        const SolveOptions o = { .solver = iterates[c].solver, .tolerance = 1e-12,
                                 .max_iterations = iterates[c].step, .no_ambient = true };
        Solution *s = solve(&h.links, &p, &o, NULL, &err);
        assert_non_null(s);
        assert_int_equal(s->iterations, iterates[c].step);
        assert_false(s->converged);
        for (int i = 0; i < 6; i++)
            assert_true(fabs(s->radiosity[i] - iterates[c].b[i]) < FLOAT_FACTORS);
        solution_destroy(s);
    }
}

static void test_cube_solution(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    const double e[6] = { 0, 0, 0, 0, 0, 1 }, rho[6] = { 0.8, 0.8, 0.8, 0.8, 0.8, 0.8 };
    const double b[6] = { 0.689681193904, 0.689681193904, 0.689681193904, 0.689681193904,
                          0.689551070738, 1.55172415364 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        const double tolerance = 1e-7;
        Solution *s = solved(&h.links, &p, SOLVERS[k], tolerance);
        assert_true(s->converged && s->residual <= tolerance);
        double error = 0, power = 0;
        for (int i = 0; i < 6; i++) {
            error += fabs(s->radiosity[i] - b[i]);
            power += e[i];
        }
        /* The bound that solve.h promises, and what float factors add (rho/(1-rho) of B). */
        assert_true(error / power <= s->residual / (1 - 0.8) + 6 * 4 * FLOAT_FACTORS);
        /* The residual itself, by hand. */
        double missing = 0;
        for (int i = 0; i < 6; i++) {
            double received = 0;
            for (uint64_t l = h.first[i]; l < h.first[i + 1]; l++)
                received += h.form_factor[l] * s->radiosity[h.source[l]];
            missing += fabs(e[i] + rho[i] * received - s->radiosity[i]);
        }
        assert_true(fabs(missing / power - s->residual) < 1e-14);
        solution_destroy(s);
    }
}

static void test_furnace(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    static const double rhos[] = { 0.1, 0.5, 0.9, 0.99 };
    for (size_t r = 0; r < 4; r++)
        for (size_t k = 0; k < SOLVER_TOTAL; k++) {
            double e[18], rho[18];
            for (int i = 0; i < 18; i++) {
                e[i] = 1 + i % 3;
                rho[i] = rhos[r];
            }
            const SolveProblem p = { .bands = 3, .emission = e, .reflectance = rho };
            Solution *s = solved(&h.links, &p, SOLVERS[k], 1e-8);
            assert_true(s->converged);
            for (int i = 0; i < 18; i++) {
                const double exact = e[i] / (1 - rhos[r]);
                /* rows of the float factors sum to 1 within 5 * 2^-25 */
                assert_true(fabs(s->radiosity[i] / exact - 1) < (1e-8 + 1.5e-7) / (1 - rhos[r]));
            }
            Energy energy;
            solution_energy(s, &h.links, &p, 2, 0, 0, &energy);
            assert_true(fabs(energy.emitted - 18) < 1e-12);
            assert_true(energy.error < (1e-8 + 1.5e-7) / (1 - rhos[r]));
            solution_destroy(s);
        }
}

static void test_received(void **state)
{
    (void)state;
    /* Uniform irradiance h from outside instead of emission: B = rho h / (1 - rho). */
    HandMade h;
    cube(&h);
    double e[6] = { 0 }, rho[6], received[6];
    for (int i = 0; i < 6; i++) {
        rho[i] = 0.5;
        received[i] = 10;
    }
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho, .received = received };
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        Solution *s = solved(&h.links, &p, SOLVERS[k], 1e-9);
        for (int i = 0; i < 6; i++) {
            assert_true(fabs(s->radiosity[i] - 10) < 10 * FLOAT_FACTORS);
            assert_true(fabs(s->irradiance[i] - 20) < 20 * FLOAT_FACTORS);
        }
        Energy energy;
        solution_energy(s, &h.links, &p, 0, 60, 0, &energy);
        assert_true(energy.error < FLOAT_FACTORS);
        solution_destroy(s);
    }
}

static void test_ambient(void **state)
{
    (void)state;
    /* With equal areas and reflectances all unshot power ends up as the ambient term says, so the
     * sum over the room is exact however early shooting stops. */
    HandMade h;
    cube(&h);
    const double e[6] = { 0, 0, 0, 0, 0, 1 }, rho[6] = { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    Error err = { 0 };
    const SolveOptions o = { .solver = SOLVER_PROGRESSIVE, .tolerance = 1e-12,
                             .max_iterations = 3 };
    Solution *s = solve(&h.links, &p, &o, NULL, &err);
    double power = 0;
    for (int i = 0; i < 6; i++)
        power += s->radiosity[i];
    assert_true(fabs(power - 1 / (1 - 0.5)) < FLOAT_FACTORS);
    /* Unshot after three shots, from the table of exact iterates. */
    assert_true(fabs(s->unshot - (0.0110050348715 + 0.121020354582 + 0.121019259701 +
                                  0.120921860807 + 0.0210094129581)) < FLOAT_FACTORS);
    solution_destroy(s);
}

/* --- the edges -------------------------------------------------------------------------------- */

static void test_dark_and_hidden(void **state)
{
    (void)state;
    /* No light at all: zero, converged. A patch without visible area and links stays dark. */
    const double factors[9] = { 0, 1, 0, 1, 0, 0, 0, 0, 0 }, area[3] = { 1, 1, 0 };
    HandMade h;
    hand_made(&h, 3, factors, area, NULL);
    const double dark[3] = { 0 }, lit[3] = { 1, 0, 0 }, rho[3] = { 0.5, 0.5, 0.5 };
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        SolveProblem p = { .bands = 1, .emission = dark, .reflectance = rho };
        Solution *s = solved(&h.links, &p, SOLVERS[k], 0);
        assert_true(s->converged && s->radiosity[0] == 0 && s->unshot == 0);
        solution_destroy(s);
        p.emission = lit;
        s = solved(&h.links, &p, SOLVERS[k], 1e-9);
        assert_true(s->converged && s->radiosity[2] == 0);
        assert_true(fabs(s->radiosity[0] - 4.0 / 3) < FLOAT_FACTORS);
        solution_destroy(s);
    }
}

static void test_refuses(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    double e[6] = { 0 }, rho[6] = { 0.5, 0.5, 1, 0.5, 0.5, 0.5 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    Error err = { 0 };
    assert_null(solve(&h.links, &p, &(SolveOptions){ 0 }, NULL, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    assert_string_equal(err.text, "reflectance 1 of patch 2 is not in [0, 1)");
    /* An Error passes through. */
    assert_null(solve(&h.links, &p, &(SolveOptions){ 0 }, NULL, &err));
    rho[2] = 0.5;
    e[3] = NAN;
    err = (Error){ 0 };
    assert_null(solve(&h.links, &p, &(SolveOptions){ 0 }, NULL, &err));
    assert_int_equal(err.code, ERROR_INPUT);
}

/* A tolerance below what rounding allows ends all the same. */
static void test_impossible_tolerance(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    const double e[6] = { 0.1, 0.2, 0.3, 0, 0, 1 }, rho[6] = { 0.7, 0.3, 0.5, 0.9, 0.1, 0.2 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        Solution *s = solved(&h.links, &p, SOLVERS[k], 1e-300);
        assert_true(s->residual < 1e-14);
        solution_destroy(s);
    }
}

static bool stop_now(void *user)
{
    int *left = user;
    return (*left)-- <= 0;
}

static void test_stop(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    const double e[6] = { 0, 0, 0, 0, 0, 1 }, rho[6] = { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        int left = 0;
        const Monitor monitor = { .user = &left, .stop = stop_now };
        Error err = { 0 };
        const SolveOptions o = { .solver = SOLVERS[k], .tolerance = 1e-9 };
        Solution *s = solve(&h.links, &p, &o, &monitor, &err);
        assert_non_null(s);
        assert_false(s->converged);
        assert_true(s->residual > 1e-9 && s->radiosity[5] >= 1);
        solution_destroy(s);
    }
}

static void test_memory(void **state)
{
    (void)state;
    HandMade h;
    cube(&h);
    const double e[6] = { 0, 0, 0, 0, 0, 1 }, rho[6] = { 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t k = 0; k < SOLVER_TOTAL; k++)
        for (long n = 0; n < 100; n++) {
            Error err = { 0 };
            array_fail_after(n);
            Solution *s = solve(&h.links, &p, &(SolveOptions){ .solver = SOLVERS[k] }, NULL, &err);
            array_fail_after(-1);
            if (s == NULL)
                assert_int_equal(err.code, ERROR_MEMORY);
            solution_destroy(s);
            assert_int_equal(array_live(), 0);
            if (s != NULL)
                break;
            assert_true(n < 99);
        }
}

static void test_names(void **state)
{
    (void)state;
    Solver solver;
    for (size_t k = 0; k < SOLVER_TOTAL; k++) {
        assert_true(solver_from_name(solver_name(SOLVERS[k]), &solver));
        assert_int_equal(solver, SOLVERS[k]);
    }
    assert_false(solver_from_name("gauss", &solver));
}

/* --- a long tube, where light needs many reflections to get from end to end ------------------- */

enum { TUBE = 120, TUBE_STEPS_MOST = 60 };

/* Rings of a closed tube that see each other the less the further apart: symmetric exchange areas
 * scaled until every row sums to the ring's area. */
static void tube_exchange(double exchange[TUBE][TUBE], double *area)
{
    for (int i = 0; i < TUBE; i++) {
        area[i] = 1 + 0.5 * (i % 3);
        for (int j = 0; j < TUBE; j++)
            exchange[i][j] = exp(-abs(i - j) / 3.0);
    }
    for (int round = 0; round < 2000; round++) {
        double sum[TUBE];
        for (int i = 0; i < TUBE; i++) {
            sum[i] = 0;
            for (int j = 0; j < TUBE; j++)
                sum[i] += exchange[i][j];
        }
        for (int i = 0; i < TUBE; i++)
            for (int j = 0; j < TUBE; j++)
                exchange[i][j] *= sqrt(area[i] / sum[i] * area[j] / sum[j]);
    }
}

/* Gaussian elimination of (1 - rho F) B = E, for comparison. */
static void eliminate(double k[TUBE][TUBE], double *b)
{
    for (int i = 0; i < TUBE; i++)
        for (int r = i + 1; r < TUBE; r++) {
            const double m = k[r][i] / k[i][i];
            for (int c = i; c < TUBE; c++)
                k[r][c] -= m * k[i][c];
            b[r] -= m * b[i];
        }
    for (int i = TUBE - 1; i >= 0; i--) {
        for (int c = i + 1; c < TUBE; c++)
            b[i] -= k[i][c] * b[c];
        b[i] /= k[i][i];
    }
}

static void test_long_dark_tube(void **state)
{
    (void)state;
    static double exchange[TUBE][TUBE], k[TUBE][TUBE];
    static uint64_t first[TUBE + 1];
    static uint32_t source[TUBE * TUBE];
    static float factor[TUBE * TUBE], escape[TUBE];
    double area[TUBE], e[TUBE] = { 0 }, rho[TUBE], exact[TUBE];
    tube_exchange(exchange, area);
    for (int i = 0; i < TUBE; i++) {
        e[i] = i == 0 ? 5 : 0;
        rho[i] = i % 7 == 3 ? 0 : 0.99;
        first[i + 1] = (uint64_t)(i + 1) * TUBE;
        exact[i] = e[i];
        for (int j = 0; j < TUBE; j++) {
            source[i * TUBE + j] = (uint32_t)j;
            factor[i * TUBE + j] = (float)(exchange[i][j] / area[i]);
            k[i][j] = (i == j) - rho[i] * (double)factor[i * TUBE + j];
        }
    }
    eliminate(k, exact);
    const Links links = { .count = TUBE, .first = first, .source = source, .form_factor = factor,
                          .escape = escape, .area = area };
    const SolveProblem p = { .bands = 1, .emission = e, .reflectance = rho };
    for (size_t s = 0; s < SOLVER_TOTAL; s++) {
        Solution *solution = solved(&links, &p, SOLVERS[s], 1e-9);
        assert_true(solution->converged);
        /* A residual of 1e-9 of the power leaves an error of at most 1/(1 - rho) times that. */
        double error = 0;
        for (int i = 0; i < TUBE; i++)
            error += area[i] * fabs(solution->radiosity[i] - exact[i]);
        assert_true(error <= 100 * 1e-9 * area[0] * e[0]);
        if (SOLVERS[s] == SOLVER_CONJUGATE_GRADIENTS || SOLVERS[s] == SOLVER_GMRES)
            assert_in_range(solution->iterations, 1, TUBE_STEPS_MOST);
        solution_destroy(solution);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_surfaces),     cmocka_unit_test(test_triangle_channel),
        cmocka_unit_test(test_iterates),         cmocka_unit_test(test_cube_solution),
        cmocka_unit_test(test_furnace),          cmocka_unit_test(test_received),
        cmocka_unit_test(test_ambient),          cmocka_unit_test(test_dark_and_hidden),
        cmocka_unit_test(test_refuses),          cmocka_unit_test(test_impossible_tolerance),
        cmocka_unit_test(test_stop),             cmocka_unit_test(test_memory),
        cmocka_unit_test(test_names),            cmocka_unit_test(test_long_dark_tube),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
