/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/build.h -- what the files that build a tree share: boxes, references, ranges.
 *
 * bvh_refs.c   primitives -> references (a box and a number), input checked
 * bvh_split.c  where to cut a range of references, and the cutting
 * bvh_top.c    the same for long ranges, by all threads
 * bvh_build.c  ranges -> nodes and groups, subtrees in parallel, all put together
 * pairs.h      the slower, better build
 * bvh_refit.c  new boxes for what has moved
 * bvh_file.c   a tree into a file and back
 */
#ifndef RAYCAST_BUILD_H
#define RAYCAST_BUILD_H

#include "base/parallel.h"
#include "raycast/internal.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* Four floats that compilers keep in one register; the fourth is of no meaning in a box. */
typedef float Float4 __attribute__((vector_size(16)));
typedef int32_t Int4 __attribute__((vector_size(16)));

static inline Float4 float4_min(Float4 a, Float4 b)
{
#ifdef __SSE2__
    return (Float4)_mm_min_ps((__m128)a, (__m128)b);
#else
    for (int k = 0; k < 4; k++)
        a[k] = a[k] < b[k] ? a[k] : b[k];
    return a;
#endif
}
static inline Float4 float4_max(Float4 a, Float4 b)
{
#ifdef __SSE2__
    return (Float4)_mm_max_ps((__m128)a, (__m128)b);
#else
    for (int k = 0; k < 4; k++)
        a[k] = a[k] > b[k] ? a[k] : b[k];
    return a;
#endif
}

typedef struct {
    Float4 lo, hi;
} Box;

static inline Box box_empty(void)
{
    const float inf = INFINITY;
    return (Box){ { inf, inf, inf, inf }, { -inf, -inf, -inf, -inf } };
}
static inline Box box_join(Box a, Box b)
{
    return (Box){ float4_min(a.lo, b.lo), float4_max(a.hi, b.hi) };
}
static inline Box box_point(Box a, Float4 p)
{
    return (Box){ float4_min(a.lo, p), float4_max(a.hi, p) };
}
/* Half the surface; 0 for the empty box. */
static inline float box_area(Box a)
{
    const Float4 d = a.hi - a.lo;
    return d[0] >= 0 ? d[0] * (d[1] + d[2]) + d[1] * d[2] : 0;
}

/* A primitive while the tree is built. */
typedef struct {
    float    lo[3];
    uint32_t primitive;
    float    hi[3];
    uint32_t unused; /* 0: both halves are loaded as Float4 */
} Ref;

static inline Box ref_box(const Ref *ref)
{
    Box box;
    __builtin_memcpy(&box.lo, ref->lo, sizeof box.lo);
    __builtin_memcpy(&box.hi, ref->hi, sizeof box.hi);
    return box;
}
/* Twice the middle of the box; the fourth number is 0. */
static inline Float4 box_centre(Box box)
{
    const Int4 three = { -1, -1, -1, 0 };
    return (Float4)((Int4)(box.lo + box.hi) & three);
}

static inline void node_set_box(Node *node, uint32_t slot, Box box)
{
    for (int k = 0; k < 3; k++) {
        node->plane[2 * k][slot] = box.lo[k];
        node->plane[2 * k + 1][slot] = box.hi[k];
    }
}

/* --- bvh_refs.c ------------------------------------------------------------------------------ */

/* References of all primitives but triangles without area, in order; *count of them.
 * owns   the caller frees with array_free.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT as bvh_create says. */
Ref *refs_create(const Primitives *in, unsigned threads, uint32_t *count, Error *err);

/* The box around a shape; false when it is not finite or reaches too far. */
bool shape_box(const Shape *shape, float lo[3], float hi[3]);

/* --- ranges ---------------------------------------------------------------------------------- */

typedef struct {
    int axis; /* SPLIT_HALVES: in the middle, no order; SPLIT_LATER: range_cut will decide, but it
                 is no leaf; SPLIT_NONE: a leaf */
    int      bin;   /* bins below this go to the left */
    uint32_t left;  /* how many references those are */
    Box      box[2]; /* around the primitives of either side; with SPLIT_HALVES of no meaning */
} Split;

#define SPLIT_HALVES (-1)
#define SPLIT_LATER (-2)
#define SPLIT_NONE (-3)

typedef struct {
    uint32_t begin, end;
    uint32_t depth;  /* cuts above it */
    uint32_t where;  /* which of the set's arrays holds it */
    Box      box;    /* around the primitives */
    Box      centre; /* around twice their middles */
    Split    split;  /* what to do with it */
} Range;

/* References in either of two arrays: a cut moves a range from one to the other. */
typedef struct {
    Ref      *ref[2];         /* both as long as the longest range */
    uint32_t  triangle_count; /* primitives from here on are shapes */
    bool      shapes;         /* whether there are any */
    unsigned  threads;        /* that take part in cuts of long ranges; 0: none does */
} RefSet;

/* What the primitives of a leaf cost: groups begun. */
static inline float groups_of(uint32_t count)
{
    return (float)((count + GROUP_WIDTH - 1) / GROUP_WIDTH);
}

/* A visit to a node costs about as much as one to a group of triangles (measured). */
#define COST_NODE 1.0f
/* Most references in a leaf. */
#define LEAF_REFS_MAX (LEAF_GROUPS_MAX * GROUP_WIDTH / 2)

/* --- bvh_split.c ----------------------------------------------------------------------------- */

#define BINS_MAX 16

typedef struct {
    Box      box[3][BINS_MAX];
    uint32_t count[3][BINS_MAX];
} Bins;

/* How middles are mapped to bins; an axis without extent has scale 0. */
typedef struct {
    Float4 lo, scale, last;
    int    bins;
} BinMap;

BinMap bin_map(const Range *r);

/* The bins along all axes of a thing whose box has this centre. */
static inline Int4 bin_of(const BinMap *map, Float4 centre)
{
    const Float4 at = float4_min((centre - map->lo) * map->scale, map->last);
    return __builtin_convertvector(at, Int4);
}

void bins_clear(Bins *bins, const BinMap *map);
void bins_join(Bins *bins, const Bins *other, const BinMap *map);
/* Clears them first. */
void bins_fill(Bins *bins, const BinMap *map, const Ref *ref, uint32_t count);
Split bins_split(const Bins *bins, const BinMap *map, float *cost);

/* Copies references to both sides, in order, and grows the boxes around twice their middles. */
void refs_scatter(const Ref *ref, uint32_t count, const BinMap *map, const Split *split, Ref *left,
                  Ref *right, Box centre[2]);

/* The whole of a set as a range, in array 0, not yet decided. */
Range range_all(const RefSet *set, uint32_t count);
/* Fills range->split. */
void range_decide(const RefSet *set, Range *range);
/* Carries out range->split: left keeps the lower half of the numbers; both are decided. The result
 * does not depend on the number of threads. */
bool range_cut(const RefSet *set, const Range *range, Range *left, Range *right, Error *err);

/* --- bvh_top.c ------------------------------------------------------------------------------- */

/* Ranges from here on are cut by all threads together. */
#define SPLIT_TOGETHER 32768u

/* Decides and moves to the other array; range->split.axis is SPLIT_HALVES after it when there is
 * no place to cut, and then nothing was moved. */
bool range_cut_together(const RefSet *set, Range *range, Box centre[2], Error *err);

/* --- bvh_build.c ----------------------------------------------------------------------------- */

/* Fills all corners of a group whose primitives stand in it. */
void group_fill(const Primitives *in, TriangleGroup *group);

/* Slots for children with these boxes, within `whole`: along a slot's diagonal (internal.h). */
void node_slots(Box whole, const Box *child, uint32_t count, uint32_t slot_of[NODE_WIDTH]);
void node_clear(Node *node);

/* One block for the tree's arrays; fills their addresses and counts, but nothing in them. */
bool tree_reserve(Bvh *bvh, size_t nodes, size_t groups, size_t shapes, Error *err);

/* Fills node, group, counts and memory of *bvh. Takes `ref` over and frees it. in->shape may be
 * NULL when something else than shapes has their numbers: then no rays may be asked. */
bool tree_build(Bvh *bvh, const Primitives *in, Ref *ref, uint32_t count, unsigned threads,
                Error *err);

#endif
