/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/stream.h -- several rays on their way at once, each alone.
 *
 * Included after trace.h. A ray takes one step, a node or a leaf, asks for the memory of its next
 * one, and then the others take theirs: while one ray's next node comes from memory, the others
 * have work. Each ray does what it would do by itself, so the answers are the same.
 */
#ifndef RAYCAST_STREAM_H
#define RAYCAST_STREAM_H

#define STREAM_RAYS 16u

typedef struct {
    const Ray *ray;
    uint32_t   at; /* number of the ray, for its answer */
    uint32_t   c, top;
    Probe      probe;
    Best       best;
    float      near[BVH_STACK + STREAM_RAYS]; /* as many may be there from the start: packet.h */
    uint32_t   child[BVH_STACK + STREAM_RAYS];
} Walker;

/* Of a leaf the first two groups: few have more. */
ALWAYS_INLINE void child_prefetch(const Bvh *bvh, uint32_t child)
{
    const char *at = child_is_leaf(child) ? (const char *)&bvh->group[child_group(child)]
                                          : (const char *)&bvh->node[child];
    for (size_t line = 0; line < 2 * sizeof(TriangleGroup); line += 64)
        __builtin_prefetch(at + line);
}

/* The nearest of what is left to visit; false when there is nothing. */
ALWAYS_INLINE bool walker_pop(Walker *w, const Bvh *bvh, bool any)
{
    /* Not >=: an equally near hit that comes before may be in there. */
    do {
        if (w->top == 0)
            return false;
        w->top--;
    } while (!any && w->near[w->top] > w->best.limit);
    w->c = w->child[w->top];
    child_prefetch(bvh, w->c);
    return true;
}

/* One step; false when the ray has arrived. */
ALWAYS_INLINE bool walker_step(Walker *w, const Bvh *bvh, bool any)
{
    uint32_t c = w->c;
    if (!child_is_leaf(c)) {
        w->top += node_push(&bvh->node[c], &w->probe, w->best.limit, any, w->near + w->top,
                            w->child + w->top, &c);
        if (c != CHILD_NONE) {
            child_prefetch(bvh, c);
            w->c = c;
            return true;
        }
    } else if (leaf_trace(bvh, w->ray, &w->probe, c, any, &w->best) && any) {
        return false;
    }
    return walker_pop(w, bvh, any);
}

/* Starts the next ray that can be traced; false when there is none left. */
ALWAYS_INLINE bool walker_start(Walker *w, const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                size_t count, size_t *next, Hit *hit, bool *blocked)
{
    if (order != NULL && *next + STREAM_RAYS < count) {
        const size_t soon = order[*next + STREAM_RAYS];
        __builtin_prefetch(hit != NULL ? (const void *)&hit[soon]
                                       : (const void *)&blocked[soon], 1);
    }
    for (; *next < count; (*next)++) {
        const Ray *r = &ray[*next];
        const size_t at = order != NULL ? order[*next] : *next;
        if (__builtin_expect(!probe_takes(r), 0)) {
            Hit one;
            const bool found = nearest_odd(bvh, r, hit != NULL ? &hit[at] : &one);
            if (hit == NULL)
                blocked[at] = found;
            continue;
        }
        w->ray = r;
        w->at = (uint32_t)at;
        w->c = w->top = 0;
        probe_init(&w->probe, w->ray, bvh->lo, bvh->hi);
        w->best = best_none(w->ray->t_max);
        (*next)++;
        return true;
    }
    return false;
}

ALWAYS_INLINE void walker_end(const Walker *w, const Bvh *bvh, Hit *hit, bool *blocked)
{
    if (hit == NULL) {
        blocked[w->at] = best_found(&w->best);
        return;
    }
    const Candidate *chosen = &w->best.first;
    if (__builtin_expect(best_is_open(&w->best), 0))
        chosen = first_or_facing(bvh, w->ray, &w->probe, &w->best);
    best_to_hit(&w->best, chosen, &hit[w->at]);
}

ALWAYS_INLINE void stream_trace(const Bvh *bvh, const Ray *ray, const uint32_t *order,
                                size_t count, Hit *hit, bool *blocked)
{
    Walker walker[STREAM_RAYS];
    size_t next = 0;
    unsigned walking = 0;
    while (walking < STREAM_RAYS
           && walker_start(&walker[walking], bvh, ray, order, count, &next, hit, blocked))
        walking++;
    while (walking > 0)
        for (unsigned i = 0; i < walking; i++) {
            if (walker_step(&walker[i], bvh, hit == NULL))
                continue;
            walker_end(&walker[i], bvh, hit, blocked);
            if (!walker_start(&walker[i], bvh, ray, order, count, &next, hit, blocked)) {
                walking--;
                if (i < walking)
                    walker[i] = walker[walking];
            }
        }
}

static void stream_nearest(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                           Hit *hit)
{
    stream_trace(bvh, ray, order, count, hit, NULL);
}

static void stream_blocked(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                           bool *blocked)
{
    stream_trace(bvh, ray, order, count, NULL, blocked);
}

#endif
