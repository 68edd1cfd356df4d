/* SPDX-License-Identifier: BSD-3-Clause */
/* All solvers, side by side. */
#include "app/compare_solvers.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/output.h"
#include "app/plot_svg.h"
#include "app/summary.h"
#include "base/array.h"
#include "base/file.h"
#include "radiosity/stochastic.h"

typedef struct {
    const char  *name;
    SolveOptions options;
} Way;

static const Way ways[] = {
    { "jacobi", { .solver = SOLVER_JACOBI } },
    { "gauss-seidel", { .solver = SOLVER_GAUSS_SEIDEL } },
    { "sor", { .solver = SOLVER_SOR } },
    { "progressive", { .solver = SOLVER_PROGRESSIVE, .no_ambient = true } },
    { "progressive, ambient", { .solver = SOLVER_PROGRESSIVE } },
    { "progressive, overshoot", { .solver = SOLVER_PROGRESSIVE, .no_ambient = true,
                                  .overshoot = true } },
    { "cg", { .solver = SOLVER_CONJUGATE_GRADIENTS } },
    { "gmres", { .solver = SOLVER_GMRES } },
    { "two-level", { .solver = SOLVER_TWO_LEVEL } },
    { "hierarchical", { .solver = SOLVER_HIERARCHICAL } },
    { "stochastic", { .threads = 0 } }, /* without links: the last */
};
enum { WAYS = sizeof ways / sizeof *ways, STOCHASTIC_WAY = WAYS - 1 };

/* What the others are measured against: doubles allow no better. */
static const double REFERENCE_TOLERANCE = 1e-14;

typedef struct {
    double   step, passes, seconds, residual, unshot, bound, error;
    uint64_t rays;
} Step;

/* One solver's run. */
typedef struct {
    const Pipeline *pipeline;
    const double   *exact;      /* radiosity */
    Step           *step;
    size_t          count, capacity;
    Error           error;
    Solution       *solution;
} Run;

/* sum A |B - exact| / sum A (E + rho H0), the worst band's, as the bound. */
static double find_error(const Pipeline *p, const double *exact, const double *radiosity)
{
    double off[ROOM_BANDS] = { 0 }, power[ROOM_BANDS] = { 0 }, worst = 0;
    const SolveProblem *problem = &p->problem;
    for (uint32_t i = 0; i < p->links->count; i++)
        for (int b = 0; b < ROOM_BANDS; b++) {
            const size_t at = (size_t)i * ROOM_BANDS + (size_t)b;
            const double h = problem->received != NULL ? problem->received[at] : 0;
            off[b] += p->links->area[i] * fabs(radiosity[at] - exact[at]);
            power[b] += p->links->area[i] * (problem->emission[at] + problem->reflectance[at] * h);
        }
    for (int b = 0; b < ROOM_BANDS; b++)
        worst = power[b] > 0 ? fmax(worst, off[b] / power[b]) : worst;
    return worst;
}

static void take_step(void *user, const SolveStep *step)
{
    Run *run = user;
    if (!array_reserve((void **)&run->step, &run->capacity, run->count + 1, sizeof *run->step,
                       "steps of a solver", &run->error))
        return;
    run->step[run->count++] =
        (Step){ step->step, step->passes, step->seconds, step->residual, step->unshot,
                step->error_bound, find_error(run->pipeline, run->exact, step->radiosity),
                run->pipeline->links->rays };
}

/* A round of rays. Work is rays over links, for a link costs a ray too; the power never shot stands
 * for the residual, and nothing bounds the noise. */
static void take_round(void *user, const SolveStep *step)
{
    Run *run = user;
    const Links *links = run->pipeline->links;
    take_step(run, step);
    if (run->count == 0 || error_is_set(&run->error))
        return;
    Step *last = &run->step[run->count - 1];
    last->rays = (uint64_t)(step->passes * links->count + 0.5);
    last->passes = (double)last->rays / (double)links->first[links->count];
    last->residual = step->unshot;
}

/* The last step, which solvers end with and do not tell, where there is more to say. */
static void take_end(Run *run, double passes)
{
    const Solution *s = run->solution;
    const SolveStep last = { .step = s->iterations, .seconds = s->seconds, .passes = passes,
                             .residual = s->residual, .unshot = s->unshot,
                             .error_bound = s->error_bound, .radiosity = s->radiosity };
    if (run->count == 0 || run->step[run->count - 1].step < s->iterations)
        take_step(run, &last);
}

static bool run_way(Run *run, const Way *way, Error *err)
{
    const Pipeline *p = run->pipeline;
    const Settings *settings = &p->session->settings;
    SolveOptions o = way->options;
    o.tolerance = settings->tolerance;
    o.max_iterations = settings->max_iterations;
    o.threads = settings->threads;
    o.relaxation = p->session->options.relaxation;
    o.centre = p->patches->centre;
    o.normal = p->patches->normal;
    o.trace = take_step;
    o.trace_user = run;
    run->solution = solve(p->links, &p->problem, &o, &p->session->monitor, err);
    if (run->solution == NULL)
        return false;
    const double sweeps = run->count > 0 ? run->step[run->count - 1].passes : 0;
    take_end(run, o.solver == SOLVER_PROGRESSIVE ? sweeps : run->solution->iterations);
    if (error_is_set(&run->error))
        *err = run->error;
    return !error_is_set(err) && !session_stopped(p->session);
}

/* To the noise that is asked for where nothing else is: --tolerance is that of the equations. */
static bool run_stochastic(Run *run, Error *err)
{
    const Pipeline *p = run->pipeline;
    const Settings *settings = &p->session->settings;
    const Monitor  *monitor = &p->session->monitor;
    const StochasticOptions so = { .rays = settings->rays, .seed = settings->seed,
                                   .threads = settings->threads, .trace = take_round,
                                   .trace_user = run };
    StochasticReport report;
    OpenPlaces       places = { .links = NULL };
    if (open_places_find(&p->room, settings->seed, settings->threads, &places, monitor, err))
        run->solution = stochastic_solve(&p->room, &places, &p->problem, &so, &report, monitor,
                                         err);
    open_places_clear(&places);
    if (error_is_set(&run->error))
        *err = run->error;
    return !error_is_set(err) && !session_stopped(p->session) && run->count > 0;
}

/* --- results ---------------------------------------------------------------------------------- */

static bool write_csv(const Run run[WAYS], const char *path, Error *err)
{
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    FILE *out = outfile_stream(file);
    fputs("solver,step,passes,seconds,rays,residual,unshot,error_bound,error\n", out);
    for (int w = 0; w < WAYS; w++)
        for (size_t k = 0; k < run[w].count; k++) {
            const Step *s = &run[w].step[k];
            fprintf(out, strchr(ways[w].name, ',') != NULL ? "\"%s\"" : "%s", ways[w].name);
            fprintf(out, ",%.0f,%.6g,%.6f,%" PRIu64 ",%.9g,%.9g,", s->step, s->passes, s->seconds,
                    s->rays, s->residual, s->unshot);
            if (!isnan(s->bound))
                fprintf(out, "%.9g", s->bound);
            fprintf(out, ",%.9g\n", s->error);
        }
    return outfile_commit(file, err);
}

/* One field of all steps. */
static double *pick(const Run *run, size_t offset, Error *err)
{
    double *values = array_create(run->count, sizeof *values, "a plot", err);
    for (size_t k = 0; values != NULL && k < run->count; k++)
        memcpy(&values[k], (const char *)&run->step[k] + offset, sizeof *values);
    return values;
}

enum { PANELS = 4, FIELDS = 4 };

static bool write_svg(const Run run[WAYS], const char *title, const char *path, Error *err)
{
    static const size_t fields[FIELDS] = { offsetof(Step, passes), offsetof(Step, seconds),
                                           offsetof(Step, residual), offsetof(Step, error) };
    double *value[WAYS][FIELDS] = { 0 };
    PlotCurve curve[PANELS][WAYS];
    PlotPanel panel[PANELS] = {
        { "Residual by work", "passes over all links", "missing power / power", curve[0], WAYS },
        { "Residual by time", "seconds", "missing power / power", curve[1], WAYS },
        { "True error by work", "passes over all links", "error of power / power", curve[2], WAYS },
        { "True error by time", "seconds", "error of power / power", curve[3], WAYS },
    };
    for (int w = 0; w < WAYS; w++) {
        for (int f = 0; f < FIELDS; f++)
            value[w][f] = pick(&run[w], fields[f], err);
        for (int p = 0; p < PANELS; p++)
            curve[p][w] = (PlotCurve){ ways[w].name, run[w].count, value[w][p % 2],
                                       value[w][2 + p / 2] };
    }
    OutFile *file = outfile_open(path, err);
    if (file != NULL)
        plot_svg(outfile_stream(file), title, panel, PANELS);
    for (int w = 0; w < WAYS; w++)
        for (int f = 0; f < FIELDS; f++)
            array_free(value[w][f]);
    return outfile_commit(file, err);
}

static bool write_json(const Pipeline *p, const Run run[WAYS], int exit_code, Error *err)
{
    Summary summary;
    Error none = { 0 };
    if (!summary_begin(&summary, p->session, exit_code, &none, err))
        return false;
    if (summary.file == NULL)
        return true;
    Json *json = &summary.json;
    json_open(json, "solvers", '[');
    for (int w = 0; w < WAYS; w++) {
        const Step *last = &run[w].step[run[w].count - 1];
        json_open(json, NULL, '{');
        json_text(json, "solver", ways[w].name);
        json_count(json, "iterations", run[w].solution->iterations);
        json_number(json, "passes", last->passes);
        json_number(json, "seconds", last->seconds);
        json_number(json, "residual", run[w].solution->residual);
        json_number(json, "error_bound", run[w].solution->error_bound);
        json_number(json, "error", last->error);
        json_bool(json, "converged", run[w].solution->converged);
        json_close(json, '}');
    }
    json_close(json, ']');
    summary_pipeline(json, p);
    return summary_finish(&summary, p->session, err);
}

static void say(const Pipeline *p, const Run run[WAYS])
{
    Session *session = p->session;
    session_say(session, "isolux: %s, %u patches, tolerance %.2g", session->options.scene,
                p->patches->count, session->settings.tolerance);
    session_say(session, "  %-24s%10s%9s%10s%11s%11s%11s", "solver", "steps", "passes", "seconds",
                "residual", "bound", "error");
    for (int w = 0; w < WAYS; w++) {
        const Step *last = &run[w].step[run[w].count - 1];
        session_say(session, "  %-24s%10u%9.1f%10.4f%11.2g%11.2g%11.2g%s", ways[w].name,
                    run[w].solution->iterations, last->passes, last->seconds,
                    run[w].solution->residual, run[w].solution->error_bound, last->error,
                    run[w].solution->converged || w == STOCHASTIC_WAY ? "" : "  tolerance missed");
    }
}

static bool write_all(Pipeline *p, const Run run[WAYS], const char *path, bool converged,
                      Error *err)
{
    char csv[4096], svg[4096], title[512];
    snprintf(title, sizeof title, "%s: %u patches", output_base(p->session->options.scene),
             p->patches->count);
    say(p, run);
    return output_name(path, ".csv", csv, sizeof csv, err) &&
           output_name(path, ".svg", svg, sizeof svg, err) &&
           write_csv(run, csv, err) && write_svg(run, title, svg, err) &&
           write_json(p, run, converged ? 0 : 4, err);
}

bool compare_solvers(Pipeline *p, const char *path, bool *converged, Error *err)
{
    assert(p->links != NULL && p->problem.emission != NULL);
    const SolveOptions exact = { .solver = SOLVER_GMRES, .tolerance = REFERENCE_TOLERANCE,
                                 .threads = p->session->settings.threads };
    Solution *reference = solve(p->links, &p->problem, &exact, &p->session->monitor, err);
    Run run[WAYS] = { 0 };
    bool done = reference != NULL;
    *converged = true;
    for (int w = 0; w < WAYS && done; w++) {
        run[w] = (Run){ .pipeline = p, .exact = reference->radiosity };
        done = w == STOCHASTIC_WAY ? run_stochastic(&run[w], err)
                                   : run_way(&run[w], &ways[w], err);
        /* Noise is none of the tolerance's business. */
        *converged = *converged && done && (w == STOCHASTIC_WAY || run[w].solution->converged);
    }
    if (done)
        done = write_all(p, run, path, *converged, err);
    else if (!error_is_set(err))
        error_set(err, ERROR_STOPPED, "stopped before all solvers had run; nothing was written");
    for (int w = 0; w < WAYS; w++) {
        array_free(run[w].step);
        solution_destroy(run[w].solution);
    }
    solution_destroy(reference);
    return done;
}
