/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve_sweeps.c -- solvers that go through all rows again and again: Jacobi, whose
 * iterates are the orders of reflection, Gauss-Seidel, which uses each new value at once, and
 * over-relaxation, which takes each step a little further.
 *
 * Gauss-Seidel and over-relaxation go through the rows in blocks, which depend on their number
 * alone: rows of one block are found side by side, from what all others had before it. Neighbours
 * in the order of patches lie on one surface and hardly see each other, so little is lost. Such a
 * splitting of 1 - rho F is regular and converges like the plain one [varga62]. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
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

/* Blocks of a sweep: enough for convergence, and each long enough for several threads. With fewer
 * rows than BLOCK_LEAST in one, each row is a block of its own. */
enum { BLOCKS = 64, BLOCK_LEAST = 256, BLOCK_CHUNK = 32 };

typedef struct {
    const SolveSystem *system;
    double             relaxation; /* each step is taken this many times: 1 is Gauss-Seidel */
    uint32_t           block;      /* rows; 1: one after the other */
    uint32_t           begin;      /* first row of the block under way */
    float             *diagonal;   /* [count]  F_ii: curved patches may see themselves */
    float             *within;     /* [count]  share of a patch's view within its block */
    double            *received;   /* [block * bands] */
    double            *moved;      /* [bands]  sum of A |change| of the last sweep */
    double            *next;       /* [values]  for a true residual */
    const double      *radiosity;  /* as it is before the block */
} Sweeper;

static uint32_t block_end(const Sweeper *s, uint32_t row)
{
    const uint32_t end = row - row % s->block + s->block, count = s->system->links->count;
    return end < count ? end : count;
}

static void find_within(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Sweeper *s = context;
    const Links *links = s->system->links;
    for (uint32_t i = begin; i < end; i++) {
        const LinksRow row = links_row(links, i, &s->system->scratch[worker]);
        const uint32_t last = block_end(s, i), first = i - i % s->block;
        for (uint64_t k = 0; k < row.count; k++) {
            if (row.source[k] == i)
                s->diagonal[i] += row.form_factor[k];
            else if (row.source[k] >= first && row.source[k] < last)
                s->within[i] += row.form_factor[k];
        }
    }
    links_leave(links, begin, end);
}

static void gather_block(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Sweeper *s = context;
    for (uint32_t k = begin; k < end; k++)
        solve_gather_row(s->system, s->radiosity, s->begin + k, worker,
                         &s->received[(size_t)k * s->system->bands]);
    links_leave(s->system->links, s->begin + begin, s->begin + end);
}

/* Rows of a block, each solved for its own value. */
static void take_block(const Sweeper *s, uint32_t end, double *radiosity)
{
    const SolveProblem *problem = s->system->problem;
    const unsigned bands = s->system->bands;
    for (uint32_t i = s->begin; i < end; i++)
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)i * bands + b;
            const double rho = problem->reflectance[at];
            const double received = s->received[(size_t)(i - s->begin) * bands + b];
            const double missing = problem->emission[at] + rho * received - radiosity[at];
            const double step = s->relaxation * missing / (1 - rho * s->diagonal[i]);
            radiosity[at] += step;
            s->moved[b] += s->system->links->area[i] * fabs(step);
        }
}

/* One pass over all rows in order. */
static void sweep(Sweeper *s, double *radiosity)
{
    const SolveSystem *system = s->system;
    const uint32_t count = system->links->count;
    memset(s->moved, 0, system->bands * sizeof *s->moved);
    s->radiosity = radiosity;
    for (s->begin = 0; s->begin < count;) {
        const uint32_t end = block_end(s, s->begin);
        if (s->block > 1) {
            parallel_for(end - s->begin, BLOCK_CHUNK, system->threads, gather_block, s, NULL,
                         NULL);
        } else {
            solve_gather_row(system, radiosity, s->begin, 0, s->received);
            links_pass(system->links, s->begin);
        }
        take_block(s, end, radiosity);
        s->begin = end;
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

/* For the symmetrised system, blocks that are solved like this converge for w < 2 / (1 + c), where
 * c is the most that a patch and its block exchange: then M + M' - A of the splitting M is positive
 * [varga62]. A little less, for c by sums of rows holds only where links are reciprocal. */
static double most_relaxation(const Sweeper *s)
{
    static const double margin = 0.95;
    const unsigned bands = s->system->bands;
    double most = 0;
    for (size_t k = 0; k < (size_t)s->system->links->count * bands; k++) {
        const double rho = s->system->problem->reflectance[k], own = s->diagonal[k / bands];
        most = fmax(most, rho * s->within[k / bands] / (1 - rho * own));
    }
    return most > 0 ? margin * 2 / (1 + most) : 2;
}

static bool sweeper_create(Sweeper *s, const SolveSystem *system, Error *err)
{
    static const char what[] = "sweeps over rows";
    const uint32_t count = system->links->count, each = count / BLOCKS + 1;
    *s = (Sweeper){ .system = system, .relaxation = 1, .block = each < BLOCK_LEAST ? 1 : each };
    s->diagonal = array_create(count, sizeof *s->diagonal, what, err);
    s->within = array_create(count, sizeof *s->within, what, err);
    s->received = array_create((size_t)s->block * system->bands, sizeof *s->received, what, err);
    s->moved = array_create(system->bands, sizeof *s->moved, what, err);
    s->next = array_create((size_t)count * system->bands, sizeof *s->next, what, err);
    if (!error_is_set(err))
        parallel_for(count, BLOCK_LEAST, system->threads, find_within, s, NULL, NULL);
    return !error_is_set(err);
}

static void sweeper_clear(Sweeper *s)
{
    array_free(s->diagonal);
    array_free(s->within);
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
            s->relaxation = fmin(best_relaxation(left / before), most_relaxation(s));
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
