/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/herd.h -- the nearest hits of rays that have little in common but kind and place.
 *
 * Included after crowd.h, whose way through the tree this is. A tree is walked once for 64 rays: a
 * node's boxes meet one ray after the other, and no branch depends on what a ray meets. The order
 * is the one each ray would take alone, by the signs of its direction. What lies behind a ray's hit
 * is not thrown away while it waits; the ray misses it when it is tested, one node further down.
 * Several herds go in turns, each asking for its next node or leaf before the others step: for one
 * alone memory would be too slow.
 */
#ifndef RAYCAST_HERD_H
#define RAYCAST_HERD_H

#include "raycast/crowd.h"

#define HERDS 8u /* four wait for memory where the tree is large, one does so longer */

typedef struct {
    Probe           probe[CROWD]; /* t_max: the limit of the best hit */
    Best            best[CROWD];
    const Ray      *ray;
    const uint32_t *order; /* places of the answers */
    unsigned        octant, count;
    uint32_t        top;
    uint64_t        rays[BVH_STACK];
    uint32_t        child[BVH_STACK];
} Herd;

ALWAYS_INLINE void herd_leaf(Herd *w, const Bvh *bvh, uint64_t rays, uint32_t leaf)
{
    if (!child_is_shape(leaf)) {
        const uint32_t first = child_group(leaf);
        groups_meet(&bvh->group[first], child_group_count(leaf), w->probe, w->best, rays,
                    first * GROUP_WIDTH);
        return;
    }
    for (; rays != 0; rays &= rays - 1) {
        const unsigned i = (unsigned)__builtin_ctzll(rays);
        if (leaf_trace(bvh, &w->ray[i], &w->probe[i], leaf, false, &w->best[i]))
            w->probe[i].t_max = w->best[i].limit;
    }
}

/* One node or leaf; false when nothing is left to visit. */
ALWAYS_INLINE bool herd_step(Herd *w, const Bvh *bvh)
{
    const uint32_t top = --w->top, child = w->child[top];
    const uint64_t rays = w->rays[top];
    if (child_is_leaf(child)) {
        herd_leaf(w, bvh, rays, child);
    } else {
        const Node *node = &bvh->node[child];
        Reach reach = reach_none();
        for (uint64_t left = rays; left != 0; left &= left - 1)
            reach_add(&reach, node, &w->probe[__builtin_ctzll(left)], w->octant, left & -left);
        w->top += reach_push(&reach, node, w->octant, w->rays + top, w->child + top);
    }
    if (w->top == 0)
        return false;
    child_prefetch(bvh, w->child[w->top - 1]);
    return true;
}

/* The herd of the next rays, as long as they are of one kind; false when none is left. */
ALWAYS_INLINE bool herd_start(Herd *w, const Bvh *bvh, const Ray *ray, const uint32_t *order,
                              size_t count, size_t *next, Hit *hit)
{
    for (; *next < count && !probe_takes(&ray[*next]); (*next)++)
        nearest_odd(bvh, &ray[*next], &hit[order[*next]]);
    if (*next == count)
        return false;
    w->ray = ray + *next;
    w->order = order + *next;
    const size_t most = count - *next < CROWD ? count - *next : CROWD;
    const unsigned kind = ray_kind(w->ray);
    unsigned n = 1;
    probe_init(&w->probe[0], w->ray, bvh->lo, bvh->hi);
    for (; n < most && probe_takes(&w->ray[n]) && ray_kind(&w->ray[n]) == kind; n++)
        crowd_probe(&w->probe[n], &w->ray[n], bvh, &w->probe[0]);
    for (unsigned i = 0; i < n; i++)
        w->best[i] = best_none(w->ray[i].t_max);
    w->octant = w->probe[0].octant;
    w->count = n;
    w->top = 1;
    w->child[0] = 0;
    w->rays[0] = ~UINT64_C(0) >> (CROWD - n);
    *next += n;
    return true;
}

ALWAYS_INLINE void herd_end(const Herd *w, const Bvh *bvh, Hit *hit)
{
    for (unsigned i = 0; i < w->count; i++) {
        const Best *best = &w->best[i];
        const Candidate *chosen = &best->first;
        if (__builtin_expect(best_is_open(best), 0))
            chosen = first_or_facing(bvh, &w->ray[i], &w->probe[i], best);
        best_to_hit(best, chosen, &hit[w->order[i]]);
    }
}

/* Answers to hit[order[i]]. */
static __attribute__((noinline)) void herds_nearest(const Bvh *bvh, const Ray *ray,
                                                    const uint32_t *order, size_t count, Hit *hit)
{
    Herd herd[HERDS];
    unsigned at[HERDS], walking = 0;
    size_t next = 0;
    for (; walking < HERDS; walking++) {
        if (!herd_start(&herd[walking], bvh, ray, order, count, &next, hit))
            break;
        at[walking] = walking;
    }
    while (walking > 0)
        for (unsigned i = 0; i < walking; i++) {
            Herd *w = &herd[at[i]];
            if (herd_step(w, bvh))
                continue;
            herd_end(w, bvh, hit);
            if (!herd_start(w, bvh, ray, order, count, &next, hit))
                at[i--] = at[--walking];
        }
}

#endif
