/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import_assimp.h -- the importing library, and what the files that use it share: they run
 * in the child. Nothing else includes assimp.
 *
 * import_assimp.c         files, materials, the whole
 * import_assimp_meshes.c  nodes and their meshes
 * import_assimp_lights.c  lights and cameras of formats other than glTF
 */
#ifndef SCENES_IMPORT_ASSIMP_H
#define SCENES_IMPORT_ASSIMP_H

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include "scenes/child_images.h"
#include "scenes/import.h"
#include "scenes/import_prepare.h"

/* What becomes of a mesh. */
typedef struct {
    uint32_t uses;       /* nodes that show it */
    uint32_t number;     /* of its record once sent to be placed, PIPE_NO_MESH before */
    bool     placed;     /* sent once, and each node sends where it stands */
    bool     shown;      /* by a node */
} MeshUse;

typedef struct {
    const char           *path;
    PipeWriter           *out;
    Error                *err;
    ImportFiles           files;
    Foreknown             known;
    const struct aiScene *scene;
    uint32_t             *material;      /* [mNumMaterials]  number in the pipe */
    uint64_t              loose;         /* points and lines */
    uint64_t              faces;         /* the rest, copies too */
    ImagePlace           *place;         /* [mNumMaterials] */
    ChildImages           images;
    MeshUse              *use;           /* [mNumMeshes] */
    uint32_t              sent;          /* meshes to be placed */
    bool                  own;           /* some faces are sent as they stand in the scene */
} Import;

static inline Affine affine_get(const struct aiMatrix4x4 *m)
{
    return (Affine){ { (double)m->a1, (double)m->b1, (double)m->c1 },
                     { (double)m->a2, (double)m->b2, (double)m->c2 },
                     { (double)m->a3, (double)m->b3, (double)m->c3 },
                     { (double)m->a4, (double)m->b4, (double)m->c4 } };
}

/* All meshes of all nodes; those that several nodes show by reference when import->out->wish says
 * so and no image is on them. */
bool import_meshes_send(Import *import);

void import_light_send(Import *import, const struct aiLight *from);
void import_camera_send(Import *import, const struct aiCamera *from);
/* How long a unit of the file is in the units of the scene. */
double import_root_scale(const Import *import);

#endif
