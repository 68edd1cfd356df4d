/* SPDX-License-Identifier: BSD-3-Clause */
/* app/shutter.h -- the moments of --shutter, and which of them share their light. */
#ifndef APP_SHUTTER_H
#define APP_SHUTTER_H

#include "app/pipeline.h"

typedef struct {
    double   time;
    uint64_t light;        /* scene_fingerprint */
    Camera  *camera;       /* [cameras]  of the scene then */
    size_t   cameras;
    uint32_t solution;     /* moments with the same number differ in cameras alone */
    uint32_t rank;         /* in the order in which they are taken */
} Moment;

typedef struct {
    Moment  *moment;       /* [count]  by solution, then by rank: however few are taken, they are
                              spread over the time */
    uint32_t count, solutions;
    uint32_t middle;       /* the one nearest to the shutter's middle */
} Shutter;

/* Reads the scene at the middles of equal parts of the shutter's time; once, with a warning, when
 * nothing in it depends on TIME. shutter_clear follows in any case.
 * fails  as scene_read. */
bool shutter_read(Shutter *shutter, Session *session, Error *err);
void shutter_clear(Shutter *shutter);

#endif
