/* SPDX-License-Identifier: BSD-3-Clause */
/* The solver's thread. */
#include "app/live.h"

#include <assert.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "app/live_picture.h"
#include "app/live_relight.h"
#include "app/pipeline_stochastic.h"
#include "base/array.h"

static void rest(void)
{
    static const struct timespec A_MOMENT = { .tv_nsec = 10 * 1000 * 1000 };
    nanosleep(&A_MOMENT, NULL);
}

bool live_must_end(const Live *live)
{
    return atomic_load(&live->control->quit) || atomic_load(&live->control->restart) ||
           session_stopped(live->pipeline->session);
}

/* Takes one of the steps that were asked for; they may end in the midst of a stage. */
static bool take_step(Live *live)
{
    unsigned steps = atomic_load(&live->control->steps);
    while (steps > 0)
        if (atomic_compare_exchange_weak(&live->control->steps, &steps, steps - 1)) {
            atomic_store(&live->stepping, true);
            return true;
        }
    return false;
}

/* The time since `begin` was none of the solver's. */
static void leave_out(Live *live, double begin)
{
    const double rested = progress_now() - begin;
    live->begin += rested;
    live->stage_begin += rested;
}

bool live_step(Live *live)
{
    Control *control = live->control;
    assert(control != NULL);
    atomic_store(&live->stepping, false);
    live_picture(live);
    while (atomic_load(&control->paused) && !live_must_end(live)) {
        const double begin = progress_now();
        if (take_step(live))
            break;
        if (!live_picture(live)) {
            rest();
            leave_out(live, begin);
        }
    }
    if (!atomic_load(&control->paused))
        atomic_store(&control->steps, 0);
    return !live_must_end(live);
}

/* --- the monitor of all stages ---------------------------------------------------------------- */

static void live_warn(void *user, const char *code, const char *where, const char *text)
{
    const Live *live = user;
    monitor_warn(&live->outer, code, where, "%s", text);
}

/* Whether a thread of the solver's has nothing to do for now: it is paused, unless a picture waits
 * for the light they find; or one is made, with all cores. */
static bool must_rest(Live *live, bool self)
{
    const Control *control = live->control;
    if (live_must_end(live))
        return false;
    if (atomic_load(&live->painting))
        return !self;
    return atomic_load(&control->paused) && !atomic_load(&live->stepping) &&
           !atomic_load(&control->easel.waiting) && !take_step(live);
}

/* Asked by every thread at work. */
static bool live_stop(void *user)
{
    Live *live = user;
    const bool self = pthread_equal(pthread_self(), live->self) != 0;
    while (must_rest(live, self)) {
        const double begin = progress_now();
        rest();
        if (self)
            leave_out(live, begin);
    }
    if (live->breakable && live_breaks(live))
        atomic_store(&live->broken, true);
    return live_must_end(live) || (live->breakable && atomic_load(&live->broken));
}

static void live_progress(void *user, const Progress *progress)
{
    Live *live = user;
    monitor_progress(&live->outer, progress);
    live->report.done = progress->done;
    if (live->rays_before + progress->rays < live->report.rays && progress->rays > 0)
        live->rays_before = live->report.rays; /* another pass of the stage */
    if (progress->rays > 0)
        live->report.rays = live->rays_before + progress->rays;
    live_report(live);
    live_picture(live); /* by the light there is, not at the end of a stage */
}

void live_report(Live *live)
{
    Report *r = &live->report;
    const double now = progress_now(), spent = now - live->stage_begin;
    r->doing = live->doing;
    r->seconds = now - live->begin;
    r->memory = progress_peak_bytes();
    r->left = r->done > 0.05 && r->done < 1 ? spent * (1 - r->done) / r->done : -1;
    r->rays_per_second = spent > 0.05 ? (double)(r->rays - live->rays_stage) / spent : 0;
    control_report(live->control, r);
}

void live_begin(Live *live, const char *doing, ShownStep step)
{
    live->doing = doing;
    live->step = step;
    live->stage_begin = progress_now();
    live->rays_before = live->rays_stage = live->report.rays;
    live->report.done = -1;
    live_report(live);
}

/* --- links, dividing, solving ----------------------------------------------------------------- */

/* After each pass of adaption: what is known so far. */
static void on_pass(void *user, const Links *links, const Solution *solution, const double *error)
{
    Live *live = user;
    Error err = { 0 }; /* a picture less is no reason to stop */
    const LiveLight light = { .radiosity = solution->radiosity,
                              .irradiance = solution->irradiance, .error = error,
                              .visible_area = links->area, .links = links,
                              .shooter = PATCH_NONE };
    live->step = STEP_LINKED;
    live->doing = "dividing";
    live->report.unshot = solution->unshot;
    live_publish(live, &light, &err);
    live_report(live);
    live_step(live);
}

static bool run_all(Live *live, Error *err)
{
    Pipeline *p = live->pipeline;
    live_begin(live, "reading", STEP_READING);
    if (!pipeline_read(p, err) || !pipeline_mesh(p, err) || !pipeline_camera(p, err) ||
        !live_glance(live, err) || !pipeline_patches(p, err) || !live_shoot(live, err))
        return false;
    live_begin(live, "links", STEP_SHOT);
    p->watch = on_pass;
    p->tolerance = live_wish;
    p->watch_user = live;
    if (!pipeline_factors(p, err))
        return false;
    live_begin(live, "solving", STEP_LINKED);
    if (!live_solve(live, err))
        return false;
    live->report.unshot = p->solution->unshot;
    live->report.residual = live_residual(p);
    live->report.steps = p->solution->iterations;
    live_begin(live, p->solution->converged ? "converged" : "stopped", STEP_SOLVED);
    live->report.done = 1;
    live_report(live);
    const LiveLight light = { .radiosity = p->solution->radiosity,
                              .irradiance = p->solution->irradiance,
                              .visible_area = p->links->area,
                              .links = live_links(live), .shooter = PATCH_NONE };
    return live_publish(live, &light, err);
}

/* The solver that was chosen in the window; SOLVER_COUNT is the one by rays alone. */
static void choose_solver(Live *live)
{
    Settings *settings = &live->pipeline->session->settings;
    const int solver = atomic_load(&live->control->solver);
    settings->clusters = solver == SOLVER_HIERARCHICAL;
    settings->stochastic = settings->clusters || solver == SOLVER_COUNT;
    settings->solver = solver == SOLVER_COUNT ? SOLVER_GAUSS_SEIDEL : (Solver)solver;
    settings->adapt = live->adapt && !settings->stochastic;
}

/* Everything anew, the scene's file too. */
static void clear_all(Live *live)
{
    choose_solver(live);
    live->mesh = shown_mesh_leave(live->mesh);
    live->carry = vertex_carry_destroy(live->carry);
    live->patches = NULL;
    live_forget(live);
    live->few = links_destroy(live->few);
    pipeline_clear(live->pipeline);
    live->begin = progress_now();
    live->steps_before = 0;
    live->rays_before = live->rays_stage = 0;
    live->report = (Report){ .done = -1, .unshot = -1, .residual = -1, .left = -1,
                             .estimated = live->pipeline->session->settings.stochastic };
}

/* After all is solved: follows the knobs until it is to end. */
static void stay(Live *live)
{
    Relighting relighting;
    bool good = relighting_begin(&relighting, live, &live->err);
    while (good && !live_must_end(live)) {
        bool done = false;
        good = relighting_follow(&relighting, live, &done, &live->err);
        if (!good || live_picture(live) || done)
            continue;
        good = relighting_rest(&relighting, live, &done, &live->err);
        if (!done)
            rest();
    }
    relighting_end(&relighting);
    if (live->err.code == ERROR_STOPPED && atomic_load(&live->control->restart))
        live->err = (Error){ 0 };
}

/* A file that cannot be read again, for it is being written or was spoilt, is told, and a solver
 * that some option forbids; what was seen stays until it is tried once more. */
static void bear(Live *live)
{
    char line[sizeof live->err.text];
    snprintf(line, sizeof line, "%s", live->err.text);
    live->err = (Error){ 0 };
    live_begin(live, "not read", STEP_READING);
    control_say(live->control, line);
    atomic_store(&live->control->finished, true);
    while (!live_must_end(live))
        rest();
}

/* Frames first, where both want the processor: nice is a thread's own, and that of threads it
 * begins, on Linux alone; elsewhere it is the whole program's, and left. */
static void give_way(void)
{
#ifdef __linux__
    enum { STEPS = 5 }; /* a third of the time while a frame is drawn */
    const int now = getpriority(PRIO_PROCESS, (id_t)gettid());
    (void)setpriority(PRIO_PROCESS, (id_t)gettid(), now + STEPS);
#endif
}

static void *run(void *user)
{
    Live *live = user;
    Control *control = live->control;
    bool on = true;
    live->self = pthread_self();
    give_way();
    for (bool again = false; on; again = true) {
        atomic_store(&control->restart, false);
        clear_all(live);
        run_all(live, &live->err);
        if (live->err.code == ERROR_STOPPED && atomic_load(&control->restart))
            live->err = (Error){ 0 };
        const bool borne = again && (live->err.code == ERROR_INPUT ||
                                     live->err.code == ERROR_USAGE);
        if (borne)
            bear(live);
        on = !error_is_set(&live->err);
        if (on && !atomic_load(&control->restart))
            atomic_store(&control->finished, true);
        if (on && !borne && !live_must_end(live))
            stay(live);
        on = !error_is_set(&live->err);
        atomic_store(&control->finished, false);
        on = on && atomic_load(&control->restart) && !atomic_load(&control->quit);
    }
    live->mesh = shown_mesh_leave(live->mesh);
    live->carry = vertex_carry_destroy(live->carry);
    live_forget(live);
    live->few = links_destroy(live->few);
    atomic_store(&control->failed, true);
    return NULL;
}

bool live_start(Live *live, Pipeline *pipeline, Mailbox *mailbox, Control *control, Error *err)
{
    Session *session = pipeline->session;
    *live = (Live){ .pipeline = pipeline, .mailbox = mailbox, .control = control,
                    .outer = session->monitor, .adapt = session->settings.adapt };
    session->monitor = (Monitor){ .user = live, .warn = live_warn, .progress = live_progress,
                                  .stop = live_stop };
    session->abrupt = true;
    if (pthread_create(&live->thread, NULL, run, live) != 0)
        return error_set(err, ERROR_FAILED, "no thread for the solver");
    return true;
}

void live_join(Live *live)
{
    pthread_join(live->thread, NULL);
    live->pipeline->session->monitor = live->outer;
}
