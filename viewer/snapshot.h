/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/snapshot.h -- light at one moment, and the place where the solver leaves it for the eye.
 *
 * The solver makes a whole new snapshot and puts it into the mailbox; the window takes what lies
 * there when it draws. One that was not taken in time is freed by the next: neither side waits.
 * Threads  one that puts, one that takes. A snapshot belongs to whoever holds it.
 */
#ifndef VIEWER_SNAPSHOT_H
#define VIEWER_SNAPSHOT_H

#include "radiosity/solve.h"
#include "viewer/shown_mesh.h"

/* How far the solver is; in this order. */
typedef enum {
    STEP_READING,  /* nothing to be seen yet */
    STEP_LIT,      /* direct light and an estimate of the rest */
    STEP_SHOT,     /* light shot from patch to patch by rays */
    STEP_LINKED,   /* solved with links */
    STEP_SOLVED    /* to the tolerance, all patches divided that were to be */
} ShownStep;

typedef enum {
    LAYER_RADIOSITY,   /* lm/m2, what leaves: emission included */
    LAYER_IRRADIANCE,  /* lux */
    LAYER_DIRECT,      /* lux, straight from lamps and lights */
    LAYER_UNSHOT,      /* lm/m2 not yet passed on */
    LAYER_ERROR,       /* estimated error of irradiance, lux */
    LAYER_COUNT
} Layer;

typedef struct {
    ShownMesh *mesh;                /* a reference */
    ShownStep step;
    float     *vertex;              /* [3 * mesh->vertex_count]  radiosity, smoothed */
    float     *layer[LAYER_COUNT];  /* [3 * mesh->patch_count] each; NULL: not known now */
    float     *row_sum;             /* [patch_count]  of form factors as cast; NULL: not known */
    float     *reflectance;         /* [3 * patch_count]; NULL: the mesh's own */
    Light     *light;               /* [mesh->light_count]; NULL: the mesh's own */
    uint32_t   shooter;             /* patch that shot last, or PATCH_NONE */
    Vec3      *ray;                 /* [2 * ray_count]  ends of some of its rays */
    uint32_t   ray_count;
} Snapshot;

typedef struct {
    _Atomic(Snapshot *) waiting;    /* NULL: nothing new */
} Mailbox;

/* One with the vertices' values smoothed from layer[LAYER_RADIOSITY], all other layers NULL.
 * patches: those that the mesh and `carry` were made from; radiosity, three bands
 * [3 * patches->count].
 * owns   takes a reference of its own to the mesh; the caller frees with snapshot_destroy.
 * fails  NULL; ERROR_MEMORY. */
Snapshot *snapshot_create(ShownMesh *mesh, const Patches *patches, const VertexCarry *carry,
                          const double *radiosity, Error *err);
/* Copies three bands per patch into a layer; fails  false; ERROR_MEMORY. */
bool snapshot_layer(Snapshot *snapshot, Layer layer, const double *value, Error *err);
/* What a patch reflects at that moment; point lights [mesh->light_count]. */
Rgb snapshot_reflectance(const Snapshot *snapshot, uint32_t patch);
const Light *snapshot_lights(const Snapshot *snapshot);
/* Frees; NULL is allowed. Always returns NULL. */
Snapshot *snapshot_destroy(Snapshot *snapshot);

/* Puts it there; it is the mailbox's from now on. */
void mailbox_put(Mailbox *mailbox, Snapshot *snapshot);
/* What lies there, or NULL; it is the caller's. */
Snapshot *mailbox_take(Mailbox *mailbox);

#endif
