/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/gltf.h -- what a glTF file says beside its triangles; this folder and its tests only.
 *
 * assimp reads the buffers and makes triangles of them. Nodes, materials, lights and cameras are
 * read here from the JSON: assimp 5.2 does not know KHR_materials_emissive_strength, multiplies a
 * camera's angle by the aspect, needs a default scene, and loses which material is which. It gets a
 * reduced JSON in which nodes, meshes and materials are named n0, a0, m0 and so on, each node that
 * has a mesh stands alone and nothing else is left that it could stumble over.
 */
#ifndef SCENES_GLTF_H
#define SCENES_GLTF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "math/affine.h"
#include "math/light.h"
#include "mesh/polygons.h"
#include "scenes/scene.h"

/* Greatest JSON that is read. */
static const size_t gltf_json_limit = (size_t)256 << 20;

/* --- JSON (gltf_json.c: the only file that knows the JSON library) ---------------------------- */

typedef struct json_t Json;

/* Where reading happens and where trouble goes. After the first error all getters give the
 * fallback, so that a reader checks once at its end. */
typedef struct {
    const char    *path;
    const Monitor *monitor;
    Error         *err;
} GltfContext;

Json *gltf_parse(const GltfContext *context, const char *text, size_t size);
void  gltf_free(Json *json);

const Json *gltf_member(const Json *object, const char *key);   /* NULL: absent, or no object */
/* Member that must be an array (object): NULL when absent. */
const Json *gltf_list(const GltfContext *c, const Json *object, const char *where, const char *key);
const Json *gltf_object(const GltfContext *c, const Json *object, const char *where,
                        const char *key);
size_t      gltf_count(const Json *list);                       /* 0 for NULL */
const Json *gltf_item(const Json *list, size_t index);
bool        gltf_is_object(const Json *json);
const char *gltf_word(const GltfContext *c, const Json *object, const char *where, const char *key,
                      const char *fallback);
double      gltf_number(const GltfContext *c, const Json *object, const char *where,
                        const char *key, double fallback);
/* A whole number below `limit`, or SIZE_MAX when absent. */
size_t      gltf_index(const GltfContext *c, const Json *object, const char *where,
                       const char *key, size_t limit);
/* An item of a list that must be a whole number below `limit`; SIZE_MAX after an error. */
size_t      gltf_index_item(const GltfContext *c, const Json *list, const char *where, size_t item,
                            size_t limit);
/* An item of a list that must be a string; NULL after an error. */
const char *gltf_string_item(const GltfContext *c, const Json *list, const char *where,
                             size_t item);
/* Exactly `count` numbers; false, and *values untouched, when absent or after an error. */
bool        gltf_numbers(const GltfContext *c, const Json *object, const char *where,
                         const char *key, double *values, size_t count);
/* The text of a value, to be freed with gltf_text_free; NULL: out of memory. */
char       *gltf_text(const Json *json);
void        gltf_text_free(char *text);
/* ERROR_INPUT about `where`. Returns false. */
bool        gltf_error(const GltfContext *c, const char *where, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* --- the container (gltf_glb.c) --------------------------------------------------------------- */

typedef struct {
    const char    *json;       /* in the file's bytes; not ended by a 0 */
    size_t         json_size;
    const uint8_t *binary;     /* the BIN chunk; NULL: none */
    size_t         binary_size;
    bool           is_glb;
} GltfParts;

/* Finds the JSON and the binary chunk of a .gltf or .glb in memory. */
bool gltf_split(const char *path, const uint8_t *bytes, size_t size, GltfParts *parts, Error *err);
/* The same file with another JSON; *size is its size. Freed with array_free. */
uint8_t *gltf_join(const GltfParts *parts, const char *json, size_t json_size, size_t *size,
                   Error *err);

/* --- what the file says (gltf_read.c and others) ---------------------------------------------- */

typedef struct {
    char   name[128];      /* its own, else its mesh's */
    Affine world;
    size_t mesh;           /* SIZE_MAX: none */
    size_t light, camera;  /* likewise */
    bool   present;        /* part of the scene that is shown */
} GltfNode;

typedef struct {
    GltfNode *node;        /* [node_count] */
    size_t    node_count;
    Material *material;    /* [material_count]  names owned */
    bool     *image;       /* [material_count]  has an image of its colour */
    bool     *glow;        /* [material_count]  has an image of its emission */
    size_t    material_count;
    Light    *light;       /* [light_count]  in the world */
    size_t    light_count;
    Camera   *camera;      /* [camera_count]  in the world */
    size_t    camera_count;
    size_t    mesh_count;
    size_t   *first_primitive; /* [mesh_count + 1]  into `faces` */
    uint64_t *faces;       /* triangles that each primitive must have; points and lines: 0 */
    char     *reduced;     /* JSON for assimp; owned */
} Gltf;

/* Reads everything from the JSON text. owns  the caller frees with gltf_destroy. */
Gltf *gltf_read(const char *path, const char *json, size_t size, const Monitor *monitor,
                Error *err);
Gltf *gltf_destroy(Gltf *gltf);

/* Steps of gltf_read. All return whether there is no error. */
bool gltf_read_nodes(const GltfContext *c, const Json *root, Gltf *gltf);
bool gltf_read_materials(const GltfContext *c, const Json *root, Gltf *gltf);
bool gltf_read_lights(const GltfContext *c, const Json *root, Gltf *gltf);
bool gltf_read_cameras(const GltfContext *c, const Json *root, Gltf *gltf);
bool gltf_read_meshes(const GltfContext *c, const Json *root, Gltf *gltf);
/* The accessor of a primitive's normals; SIZE_MAX: none that can be used, which is told. */
size_t gltf_normals(const GltfContext *c, const Json *root, const Json *primitive,
                    const char *where);
bool gltf_reduce(const GltfContext *c, const Json *root, Gltf *gltf);

#endif
