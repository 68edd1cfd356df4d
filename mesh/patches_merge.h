/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_merge.h -- what the steps of merge_small hand to each other; its files only.
 *
 * Lengths are in patch sizes, counted from the scene's least corner, and areas in squares of the
 * size, so that every limit is a plain number.
 */
#ifndef MESH_PATCHES_MERGE_H
#define MESH_PATCHES_MERGE_H

#include "mesh/patches_internal.h"

#define MERGE_NONE UINT32_MAX

/* Area that a cluster aims at: that of a square cell. */
static const double merge_area = 1;

/* Most area of a cluster: half more, so that what is left between others can be taken in. */
static const double merge_area_most = 1.5;

/* Most diagonal of a cluster's box. A square cell has sqrt 2, a strip four times as long as wide of
 * the same area sqrt(4 + 1/4): about what a bent or ragged piece needs, and no more. */
static const double merge_extent_most = 2;

/* ... or this many times its longest piece, where that is more: needles lie side by side. */
static const double merge_needle_most = 1.1;

/* Most diagonal of the box round a cluster's unit normals: the chord of 60 degrees, so that no two
 * normals are further apart and all are in a cone of half that, the crease angle, about. */
static const double merge_chord_most = 1;

/* A place and a normal in one point, so that both are limited and compared alike. */
enum { MERGE_PLACE = 3, MERGE_AXES = 6 };

typedef struct {
    float lo[MERGE_AXES], hi[MERGE_AXES];
    float longest;           /* diagonal of the greatest piece's box */
} MergeBox;

/* One surface's side that may be merged. */
typedef struct {
    float    at[MERGE_AXES]; /* centroid, unit normal out of the side */
    float    lo[MERGE_PLACE], hi[MERGE_PLACE];
    float    area;
    uint32_t class;          /* pieces of one cluster agree in it */
    uint32_t surface;
    uint32_t next[4];        /* piece of the same class over each edge, or MERGE_NONE */
} MergePiece;

typedef struct {
    double   area;
    double   moment[MERGE_AXES]; /* sum of area * at */
    MergeBox box;                /* of corners and normals */
    uint32_t class;
} MergeCluster;

typedef struct {
    const Surfaces *surfaces;
    const uint8_t  *sides;       /* as in PatchOptions */
    unsigned        side;
    MergePiece     *piece;       /* [count] */
    uint32_t        count;
    uint32_t       *local;       /* [surfaces->count]  piece of a surface, or MERGE_NONE */
    uint32_t       *cluster_of;  /* [count] */
    MergeCluster   *cluster;     /* [cluster_count], room for count; one without pieces: area 0 */
    uint32_t        cluster_count;
} Merge;

static inline bool merge_side_used(const Merge *m, uint32_t surface)
{
    return m->sides == NULL || (m->sides[surface] >> m->side & 1) != 0;
}

static inline void merge_box_add(MergeBox *box, const MergeBox *other)
{
    for (int k = 0; k < MERGE_AXES; k++) {
        /* never NaN, so quicker than fminf */
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
    box->longest = other->longest > box->longest ? other->longest : box->longest;
}

static inline MergeBox merge_piece_box(const MergePiece *piece)
{
    MergeBox box;
    float square = 0;
    for (int k = 0; k < MERGE_PLACE; k++) {
        const float d = piece->hi[k] - piece->lo[k];
        square += d * d;
        box.lo[k] = piece->lo[k];
        box.hi[k] = piece->hi[k];
        box.lo[MERGE_PLACE + k] = box.hi[MERGE_PLACE + k] = piece->at[MERGE_PLACE + k];
    }
    box.longest = sqrtf(square);
    return box;
}

/* Whether a box keeps the limits of place and of normals. */
static inline bool merge_box_fits(const MergeBox *box)
{
    double square[2] = { 0, 0 };
    for (int k = 0; k < MERGE_AXES; k++) {
        const double d = (double)box->hi[k] - box->lo[k];
        square[k / MERGE_PLACE] += d * d;
    }
    const double needle = merge_needle_most * box->longest;
    const double most = needle > merge_extent_most ? needle : merge_extent_most;
    return square[0] <= most * most && square[1] <= merge_chord_most * merge_chord_most;
}

/* patches_merge_edges.c: shared[i] bit k: edge k of surface i, or a piece of it between stitches,
 * is an edge of more than two surfaces. fails  false and ERROR_MEMORY. */
bool merge_shared_edges(const Surfaces *surfaces, uint8_t *shared, Error *err);

/* patches_merge_grow.c: a heap of keys, the least on top; the caller has the room. */
void merge_heap_push(uint64_t *heap, uint32_t *count, uint64_t key);
uint64_t merge_heap_pop(uint64_t *heap, uint32_t *count);

/* patches_merge_grow.c: clusters over neighbours. fails  false and ERROR_MEMORY. */
bool merge_grow(Merge *m, Error *err);

/* patches_merge_relax.c: pieces at borders go to the nearer cluster, small clusters to neighbours
 * with like normals. */
bool merge_relax(Merge *m, Error *err);

/* patches_merge_join.c: small clusters to others nearby with like normals that options->joined
 * finds a way to. fails  false and ERROR_MEMORY. */
bool merge_join(Merge *m, const PatchOptions *options, Error *err);

#endif
