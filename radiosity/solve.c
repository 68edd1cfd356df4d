/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/solve.c -- checks the problem, runs the solver asked for, measures what it reached. */
#include "radiosity/solve.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/contraction.h"
#include "radiosity/internal.h"
#include "radiosity/solve_internal.h"

/* Rows a thread takes at a time: some 10^5 links, large beside the cost of handing out a chunk. */
static const uint32_t ROW_CHUNK = 256;

/* The balance of energy is off by about the residual, and asked for to 1e-6. */
static const double DEFAULT_TOLERANCE = 1e-6;

/* Iterations without any gain after which an iteration is taken to have reached its floor. */
static const uint32_t STALL_ITERATIONS = 64;

static const char *const SOLVER_NAMES[SOLVER_COUNT] = { "gauss-seidel", "jacobi", "progressive",
                                                        "sor", "cg", "gmres",
                                                        "hierarchical", "two-level" };

const char *solver_name(Solver solver)
{
    assert((unsigned)solver < SOLVER_COUNT);
    return SOLVER_NAMES[solver];
}

bool solver_from_name(const char *name, Solver *solver)
{
    assert(name != NULL && solver != NULL);
    for (unsigned k = 0; k < SOLVER_COUNT; k++)
        if (strcmp(name, SOLVER_NAMES[k]) == 0) {
            *solver = (Solver)k;
            return true;
        }
    return false;
}

/* --- one application of the operator ---------------------------------------------------------- */

/* Bands first .. first + n - 1 of a row, n <= GATHERED being known where it is called, so that the
 * sums stay in registers. */
enum { GATHERED = 4 };

static inline void gather_bands(const LinksRow *row, const double *radiosity, unsigned bands,
                                unsigned first, unsigned n, double *out)
{
    double sum[GATHERED] = { 0 };
    const double *at = radiosity + first;
    for (uint64_t k = 0; k < row->count; k++) {
        const double *from = &at[(size_t)row->source[k] * bands];
        const double f = row->form_factor[k];
        for (unsigned b = 0; b < n; b++)
            sum[b] += f * from[b];
    }
    for (unsigned b = 0; b < n; b++)
        out[first + b] = sum[b];
}

/* The row is read anew for each four bands, but lies near by then. */
static void gather_row(const LinksRow *row, const double *radiosity, unsigned bands, double *out)
{
    unsigned b = 0;
    for (; b + GATHERED <= bands; b += GATHERED)
        gather_bands(row, radiosity, bands, b, GATHERED, out);
    switch (bands - b) {
    case 1: gather_bands(row, radiosity, bands, b, 1, out); break;
    case 2: gather_bands(row, radiosity, bands, b, 2, out); break;
    case 3: gather_bands(row, radiosity, bands, b, 3, out); break;
    default: break;
    }
}

void solve_gather_row(const SolveSystem *system, const double *radiosity, uint32_t patch,
                      unsigned worker, double *out)
{
    const LinksRow row = links_row(system->links, patch, &system->scratch[worker]);
    const double *received = system->problem->received;
    const unsigned bands = system->bands;
    gather_row(&row, radiosity, bands, out);
    for (unsigned b = 0; b < bands && received != NULL; b++)
        out[b] += received[(size_t)patch * bands + b];
}

typedef struct {
    const SolveSystem *system;
    const double      *radiosity;
    double            *next, *irradiance;
} Application;

static void apply_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Application *a = context;
    const SolveSystem *system = a->system;
    const unsigned bands = system->bands;
    double *sum = &system->chunk_sum[(size_t)(begin / ROW_CHUNK) * bands];
    for (unsigned b = 0; b < bands; b++)
        sum[b] = 0;
    for (uint32_t i = begin; i < end; i++) {
        const size_t at = (size_t)i * bands;
        solve_gather_row(system, a->radiosity, i, worker, &a->next[at]);
        for (unsigned b = 0; b < bands; b++) {
            const double received = a->next[at + b];
            if (a->irradiance != NULL)
                a->irradiance[at + b] = received;
            a->next[at + b] = system->problem->emission[at + b] +
                              system->problem->reflectance[at + b] * received;
            sum[b] += system->links->area[i] * fabs(a->next[at + b] - a->radiosity[at + b]);
        }
    }
    links_leave(system->links, begin, end);
}

double solve_relative(const SolveSystem *system, const double *sum)
{
    double worst = 0;
    for (unsigned b = 0; b < system->bands; b++)
        if (system->power[b] > 0)
            worst = fmax(worst, sum[b] / system->power[b]);
    return worst;
}

double solve_share(const SolveSystem *system, double power)
{
    double least = INFINITY;
    for (unsigned b = 0; b < system->bands; b++)
        if (system->power[b] > 0)
            least = fmin(least, system->power[b]);
    return isfinite(least) ? power / least : 0; /* in the dark nothing is missing */
}

double solve_apply(const SolveSystem *system, const double *radiosity, double *next,
                   double *irradiance)
{
    Application a = { system, radiosity, next, irradiance };
    const uint32_t count = system->links->count;
    parallel_for(count, ROW_CHUNK, system->threads, apply_chunk, &a, NULL, NULL);
    const size_t chunks = ((size_t)count + ROW_CHUNK - 1) / ROW_CHUNK;
    for (size_t c = 1; c < chunks; c++)
        for (unsigned b = 0; b < system->bands; b++)
            system->chunk_sum[b] += system->chunk_sum[c * system->bands + b];
    return count > 0 ? solve_relative(system, system->chunk_sum) : 0;
}

/* --- when to stop ----------------------------------------------------------------------------- */

bool solve_stalled(SolveStall *stall, double residual)
{
    if (stall->since == 0 || residual < stall->best) {
        stall->best = residual;
        stall->since = 1;
        return false;
    }
    return ++stall->since > STALL_ITERATIONS;
}

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double error_bound(const SolveSystem *system, double residual)
{
    if (residual == 0)
        return 0;
    if (system->options->solver == SOLVER_HIERARCHICAL)
        return INFINITY; /* of the links as they are, which it does not solve */
    if (system->reflected == NULL)
        return INFINITY; /* not asked for */
    const double q = system->reflected->most;
    return q < 1 ? residual / (1 - q) : INFINITY;
}

/* What solvers know of their residual while they run is an estimate for some, so it is measured
 * anew; that bounds the error of what is shown. */
static void trace_step(const SolveSystem *system, double passes, SolveShow show, void *context)
{
    const double now = clock_seconds();
    const double *radiosity = system->solution->radiosity;
    if (show != NULL) {
        show(context, system->shown);
        radiosity = system->shown;
    }
    const double residual = system->options->solver == SOLVER_HIERARCHICAL
                                ? system->solution->residual
                                : solve_apply(system, radiosity, system->after, NULL);
    const SolveStep step = { .step = system->solution->iterations,
                             .seconds = now - *system->begin, .residual = residual,
                             .unshot = system->solution->unshot, .passes = passes,
                             .error_bound = error_bound(system, residual),
                             .radiosity = radiosity };
    system->options->trace(system->options->trace_user, &step);
    *system->begin += clock_seconds() - now;
}

bool solve_report(const SolveSystem *system, double left, double passes, SolveShow show,
                  void *context)
{
    const SolveOptions *o = system->options;
    if (o->trace != NULL && (o->trace_due == NULL || o->trace_due(o->trace_user)))
        trace_step(system, passes, show, context);
    /* Residuals fall geometrically, so progress is the share of decades that is done. */
    const double decades = log(fmax(system->tolerance, DBL_MIN));
    const double done = left > 0 && left < 1 ? log(left) / decades : left > 0 ? 0 : 1;
    const Progress progress = { .stage = "solve", .done = fmin(fmax(done, 0), 1),
                                .energy_left = fmin(left, 1) };
    monitor_progress(system->monitor, &progress);
    return monitor_stop(system->monitor);
}

/* --- the problem ------------------------------------------------------------------------------ */

static bool check_problem(const Links *links, const SolveProblem *problem, Error *err)
{
    const unsigned bands = problem->bands;
    for (size_t k = 0; k < (size_t)links->count * bands; k++) {
        const double rho = problem->reflectance[k], e = problem->emission[k];
        const double h = problem->received != NULL ? problem->received[k] : 0;
        if (!(rho >= 0 && rho < 1))
            return error_set(err, ERROR_INPUT, "reflectance %g of patch %zu is not in [0, 1)", rho,
                             k / bands);
        if (!(e >= 0 && isfinite(e) && h >= 0 && isfinite(h)))
            return error_set(err, ERROR_INPUT, "patch %zu: emission %g or irradiance %g from "
                             "outside is negative or not finite", k / bands, e, h);
    }
    return true;
}

/* A band without power has no residual that would tell: what it starts with must be right. */
static bool set_start(SolveSystem *system, Error *err)
{
    const size_t values = (size_t)system->links->count * system->bands;
    if (system->options->start == NULL)
        return true;
    system->start = array_create(values, sizeof *system->start, "a solution to start from", err);
    for (size_t k = 0; system->start != NULL && k < values; k++)
        if (system->power[k % system->bands] > 0)
            system->start[k] = system->options->start[k];
    return system->start != NULL;
}

static bool set_bound(SolveSystem *system, Error *err)
{
    const size_t values = (size_t)system->links->count * system->bands;
    const SolveOptions *o = system->options;
    if (o->trace != NULL) {
        system->shown = array_create(values, sizeof *system->shown, "a trace", err);
        system->after = array_create(values, sizeof *system->after, "a trace", err);
    }
    if (((o->trace != NULL && o->trace_due == NULL) || o->bound) && !error_is_set(err))
        system->reflected = reflected_create(system->links, system->bands,
                                             system->problem->reflectance, o->reflected,
                                             system->threads, err);
    return !error_is_set(err);
}

void solve_start(const SolveSystem *system, const double *otherwise, double *radiosity)
{
    const double *start = system->start != NULL ? system->start : otherwise;
    memcpy(radiosity, start, (size_t)system->links->count * system->bands * sizeof *radiosity);
}

static void system_clear(SolveSystem *system)
{
    array_free(system->source);
    array_free(system->power);
    array_free(system->chunk_sum);
    for (unsigned k = 0; k < system->threads && system->scratch != NULL; k++)
        links_scratch_clear(&system->scratch[k]);
    array_free(system->scratch);
    array_free(system->start);
    array_free(system->shown);
    array_free(system->after);
    reflected_destroy(system->reflected);
}

static bool system_init(SolveSystem *system, const Links *links, const SolveProblem *problem,
                        const SolveOptions *options, const Monitor *monitor, Error *err)
{
    const size_t bands = problem->bands, count = links->count;
    *system = (SolveSystem){
        .links = links, .problem = problem, .monitor = monitor, .bands = problem->bands,
        .threads = parallel_threads(options->threads), .options = options,
        .tolerance = options->tolerance > 0 ? options->tolerance : DEFAULT_TOLERANCE,
        .max_iterations = options->max_iterations > 0 ? options->max_iterations : UINT32_MAX,
    };
    if (!check_problem(links, problem, err))
        return false;
    system->source = array_create(count * bands, sizeof *system->source, "the system", err);
    system->power = array_create(bands, sizeof *system->power, "the system", err);
    system->chunk_sum = array_create((count / ROW_CHUNK + 1) * bands, sizeof *system->chunk_sum,
                                     "the system", err);
    system->scratch = array_create(system->threads, sizeof *system->scratch, "the system", err);
    for (unsigned k = 0; k < system->threads && !error_is_set(err); k++)
        links_scratch_create(links, &system->scratch[k], err);
    if (error_is_set(err))
        return false;
    for (size_t k = 0; k < count * bands; k++) {
        const double received = problem->received != NULL ? problem->received[k] : 0;
        system->source[k] = problem->emission[k] + problem->reflectance[k] * received;
        system->power[k % bands] += links->area[k / bands] * system->source[k];
    }
    return true;
}

static Solution *solution_create(uint32_t count, unsigned bands, Error *err)
{
    Solution *solution = array_create(1, sizeof *solution, "a solution", err);
    if (solution == NULL)
        return NULL;
    solution->count = count;
    solution->bands = bands;
    solution->radiosity = array_create((size_t)count * bands, sizeof(double), "radiosity", err);
    solution->irradiance = array_create((size_t)count * bands, sizeof(double), "irradiance", err);
    return error_is_set(err) ? solution_destroy(solution) : solution;
}

Solution *solution_destroy(Solution *solution)
{
    if (solution == NULL)
        return NULL;
    array_free(solution->radiosity);
    array_free(solution->irradiance);
    array_free(solution->direct);
    reflected_destroy(solution->reflected);
    return array_free(solution);
}

static bool run(const SolveSystem *system, const SolveOptions *options, Solution *solution,
                Error *err)
{
    switch (options->solver) {
    case SOLVER_JACOBI:
        return solve_jacobi(system, solution, err);
    case SOLVER_GAUSS_SEIDEL:
        return solve_gauss_seidel(system, solution, err);
    case SOLVER_PROGRESSIVE:
        return solve_progressive(system, solution, err);
    case SOLVER_SOR:
        return solve_sor(system, options->relaxation, solution, err);
    case SOLVER_CONJUGATE_GRADIENTS:
        return solve_conjugate_gradients(system, solution, err);
    case SOLVER_GMRES:
        return solve_gmres(system, solution, err);
    case SOLVER_HIERARCHICAL:
        solution->drift = INFINITY;
        return solve_hierarchical(system, solution, err);
    case SOLVER_TWO_LEVEL:
        return solve_two_level(system, solution, err);
    case SOLVER_COUNT:
        break;
    }
    assert(!"a solver that exists");
    return false;
}

/* Steps along directions may end a little below what a patch sends out by itself. Returns the power
 * by which patches had to be lifted, of the band with the most. */
static double keep_emission(const SolveSystem *system, Solution *solution)
{
    const unsigned bands = solution->bands;
    double *lifted = system->chunk_sum, most = 0;
    memset(lifted, 0, bands * sizeof *lifted);
    for (size_t k = 0; k < (size_t)solution->count * bands; k++)
        if (solution->radiosity[k] < system->problem->emission[k]) {
            const double missing = system->problem->emission[k] - solution->radiosity[k];
            lifted[k % bands] += system->links->area[k / bands] * missing;
            solution->radiosity[k] = system->problem->emission[k];
        }
    for (unsigned b = 0; b < bands; b++)
        most = fmax(most, lifted[b]);
    return most;
}

/* Leaves residual and irradiance of the radiosity it ends with. */
static bool measures_itself(Solver solver)
{
    return solver == SOLVER_CONJUGATE_GRADIENTS || solver == SOLVER_GMRES ||
           solver == SOLVER_HIERARCHICAL || solver == SOLVER_TWO_LEVEL;
}

/* What patches were lifted by misses from their radiosity and, sent out, from all irradiance.
 * Whether that stays within the tolerance. */
static bool take_lift(const SolveSystem *system, double lifted, Solution *solution)
{
    if (!system->options->bound || system->options->solver != SOLVER_TWO_LEVEL)
        return false;
    const double arriving = system->reflected->plain * lifted;
    const double residual = solution->residual + solve_share(system, lifted + arriving);
    if (!(residual <= system->tolerance))
        return false;
    solution->residual = residual;
    solution->drift += arriving;
    return true;
}

/* The same measure for all, taken from the result itself. */
static void measure(SolveSystem *system, Solution *solution)
{
    const double lifted = keep_emission(system, solution);
    if (!measures_itself(system->options->solver) ||
        (lifted > 0 && !take_lift(system, lifted, solution))) {
        /* source is not needed any more */
        solution->residual = solve_apply(system, solution->radiosity, system->source,
                                         solution->irradiance);
        solution->drift = 0;
    }
    solution->converged = solution->residual <= system->tolerance;
    solution->error_bound = system->reflected != NULL
                                ? error_bound(system, solution->residual) : NAN;
    solution->reflected = system->reflected;
    system->reflected = NULL;
}

Solution *solve(const Links *links, const SolveProblem *problem, const SolveOptions *options,
                const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(links != NULL && problem != NULL && options != NULL);
    assert(problem->bands > 0 && problem->emission != NULL && problem->reflectance != NULL);
    double begin = clock_seconds();
    SolveSystem system;
    Solution *solution = NULL;
    if (system_init(&system, links, problem, options, monitor, err) &&
        set_start(&system, err) && set_bound(&system, err))
        system.solution = solution = solution_create(links->count, problem->bands, err);
    system.begin = &begin;
    if (solution != NULL && run(&system, options, solution, err))
        measure(&system, solution);
    else
        solution = solution_destroy(solution);
    system_clear(&system);
    if (solution != NULL)
        solution->seconds = clock_seconds() - begin;
    return solution;
}

void solution_energy(const Solution *solution, const Links *links, const SolveProblem *problem,
                     unsigned band, double light_flux, double light_escaped, Energy *energy)
{
    assert(solution->count == links->count && band < solution->bands);
    assert(solution->bands == problem->bands);
    *energy = (Energy){ .emitted = light_flux, .escaped = light_escaped };
    for (uint32_t i = 0; i < links->count; i++) {
        const size_t at = (size_t)i * problem->bands + band;
        const double area = links->area[i];
        energy->emitted += area * problem->emission[at];
        energy->absorbed += area * (1 - problem->reflectance[at]) * solution->irradiance[at];
        energy->escaped += area * links->escape[i] * solution->radiosity[at];
    }
    if (energy->emitted > 0)
        energy->error =
            fabs(energy->emitted - energy->absorbed - energy->escaped) / energy->emitted;
}
