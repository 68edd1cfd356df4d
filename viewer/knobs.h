/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/knobs.h -- what can be turned while looking on: lamps brighter, paint darker.
 *
 * The list is made with the scene and belongs to the mesh that is shown; what the knobs stand at is
 * shared with the solver, which looks at it between two solutions.
 * Threads  values are under a lock that is held to copy them alone.
 */
#ifndef VIEWER_KNOBS_H
#define VIEWER_KNOBS_H

#include <pthread.h>
#include <stdatomic.h>

#include "base/error.h"
#include "scenes/scene.h"

typedef enum {
    KNOB_LAMP,       /* emission of a material */
    KNOB_LIGHTS,     /* intensity of all point lights */
    KNOB_PAINT       /* reflectance of a material */
} KnobKind;

typedef struct {
    KnobKind kind;
    uint32_t index;      /* material */
    char    *name;       /* owned */
} Knob;

enum { KNOBS_MOST = 256 };

typedef struct {
    atomic_uint version; /* grows with each turn */
    atomic_bool save;    /* write what was turned to a file, then clear this */
    pthread_mutex_t lock;
    double value[KNOBS_MOST]; /* under the lock; 1: as in the scene */
} Knobs;

/* What the scene has: lamps, point lights, then paint; no more than KNOBS_MOST.
 * owns   the caller frees with knobs_free. fails  false; ERROR_MEMORY. */
bool knobs_list(const Scene *scene, Knob **knob, uint32_t *count, Error *err);
Knob *knobs_free(Knob *knob, uint32_t count);

/* All at 1. */
void knobs_init(Knobs *knobs);
void knobs_clear(Knobs *knobs);
double knobs_value(Knobs *knobs, uint32_t k);
void knobs_turn(Knobs *knobs, uint32_t k, double value);
/* All of them, and the version they are of. */
unsigned knobs_read(Knobs *knobs, double value[KNOBS_MOST]);

#endif
