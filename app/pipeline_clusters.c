/* SPDX-License-Identifier: BSD-3-Clause */
/* Light over links between clusters of patches. */
#include "app/pipeline_clusters.h"

#include <assert.h>

#include "app/commands.h"
#include "app/pipeline_stochastic.h"
#include "app/progress.h"
#include "app/saving.h"
#include "app/trace.h"
#include "base/array.h"
#include "render/seen.h"

/* Most rays of links for each ray that gathers last: those are visibility rays, which cost less,
 * and fewer leave links more uncertain than gathering makes up for. */
enum { LINK_SHARE = 2 };

/* What the window may raise rays by: links take memory in proportion. */
enum { MORE_RAYS = 4 };

/* What links may take of --max-memory, less what is in use. They are sorted from one copy into
 * another; what is kept of them for a checkpoint is a third one. */
static uint64_t memory_left(const Session *session, bool kept)
{
    const uint64_t limit = session->options.max_memory, used = progress_peak_bytes();
    const uint64_t left = limit > used ? limit - used : 1;
    return limit == 0 ? 0 : kept ? left / 3 * 2 + 1 : left;
}

/* What of its picture each patch takes up, of all cameras together; NULL: it was not asked for, or
 * there is no camera. */
static double *what_is_seen(Pipeline *pipeline, Error *err)
{
    const int width = pipeline->width, height = pipeline->height;
    if (!pipeline->session->options.importance || !pipeline->has_camera)
        return NULL;
    double *seen = array_create(pipeline->patches->count, sizeof *seen, "what is seen", err);
    view_size(pipeline);
    for (uint32_t k = 0; k < pipeline->view_count && !error_is_set(err); k++)
        seen_add(&pipeline->room, &pipeline->view[k], pipeline->width, pipeline->height,
                 1.0 / pipeline->view_count, seen, err);
    pipeline->width = width;
    pipeline->height = height;
    return seen;
}

static void wish(void *user, double *tolerance, uint32_t *rays)
{
    if (pipeline_stochastic_wish(user, MORE_RAYS, tolerance, rays))
        *rays *= LINK_SHARE;
}

bool pipeline_clusters_solve(Pipeline *pipeline, Error *err)
{
    Session *session = pipeline->session;
    const Settings *settings = &session->settings;
    Trace trace;
    assert(settings->clusters);
    if (!trace_begin(&trace, session->options.trace, pipeline->links->rays, err))
        return false;
    double *seen = what_is_seen(pipeline, err);
    const uint32_t rays = pipeline_solver_rays(pipeline);
    const bool gather = !session->options.no_last_gather && !session->hurry;
    const bool given = options_given(&session->options, OPTION_TOLERANCE);
    ClustersKept *kept = saving_clusters(pipeline->saving);
    trace_watch(&trace, pipeline->step, pipeline->watch_user);
    const ClustersOptions options = { .tolerance = given ? settings->tolerance : 0,
                                      .rays = LINK_SHARE * rays, .seen = seen,
                                      .gather = gather ? rays : 0,
                                      .sights = settings->lamp_rays, .seed = settings->seed,
                                      .threads = settings->threads,
                                      .trace_user = &trace,
                                      .memory = memory_left(session, kept != NULL), .kept = kept,
                                      .wish = pipeline->tolerance != NULL ? wish : NULL,
                                      .wish_user = pipeline,
                                      .trace = trace_wanted(&trace) ? trace_step : NULL };
    pipeline->solution = clusters_solve(&pipeline->room, &pipeline->places, &pipeline->problem,
                                        &options, &pipeline->clusters, &session->monitor, err);
    saving_tick(pipeline->saving); /* where the last round was, when it was asked to stop */
    array_free(seen);
    return trace_finish(&trace, err) && pipeline->solution != NULL;
}

void pipeline_clusters_print(const Pipeline *pipeline)
{
    const ClustersReport *r = &pipeline->clusters;
    session_say(pipeline->session, "  solve    hierarchical, %u rounds, %.3g links between %u "
                "nodes (%.3g MB), %.3g rays, irradiance off by %.2g %% (rms, estimated)%s, %.2f s",
                r->rounds, (double)r->links, r->nodes, 1e-6 * (double)r->bytes, (double)r->rays,
                100 * r->error,
                pipeline->solution->converged ? "" : r->full ? ": more --max-memory is needed"
                                                             : ": more --rays are needed",
                pipeline->seconds[STAGE_SOLVE]);
    if (r->gathered)
        session_say(pipeline->session, "           last reflection by %.3g rays, noise %.2g %%",
                    (double)r->gather_rays, 100 * r->noise);
    session_say(pipeline->session, "           rows of links lacked %.2g %% (rms) before they were "
                "closed", 100 * r->rows);
}
