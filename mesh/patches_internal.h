/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_internal.h -- what the steps of patches_create hand to each other; this folder only.
 *
 * A use is edge k of surface i: 4 * i + k, from corner k to the next. A node is one side of a use
 * or of a corner: 2 * (4 * i + k) + side.
 *
 * What later divisions need from here: the points of an edge are any rising list of fractions,
 * not only k / n, and polygons take whatever lies on their edges; a surface divided by a quadtree
 * only has to bring its own fractions and its own patches_at. A patch made of many small triangles
 * would keep `surface` as its first triangle, several surfaces' `first` would name it, and their
 * corner nodes already share vertices.
 */
#ifndef MESH_PATCHES_INTERNAL_H
#define MESH_PATCHES_INTERNAL_H

#include "mesh/edges.h"
#include "mesh/patches.h"

#define PATCH_NODE_NONE UINT32_MAX

typedef struct {
    const Surfaces *surfaces;
    const uint8_t  *sides;        /* as in PatchOptions; may be NULL */
    Patches        *out;
    Error          *err;
    Edges           edges;        /* of all uses of surfaces with a side in use */
    uint32_t       *from, *to;    /* [4 * surfaces]  welded ends of a use; equal: no such edge */
    uint32_t       *mate;         /* [4 * surfaces]  use that continues the surface smoothly */
    uint32_t       *point_first;  /* [edges.count + 1] */
    double         *fraction;     /* [point_first[edges.count]]  rising, from the smaller vertex */
    uint32_t       *parent;       /* [8 * surfaces]  union-find over corner nodes */
    uint32_t       *corner_vertex;/* [8 * surfaces]  of a corner node that is a root */
    uint32_t       *run;          /* [8 * surfaces]  of a use node: first of its edge points */
    size_t          fraction_capacity, position_capacity, corner_capacity;
} PatchBuilder;

static inline unsigned patches_corners(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

static inline bool patches_side_used(const PatchBuilder *b, uint32_t surface, unsigned side)
{
    return b->sides == NULL || (b->sides[surface] >> side & 1) != 0;
}

/* How many patches one side of a surface has. */
static inline uint32_t patches_of_side(const Patches *p, const Surfaces *s, uint32_t surface)
{
    const uint32_t nu = p->nu[surface];
    return s->surface[surface].kind == SURFACE_TRIANGLE ? nu * nu : nu * p->nv[surface];
}

/* Divisions of edge k. */
static inline uint32_t patches_edge_divisions(const PatchBuilder *b, uint32_t surface, unsigned k)
{
    return k % 2 == 0 ? b->out->nu[surface] : b->out->nv[surface];
}

/* patches_divide.c: fills out->nu, nv, size. */
bool patches_divide(PatchBuilder *b, const PatchOptions *options, const Monitor *monitor);

/* patches_edges.c: edges, mates, fractions. */
bool patches_find_edges(PatchBuilder *b);
/* Node whose run holds the points of this edge on this side. */
uint32_t patches_edge_owner(const PatchBuilder *b, uint32_t use, unsigned side);
/* Index among the edge's points of division m (0 < m < n) counted along the use. */
uint32_t patches_edge_point(const PatchBuilder *b, uint32_t use, uint32_t m, uint32_t n);

/* patches_vertices.c: vertices and the grid tables. */
bool patches_make_vertices(PatchBuilder *b);

/* patches_polygons.c: corners of every patch. */
bool patches_make_polygons(PatchBuilder *b);

/* patches_merge.c: neighbours with like normals and the same material, grown to about `size` across.
 * cluster [2 * surfaces->count]: number of the cluster of (surface, side), at 2 * surface + side, or
 * PATCH_NONE: to be cut on a grid. Clusters have two or more pieces and are numbered from 0 in the
 * order of their first piece; only sides in use have one. */
bool merge_small(const Surfaces *surfaces, const PatchOptions *options, double size,
                 uint32_t *cluster, uint32_t *cluster_count, Error *err);
/* Parts of one cluster's pieces, piece [count] on `side`: part[k] gets 0 .. parts - 1, parts >= 2,
 * by place, of about equal area, connected where that can be. */
bool merge_split(const Surfaces *surfaces, unsigned side, const uint32_t *piece, uint32_t count,
                 uint32_t *part, uint32_t *parts, Error *err);

/* patches_query.c: cell of a patch within its side. */
PatchCell patches_cell(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                       uint32_t index);

#endif
