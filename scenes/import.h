/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import.h -- what the parts of the reader of foreign files share; this folder and tests.
 *
 * OBJ and PLY are read here, so that an error names its line or element and vertices stay as they
 * are in the file; all other formats pass through assimp in a child process, which hands what it
 * found back through a pipe. Whatever comes in goes through an ImportTarget.
 */
#ifndef SCENES_IMPORT_H
#define SCENES_IMPORT_H

#include "scenes/internal.h"
#include "scenes/pipe.h"
#include "scenes/text.h"

/* Greatest file that is read. */
static const size_t import_file_limit = (size_t)2 << 30;

/* Where polygons, lights and cameras go. */
typedef struct {
    Polygons               *soup;
    Scene                  *scene;      /* gets lights and cameras; NULL: not wanted */
    const char             *path;
    const SceneReadOptions *options;    /* not NULL */
    Affine                  map;        /* applied to positions */
    bool                    mirrored;   /* the map turns faces round: so does the target */
    bool                    replace;    /* every polygon gets `material`; none is added */
    uint32_t                material;
    uint32_t                plain;      /* the default material once it is needed, or UINT32_MAX */
    char                    stem[128];  /* group name of polygons in no group */
    uint64_t                hash;
    size_t                  faces;      /* polygons added by this file */
    uint64_t                loose;      /* points and lines that were ignored */
} ImportTarget;

/* All adders map positions, and return false with *err set when they fail. */
bool import_add_vertex(ImportTarget *target, Vec3 p, uint32_t *index, Error *err);
bool import_add_face(ImportTarget *target, uint32_t *corners, size_t count, uint32_t material,
                     uint32_t group, Error *err);
/* A face with what a file may give its corners besides their places. */
typedef struct {
    uint32_t   *corner;     /* [count]  may be turned round */
    size_t      count;
    uint32_t    material, group;
    const double (*uv)[2];  /* [count]  in the image of the material; NULL: none */
    const Vec3 *normal;     /* [count]  for shading, of any length, 0 0 0: none; NULL: none */
} ImportFace;
/* A quad on which (u, v) are bent becomes two triangles; on larger faces they are made linear. */
bool import_add_valued(ImportTarget *target, const ImportFace *face, Error *err);
bool import_add_group(ImportTarget *target, const char *name, uint32_t *index, Error *err);
/* Limits the material, adds it, or answers with the one that replaces all. */
bool import_add_material(ImportTarget *target, const Material *material, uint32_t *index,
                         Error *err);
/* The material of faces that have none: grey 0.5. */
bool import_plain_material(ImportTarget *target, uint32_t *index, Error *err);

/* Reads an OBJ file and its material libraries into the target. */
bool import_obj(ImportTarget *target, Error *err);
bool import_ply(ImportTarget *target, Error *err);
/* View3D's surfaces, F = 3 and 3a; front sides take part. */
bool import_vs3(ImportTarget *target, Error *err);

/* --- materials of OBJ (import_mtl.c) ---------------------------------------------------------- */

/* What a material library says of an image: its file, and (u, v) scaled and moved. */
typedef struct {
    char  *file;            /* NULL: none */
    double scale[2], offset[2];
    bool   clamp;
} MapImage;

typedef struct {
    MapImage colour, emission, cut;
    char    *path;          /* of the library: files are beside it */
} MaterialImages;

/* Materials of one or more libraries, by name; all fields are this struct's own. */
typedef struct {
    Material *material;     /* [count]  names owned */
    uint32_t *index;        /* [count]  in the soup once used, UINT32_MAX before */
    MaterialImages *images; /* [count]  names owned */
    size_t    count, capacity, index_capacity, images_capacity;
    uint32_t *slot;         /* [slots]  hash table of the names: 1 + position, 0: free */
    size_t    slots;        /* 0 or a power of two */
} MaterialLibrary;

/* --- images of materials (import_images.c) */

/* What follows map_Kd and its like. fails  false; ERROR_MEMORY. */
bool map_image_read(const TextFile *text, const char *line, MapImage *image, Error *err);
void material_images_clear(MaterialImages *images);
/* Reads the images into the target's scene and lets the material use them; one that is missing or
 * damaged is told. fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool import_images(ImportTarget *target, const MaterialImages *images, Material *material,
                   Error *err);

/* Adds what the file holds. fails  false and ERROR_INPUT when it cannot be read. */
bool import_mtl(MaterialLibrary *library, const char *path, uint64_t *hash, Error *err);
/* Position of the material, or SIZE_MAX. */
size_t library_find(const MaterialLibrary *library, const char *name);
/* Takes over a copy of `material` under that name; *at is its position. */
bool library_add(MaterialLibrary *library, const char *name, const Material *material, size_t *at,
                 Error *err);
void library_clear(MaterialLibrary *library);

/* --- the child (import_child.c, import_receive.c) --------------------------------------------- */

/* Runs in the child: does the dangerous work and writes records to `out`. */
typedef bool (*ImportWork)(const char *path, PipeWriter *out, Error *err);

/* Forks, lets the child do `work`, takes its records into the target. The child's death, its
 * running out of time or memory, and records that make no sense are ERROR_INPUT. */
bool import_from_child(ImportTarget *target, ImportWork work, Error *err);

/* The work for assimp (import_assimp.c). */
bool import_assimp(const char *path, PipeWriter *out, Error *err);

#endif
