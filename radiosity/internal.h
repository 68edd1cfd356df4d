/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/internal.h -- what the files of this folder share; this folder only. */
#ifndef RADIOSITY_INTERNAL_H
#define RADIOSITY_INTERNAL_H

#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/solve.h"

/* --- solvers ---------------------------------------------------------------------------------- */

/* A problem made ready: what all solvers read. */
typedef struct {
    const Links        *links;
    const SolveProblem *problem;
    const Monitor      *monitor;
    unsigned            bands, threads;
    double              tolerance;
    uint32_t            max_iterations; /* UINT32_MAX: no limit */
    double             *source;         /* [count * bands]  E + rho H0 */
    double             *power;          /* [bands]  sum of A (E + rho H0) */
    double             *chunk_sum;      /* [chunks * bands]  scratch of solve_apply */
} SolveSystem;

/* next = E + rho (H0 + F radiosity) in parallel; `irradiance` gets H0 + F radiosity unless NULL.
 * Returns the residual of `radiosity`. */
double solve_apply(const SolveSystem *system, const double *radiosity, double *next,
                   double *irradiance);

/* H0 + F radiosity of one patch into out[bands]. */
void solve_gather_row(const SolveSystem *system, const double *radiosity, uint32_t patch,
                      double *out);

/* max over bands of sum[b] / power[b]; a band without power has nothing to miss. */
double solve_relative(const SolveSystem *system, const double *sum);

/* Tells when an iteration no longer gains: rounding sets a floor that no tolerance can undercut. */
typedef struct {
    double   best;
    uint32_t since;
} SolveStall;
bool solve_stalled(SolveStall *stall, double residual);

/* Tells how much light is still missing; true when the caller wants to stop. */
bool solve_report(const SolveSystem *system, double left);

/* Each leaves radiosity, iterations and unshot in *solution. */
bool solve_jacobi(const SolveSystem *system, Solution *solution, Error *err);
bool solve_gauss_seidel(const SolveSystem *system, Solution *solution, Error *err);
bool solve_progressive(const SolveSystem *system, bool ambient, Solution *solution, Error *err);

/* --- links ------------------------------------------------------------------------------------ */

/* The links by source: column j of F. */
typedef struct {
    uint64_t *first;        /* [count + 1] */
    uint32_t *receiver;     /* [first[count]]  rising within a column */
    float    *form_factor;  /* [first[count]]  from receiver to the column's source */
} LinkColumns;

bool link_columns_create(const Links *links, LinkColumns *columns, Error *err);
void link_columns_clear(LinkColumns *columns);

/* Rows without content: first, escape and area are zero; room for `nonzeros` links. */
Links *links_allocate(uint32_t count, uint64_t nonzeros, Error *err);

#endif
