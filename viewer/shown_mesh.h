/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/shown_mesh.h -- patches as triangles for the screen, with what is asked about a patch.
 *
 * A copy: it goes on living when the solver has finer patches already. Shared between threads by
 * counted references; nothing in it changes once it is made.
 */
#ifndef VIEWER_SHOWN_MESH_H
#define VIEWER_SHOWN_MESH_H

#include <stdatomic.h>

#include "base/error.h"
#include "mesh/patches.h"
#include "raycast/bvh.h"
#include "scenes/scene.h"
#include "viewer/knobs.h"

/* What a patch is, light apart. */
typedef struct {
    uint32_t group, material;
    uint8_t  side, level;   /* level: how often it was divided */
    bool     lamp;          /* it emits */
    double   area;          /* scene units squared */
    Vec3     centre, normal;
    Rgb      reflectance;
} ShownPatch;

typedef struct {
    atomic_uint references;
    uint32_t    patch_count, vertex_count, triangle_count, edge_count;
    ShownPatch *patch;          /* [patch_count] */
    Vec3       *position;       /* [vertex_count] */
    uint32_t   *corner;         /* [3 * triangle_count]  counter-clockwise from the patch's side */
    uint32_t   *triangle_patch; /* [triangle_count] */
    uint32_t   *edge;           /* [2 * edge_count]  vertices: the outlines of patches */
    /* The first plain_count vertices are those of the Patches; each one after that lies in a face
     * with vertices on its edges and is the mean of up to four of them. */
    uint32_t    plain_count;
    uint32_t   *mean_of;        /* [4 * (vertex_count - plain_count)] */
    Bvh        *bvh;            /* over the triangles: primitive i is triangle i */
    Vec3        lo, hi;         /* bounds */
    Camera     *camera;         /* [camera_count]  the first is shown at the beginning */
    uint32_t    camera_count;
    Light      *light;          /* [light_count]  point and spot lights */
    uint32_t    light_count;
    Vec3        up, origin;     /* origin: of the places in here, in the file's coordinates */
    uint64_t    scene_hash;
    char      **group_name, **material_name; /* [..count] */
    uint32_t    group_count, material_count;
    Knob       *knob;           /* [knob_count]  what can be turned in the scene */
    uint32_t    knob_count;
} ShownMesh;

/* camera: the first to be shown, before the scene's own; sides that emit as in Room.
 * owns   one reference, given back by shown_mesh_leave.
 * fails  NULL; ERROR_MEMORY. */
ShownMesh *shown_mesh_create(const Scene *scene, const Patches *patches, const uint8_t *emitting,
                             const Camera *camera, unsigned threads, Error *err);
/* One reference more; returns its argument. */
ShownMesh *shown_mesh_share(ShownMesh *mesh);
/* Gives one back, the last one frees; NULL is allowed. Always returns NULL. */
ShownMesh *shown_mesh_leave(ShownMesh *mesh);

#endif
