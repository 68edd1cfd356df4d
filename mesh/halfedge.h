/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/halfedge.h -- a half-edge mesh of triangles, as plain C; OpenMesh is behind it.
 *
 * Connectivity only: no positions here. Triangles keep their numbers.
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

/* corner  [3 * triangle_count]  three different vertices each, < vertex_count. Windings should
 *         agree across edges: a triangle that does not fit is added with vertices of its own and
 *         marked.
 * refused [triangle_count]  set to 1 for those, else 0.
 * owns    the caller frees with halfedge_destroy.
 * fails   NULL; ERROR_MEMORY, ERROR_FAILED with what OpenMesh said. */
HalfEdges *halfedge_create(const uint32_t *corner, uint32_t triangle_count, uint32_t vertex_count,
                           uint8_t *refused, Error *err);
HalfEdges *halfedge_destroy(HalfEdges *mesh);

/* Triangle over the edge from corner k to corner k + 1 (mod 3), and the number of that edge there;
 * HALFEDGE_NONE at a rim. */
uint32_t halfedge_across(const HalfEdges *mesh, uint32_t triangle, unsigned k, unsigned *edge);

#ifdef __cplusplus
}
#endif

#endif
