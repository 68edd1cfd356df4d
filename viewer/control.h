/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/control.h -- what the window asks of the solver, and what the solver says of itself.
 *
 * Threads  requests are atomics that either side reads and writes; the report is copied under a
 *          lock that is held for the copy alone.
 */
#ifndef VIEWER_CONTROL_H
#define VIEWER_CONTROL_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "viewer/easel.h"
#include "viewer/knobs.h"

typedef struct {
    const char *doing;      /* "reading", "shooting", ...; static */
    double      done;       /* share of that, 0..1; < 0: not known */
    double      unshot;     /* share of the power not yet passed on; < 0: not known */
    double      residual;   /* < 0: not known */
    bool        estimated;  /* it is the error of light, estimated by a solver without links */
    double      seconds;    /* since the beginning, pauses left out */
    double      left;       /* seconds to go, estimated; < 0: not known */
    uint64_t    rays, memory; /* cast so far; bytes */
    double      rays_per_second;
    uint32_t    patches, steps;
} Report;

typedef struct {
    atomic_bool quit, restart, reload, paused;
    atomic_uint steps;      /* to do while it is paused */
    atomic_int  solver;     /* Solver, or SOLVER_COUNT: by rays alone */
    _Atomic double tolerance; /* of the residual */
    _Atomic double error;   /* of the estimated error, where the solver has no links */
    atomic_bool failed;     /* the solver's thread has ended with an error: close */
    atomic_bool finished;   /* nothing is left to do */
    Knobs       knobs;
    Easel       easel;
    pthread_mutex_t lock;
    Report      report;     /* under the lock */
    char        said[256];  /* under the lock: a line for the window */
    unsigned    sayings;    /* under the lock: grows with each of them */
} Control;

/* With a report of nothing done yet. */
void control_init(Control *control);
void control_clear(Control *control);
/* The solver's report so far, and the last one there was. */
void control_report(Control *control, const Report *report);
void control_read(Control *control, Report *report);
/* A line of the solver's for who looks on; each is shown once, the last one of several. */
void control_say(Control *control, const char *line);
/* It, when it is another than the last; sayings: counts, 0 at first. */
bool control_heard(Control *control, unsigned *sayings, char *line, size_t size);

#endif
