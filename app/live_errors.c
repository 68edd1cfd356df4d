/* SPDX-License-Identifier: BSD-3-Clause */
/* How far each patch of a solution may be off: what its one value leaves out, as dividing asks. */
#include <assert.h>

#include "app/live.h"
#include "base/array.h"
#include "radiosity/adapt.h"

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

/* Solvers without links have rows without any: then it is direct light alone that is looked at. */
static double *estimate(Live *live, Error *err)
{
    const Pipeline *p = live->pipeline;
    const Settings *settings = &p->session->settings;
    Estimate own = { live, atomic_load(&live->control->knobs.version) };
    const Monitor monitor = { .user = &own, .stop = estimate_stop };
    const AdaptOptions options = { .row_rays = settings->rays, .seed = settings->seed,
                                   .threads = settings->threads };
    double *error = array_create(p->patches->count, sizeof *error, "errors", err);
    if (error != NULL && adapt_errors(&p->room, p->links, p->solution->irradiance, &options, error,
                                      &monitor, err))
        return error;
    return array_free(error);
}

bool live_errors(Live *live, bool changed, Error *err)
{
    const Pipeline *p = live->pipeline;
    assert(p->solution != NULL && live->step == STEP_SOLVED);
    if (p->links->packed != NULL) { /* in 16 bits they cannot be asked */
        live->lit_wholly = true;
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
                              .visible_area = p->links->area, .links = p->links,
                              .shooter = PATCH_NONE, .changed = changed };
    const bool done = live_publish(live, &light, err);
    array_free(error);
    return done;
}
