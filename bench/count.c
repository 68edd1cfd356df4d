/* SPDX-License-Identifier: BSD-3-Clause */
/* How many nodes and triangles a ray visits: the scalar walk once more, counting. Kernels that
 * trace rays together visit fewer a ray, as they share. */
#include "bench/bench.h"
#include "raycast/internal.h"
#include "raycast/single_scalar.h"

/* Not every ray: one in so many. */
enum { COUNT_STEP = 61 };

static struct {
    uint64_t nodes, triangles;
} counted;

static inline uint32_t node_push(const Node *node, const Probe *p, float t_limit, bool any,
                                 float *near, uint32_t *child, uint32_t *next)
{
    counted.nodes++;
    return scalar_push(node, p, t_limit, any, near, child, next);
}

static inline bool groups_test(const TriangleGroup *group, uint32_t count, const Probe *p,
                               uint32_t place, bool any, Best *best)
{
    for (uint32_t g = 0; g < count; g++)
        for (uint32_t i = 0; i < GROUP_WIDTH; i++)
            counted.triangles += group[g].primitive[i] != RAY_MISS;
    return scalar_groups(group, count, p, place, any, best);
}

#include "raycast/trace.h"

static const Kernel counting = KERNEL_TABLE("counting", singles_nearest, singles_blocked, NULL,
                                            singles_nearest, singles_blocked);

void rays_count(const Bvh *bvh, const RaySet *set, double *nodes, double *triangles)
{
    uint32_t rays = 0;
    counted.nodes = counted.triangles = 0;
    for (uint32_t i = 0; i < set->count; i += COUNT_STEP, rays++) {
        Hit hit;
        if (set->work == WORK_VISIBILITY)
            counting.blocked(bvh, &set->ray[i]);
        else
            counting.nearest(bvh, &set->ray[i], &hit);
    }
    *nodes = (double)counted.nodes / rays;
    *triangles = (double)counted.triangles / rays;
}
