/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/bvh.h -- a tree of boxes over triangles and shapes: nearest hit, and who sees whom.
 *
 * Knows    base/ and math/. Primitive i is the number i: no mesh, patch or material here.
 * Units    scene units; a hit's t counts in lengths of the ray's direction.
 * Method   build: binned surface-area heuristic [wald07], nodes of 8 children; triangle test:
 *          watertight [woop13]; shapes: exact, in double. Vertices are rounded to float.
 * Ties     the nearest hit wins; at exactly the same t one that faces the ray (its normal, from the
 *          triangle's winding, against the direction) before one that does not, then the smaller
 *          primitive. A facing hit behind one that does not face the ray wins too when rounding
 *          alone may have put it there: faces in one place, cut in different ways (best.h). The
 *          answer depends neither on the tree nor on the kernel.
 * NaN      a ray with a NaN or infinity in origin or direction misses everything; so does one
 *          without direction, or with an origin beyond 2^40.
 * Threads  a finished Bvh never changes: query it from any thread, without locks.
 */
#ifndef RAYCAST_BVH_H
#define RAYCAST_BVH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/shape.h"
#include "raycast/ray.h"

typedef struct {
    const Vec3     *position;       /* [vertex_count] */
    const uint32_t *corner;         /* [3 * triangle_count]  index into position */
    const Shape    *shape;          /* [shape_count] */
    uint32_t        vertex_count, triangle_count, shape_count;
} Primitives;

typedef struct Bvh Bvh;

/* A triangle without area is kept and never hit; no primitives at all make a valid, empty tree.
 * owns   the caller gets the tree; `primitives` is copied, not kept.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT for a corner out of range or a position not finite or
 *        beyond 2^40; ERROR_USAGE when ISOLUX_ISA names a kernel that is not there. */
Bvh *bvh_create(const Primitives *primitives, unsigned threads, Error *err);
Bvh *bvh_destroy(Bvh *bvh);

/* BVH_HIGH: triangles are cut where their boxes overlap [stich09], subtrees put where they cost
 * least [meister18]. It takes several times as long and pays when many rays follow. */
typedef enum { BVH_MEDIUM, BVH_HIGH } BvhQuality;

/* bvh_create makes trees of BVH_MEDIUM. Answers do not depend on the quality.
 * owns, fails  as bvh_create */
Bvh *bvh_create_as(const Primitives *primitives, BvhQuality quality, unsigned threads, Error *err);

/* The same primitives after they moved: other positions, shapes in other places, the corners'
 * numbers as they were. Answers are those of a new tree. The tree keeps its form, so it is made in
 * a fraction of the time, but rays take longer the more things have gone apart.
 * fails  false, and the tree is as before: as bvh_create; ERROR_INPUT when a triangle has an area
 *        that had none when the tree was made. No ray may be under way. */
bool bvh_refit(Bvh *bvh, const Primitives *moved, unsigned threads, Error *err);

typedef struct {
    uint64_t triangles, shapes, nodes, bytes;
    double   seconds; /* of the build, by the clock */
} BvhStats;

/* What the tree holds and takes; triangles without area count too. */
void bvh_stats(const Bvh *bvh, BvhStats *stats);

typedef struct {
    uint64_t nodes, triangles, shapes;
} BvhCost;

/* Adds to *cost what a ray meets on its way when it is traced alone, to the nearest hit or (`any`)
 * the first. Rays in company share nodes and meet fewer each. Slow: for measuring. */
void bvh_cost(const Bvh *bvh, const Ray *ray, bool any, BvhCost *cost);

/* The kernel that walks this tree: "avx512", "avx2", "sse4.2" or "scalar"; the best the processor
 * has, unless the environment variable ISOLUX_ISA named one when the tree was made. All answer
 * alike. */
const char *bvh_isa(const Bvh *bvh);

/* Nearest hit: true and *hit; else false and hit->primitive = RAY_MISS.
 * hot    checks nothing in release builds. */
bool bvh_nearest(const Bvh *bvh, const Ray *ray, Hit *hit);

/* Whether anything lies on the ray; stops at the first hit: cheaper.
 * hot    checks nothing in release builds. */
bool bvh_blocked(const Bvh *bvh, const Ray *ray);

/* The same for many rays at once. They are sorted by direction and origin in blocks of up to
 * BVH_BLOCK, so that those that go the same way are traced together: hand over the rays of a whole
 * tile of neighbouring patches, in their order, rather than patch by patch. Answers are in the
 * caller's order and do not depend on the grouping. A call borrows about 3 MB. */
#define BVH_BLOCK 65536u
void bvh_nearest_many(const Bvh *bvh, const Ray *ray, Hit *hit, size_t count);
void bvh_blocked_many(const Bvh *bvh, const Ray *ray, bool *blocked, size_t count);

/* The same for rays whose neighbours in the array already go nearly the same way, like those of a
 * picture's tile or towards one small lamp: nothing is sorted. */
void bvh_nearest_beam(const Bvh *bvh, const Ray *ray, Hit *hit, size_t count);
void bvh_blocked_beam(const Bvh *bvh, const Ray *ray, bool *blocked, size_t count);

/* --- trees in files -------------------------------------------------------------------------- */

/* Writes beside and renames: a reader sees the old file or the new one. The file is in this
 * machine's order of bytes and ends with a checksum.
 * fails  false and ERROR_FAILED or ERROR_MEMORY; what stood at `path` stays. */
bool bvh_save(const Bvh *bvh, const Primitives *primitives, const char *path, Error *err);

/* The tree of these primitives from a file: the one that was saved, bit for bit.
 * owns   the caller gets the tree.
 * fails  NULL; ERROR_MEMORY; ERROR_USAGE as bvh_create; ERROR_INPUT when the file cannot be read,
 *        is no tree, is of another version, was made from other primitives, or is damaged. */
Bvh *bvh_load(const char *path, const Primitives *primitives, Error *err);

/* The same from bytes that lie in memory; `name` stands in errors. */
Bvh *bvh_parse(const void *bytes, size_t size, const char *name, const Primitives *primitives,
               Error *err);

/* Invariants: boxes contain their children and primitives, each primitive is there exactly once;
 * in a tree of BVH_HIGH at least once, in boxes that together reach as far as it does. */
bool bvh_check(const Bvh *bvh);

/* Every primitive, no tree: what tests compare with. Same arithmetic per primitive, same ties. */
bool brute_nearest(const Primitives *primitives, const Ray *ray, Hit *hit);
bool brute_blocked(const Primitives *primitives, const Ray *ray);

#endif
