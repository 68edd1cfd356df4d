/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/pace.h -- how quick the window is: what frames cost, how soon input and light show.
 *
 * Seconds count from the program's begin. Threads: the window's.
 */
#ifndef VIEWER_PACE_H
#define VIEWER_PACE_H

#include "base/error.h"
#include "viewer/snapshot.h"

/* Bins of 2 % from 10 microseconds on: quantiles to 1 %, in fixed memory however long it runs. */
enum { PACE_BINS = 820 };

typedef struct {
    uint32_t bin[PACE_BINS];
    uint64_t count;
    double   most;
} PaceTimes;

/* Power received by what is no lamp, as one snapshot knew it: estimates are not in it. */
typedef struct { double seconds, power; } PaceLight;

typedef struct {
    double    before;             /* seconds of the program before the window's clock */
    PaceTimes working, resting;   /* seconds of a frame: while the solver works, and after */
    PaceTimes latency;            /* from an event to the frame that shows it */
    PaceTimes updates;            /* between snapshots after all was solved */
    double    first_frame, first_lit;
    double    working_seconds;    /* from the first lit frame to the solver's end */
    double    changed;            /* when the last snapshot came after all was solved */
    double    event;              /* the oldest one not yet shown; < 0: none */
    PaceLight *light;             /* [light_count] */
    size_t    light_count, light_capacity;
} Pace;

void pace_init(Pace *pace, double before);
void pace_clear(Pace *pace);

/* A snapshot was taken; power only when it knows irradiance.
 * fails  false; ERROR_MEMORY. */
bool pace_snapshot(Pace *pace, const Snapshot *snapshot, bool finished, double now, Error *err);
/* An event was handled at `now`. */
void pace_event(Pace *pace, double now);
/* A frame was drawn and shown from `begin` to `now`. */
void pace_frame(Pace *pace, double begin, double now, bool lit, bool finished);

/* NAN without any. */
double pace_quantile(const PaceTimes *times, double share);
/* When `share` of the last known power was first seen; NAN: never, or nothing is known. */
double pace_light_at(const Pace *pace, double share);

#endif
