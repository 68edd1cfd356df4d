/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/internal.h -- how a tree lies in memory, and the table of kernels that walk it.
 *
 * A node has up to 8 children, coordinate by coordinate, so that one AVX instruction treats all.
 * A child is a 32-bit reference: two bits of kind, then a node, 1..8 groups of triangles, or one
 * shape. Triangles lie in groups of 4 with their own copy of the vertices in float: all triangles
 * that share a vertex round it alike, so closed meshes stay closed.
 *
 * Order    slot s of a node is for the child that lies, seen from the node's middle, on the low
 *          side along axis k when bit k of s is set. A ray whose direction has the signs `octant`
 *          takes the slots 7 ^ octant, 6 ^ octant, ... 0 ^ octant: near ones first, without
 *          sorting [ylitie17].
 * Depth    at most BVH_DEPTH levels (bvh_split.c), so a stack of BVH_STACK entries never overflows.
 */
#ifndef RAYCAST_INTERNAL_H
#define RAYCAST_INTERNAL_H

#include "raycast/bvh.h"

/* Copies of a walk for each value of a constant are wanted, so inlining is not left to the
 * compiler; but where a sanitizer's checks are in each step, that takes it minutes. Clang tells of
 * them by a feature, which other compilers cannot be asked for. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define RAYCAST_CHECKED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(RAYCAST_CHECKED)
#define ALWAYS_INLINE static inline
#else
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#endif

#define NODE_WIDTH 8u
#define GROUP_WIDTH 4u
#define LEAF_GROUPS_MAX 8u

typedef struct {
    float    plane[6][NODE_WIDTH]; /* lo x, hi x, lo y, hi y, lo z, hi z; unused slot: +inf, -inf */
    uint32_t child[NODE_WIDTH];    /* references; unused slot: CHILD_NONE */
} Node;

typedef struct {
    float    vertex[3][3][GROUP_WIDTH]; /* corner, axis, lane */
    uint32_t primitive[GROUP_WIDTH];    /* unused lane: RAY_MISS */
} TriangleGroup;

/* Primitive numbers stay below 2^31: the sign bit marks the unused lanes of a group. */
#define PRIMITIVES_MAX (UINT32_C(1) << 31)

/* --- references to children ------------------------------------------------------------------ */

#define CHILD_NONE UINT32_MAX
#define CHILD_LEAF (UINT32_C(1) << 31)
#define CHILD_SHAPE (UINT32_C(3) << 30)
#define CHILD_INDEX_MAX ((UINT32_C(1) << 27) - 2) /* groups or shapes in one tree */

static inline uint32_t child_triangles(uint32_t first_group, uint32_t groups)
{
    return CHILD_LEAF | (groups - 1) << 27 | first_group;
}
static inline uint32_t child_shape(uint32_t shape) { return CHILD_SHAPE | shape; }
static inline bool child_is_leaf(uint32_t child) { return (child & CHILD_LEAF) != 0; }
static inline bool child_is_shape(uint32_t child) { return child >> 30 == 3; }
static inline uint32_t child_group(uint32_t child) { return child & ((UINT32_C(1) << 27) - 1); }
static inline uint32_t child_group_count(uint32_t child) { return (child >> 27 & 7) + 1; }
static inline uint32_t child_shape_index(uint32_t child) { return child & ~CHILD_SHAPE; }

/* --- the tree -------------------------------------------------------------------------------- */

/* Free choice of the split for the first 32 levels, halves after that: 2^32 primitives fit. Each
 * level leaves at most 7 more entries behind; a node may write 8 before it counts. */
#define BVH_DEPTH_FREE 32u
#define BVH_DEPTH (BVH_DEPTH_FREE + 32u)
#define BVH_STACK (BVH_DEPTH * (NODE_WIDTH - 1) + NODE_WIDTH + 1)

typedef struct Cells Cells; /* sort.h */

typedef struct {
    const char *name;
    bool (*nearest)(const Bvh *bvh, const Ray *ray, Hit *hit);
    bool (*blocked)(const Bvh *bvh, const Ray *ray);
    /* The answer of ray[i] goes to place order[i], or i when `order` is NULL. */
    void (*nearest_many)(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                         Hit *hit);
    void (*blocked_many)(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                         bool *blocked);
    /* The same for rays that have nothing in common. */
    void (*nearest_apart)(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                          Hit *hit);
    void (*blocked_apart)(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                          bool *blocked);
    /* Of rays to be sorted; NULL: the calls above do not gain when neighbours are alike. */
    void (*keys)(const Cells *cells, const Ray *ray, size_t count, uint32_t *key);
} Kernel;

struct Bvh {
    Node          *node;  /* [node_count]  node[0] is the root */
    TriangleGroup *group; /* [group_count] */
    Shape         *shape; /* [shape_count] */
    const Kernel  *kernel;
    float          lo[3], hi[3]; /* box around everything; all 0 when there is nothing */
    uint32_t       node_count, group_count, shape_count, triangle_count;
    uint32_t       flat_count; /* triangles without area: they are not in the tree */
    bool           cut;        /* a triangle may be in several leaves, in each box a part of it */
    void          *memory;     /* the one block that holds node, group and shape */
    size_t         bytes;
    double         seconds;
};

extern const Kernel kernel_scalar;
#if defined(__SSE2__) && !defined(ISOLUX_SCALAR)
#define ISOLUX_X86 1
extern const Kernel kernel_sse42;
extern const Kernel kernel_avx2;
extern const Kernel kernel_avx512;
#endif

/* The best for this processor, or the one ISOLUX_ISA names; NULL and ERROR_USAGE: not there. */
const Kernel *kernel_choose(Error *err);

#endif
