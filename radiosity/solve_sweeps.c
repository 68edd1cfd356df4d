/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_sweeps.c -- solvers that go through all rows again and again: Jacobi, whose
 * iterates are the orders of reflection, Gauss-Seidel, which uses each new value at once, and
 * over-relaxation, which takes each step a little further. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/internal.h"
#include "radiosity/solve_internal.h"

/* Sweeps of Gauss-Seidel before over-relaxation sets in: by then the slowest part of the error
 * dominates what a sweep moves. */
enum { PLAIN_SWEEPS = 4 };

/* Both start at E: the source less what comes from outside, as the literature's iterates do
 * [cohen93]. */

bool solve_jacobi(const SolveSystem *system, Solution *solution, Error *err)
{
    const size_t values = (size_t)solution->count * solution->bands;
    double *next = array_create(values, sizeof *next, "radiosity of the next sweep", err);
    if (next == NULL)
        return false;
    solve_start(system, system->problem->emission, solution->radiosity);
    SolveStall stall = { 0 };
    for (;;) {
        const double residual = solve_apply(system, solution->radiosity, next, NULL);
        solution->unshot = fmin(residual, 1);
        if (residual <= system->tolerance || solution->iterations >= system->max_iterations ||
            solve_report(system, residual, solution->iterations, NULL, NULL) ||
            solve_stalled(&stall, residual))
            break;
        double *const old = solution->radiosity;
        solution->radiosity = next;
        next = old;
        solution->iterations++;
    }
    array_free(next);
    return true;
}

/* F_ii of every patch: curved patches may see themselves. */
static void find_diagonal(const Links *links, LinksScratch *scratch, float *diagonal)
{
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, scratch);
        for (uint64_t k = 0; k < row.count; k++)
            if (row.source[k] == i)
                diagonal[i] += row.form_factor[k];
        links_pass(links, i);
    }
}

typedef struct {
    const SolveSystem *system;
    double             relaxation; /* each step is taken this many times: 1 is Gauss-Seidel */
    float             *diagonal;   /* [count] */
    double            *received;   /* [bands] */
    double            *moved;      /* [bands]  sum of A |change| of the last sweep */
    double            *next;       /* [values]  for a true residual */
} Sweeper;

/* One pass over all rows in order, each solved for its own value. */
static void sweep(const Sweeper *s, double *radiosity)
{
    const SolveSystem *system = s->system;
    const SolveProblem *problem = system->problem;
    const unsigned bands = system->bands;
    for (unsigned b = 0; b < bands; b++)
        s->moved[b] = 0;
    for (uint32_t i = 0; i < system->links->count; i++) {
        solve_gather_row(system, radiosity, i, 0, s->received);
        links_pass(system->links, i);
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            const double rho = problem->reflectance[at];
            const double missing = problem->emission[at] + rho * s->received[b] - radiosity[at];
            const double step = s->relaxation * missing / (1 - rho * s->diagonal[i]);
            radiosity[at] += step;
            s->moved[b] += system->links->area[i] * fabs(step);
        }
    }
}

/* The best factor for what a plain sweep leaves of the error (its rate): 2 / (1 + sqrt(1 - rate))
 * [young54]. That holds for matrices ordered in a way that radiosity's is not, so it is kept below
 * what the theory for any symmetric positive system allows, 2. */
static double best_relaxation(double rate)
{
    static const double most = 1.9;
    return rate > 0 && rate < 1 ? fmin(2 / (1 + sqrt(1 - rate)), most) : 1;
}

static bool sweeper_create(Sweeper *s, const SolveSystem *system, Error *err)
{
    const uint32_t count = system->links->count;
    *s = (Sweeper){ .system = system, .relaxation = 1 };
    s->diagonal = array_create(count, sizeof *s->diagonal, "the diagonal", err);
    s->received = array_create(system->bands, sizeof *s->received, "a row", err);
    s->moved = array_create(system->bands, sizeof *s->moved, "a row", err);
    s->next = array_create((size_t)count * system->bands, sizeof *s->next,
                           "radiosity to compare with", err);
    if (!error_is_set(err))
        find_diagonal(system->links, &system->scratch[0], s->diagonal);
    return !error_is_set(err);
}

static void sweeper_clear(Sweeper *s)
{
    array_free(s->diagonal);
    array_free(s->received);
    array_free(s->moved);
    array_free(s->next);
}

/* Sweeps until little enough is missing. relaxation 0: found from the first plain sweeps. */
static void run_sweeps(Sweeper *s, double relaxation, Solution *solution)
{
    const SolveSystem *system = s->system;
    SolveStall stall = { 0 };
    double before = 0;
    solve_start(system, system->problem->emission, solution->radiosity);
    solution->unshot = 1;
    s->relaxation = relaxation > 0 ? relaxation : 1;
    while (solution->iterations < system->max_iterations) {
        sweep(s, solution->radiosity);
        solution->iterations++;
        /* What a sweep moved bounds the residual it leaves only roughly: look before stopping. */
        double left = solve_relative(system, s->moved);
        if (!(relaxation > 0) && solution->iterations == PLAIN_SWEEPS)
            s->relaxation = best_relaxation(left / before);
        before = left;
        if (left <= system->tolerance || solution->iterations >= system->max_iterations)
            left = solve_apply(system, solution->radiosity, s->next, NULL);
        solution->unshot = fmin(left, 1);
        if (left <= system->tolerance ||
            solve_report(system, left, solution->iterations, NULL, NULL) ||
            solve_stalled(&stall, left))
            break;
    }
}

static bool solve_relaxed(const SolveSystem *system, double relaxation, Solution *solution,
                          Error *err)
{
    Sweeper s;
    const bool made = sweeper_create(&s, system, err);
    if (made)
        run_sweeps(&s, relaxation, solution);
    sweeper_clear(&s);
    return made;
}

bool solve_gauss_seidel(const SolveSystem *system, Solution *solution, Error *err)
{
    return solve_relaxed(system, 1, solution, err);
}

bool solve_sor(const SolveSystem *system, double relaxation, Solution *solution, Error *err)
{
    return solve_relaxed(system, relaxation, solution, err);
}
