/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/internal.h -- what the searches of inspect share; this folder only. */
#ifndef INSPECT_INTERNAL_H
#define INSPECT_INTERNAL_H

#include "inspect/inspect.h"

/* --- boxes.c: a tree of boxes, for neighbours and for rays that count all they pass ----------- */

typedef struct {
    float lo[3], hi[3];
} Box;

typedef struct {
    Box      box;
    float    size;      /* box_size of the largest below */
    uint32_t first;     /* leaf: first entry; else the left child, the right one follows it */
    uint32_t count;     /* entries of a leaf; 0: inner node */
} BoxNode;

typedef struct {
    Box      box;
    uint32_t item;
} BoxEntry;

typedef struct {
    BoxNode  *node;     /* [node_count]  the first is the root */
    uint32_t  node_count;
    BoxEntry *entry;    /* [count] */
    uint32_t  count;
} BoxTree;

/* A box that holds lo..hi, rounded outwards. */
Box box_around(Vec3 lo, Vec3 hi);
/* Length of its longest edge. */
float box_size(const Box *box);

/* Puts item k into the tree for each entry k, whose boxes are filled in already; takes over the
 * array, also on failure.
 * fails  false and ERROR_MEMORY. */
bool box_tree_create(BoxTree *tree, BoxEntry *entry, uint32_t count, Error *err);
void box_tree_clear(BoxTree *tree);

/* Entries whose boxes meet `box` and are at least as large as `least`, at most `most` of them;
 * returns how many there are, or most + 1 when there are more. */
uint32_t box_tree_meet(const BoxTree *tree, const Box *box, float least, uint32_t *at,
                       uint32_t most);
/* Entries whose boxes the ray from `origin` to origin + reach * direction meets, likewise. No
 * component of direction may be 0. */
uint32_t box_tree_pierce(const BoxTree *tree, Vec3 origin, Vec3 direction, double reach,
                         uint32_t *at, uint32_t most);

/* --- pair.c: two triangles -------------------------------------------------------------------- */

typedef struct {
    Vec3            p[3];
    const uint32_t *corner;  /* [3]  numbers of the vertices: equal ones are shared */
    Vec3            normal;  /* unit; only after triangle_plane */
    double          tolerance;
} Triangle;

Triangle triangle_get(const Surfaces *surfaces, uint32_t k);
/* Its normal; false when it is thinner than the tolerance: its plane would mean nothing. */
bool triangle_plane(Triangle *t);
Box  triangle_box(const Triangle *t);
/* Whether b lies on one side of a's plane, or off it, by more than the tolerance: quick. */
bool triangle_clear(const Triangle *a, const Triangle *b);

typedef enum { PAIR_APART, PAIR_CROSSING, PAIR_OVERLAP } PairKind;

typedef struct {
    PairKind kind;
    Vec3     at;      /* in the middle of what is common */
    double   depth;   /* how far one would have to move, at least about */
} Pair;

/* How two triangles with their planes meet, when they do by more than the tolerance; `a` should be
 * the smaller. */
Pair pair_find(const Triangle *a, const Triangle *b);

/* --- the searches ----------------------------------------------------------------------------- */

typedef struct {
    const Surfaces       *surfaces;
    const InspectOptions *options;
    const Monitor        *monitor;
    Defects              *defects;
    Inspection           *out;
    BoxTree               tree;     /* over the triangles */
    bool                  sighted;  /* sides tell more than that there is no light */
    Error                *err;
} Inspector;

/* How far apart two points that lie at most that far from the origin may be and mean one: each of
 * them is off by rounding. */
double inspect_tolerance(double largest_coordinate);

/* Vertex of corner k (0..2; of quads 0..3) of a surface. */
uint32_t inspect_corner(const Surfaces *surfaces, uint32_t surface, unsigned k);

/* rims.c: open edges and their chains. */
bool inspect_rims(Inspector *in);
/* crossings.c: pairs of faces. */
bool inspect_crossings(Inspector *in);
/* parts.c: what parts there are, and those inside of others. */
bool inspect_parts(Inspector *in);

#endif
