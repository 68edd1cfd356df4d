/* SPDX-License-Identifier: BSD-3-Clause */
/* Light without links, for patches that are too many for them. */
#include "app/pipeline_stochastic.h"

#include <assert.h>
#include <math.h>

#include "app/saving.h"
#include "app/trace.h"

/* Links of so many patches, 320 rays each, and the copy that closing makes take up to 768 MB: what
 * a small machine has to spare. */
enum { STOCHASTIC_PATCHES = 150000 };

/* What the window may raise rays by; memory does not grow with them. */
enum { MORE_RAYS = 16 };

/* Bytes of a link, and copies of it while links are closed. */
enum { LINK_BYTES = 8, LINK_COPIES = 2 };

/* Options that speak of links or of other solvers. */
static const OptionId needs_links[] = {
    OPTION_ADAPT, OPTION_LEAST_SIZE, OPTION_LAMP_RAYS, OPTION_CLOSURE, OPTION_STORAGE,
    OPTION_FACTORS, OPTION_RELAXATION, OPTION_OVERSHOOT, OPTION_NO_AMBIENT, OPTION_COMPARE,
    OPTION_SET, OPTION_CHANGES, OPTION_LIGHT_GROUPS, OPTION_MAX_ITERATIONS
};

void pipeline_stochastic_choose(Pipeline *pipeline, uint32_t patches)
{
    Session *session = pipeline->session;
    Settings *s = &session->settings;
    const unsigned lit = COMMAND_RENDER | COMMAND_SOLVE | COMMAND_MEASURE;
    if (s->stochastic || options_given(&session->options, OPTION_SOLVER) ||
        (lit & (unsigned)session->options.command) == 0)
        return;
    for (size_t k = 0; k < sizeof needs_links / sizeof *needs_links; k++)
        if (options_given(&session->options, needs_links[k]))
            return;
    const uint64_t bytes = (uint64_t)patches * (s->rays + s->lamp_rays) * LINK_BYTES * LINK_COPIES;
    const uint64_t limit = session->options.max_memory;
    const bool large = limit > 0 && bytes > limit;
    if (patches <= STOCHASTIC_PATCHES && !large)
        return;
    s->stochastic = true;
    s->adapt = false;
    session_say(session, "isolux: %u patches%s: --solver stochastic, without links", patches,
                patches > STOCHASTIC_PATCHES ? "" : ", whose links may pass --max-memory");
}

static bool refuse(const Session *session, OptionId id, Error *err)
{
    return error_set(err, ERROR_USAGE, "%s: not with --solver %s", options_table()[id].name,
                     session->settings.clusters ? "hierarchical" : "stochastic");
}

bool pipeline_stochastic_places(Pipeline *pipeline, Error *err)
{
    const Session *session = pipeline->session;
    const double begin = progress_now();
    assert(session->settings.stochastic && pipeline->links == NULL);
    for (size_t k = 0; k < sizeof needs_links / sizeof *needs_links; k++)
        if (options_given(&session->options, needs_links[k]) &&
            !(session->settings.clusters && needs_links[k] == OPTION_LAMP_RAYS))
            return refuse(session, needs_links[k], err);
    pipeline_begin(pipeline, STAGE_FACTORS);
    if (!saving_resume(pipeline->saving, err))
        return false;
    pipeline->links = links_destroy(pipeline->links); /* an earlier run's, without places */
    do {
        open_places_find(&pipeline->room, session->settings.seed, session->settings.threads,
                         &pipeline->places, &session->monitor, err);
    } while (pipeline->places.links == NULL && pipeline_hurry(pipeline, err));
    pipeline->links = pipeline->places.links;
    pipeline_note(pipeline, STAGE_FACTORS, begin);
    pipeline->factors_seconds = pipeline->seconds[STAGE_FACTORS];
    return pipeline->links != NULL && pipeline_fits(pipeline, 0, session->options.scene, err);
}

bool pipeline_stochastic_wish(const Pipeline *pipeline, uint32_t most, double *tolerance,
                              uint32_t *rays)
{
    const Session *session = pipeline->session;
    const bool given = options_given(&session->options, OPTION_TOLERANCE);
    const double first = given ? session->settings.tolerance : STOCHASTIC_TOLERANCE;
    assert(most > 0);
    if (pipeline->tolerance == NULL)
        return false;
    *tolerance = pipeline->tolerance(pipeline->watch_user);
    /* Noise falls with the root of their number. */
    const double more = first * first / (*tolerance * *tolerance);
    *rays = (uint32_t)(pipeline_solver_rays(pipeline) * fmin(fmax(more, 1), most));
    return true;
}

static void wish(void *user, double *tolerance, uint32_t *rays)
{
    pipeline_stochastic_wish(user, MORE_RAYS, tolerance, rays);
}

bool pipeline_stochastic_solve(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    Trace trace;
    if (!trace_begin(&trace, session->options.trace, pipeline->links->rays, err))
        return false;
    const bool given = options_given(&session->options, OPTION_TOLERANCE);
    trace_watch(&trace, pipeline->step, pipeline->watch_user);
    const StochasticOptions so = { .tolerance = given ? settings->tolerance : 0,
                                   .rays = pipeline_solver_rays(pipeline), .seed = settings->seed,
                                   .threads = settings->threads, .trace_user = &trace,
                                   .trace = trace_wanted(&trace) ? trace_step : NULL,
                                   .wish = pipeline->tolerance != NULL ? wish : NULL,
                                   .wish_user = pipeline,
                                   .kept = saving_light(pipeline->saving) };
    pipeline->solution = stochastic_solve(&pipeline->room, &pipeline->places, &pipeline->problem,
                                          &so, &pipeline->stochastic, &session->monitor, err);
    saving_tick(pipeline->saving); /* where the last round was, when it was asked to stop */
    return trace_finish(&trace, err) && pipeline->solution != NULL;
}
