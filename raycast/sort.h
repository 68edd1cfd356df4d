/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/sort.h -- an order in which rays that go the same way are neighbours. */
#ifndef RAYCAST_SORT_H
#define RAYCAST_SORT_H

#include "raycast/internal.h"

#define SORT_MOST BVH_BLOCK

/* order[0..count-1] becomes a permutation of 0..count-1; count <= SORT_MOST. */
void rays_sort(const Bvh *bvh, const Ray *ray, size_t count, uint32_t *order);

#endif
