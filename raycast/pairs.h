/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/pairs.h -- what the files of the slower, better build share: a tree of nodes in twos.
 *
 * bvh_chop.c      triangles cut by planes: both sides get a part of the box [stich09]
 * bvh_pairs.c     references -> a tree of pairs down to single references
 * bvh_reinsert.c  subtrees taken out and put where they cost less [meister18]
 * bvh_collapse.c  pairs -> nodes of 8 children and groups, at the least cost [ylitie17]
 */
#ifndef RAYCAST_PAIRS_H
#define RAYCAST_PAIRS_H

#include "raycast/build.h"

/* A node with two children, or one reference. */
typedef struct {
    float    lo[3];
    uint32_t left; /* a pair's number; of a reference: its primitive */
    float    hi[3];
    uint32_t right; /* of a reference: PAIR_ONE */
} Pair;

#define PAIR_ONE UINT32_MAX

/* Both ends lie in memory like a Ref's. */
static inline Box pair_box(const Pair *pair)
{
    Box box;
    __builtin_memcpy(&box.lo, pair->lo, sizeof box.lo);
    __builtin_memcpy(&box.hi, pair->hi, sizeof box.hi);
    return box;
}
static inline void pair_set_box(Pair *pair, Box box)
{
    __builtin_memcpy(pair->lo, &box.lo, sizeof pair->lo);
    __builtin_memcpy(pair->hi, &box.hi, sizeof pair->hi);
}
static inline bool pair_is_one(const Pair *pair) { return pair->right == PAIR_ONE; }

typedef struct {
    Pair    *pair;  /* [count]  pair[0] is the root; numbers between may be unused */
    uint32_t count;
    uint32_t refs;  /* references in it */
} Pairs;

/* --- bvh_chop.c ------------------------------------------------------------------------------ */

#define CHOP_BINS 16

typedef struct {
    Box      box[3][CHOP_BINS];
    uint32_t enter[3][CHOP_BINS], leave[3][CHOP_BINS]; /* where references begin and end */
} ChopBins;

/* Planes at equal distances across a box. */
typedef struct {
    Float4 lo, step, scale;
} ChopMap;

/* A plane across an axis, and what would lie on either side. */
typedef struct {
    int      axis; /* SPLIT_NONE: there is no such plane */
    float    plane;
    uint32_t count[2];
    Box      box[2];
    float    cost; /* as in bins_split */
} Chop;

/* Which side a reference goes to. */
enum { CHOP_LEFT, CHOP_RIGHT, CHOP_BOTH };

ChopMap chop_map(Box box);
void chops_clear(ChopBins *bins);
void chops_join(ChopBins *bins, const ChopBins *other);
void chops_fill(ChopBins *bins, const ChopMap *map, const Primitives *in, const Ref *ref,
                uint32_t count);
Chop chops_cheapest(const ChopBins *bins, const ChopMap *map);

/* Writes each reference's side into ref->unused; adds to how many references each side gets. */
void chop_sides(const Chop *chop, const Primitives *in, Ref *ref, uint32_t count,
                uint32_t sides[2]);
/* Writes the sides' references, cut, and grows the boxes around them and around twice their
 * middles. */
void chop_scatter(const Chop *chop, const Primitives *in, const Ref *ref, uint32_t count,
                  Ref *left, Ref *right, Box box[2], Box centre[2]);

/* --- the steps ------------------------------------------------------------------------------- */

/* Takes `ref` over and frees it. The same tree for any number of threads.
 * fails  false; ERROR_MEMORY. */
bool pairs_build(Pairs *pairs, const Primitives *in, Ref *ref, uint32_t count, unsigned threads,
                 Error *err);

bool pairs_reinsert(Pairs *pairs, unsigned threads, Error *err);

/* Fills node, group, counts and memory of *bvh. *deep: the tree would be deeper than BVH_DEPTH, and
 * nothing was filled. */
bool pairs_collapse(Bvh *bvh, const Pairs *pairs, const Primitives *in, unsigned threads,
                    bool *deep, Error *err);

#endif
