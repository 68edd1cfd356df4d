/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_sweeps.c -- solvers that go through all rows again and again: Jacobi, whose
 * iterates are the orders of reflection, and Gauss-Seidel, which uses each new value at once. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/internal.h"

/* Starts at E: the source less what comes from outside, as the literature's iterates do
 * [cohen93]. */
static void start_at_emission(const SolveSystem *system, double *radiosity)
{
    const size_t values = (size_t)system->links->count * system->bands;
    memcpy(radiosity, system->problem->emission, values * sizeof *radiosity);
}

bool solve_jacobi(const SolveSystem *system, Solution *solution, Error *err)
{
    const size_t values = (size_t)solution->count * solution->bands;
    double *next = array_create(values, sizeof *next, "radiosity of the next sweep", err);
    if (next == NULL)
        return false;
    start_at_emission(system, solution->radiosity);
    SolveStall stall = { 0 };
    for (;;) {
        const double residual = solve_apply(system, solution->radiosity, next, NULL);
        solution->unshot = fmin(residual, 1);
        if (residual <= system->tolerance || solution->iterations >= system->max_iterations ||
            solve_report(system, residual) || solve_stalled(&stall, residual))
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
static void find_diagonal(const Links *links, float *diagonal)
{
    for (uint32_t i = 0; i < links->count; i++)
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            if (links->source[k] == i)
                diagonal[i] = links->form_factor[k];
}

/* One pass over all rows in order, each solved for its own value; moved: sum of A |change|. */
static void sweep(const SolveSystem *system, const float *diagonal, double *radiosity,
                  double *received, double *moved)
{
    const SolveProblem *problem = system->problem;
    const unsigned bands = system->bands;
    for (unsigned b = 0; b < bands; b++)
        moved[b] = 0;
    for (uint32_t i = 0; i < system->links->count; i++) {
        solve_gather_row(system, radiosity, i, received);
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            const double rho = problem->reflectance[at];
            const double missing = problem->emission[at] + rho * received[b] - radiosity[at];
            const double step = missing / (1 - rho * diagonal[i]);
            radiosity[at] += step;
            moved[b] += system->links->area[i] * fabs(step);
        }
    }
}

bool solve_gauss_seidel(const SolveSystem *system, Solution *solution, Error *err)
{
    const size_t values = (size_t)solution->count * solution->bands;
    float *diagonal = array_create(solution->count, sizeof *diagonal, "the diagonal", err);
    double *row = array_create(2 * (size_t)solution->bands, sizeof *row, "a row", err);
    double *next = array_create(values, sizeof *next, "radiosity to compare with", err);
    const bool made = !error_is_set(err);
    SolveStall stall = { 0 };
    if (made) {
        find_diagonal(system->links, diagonal);
        start_at_emission(system, solution->radiosity);
        solution->unshot = 1;
    }
    while (made && solution->iterations < system->max_iterations) {
        sweep(system, diagonal, solution->radiosity, row, row + solution->bands);
        solution->iterations++;
        /* What a sweep moved bounds the residual it leaves only roughly: look before stopping. */
        double left = solve_relative(system, row + solution->bands);
        if (left <= system->tolerance || solution->iterations >= system->max_iterations)
            left = solve_apply(system, solution->radiosity, next, NULL);
        solution->unshot = fmin(left, 1);
        if (left <= system->tolerance || solve_report(system, left) || solve_stalled(&stall, left))
            break;
    }
    array_free(diagonal);
    array_free(row);
    array_free(next);
    return made;
}
