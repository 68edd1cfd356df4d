/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_internal.h -- what the steps of patches_create and patches_split hand to each other;
 * this folder only.
 *
 * A use is a piece of an edge of a surface between two welded vertices, run through from corner k
 * to the next: use 4 * i + k starts at corner k of surface i; where stitches lie on the edge it
 * ends at the first, and use 4 * surfaces + j starts at stitch j. A node is one side of a use, or
 * of the vertex it starts at: 2 * use + side.
 *
 * Blocks are what patches are numbered by: the cells of one side of a surface, or a merged patch.
 */
#ifndef MESH_PATCHES_INTERNAL_H
#define MESH_PATCHES_INTERNAL_H

#include <assert.h>

#include "mesh/edges.h"
#include "mesh/patches.h"

#define PATCH_NODE_NONE UINT32_MAX

typedef struct {
    const Surfaces *surfaces;
    const uint8_t  *sides;        /* as in PatchOptions; may be NULL */
    Patches        *out;
    Error          *err;
    /* order of patches */
    uint32_t       *cluster;      /* [2 * surfaces]  as merge_small gives it; NULL: none */
    uint32_t        cluster_count;
    uint32_t        block_count;
    uint32_t       *block;        /* [2 * surfaces]  2 * surface + side of a block's first piece */
    uint32_t       *block_merged; /* [2 * surfaces]  merged patch that it is, or PATCH_NONE */
    uint32_t        merged_count;
    uint32_t       *merged_first; /* [merged_count + 1] */
    uint32_t       *merged_piece; /* [merged_first[merged_count]]  surfaces */
    /* edges */
    uint32_t        use_count;    /* 4 * surfaces + stitches */
    uint32_t       *stitch_use;   /* [stitches]  use 4 * i + k of the edge a stitch lies on */
    Edges           edges;        /* of all uses of surfaces with a side in use */
    uint32_t       *from, *to;    /* [use_count]  welded ends of a use; equal: no such edge */
    uint32_t       *mate;         /* [use_count]  use that continues the surface smoothly */
    uint32_t       *point_first;  /* [2 * edges.count + 1]  by edge and patches_edge_class */
    double         *fraction;     /* [point_first[..]]  rising, from the smaller vertex */
    /* vertices */
    uint32_t       *parent;       /* [2 * use_count]  union-find over corner nodes */
    uint32_t       *corner_vertex;/* [2 * use_count]  of a corner node that is a root */
    uint32_t       *run;          /* [2 * use_count]  of a use node: first of its edge points */
    size_t          fraction_capacity, position_capacity, corner_capacity, along_capacity;
} PatchBuilder;

static inline unsigned patches_corners(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

static inline const Shape *patches_shape(const Surfaces *s, const Surface *f)
{
    return f->kind == SURFACE_SHAPE ? &s->shape[f->primitive - s->triangle_count] : NULL;
}

static inline bool patches_side_used(const PatchBuilder *b, uint32_t surface, unsigned side)
{
    return b->sides == NULL || (b->sides[surface] >> side & 1) != 0;
}

/* How many base cells a side of a surface has. */
static inline uint32_t patches_base_count(const Patches *p, const Surfaces *s, uint32_t surface)
{
    const uint32_t nu = p->nu[surface];
    return s->surface[surface].kind == SURFACE_TRIANGLE ? nu * nu : nu * p->nv[surface];
}

/* Base divisions of edge k. */
static inline uint32_t patches_edge_divisions(const Patches *p, uint32_t surface, unsigned k)
{
    return k % 2 == 0 ? p->nu[surface] : p->nv[surface];
}

static inline bool patches_is_merged(const Patches *p, uint32_t patch)
{
    return p->first_piece[patch + 1] > p->first_piece[patch];
}

/* The part of a cell that a patch is, or NULL. */
static inline const PatchPart *patches_part_of(const Patches *p, uint32_t patch)
{
    return p->part_of == NULL || p->part_of[patch] == PATCH_NONE ? NULL
                                                                 : &p->part[p->part_of[patch]];
}

/* Whether (s, t) runs clockwise seen from the side. Normals are defined by the solid, not by the
 * parameters: a disc's angle and radius turn the other way than its normal, and a mirroring map
 * turns any shape. */
static inline bool patches_turned(const Surfaces *s, const Surface *f, unsigned side)
{
    const Shape *shape = patches_shape(s, f);
    bool turned = side == 1;
    if (shape != NULL && (shape->kind == SHAPE_DISC) != (affine_determinant(&shape->to_world) < 0))
        turned = !turned;
    return turned;
}

/* --- cells (patches_tree.c) ------------------------------------------------------------------- */

static inline uint32_t patches_base_index(bool triangle, uint32_t nu, PatchCell c)
{
    return triangle ? nu * nu - (nu - c.j) * (nu - c.j) + 2 * c.i + c.upper : c.j * nu + c.i;
}

/* Base cell with this index. */
PatchCell patches_base_cell(bool triangle, uint32_t nu, uint32_t index);
/* Quarter q of a cell. */
PatchCell patches_cell_child(bool triangle, PatchCell cell, unsigned q);
/* The cell it is a quarter of; *q gets which. Not for base cells. */
PatchCell patches_cell_parent(bool triangle, PatchCell cell, unsigned *q);
/* Cell at interval m of edge k, where the cells of `level` are nu x nv. */
PatchCell patches_edge_cell(bool triangle, uint32_t nu, uint32_t nv, unsigned k, uint32_t m,
                            unsigned level);
/* Number of cells of a side of a surface, divided or not; parts count, not what is parted. */
uint32_t patches_side_cells(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side);
/* All of them, by number: cell [patches_side_cells]. */
void patches_fill_cells(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side,
                        PatchCell *cell);

/* The cells along edge k of a side, rising from corner k: each ends at `mark`, in units of
 * 1 / (divisions << PATCH_LEVELS) of the edge, and is `length` long. */
typedef bool (*PatchMark)(void *context, uint32_t mark, uint32_t length);
bool patches_edge_marks(const Patches *p, const Surfaces *s, uint32_t surface, unsigned side,
                        unsigned k, PatchMark mark, void *context);

/* --- steps ------------------------------------------------------------------------------------ */

/* patches_divide.c: fills out->nu, nv, size, and cluster. */
bool patches_divide(PatchBuilder *b, const PatchOptions *options, const Monitor *monitor);

/* patches.c: what is kept per surface; then, when nu, nv, tree, blocks and edges are known, all of
 * the rest. */
bool patches_allocate_surfaces(PatchBuilder *b);
bool patches_build(PatchBuilder *b);
void patches_builder_clear(PatchBuilder *b);

/* patches_edges.c: uses, edges, mates. */
bool patches_find_edges(PatchBuilder *b);
/* The edge a use lies on, as the use at its start: 4 * surface + k. */
static inline uint32_t patches_whole_use(const PatchBuilder *b, uint32_t use)
{
    const uint32_t whole = 4 * b->surfaces->count;
    return use < whole ? use : b->stitch_use[use - whole];
}
/* The use at whose start this one ends: along the same edge, or round the corner. */
uint32_t patches_next_use(const PatchBuilder *b, uint32_t use);
/* Where on its surface's edge a use starts and ends. */
void patches_use_span(const PatchBuilder *b, uint32_t use, double *start, double *end);
/* The side of the mate that continues `side`. */
static inline unsigned patches_mate_side(const PatchBuilder *b, uint32_t use, unsigned side)
{
    return b->from[use] != b->from[b->mate[use]] ? side : 1 - side;
}
/* Which of an edge's two lists of points a node takes: where no more than two surfaces meet, sides
 * that face the same room share one; else all share the first. */
unsigned patches_edge_class(const PatchBuilder *b, uint32_t use, unsigned side);
/* Node whose run holds the points of this use on this side. */
uint32_t patches_edge_owner(const PatchBuilder *b, uint32_t use, unsigned side);

/* patches_points.c: where vertices lie on edges. */
bool patches_find_points(PatchBuilder *b);

/* patches_vertices.c: vertices, those of edges shared where the surface is smooth. */
bool patches_start_vertices(PatchBuilder *b);
bool patches_add_vertex(PatchBuilder *b, Vec3 p, uint32_t *vertex);
/* Vertex at the start of a use. */
bool patches_corner_vertex(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *vertex);
/* First vertex of a use's points, in the order of the edge. */
bool patches_run_vertices(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *first);

/* patches_outline.c: all vertices round one side of a flat surface. */
typedef struct {
    uint32_t  first[5];   /* edge k: entries first[k] .. first[k + 1] - 1, both corners included */
    uint32_t *vertex;
    double   *fraction;   /* of the way along the edge */
    size_t    vertex_capacity, fraction_capacity;
} PatchOutline;
bool patches_outline(PatchBuilder *b, uint32_t surface, unsigned side, PatchOutline *outline);
/* Entry of edge k nearest to `fraction`. */
uint32_t patches_outline_entry(const PatchOutline *outline, unsigned k, double fraction);

/* patches_faces.c: corners of every face, and the vertices inside of surfaces. */
bool patches_make_faces(PatchBuilder *b);

/* patches_measure.c: areas, centres, normals. */
void patches_measure(PatchBuilder *b);

/* patches_part.c: makes parts of the cells that other surfaces part, each a patch, after all else
 * is there. When `old` was divided, *parent, [out->count], goes with the new patches, and each
 * patch of `old` stays the parent of one at least; they are put in the order of their parents. */
bool patches_part(PatchBuilder *b, const Patches *old, uint32_t **parent);

/* patches_part_cell.c: the parts of one cell. */
enum { PART_SLICERS = 24, PARTS_MOST = 32, PARTS_ROOM = 96 };
typedef struct {
    const Surfaces *surfaces;
    uint32_t  surface;
    PatchCell cell;
    double    nu, nv;              /* cells of its level */
    uint32_t  slicer[PART_SLICERS];
    uint32_t  slicers;
    PatchPart part[PARTS_ROOM];    /* share, box, place and signs are filled in */
    double    area[PARTS_ROOM];    /* relative to each other */
    double    widest[PARTS_ROOM];  /* scratch: share whose middle is the place */
    double    mean[PARTS_ROOM][2]; /* scratch: of a, b */
    uint32_t  parts;
} PartedCell;
/* Fills in all from `slicers` on, with surface and cell given; `kept` slicers, known to part what
 * the cell was a part of, are taken whenever they cross it. No parts: the cell is whole. */
void patches_part_cell(PartedCell *c, const uint32_t *kept, uint32_t kept_count);
/* Adds a part for a place that should have one: with the signs there, or, where another part has
 * these, with none that any place has. False: PARTS_ROOM are there. */
bool patches_part_add(PartedCell *c, double s, double t);
/* Place in the surface of (a, b) in a cell's square. */
void patches_cell_place(bool triangle, PatchCell cell, double nu, double nv, double a, double b,
                        double *s, double *t);

/* patches_balance.c: divides cells in out->tree, and more of them where balance asks for it. */
typedef struct {
    uint32_t  surface;
    PatchCell cell;
    uint8_t   side;
} PatchWish;

typedef struct {
    PatchBuilder  *b;
    const Patches *old;   /* its merged patches stay whole; numbers the cells divided here */
    PatchWish     *wish;  /* cells that must be there */
    size_t         wish_count, wish_capacity, tree_capacity;
} PatchForest;
bool patches_forest_divide(PatchForest *forest, uint32_t surface, unsigned side, PatchCell cell);

/* patches_merge.c: neighbours with like normals and the same material, grown to about `size`
 * across. cluster [2 * surfaces->count]: number of the cluster of (surface, side), at
 * 2 * surface + side, or PATCH_NONE: to be cut on a grid. Clusters have two or more pieces and are
 * numbered from 0 in the order of their first piece; only sides in use have one. */
bool merge_small(const Surfaces *surfaces, const PatchOptions *options, double size,
                 uint32_t *cluster, uint32_t *cluster_count, Error *err);
/* Parts of one cluster's pieces, piece [count] on `side`: part[k] gets 0 .. parts - 1, parts >= 2,
 * by place, of about equal area, connected where that can be. */
bool merge_split(const Surfaces *surfaces, unsigned side, const uint32_t *piece, uint32_t count,
                 uint32_t *part, uint32_t *parts, Error *err);

/* --- where (s, t) is (patches_query.c, patches_interpolate.c) --------------------------------- */

/* The part of a parted cell, given as a tree's leaf, that (s, t) belongs to, or NULL. */
const PatchPart *patches_part_at(const Patches *p, const Surfaces *surfaces, uint32_t surface,
                                 uint32_t leaf, double s, double t);

/* Cell of x in 0 .. n - 1; outside, the nearest one; a NaN gives 0. */
static inline uint32_t patches_cell_of(double x, uint32_t n)
{
    return !(x > 0) ? 0 : x < n ? (uint32_t)x : n - 1;
}

/* Walks down from a base cell; (*u, *v) is the place in the cell, before and after. */
static inline uint32_t patches_walk_quad(const uint32_t *tree, uint32_t node, double *u, double *v)
{
    while (node & PATCH_DIVIDED) {
        const double x = 2 * *u, y = 2 * *v;
        const uint32_t right = x >= 1, above = y >= 1;
        *u = x - right;
        *v = y - above;
        node = tree[(node & ~PATCH_DIVIDED) + 2 * above + right];
    }
    return node;
}

/* The same for triangles: (*u, *v) are the weights of the cell's corners 1 and 2. */
static inline uint32_t patches_walk_triangle(const uint32_t *tree, uint32_t node, bool upper,
                                             double *u, double *v)
{
    while (node & PATCH_DIVIDED) {
        const double x = 2 * *u, y = 2 * *v;
        uint32_t q;
        if (x >= 1) {
            q = 1;
            *u = x - 1;
            *v = y;
        } else if (y >= 1) {
            q = upper ? 0 : 2;
            *u = x;
            *v = y - 1;
        } else if (!(x + y > 1)) {
            q = upper ? 2 : 0;
            *u = x;
            *v = y;
        } else {
            q = 3;
            upper = !upper;
            *u = 1 - x;
            *v = 1 - y;
        }
        node = tree[(node & ~PATCH_DIVIDED) + q];
    }
    return node;
}

#endif
