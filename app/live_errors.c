/* SPDX-License-Identifier: BSD-3-Clause */
/* How far each patch of a solution may be off: what its one value leaves out, as dividing asks. */
#include <assert.h>

#include "app/live.h"
#include "base/array.h"
#include "radiosity/adapt.h"

enum {
    FEW_RAYS = 64,        /* of a patch, where links are cast for this and direct light alone */
    PATCH_BYTES = 2048,   /* that points and pieces of a patch take, and such links */
    PATCHES_MOST = 250000 /* half a gigabyte of that, and half a minute */
};

typedef struct {
    Live    *live;
    unsigned version;    /* of the knobs */
} Estimate;

/* Hands go first. */
static bool estimate_stop(void *user)
{
    const Estimate *estimate = user;
    const Live *live = estimate->live;
    const Control *control = live->control;
    return live_must_end(live) || atomic_load(&control->knobs.version) != estimate->version ||
           atomic_load(&control->easel.waiting) || live_tolerance(live) < live->asked;
}

/* The solver's own links; where it has none, or in 16 bits, some of few rays: the chance in them is
 * known, and no reason to call a patch wrong. */
static const Links *links_to_ask(Live *live, uint32_t *rays, const Monitor *monitor, Error *err)
{
    const Pipeline *p = live->pipeline;
    const Settings *settings = &p->session->settings;
    *rays = settings->rays;
    if (!settings->stochastic && p->links->packed == NULL)
        return p->links;
    *rays = FEW_RAYS;
    if (live->few != NULL)
        return live->few;
    const LinksOptions options = { .rays = FEW_RAYS, .seed = settings->seed,
                                   .threads = settings->threads };
    Links *links = links_create(&p->room, &options, monitor, err);
    if (links != NULL)
        live->few = links_close(links, p->patches, CLOSURE_ROWS, settings->threads, monitor, err);
    links_destroy(links);
    return live->few;
}

static double *estimate(Live *live, Error *err)
{
    const Pipeline *p = live->pipeline;
    const Settings *settings = &p->session->settings;
    Estimate own = { live, atomic_load(&live->control->knobs.version) };
    const Monitor monitor = { .user = &own, .stop = estimate_stop };
    uint32_t rays;
    const Links *links = links_to_ask(live, &rays, &monitor, err);
    const AdaptOptions options = { .row_rays = rays, .seed = settings->seed,
                                   .threads = settings->threads };
    double *error = array_create(p->patches->count, sizeof *error, "errors", err);
    if (links != NULL && error != NULL &&
        adapt_errors(&p->room, links, p->solution->irradiance, &options, error, &monitor, err))
        return error;
    return array_free(error);
}

/* Whether there is memory for it. */
static bool is_modest(const Live *live)
{
    const Pipeline *p = live->pipeline;
    const uint64_t count = p->patches->count;
    Error err = { 0 };
    return count <= PATCHES_MOST && pipeline_fits(p, count * PATCH_BYTES, "errors", &err);
}

bool live_errors(Live *live, bool changed, Error *err)
{
    const Pipeline *p = live->pipeline;
    assert(p->solution != NULL && live->step == STEP_SOLVED);
    if (!is_modest(live)) {
        live->lit_wholly = true; /* with all that there will be */
        return true;
    }
    double *error = estimate(live, err);
    if (error == NULL) {
        const bool stopped = err->code == ERROR_STOPPED;
        if (stopped)
            *err = (Error){ 0 }; /* once more later */
        return stopped;
    }
    const LiveLight light = { .radiosity = p->solution->radiosity,
                              .irradiance = p->solution->irradiance, .error = error,
                              .visible_area = p->links->area, .links = live_links(live),
                              .shooter = PATCH_NONE, .changed = changed };
    const bool done = live_publish(live, &light, err);
    array_free(error);
    return done;
}
