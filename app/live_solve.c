/* SPDX-License-Identifier: BSD-3-Clause */
/* The solver while somebody looks on: its steps are seen, its tolerance may change as it goes. */
#include <assert.h>
#include <math.h>

#include "app/live.h"

double live_tolerance(const Live *live)
{
    assert(live->control != NULL);
    const bool links = !live->pipeline->session->settings.stochastic;
    return links ? atomic_load(&live->control->tolerance) : atomic_load(&live->control->error);
}

double live_wish(void *user)
{
    Live *live = user;
    live->asked = live_tolerance(live);
    return live->asked;
}

/* Of those on links; the others begin anew. */
static Solver chosen_solver(const Live *live)
{
    const int chosen = atomic_load(&live->control->solver);
    const bool links = chosen != SOLVER_COUNT && chosen != SOLVER_HIERARCHICAL;
    return links ? (Solver)chosen : live->pipeline->session->settings.solver;
}

bool live_breaks(const Live *live)
{
    return fabs(live_tolerance(live) - live->asked) > 0 ||
           chosen_solver(live) != live->pipeline->session->settings.solver;
}

double live_residual(const Pipeline *pipeline)
{
    const Settings *settings = &pipeline->session->settings;
    return settings->clusters     ? pipeline->clusters.error
           : settings->stochastic ? pipeline->stochastic.error
                                  : pipeline->solution->residual;
}

/* Sweeps win about the same factor each; errors of rays fall with the root of their number. */
static double share_done(const Live *live, double left)
{
    const double tolerance = live_tolerance(live);
    if (live->report.estimated)
        return left > tolerance ? tolerance * tolerance / (left * left) : 1;
    return left > 0 && left < 1 ? fmin(1, log(left) / log(tolerance)) : 0;
}

static void on_step(void *user, const SolveStep *step)
{
    Live *live = user;
    Error err = { 0 }; /* a picture less is no reason to stop */
    const Pipeline *p = live->pipeline;
    const LiveLight light = { .radiosity = step->radiosity, .visible_area = p->links->area,
                              .shooter = PATCH_NONE };
    if (live->step == STEP_SOLVED)
        return; /* solved for once more: what is shown is better than first steps */
    live->report.unshot = step->unshot;
    live->report.residual = step->residual;
    live->report.steps = live->steps_before + step->step;
    live->report.done = share_done(live, step->residual);
    live_report(live);
    if (live_due(live))
        live_publish(live, &light, &err);
    live_step(live);
}

/* When it is to be shown, or to be waited at. */
static bool is_step_due(void *user)
{
    const Live *live = user;
    return live_due(live) || atomic_load(&live->stepping);
}

/* --- with links ------------------------------------------------------------------------------- */

static Solution *solve_from(Live *live, const Solution *before, Error *err)
{
    Pipeline *p = live->pipeline;
    const Options *options = &p->session->options;
    const Settings *settings = &p->session->settings;
    const SolveOptions so = { .solver = settings->solver, .tolerance = live->asked,
                              .max_iterations = settings->max_iterations,
                              .threads = settings->threads, .centre = p->patches->centre,
                              .normal = p->patches->normal, .relaxation = options->relaxation,
                              .overshoot = options->overshoot, .trace = on_step,
                              .start = before != NULL ? before->radiosity : NULL,
                              .trace_user = live, .trace_due = is_step_due };
    atomic_store(&live->broken, false);
    live->breakable = true;
    Solution *after = solve(p->links, &p->problem, &so, &p->session->monitor, err);
    live->breakable = false;
    return after;
}

/* Goes on from where it was broken off. */
static bool solve_links(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    assert(p->links != NULL && p->emission != NULL);
    do {
        live_wish(live);
        p->session->settings.solver = chosen_solver(live);
        live->steps_before = p->solution != NULL ? p->solution->iterations : 0;
        Solution *after = solve_from(live, p->solution, err);
        if (after == NULL)
            return false;
        after->iterations += live->steps_before;
        solution_destroy(p->solution);
        p->solution = after;
        if (after->residual <= live_wish(live))
            after->converged = true;
    } while (!live_must_end(live) && !p->solution->converged && atomic_load(&live->broken));
    return true;
}

/* --- all of them ------------------------------------------------------------------------------ */

bool live_solve(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    const double begin = progress_now();
    assert(p->links != NULL || p->session->settings.stochastic);
    if (p->session->settings.stochastic) {
        p->step = on_step;
        return pipeline_solve(p, err);
    }
    if (!pipeline_light(p, err) || !solve_links(live, err))
        return false;
    pipeline_energy(p);
    pipeline_note(p, STAGE_SOLVE, begin);
    return !live_must_end(live) || error_set(err, ERROR_STOPPED, "stopped");
}
