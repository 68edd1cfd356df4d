/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve.h -- from links to light: B = E + rho (H0 + F B).
 *
 * Knows no room: flat arrays in, flat arrays out, any number of bands.
 * Units    E, B exitance (lm/m2 or W/m2); H irradiance (lux or W/m2).
 * Residual the power still missing, sum A |E + rho (H0 + F B) - B| / sum A (E + rho H0), the
 *          largest over bands: the same measure in all solvers.
 * Bound    sum A |B - exact| / sum A (E + rho H0) <= residual / (1 - q), where q is the most of any
 *          patch's light that is reflected once more: max_j sum_i A_i rho_i F_ij / A_j, from the
 *          links as they are. No bound (INFINITY) where that makes 1 or more.
 * Threads  same bytes for any number.
 */
#ifndef RADIOSITY_SOLVE_H
#define RADIOSITY_SOLVE_H

#include "base/error.h"
#include "base/monitor.h"
#include "math/vec3.h"
#include "radiosity/links.h"

typedef enum {
    SOLVER_GAUSS_SEIDEL,
    SOLVER_JACOBI,
    SOLVER_PROGRESSIVE,
    SOLVER_SOR,
    SOLVER_CONJUGATE_GRADIENTS,
    SOLVER_GMRES,
    SOLVER_HIERARCHICAL,
    SOLVER_TWO_LEVEL,
    SOLVER_COUNT
} Solver;

/* What the bound on the error is made of; see above. */
typedef struct {
    size_t  values;        /* patches * bands */
    double *column;        /* [values]  sum_i A_i rho_i F_ij */
    double *reflectance;   /* [values]  rho */
    double  most;          /* q */
    double  plain;         /* the same for rho = 1 */
} Reflected;

typedef struct {
    unsigned      bands;
    const double *emission;     /* [count * bands]  E >= 0 */
    const double *reflectance;  /* [count * bands]  0 <= rho < 1 */
    const double *received;     /* [count * bands]  H0 >= 0, irradiance from outside; NULL: none */
} SolveProblem;

/* What is known after a step: an iteration, or a number of shots. */
typedef struct {
    uint32_t step;         /* iterations or shots so far */
    double   seconds;      /* since the solver began */
    double   residual;     /* of what there is now */
    double   unshot;       /* power not yet distributed, 0..1 */
    double   error_bound;  /* see above */
    double   passes;       /* work so far: links read / links there are */
    uint64_t rays;         /* cast by the solver itself; 0 where links are stored */
    const double *radiosity; /* [count * bands]  what there is now */
} SolveStep;

typedef struct {
    Solver   solver;
    double   tolerance;        /* stop when the residual is below; 0: 1e-6 */
    uint32_t max_iterations;   /* sweeps; for progressive: shots; 0: no limit */
    double   relaxation;       /* of SOR, 0 < w < 2; 0: found from the first sweeps */
    bool     no_ambient;       /* progressive, stopped early: leave the ambient estimate out */
    bool     overshoot;        /* progressive: patches shoot the light they expect back as well */
    bool     bound;            /* find the bound on the error: one more pass over the links; with
                                  a trace it is found anyway */
    const double *start;       /* [count * bands]  a radiosity near the solution; NULL: emission */
    const double *start_irradiance; /* [count * bands]  H0 + F start, where it is known: saves
                                       GMRES and the two-level solver a pass */
    double   start_drift;      /* power, of one band at most, that it may be wrong by */
    const Reflected *reflected; /* of the same links with another reflectance: saves most of what
                                   the bound costs; NULL: none */
    const Vec3   *centre, *normal; /* [count]  of patches; the hierarchical solver needs them, the
                                      two-level solver is faster with them */
    unsigned threads;
    /* called after every step, from the caller's thread; NULL: not. What it takes to know the
     * residual of each step is not counted in `seconds`. */
    void   (*trace)(void *user, const SolveStep *step);
    void    *trace_user;
    /* solvers on links: asked after every step whether its trace is wanted, as each costs a pass
     * over the links; then no bound is found for it. NULL: all are */
    bool   (*trace_due)(void *user);
} SolveOptions;

typedef struct {
    uint32_t count;
    unsigned bands;
    double  *radiosity;    /* [count * bands]  B, E included */
    double  *irradiance;   /* [count * bands]  H = H0 + F B */
    double  *direct;       /* [count * bands]  of it, H0 + F E; NULL: not known apart */
    uint32_t iterations;
    double   residual;     /* reached */
    double   unshot;       /* power not yet distributed / (emitted + received power), 0..1 */
    double   error_bound;  /* of the relative error in power; NAN: not asked for */
    double   drift;        /* power, of one band at most, that irradiance differs by from
                              H0 + F B; counted in the residual. INFINITY: not known */
    Reflected *reflected;  /* where the bound was asked for; else NULL */
    bool     converged;
    double   seconds;
} Solution;

/* Progressive refinement shoots from the patch with the greatest unshot power [cohen88], with the
 * matrix' own column, so that all solvers solve the same system; with overshooting it also shoots
 * what the ambient estimate says will come back to the patch [feda92]. Conjugate gradients rely on
 * reciprocity (closure both): what links lack of it costs fresh starts. Progressive refinement
 * stopped by max_iterations or the monitor holds the ambient estimate for what was not shot.
 * owns   the caller frees with solution_destroy.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT for values out of range. A stop by the monitor gives a
 * solution with converged false. */
Solution *solve(const Links *links, const SolveProblem *problem, const SolveOptions *options,
                const Monitor *monitor, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
Solution *solution_destroy(Solution *solution);

/* "gauss-seidel", "jacobi", "progressive", "sor", "cg", "gmres", "hierarchical",
 * "two-level". */
const char *solver_name(Solver solver);
/* The other way; false when there is no solver of that name. */
bool solver_from_name(const char *name, Solver *solver);

/* Power bookkeeping per band; the caller adds lights' flux and what of it escapes directly. */
typedef struct {
    double emitted, absorbed, escaped; /* power */
    double error;                      /* |emitted - absorbed - escaped| / emitted */
} Energy;
void solution_energy(const Solution *solution, const Links *links, const SolveProblem *problem,
                     unsigned band, double light_flux, double light_escaped, Energy *energy);

/* Values of patches carried over to vertices: out [vertex_count * bands]. At each vertex a plane is
 * laid through the values at the centres of the patches around it, near ones weighing more, at rims
 * with their neighbours; what the means over patches then lack is added once. Exact for linear
 * functions on flat grids up to the rim; never beyond the values around but for rims, where as much
 * as their range is allowed, nor below 0 where they are not. Creases, sides and material borders
 * are kept because vertices are split there. `area` [patches->count] is the visible one: patches
 * with 0 (hidden inside solids) do not count, and vertices of hidden patches alone get what lies
 * nearest, or 0.
 * fails  false and ERROR_MEMORY. */
bool vertex_radiosity(const Patches *patches, const double *area, unsigned bands,
                      const double *patch_value, double *out, Error *err);

/* The same for many values on the same patches: their planes are laid once, which is nearly all of
 * the work, and kept, some 12 bytes for each patch that a vertex looks at. patches stay the
 * caller's and outlive it; area is copied.
 * owns   the caller frees with vertex_carry_destroy. fails  NULL; ERROR_MEMORY.
 * Threads  never changes once made. */
typedef struct VertexCarry VertexCarry;
VertexCarry *vertex_carry_create(const Patches *patches, const double *area, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
VertexCarry *vertex_carry_destroy(VertexCarry *carry);
/* Whether it was made for these patches and areas; false for NULL. */
bool vertex_carry_fits(const VertexCarry *carry, const Patches *patches, const double *area);
/* As vertex_radiosity, bit for bit. */
bool vertex_carry_values(const VertexCarry *carry, unsigned bands, const double *patch_value,
                         double *out, Error *err);

#endif
