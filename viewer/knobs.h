/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/knobs.h -- what can be turned while looking on: lamps brighter, paint of another colour.
 *
 * The list is made with the scene and belongs to the mesh that is shown; what the knobs stand at is
 * shared with the solver, which looks at it between two solutions. Values are colours as in the
 * scene: radiance of lamps, intensity of point lights, reflectance of paint.
 * Threads  values are under a lock that is held to copy them alone.
 */
#ifndef VIEWER_KNOBS_H
#define VIEWER_KNOBS_H

#include <pthread.h>
#include <stdatomic.h>

#include "base/error.h"
#include "scenes/scene.h"

typedef enum {
    KNOB_GROUP,      /* emission of all lamps of a group */
    KNOB_LAMP,       /* emission of a material: where the groups that emit are too many */
    KNOB_LIGHT,      /* intensity of the point lights of one name */
    KNOB_LIGHTS,     /* of all of them: where names are too many */
    KNOB_PAINT       /* reflectance of a material */
} KnobKind;

typedef struct {
    KnobKind kind;
    uint32_t index;      /* group, material, or the first light */
    char    *name;       /* owned */
    Rgb      base;       /* as in the scene; of several the largest, band by band */
    bool     plain;      /* of one material: bands that are 0 there may be raised */
} Knob;

enum { KNOBS_MOST = 256, KNOBS_GROUPS = 64, KNOBS_LIGHTS = 32 };

/* What all knobs stand at. */
typedef struct {
    Rgb  value[KNOBS_MOST];
    bool turned[KNOBS_MOST]; /* false: as in the scene */
} KnobSetting;

typedef struct {
    atomic_uint version; /* grows with each turn */
    atomic_uint settled; /* version that light is solved for, not roughly */
    atomic_bool save;    /* write what was turned to a file, then clear this */
    pthread_mutex_t lock;
    KnobSetting setting; /* under the lock */
} Knobs;

/* What the scene has: lamps, point lights, then paint; no more than KNOBS_MOST.
 * owns   the caller frees with knobs_free. fails  false; ERROR_MEMORY. */
bool knobs_list(const Scene *scene, Knob **knob, uint32_t *count, Error *err);
Knob *knobs_free(Knob *knob, uint32_t count);
/* Whether it is about light, not paint. */
bool knob_shines(const Knob *knob);
/* What becomes of a value of the scene when the knob stands at `value`: times value / base, band by
 * band; where the base is 0 the value itself, if the knob is plain. */
Rgb knob_apply(const Knob *knob, Rgb value, Rgb before);
/* Whether value / base is all there is to it. */
bool knob_is_factor(const Knob *knob, Rgb value);

/* None is turned. */
void knobs_init(Knobs *knobs);
void knobs_clear(Knobs *knobs);
/* What knob k of a list stands at. */
Rgb  knobs_value(Knobs *knobs, const Knob *knob, uint32_t k);
void knobs_turn(Knobs *knobs, uint32_t k, Rgb value);
/* All as in the scene again. */
void knobs_reset(Knobs *knobs);
/* All of them, and the version they are of. */
unsigned knobs_read(Knobs *knobs, KnobSetting *setting);

#endif
