/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/instances.h -- trees in many places: a tree over affine copies of trees.
 *
 * A copy costs about 210 bytes however many triangles its tree has, so 10^9 triangles fit.
 * Method   a ray goes to the copies whose boxes it passes, nearest entry first, in each as a ray of
 *          that copy's own space; an affine map leaves t as it is. In the calls for many rays,
 *          those that have come to one copy go through it together.
 * Ties     within a copy as in bvh.h; of hits in two copies the nearer, at exactly the same t that
 *          of the smaller number. The answer does not depend on the tree or on the grouping.
 * Limits   the ray is rounded to float once in each copy's space: within a copy meshes stay closed;
 *          between two copies that touch, a ray may pass or hit both, as with rounded vertices.
 * Threads  as bvh.h: finished, it never changes.
 */
#ifndef RAYCAST_INSTANCES_H
#define RAYCAST_INSTANCES_H

#include "math/affine.h"
#include "raycast/bvh.h"

typedef struct {
    const Bvh *bvh; /* kept, not copied: it must live as long */
    Affine     to_world;
} Instance;

typedef struct {
    Hit      hit;      /* t along the ray as it was given; the rest as the copy's tree says it */
    uint32_t instance; /* RAY_MISS: nothing was hit */
} InstanceHit;

typedef struct Instances Instances;

/* owns   the caller gets it; `instance` is copied, the trees are not.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT when a map has no inverse or a copy reaches beyond
 *        2^40. */
Instances *instances_create(const Instance *instance, uint32_t count, unsigned threads,
                            Error *err);
Instances *instances_destroy(Instances *instances);

typedef struct {
    uint64_t instances, triangles; /* all copies' together */
    uint64_t bytes;                /* without the trees that are copied */
} InstancesStats;
void instances_stats(const Instances *instances, InstancesStats *stats);

/* Corners of the box around everything; both 0 when there is nothing. */
void instances_bounds(const Instances *instances, Vec3 *lo, Vec3 *hi);

/* A normal of the copy's own space, as one of the world; not of unit length. */
Vec3 instances_normal(const Instances *instances, uint32_t instance, Vec3 normal);

/* Nearest hit: true and *hit; else false and both numbers are RAY_MISS. */
bool instances_nearest(const Instances *instances, const Ray *ray, InstanceHit *hit);
bool instances_blocked(const Instances *instances, const Ray *ray);

/* For many rays, sorted or, with `beam`, already in a good order (bvh.h).
 * fails  false and ERROR_MEMORY. */
bool instances_nearest_many(const Instances *instances, const Ray *ray, InstanceHit *hit,
                            size_t count, bool beam, Error *err);
bool instances_blocked_many(const Instances *instances, const Ray *ray, bool *blocked,
                            size_t count, bool beam, Error *err);

#endif
