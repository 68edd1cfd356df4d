/* SPDX-License-Identifier: BSD-3-Clause */
/* How many nodes and triangles a ray visits alone. Kernels that trace rays together visit fewer a
 * ray, as they share. */
#include "bench/bench.h"

/* Not every ray: one in so many. */
enum { COUNT_STEP = 61 };

void rays_count(const Bvh *bvh, const RaySet *set, double *nodes, double *triangles)
{
    BvhCost cost = { 0 };
    uint32_t rays = 0;
    for (uint32_t i = 0; i < set->count; i += COUNT_STEP, rays++)
        bvh_cost(bvh, &set->ray[i], set->work == WORK_VISIBILITY, &cost);
    *nodes = (double)cost.nodes / rays;
    *triangles = (double)cost.triangles / rays;
}
