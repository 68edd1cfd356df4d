/* SPDX-License-Identifier: BSD-3-Clause */
/* app/ply_read.h -- solved meshes read back from PLY, as isolux itself writes them; no others.
 *
 * Values a file may hold are checked, so that who reads on need not: indices in range, numbers
 * finite, areas not negative.
 */
#ifndef APP_PLY_READ_H
#define APP_PLY_READ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "app/ply_notes.h"

/* What stands in the header after each element's line, and so what its records hold; a face's list
 * of corners comes first. */
#define PLY_BANDS(name) "property float " name "_r\nproperty float " name "_g\n" \
                        "property float " name "_b\n"
#define PLY_FLOATS "property float x\nproperty float y\nproperty float z\n"
/* Where the scene lies far from the origin. */
#define PLY_DOUBLES "property double x\nproperty double y\nproperty double z\n"
#define PLY_VERTEX_LAYOUT "property uchar red\nproperty uchar green\nproperty uchar blue\n"   \
                          PLY_BANDS("radiosity") PLY_BANDS("irradiance")
#define PLY_FACE_LAYOUT "property int patch\nproperty int surface\nproperty int side\n"       \
                        "property int group\nproperty int material\nproperty float area\n"    \
                        "property float visible_area\n"                                       \
                        PLY_BANDS("radiosity") PLY_BANDS("irradiance") PLY_BANDS("reflectance")
/* Bytes of a vertex after its position, and of a face after its corners; where in them what is read
 * stands. */
enum {
    PLY_VERTEX_BYTES = 27, PLY_VERTEX_RADIOSITY = 3, PLY_VERTEX_IRRADIANCE = 15,
    PLY_FACE_BYTES = 64, PLY_FACE_PATCH = 0, PLY_FACE_SIDE = 8, PLY_FACE_GROUP = 12,
    PLY_FACE_MATERIAL = 16, PLY_FACE_AREA = 20, PLY_FACE_VISIBLE = 24, PLY_FACE_RADIOSITY = 28,
    PLY_FACE_IRRADIANCE = 40, PLY_FACE_REFLECTANCE = 52
};

typedef struct {
    uint32_t  vertex_count, face_count, group_count;
    Vec3     *position;       /* [vertex_count] */
    bool      far;            /* positions are doubles, for they are far from the origin */
    double   *radiosity, *irradiance; /* [3 * vertex_count] */
    uint32_t *first_corner;   /* [face_count + 1] */
    uint32_t *corner;         /* [first_corner[face_count]] */
    uint32_t *patch;          /* [face_count] */
    uint32_t *group;          /* [face_count]  < group_count */
    uint32_t *material;       /* [face_count]  of notes.material_name; unknown ones may occur */
    uint8_t  *side;           /* [face_count]  0 or 1 */
    double   *area;           /* [face_count]  visible */
    double   *whole_area;     /* [face_count]  all of it */
    double   *face_radiosity, *face_irradiance, *face_reflectance; /* [3 * face_count] */
    char    **group_name;     /* [group_count] */
    size_t    group_capacity;
    PlyNotes  notes;
} SolvedMesh;

/* *mesh starts as { 0 }.
 * fails  false; ERROR_INPUT, ERROR_MEMORY; solved_mesh_clear is due in any case. */
bool solved_mesh_read(SolvedMesh *mesh, const char *path, Error *err);
/* The same from bytes; `path` is for messages. */
bool solved_mesh_parse(SolvedMesh *mesh, const uint8_t *bytes, size_t size, const char *path,
                       Error *err);
/* Whether a file begins as isolux itself begins a solved mesh; not when it cannot be read. */
bool solved_mesh_is(const char *path);
/* Takes `by` from all positions. */
void solved_mesh_move(SolvedMesh *mesh, Vec3 by);
void solved_mesh_clear(SolvedMesh *mesh);

#endif
