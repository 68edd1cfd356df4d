/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live.h -- the pipeline in a thread of its own, publishing what light there is so far.
 *
 * First direct light with an estimate of the rest, by a few rays; then light is shot from patch to
 * patch by rays, the brightest first [cohen88]; then come links, patches divided where light
 * changes, and the solver: each is seen. Then it rests until it is asked for more.
 */
#ifndef APP_LIVE_H
#define APP_LIVE_H

#include <pthread.h>

#include "app/pipeline.h"
#include "viewer/control.h"
#include "viewer/snapshot.h"

/* Light on all patches. */
typedef struct {
    const double *radiosity, *irradiance; /* [3 * patches]; the latter may be NULL */
    const double *direct, *unshot;        /* the same; direct NULL: from the links, if any */
    const double *error;                  /* [patches], or NULL */
    const double *visible_area;           /* [patches] */
    const Links  *links;                  /* for row sums and direct light; NULL: none */
    uint32_t      shooter;                /* patch, or PATCH_NONE */
    const Vec3   *ray;                    /* [2 * ray_count] */
    uint32_t      ray_count;
    bool          changed;                /* lamps or paint are not what they were in the scene */
} LiveLight;

typedef struct {
    Pipeline  *pipeline;
    Mailbox   *mailbox;
    Control   *control;
    Monitor    outer;          /* the session's own, for warnings */
    pthread_t  thread;
    ShownMesh *mesh;           /* of `patches`, a reference; NULL: none yet */
    const Patches *patches;
    VertexCarry *carry;        /* of `patches` as well; NULL: none yet */
    pthread_t  self;           /* the thread as it knows itself */
    double     begin, stage_begin; /* clock of progress_now; pauses put them off */
    double     published;
    const char *doing;
    Report     report;
    uint64_t   rays_stage, rays_before; /* of stages that are over; and of passes of this one */
    ShownStep  step;
    bool       adapt;          /* patches are divided, where the solver has links */
    atomic_bool stepping;      /* a single step is under way */
    atomic_bool painting;      /* a picture is: all other threads rest */
    /* light as published last, for pictures: of these patches; NULL: none that still holds */
    const Patches *lit;
    double    *lit_radiosity, *lit_area; /* [3 * lit->count], [lit->count] */
    Links     *few;            /* of errors, where the solver has none; NULL: not needed yet */
    bool       lit_wholly;     /* with all that is known of a solution, errors too */
    double     asked;          /* tolerance that light is solved for */
    bool       breakable;      /* a solver runs that live_breaks is asked for */
    atomic_bool broken;        /* one was */
    uint32_t   steps_before;   /* of solvers that were broken off */
    int        exit_code;
    Error      err;
} Live;

/* Begins; the session's monitor is the thread's until live_join.
 * fails  false; ERROR_FAILED. */
bool live_start(Live *live, Pipeline *pipeline, Mailbox *mailbox, Control *control, Error *err);
/* Waits for the end, after control->quit. What went wrong is in live->err. */
void live_join(Live *live);

/* --- parts ------------------------------------------------------------------------------------ */

/* Between two steps: makes a picture that is wished for, waits while paused. False: it is to
 * end. */
bool live_step(Live *live);
bool live_must_end(const Live *live);
void live_begin(Live *live, const char *doing, ShownStep step);
void live_report(Live *live);

/* live_publish.c: whether it is time again, and doing it. What is needed of `light` is copied. */
bool live_due(const Live *live);
bool live_publish(Live *live, const LiveLight *light, Error *err);
/* What was published is not the light of the room any more. */
void live_forget(Live *live);

/* live_solve.c: the tolerance as the window has it now, for the session's solver. */
double live_tolerance(const Live *live);
/* The same, of a Live, for the pipeline: light is solved for it. */
double live_wish(void *live);
/* Whether a solver on links is to be broken off, to go on with another tolerance or by another. */
bool live_breaks(const Live *live);
/* Solves, once there are links; every step is seen, and another tolerance holds at once.
 * fails  false; as pipeline_solve. */
bool live_solve(Live *live, Error *err);
/* The residual, or the error that solvers without links estimate. */
double live_residual(const Pipeline *pipeline);

/* Links that tell of rows and direct light; NULL: the solver has none. */
const Links *live_links(const Live *live);

/* live_errors.c: estimates how far each patch of the solution is off, and publishes it with all
 * else; unless something else is wished for meanwhile. fails  false; ERROR_MEMORY. */
bool live_errors(Live *live, bool changed, Error *err);

/* live_shoot.c: the first two of the stages above. */
bool live_shoot(Live *live, Error *err);
/* Of a large scene, before its sides and patches are known: triangles as the eye meets them, by the
 * light that comes straight from lamps, either way, and an estimate. Leaves nothing behind. */
bool live_glance(Live *live, Error *err);

#endif
