/* SPDX-License-Identifier: BSD-3-Clause */
/* app/nearest_face.h -- the nearest face of a solved mesh to a point, by a tree of boxes. */
#ifndef APP_NEAREST_FACE_H
#define APP_NEAREST_FACE_H

#include "app/ply_read.h"

typedef struct NearestFaces NearestFaces;

/* owns   the caller frees with nearest_faces_destroy; the mesh must outlive it.
 * fails  NULL and ERROR_MEMORY. */
NearestFaces *nearest_faces_create(const SolvedMesh *mesh, Error *err);
NearestFaces *nearest_faces_destroy(NearestFaces *faces);

typedef struct {
    uint32_t face;
    double   distance;
    Vec3     point;     /* on the face's triangles */
} NearestFace;

/* The nearest face of group `group` whose normal is within 60 degrees of `normal`, at
 * most `reach` away; of equals the first. False: there is none. */
bool nearest_face_find(const NearestFaces *faces, Vec3 point, Vec3 normal, uint32_t group,
                       double reach, NearestFace *out);

#endif
