/* SPDX-License-Identifier: BSD-3-Clause */
/* What a ray costs: the scalar walk once more, counting. */
#include <assert.h>

#include "raycast/single_scalar.h"

/* Offers the triangles or the shape of a leaf; whether there was a hit. */
static bool leaf_count(const Bvh *bvh, const Ray *ray, const Probe *p, uint32_t leaf, bool any,
                       Best *best, BvhCost *cost)
{
    if (child_is_shape(leaf)) {
        const uint32_t i = child_shape_index(leaf);
        cost->shapes++;
        return probe_shape(ray, p, &bvh->shape[i], bvh->triangle_count + i, false, best);
    }
    bool found = false;
    const uint32_t first = child_group(leaf);
    for (uint32_t g = first; g < first + child_group_count(leaf) && !(any && found); g++) {
        for (uint32_t i = 0; i < GROUP_WIDTH; i++)
            cost->triangles += bvh->group[g].primitive[i] != RAY_MISS;
        found |= scalar_group(&bvh->group[g], p, g * GROUP_WIDTH, best);
    }
    return found;
}

void bvh_cost(const Bvh *bvh, const Ray *ray, bool any, BvhCost *cost)
{
    assert(bvh != NULL && ray != NULL && cost != NULL);
    Ray scaled = *ray;
    int exponent;
    if (!probe_takes(ray) && !ray_rescale(ray, &scaled, &exponent))
        return;
    Probe p;
    probe_init(&p, &scaled, bvh->lo, bvh->hi);
    Best best = best_none(scaled.t_max);
    float near[BVH_STACK];
    uint32_t child[BVH_STACK], top = 0, c = 0;
    for (;;) {
        while (!child_is_leaf(c)) {
            cost->nodes++;
            top += scalar_push(&bvh->node[c], &p, best.limit, any, near + top, child + top, &c);
        }
        if (c != CHILD_NONE && leaf_count(bvh, &scaled, &p, c, any, &best, cost) && any)
            return;
        do {
            if (top == 0)
                return;
            top--;
        } while (near[top] > best.limit);
        c = child[top];
    }
}
