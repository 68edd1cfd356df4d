/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/trace.h -- the walk through the tree, compiled once per instruction set.
 *
 * The file that includes this defines before:
 *   node_push      tests a node's boxes; *next is the first child to visit or CHILD_NONE; of the
 *                  others that are hit, writes the nearer end and the reference to near[] and
 *                  child[], far ones first, and returns how many; may write 8 of each; with `any`,
 *                  where nothing that is met cuts off the rest, near[] may be left out
 *   groups_test    offers the triangles of `count` groups, the first at `place`, to *best, as
 *                  probe_lane would each of them; whether one was taken; with `any` it may stop
 *                  at the first, and only best_found counts afterwards
 * and calls KERNEL_TABLE after.
 */
#include "raycast/probe.h"

ALWAYS_INLINE bool leaf_trace(const Bvh *bvh, const Ray *ray, const Probe *p, uint32_t leaf,
                              bool any, Best *best)
{
    if (child_is_shape(leaf)) {
        const uint32_t i = child_shape_index(leaf);
        return probe_shape(ray, p, &bvh->shape[i], bvh->triangle_count + i, any, best);
    }
    const uint32_t first = child_group(leaf);
    return groups_test(&bvh->group[first], child_group_count(leaf), p, first * GROUP_WIDTH, any,
                       best);
}

/* The subtree below `c`: improves *best, or with `any` stops at the first hit that turns up. */
ALWAYS_INLINE void tree_walk(const Bvh *bvh, const Ray *ray, const Probe *p, uint32_t c, bool any,
                             Best *best)
{
    float near[BVH_STACK];
    uint32_t child[BVH_STACK], top = 0;
    for (;;) {
        while (!child_is_leaf(c))
            top += node_push(&bvh->node[c], p, best->limit, any, near + top, child + top,
                             &c);
        if (c != CHILD_NONE && leaf_trace(bvh, ray, p, c, any, best) && any)
            return;
        /* Not >=: an equally near hit that comes before may be in there. */
        do {
            if (top == 0)
                return;
            top--;
        } while (!any && near[top] > best->limit);
        c = child[top];
    }
}

/* A face that looks away was hit first, one that faces the ray behind it: rare. */
static __attribute__((noinline, cold)) const Candidate *
first_or_facing(const Bvh *bvh, const Ray *ray, const Probe *p, const Best *best)
{
    const uint32_t primitive = best->first.key & ~BEST_BACK, lane = best->first.place % GROUP_WIDTH;
    if (primitive >= bvh->triangle_count) {
        const Shape *shape = &bvh->shape[primitive - bvh->triangle_count];
        return best_choose(best, p, ray, shape_normal(shape, (double)best->first.u,
                                                      (double)best->first.v));
    }
    const TriangleGroup *group = &bvh->group[best->first.place / GROUP_WIDTH];
    float corner[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            corner[i][k] = group->vertex[i][k][lane];
    return best_choose(best, p, ray, probe_normal(corner[0], corner[1], corner[2]));
}

static bool nearest_odd(const Bvh *bvh, const Ray *ray, Hit *hit);

static inline bool nearest_one(const Bvh *bvh, const Ray *ray, Hit *hit)
{
    if (__builtin_expect(!probe_takes(ray), 0))
        return nearest_odd(bvh, ray, hit);
    Probe p;
    probe_init(&p, ray, bvh->lo, bvh->hi);
    Best best = best_none(ray->t_max);
    tree_walk(bvh, ray, &p, 0, false, &best);
    const Candidate *chosen = &best.first;
    if (__builtin_expect(best_is_open(&best), 0))
        chosen = first_or_facing(bvh, ray, &p, &best);
    return best_to_hit(&best, chosen, hit);
}

/* Kept out of the way of the usual rays. */
static __attribute__((noinline, cold)) bool nearest_odd(const Bvh *bvh, const Ray *ray, Hit *hit)
{
    Ray scaled;
    int exponent;
    *hit = (Hit){ .t = ray->t_max, .primitive = RAY_MISS };
    return ray_rescale(ray, &scaled, &exponent) && nearest_one(bvh, &scaled, hit)
           && hit_rescale(hit, exponent);
}

static inline bool blocked_one(const Bvh *bvh, const Ray *ray)
{
    Hit hit;
    if (__builtin_expect(!probe_takes(ray), 0))
        return nearest_odd(bvh, ray, &hit);
    Probe p;
    probe_init(&p, ray, bvh->lo, bvh->hi);
    Best best = best_none(ray->t_max);
    tree_walk(bvh, ray, &p, 0, true, &best);
    return best_found(&best);
}

static bool trace_nearest(const Bvh *bvh, const Ray *ray, Hit *hit)
{
    return nearest_one(bvh, ray, hit);
}

static bool trace_blocked(const Bvh *bvh, const Ray *ray)
{
    return blocked_one(bvh, ray);
}

/* Ray by ray; kernels with packets do not use these. */
static inline void singles_nearest(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                   size_t count, Hit *hit)
{
    for (size_t i = 0; i < count; i++)
        nearest_one(bvh, &ray[i], &hit[order != NULL ? order[i] : i]);

}

static inline void singles_blocked(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                   size_t count, bool *blocked)
{
    for (size_t i = 0; i < count; i++)
        blocked[order != NULL ? order[i] : i] = blocked_one(bvh, &ray[i]);

}

#define KERNEL_TABLE(isa, nearest_rays, blocked_rays, ray_keys, nearest_alone, blocked_alone)   \
    { .name = isa, .nearest = trace_nearest, .blocked = trace_blocked,                          \
      .nearest_many = nearest_rays, .blocked_many = blocked_rays, .keys = ray_keys,       \
      .nearest_apart = nearest_alone, .blocked_apart = blocked_alone }
