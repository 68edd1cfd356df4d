/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/halfedge.h -- a half-edge mesh of polygons, as plain C; OpenMesh is behind it.
 *
 * Connectivity only: no positions here. A use is one edge of one face, numbered as the corner it
 * begins at: a face keeps its number and its uses keep theirs.
 * Threads  a finished mesh never changes.
 */
#ifndef MESH_HALFEDGE_H
#define MESH_HALFEDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

#define HALFEDGE_NONE UINT32_MAX

typedef struct HalfEdges HalfEdges;

/* first   [face_count + 1]  face i has corners first[i] .. first[i + 1] - 1, at least three, all
 *         different vertices; NULL: triangles, first[i] is 3 i.
 * corner  < vertex_count. Windings should agree across edges: a face that does not fit is added
 *         with vertices of its own and marked.
 * refused [face_count]  set to 1 for those, else 0.
 * owns    the caller frees with halfedge_destroy.
 * fails   NULL; ERROR_MEMORY, ERROR_FAILED with what OpenMesh said. */
HalfEdges *halfedge_create(const uint32_t *first, const uint32_t *corner, uint32_t face_count,
                           uint32_t vertex_count, uint8_t *refused, Error *err);
HalfEdges *halfedge_destroy(HalfEdges *mesh);

/* The use of the same edge in the face on the other side; HALFEDGE_NONE at a rim. */
uint32_t halfedge_across(const HalfEdges *mesh, uint32_t use);

#ifdef __cplusplus
}
#endif

#endif
