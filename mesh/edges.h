/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/edges.h -- which face edges lie between the same two vertices.
 *
 * A use is one edge of one face, from a vertex to a vertex; an edge gathers all uses between the
 * same pair, whatever their direction and however many. This folder only.
 */
#ifndef MESH_EDGES_H
#define MESH_EDGES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

#define EDGE_NONE UINT32_MAX

typedef struct {
    uint32_t  count;     /* edges */
    uint32_t  use_count;
    uint32_t *first;     /* [count + 1] */
    uint32_t *use;       /* [first[count]]  uses of each edge, rising */
    uint32_t *edge;      /* [use_count]  edge of a use, EDGE_NONE when it was left out */
} Edges;

/* A use with from == to is left out. Edges are in the order of (smaller, larger) vertex.
 * fails  false and ERROR_MEMORY; *edges is then empty. */
bool edges_create(Edges *edges, const uint32_t *from, const uint32_t *to, uint32_t use_count,
                  uint32_t vertex_count, Error *err);
/* Frees everything inside, leaves { 0 }. */
void edges_clear(Edges *edges);

/* Sorts n keys in rising order. */
void edges_sort_keys(uint64_t *key, uint32_t n);

#endif
