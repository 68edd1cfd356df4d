/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/crowd.h -- whether anything lies on rays that have little in common but their signs.
 *
 * Included after stream.h. A crowd walks the tree once [barringer14]: what waits on the stack is a
 * subtree and the set of rays that reach it, one bit each. At a node each ray of the set meets all
 * 8 boxes at once, which puts its bit into the sets of the children it reaches: no branch depends
 * on what a ray meets, and a node comes from memory once for all. That no hit cuts off others but
 * by ending its ray is what makes the common order harmless, so this is for any hit only. Subtrees
 * that few rays reach are left to these alone.
 */
#ifndef RAYCAST_CROWD_H
#define RAYCAST_CROWD_H

#define CROWD 64u /* bits of a set */

typedef struct {
    Probe      probe[CROWD];
    const Ray *ray;   /* [CROWD] */
    uint64_t   alive; /* rays that nothing was found on */
} Crowd;

typedef struct {
    uint64_t rays[BVH_STACK];
    uint32_t child[BVH_STACK];
} CrowdStack;

ALWAYS_INLINE void crowd_leaf(Crowd *w, const Bvh *bvh, uint64_t rays, uint32_t leaf)
{
    if (!child_is_shape(leaf)) {
        w->alive &= ~groups_block(&bvh->group[child_group(leaf)], child_group_count(leaf),
                                  w->probe, rays);
        return;
    }
    for (; rays != 0; rays &= rays - 1) {
        const unsigned i = (unsigned)__builtin_ctzll(rays);
        Best best = best_none(w->probe[i].t_max);
        if (leaf_trace(bvh, &w->ray[i], &w->probe[i], leaf, true, &best))
            w->alive &= ~(UINT64_C(1) << i);
    }
}

ALWAYS_INLINE void crowd_walk(Crowd *w, const Bvh *bvh)
{
    CrowdStack stack;
    const unsigned octant = w->probe[0].octant;
    uint32_t top = 1;
    stack.child[0] = 0;
    stack.rays[0] = w->alive;
    while (top > 0) {
        top--;
        const uint64_t rays = stack.rays[top] & w->alive;
        const uint32_t child = stack.child[top];
        if (rays == 0)
            continue;
        if (child_is_leaf(child)) {
            crowd_leaf(w, bvh, rays, child);
        } else {
            const Node *node = &bvh->node[child];
            Reach reach = reach_none();
            for (uint64_t left = rays; left != 0; left &= left - 1)
                reach_add(&reach, node, &w->probe[__builtin_ctzll(left)], octant, left & -left);
            const uint32_t more = reach_push(&reach, node, octant, stack.rays + top,
                                             stack.child + top);
            for (uint32_t k = 0; k < more; k++)
                child_prefetch(bvh, stack.child[top + k]);
            top += more;
        }
    }
}

/* Major axis, as probe_init chooses it, and signs. */
ALWAYS_INLINE unsigned ray_kind(const Ray *ray)
{
    const float ax = fabsf(ray->dx), ay = fabsf(ray->dy), az = fabsf(ray->dz);
    const bool on_x = (ax > ay) & (ax > az), on_y = (ax <= ay) & (ay > az);
    const unsigned signs = (unsigned)_mm_movemask_ps(_mm_loadu_ps(&ray->dx)) & 7;
    return 8 * (on_x ? 0 : on_y ? 1 : 2) + signs;
}

/* probe_init for rays of one kind, that of `like`: no branches. The same operations. */
ALWAYS_INLINE void crowd_probe(Probe *p, const Ray *ray, const Bvh *bvh, const Probe *like)
{
    const int x = like->axis[0], y = like->axis[1], z = like->axis[2];
    const __m128i order = _mm_setr_epi32(x, y, z, 3), major = _mm_set1_epi32(z);
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 o = _mm_loadu_ps(&ray->ox), d = _mm_loadu_ps(&ray->dx);
    const __m128 lo = _mm_setr_ps(bvh->lo[0], bvh->lo[1], bvh->lo[2], 0);
    const __m128 hi = _mm_setr_ps(bvh->hi[0], bvh->hi[1], bvh->hi[2], 0);
    const __m128 reach = _mm_max_ps(_mm_andnot_ps(sign, _mm_sub_ps(lo, o)),
                                    _mm_andnot_ps(sign, _mm_sub_ps(hi, o)));
    const __m128 length = _mm_andnot_ps(sign, d);
    const __m128 smallest = _mm_mul_ps(_mm_permutevar_ps(length, major),
                                       _mm_set1_ps(PROBE_SMALLEST_SLOPE));
    const __m128 inverse = _mm_or_ps(_mm_div_ps(_mm_set1_ps(1), _mm_max_ps(length, smallest)),
                                     _mm_and_ps(sign, d));
    const __m128 sum = _mm_add_ps(_mm_add_ps(_mm_andnot_ps(sign, o), reach),
                                  _mm_permutevar_ps(reach, major));
    const __m128 margin = _mm_mul_ps(_mm_set1_ps(PROBE_MARGIN), sum);
    const __m128 wider = _mm_mul_ps(margin, _mm_andnot_ps(sign, inverse));
    const __m128 at = _mm_mul_ps(o, inverse);
    const __m128 shear = _mm_mul_ps(_mm_permutevar_ps(d, order),
                                    _mm_permutevar_ps(inverse, major));
    _Alignas(16) float row[4];
    /* What is written of four spills into the field that is written next. */
    _mm_storeu_ps(p->inverse, inverse);
    _mm_storeu_ps(p->near_add, _mm_sub_ps(_mm_xor_ps(at, sign), wider));
    _mm_storeu_ps(p->far_add, _mm_sub_ps(wider, at));
    _mm_store_ps(row, shear);
    p->t_min = ray->t_min;
    p->t_max = ray->t_max;
    p->axis[0] = x;
    p->axis[1] = y;
    p->axis[2] = z;
    _mm_storeu_ps(p->origin, _mm_permutevar_ps(o, order));
    p->shear[0] = row[0];
    p->shear[1] = row[1];
    p->inverse_z = 1 / (double)((const float *)ray)[4 + z];
    _mm_store_ps(row, margin);
    for (int k = 0; k < 3; k++)
        p->margin[k] = row[k];
    p->reach = BEST_GRADIENT * (row[0] + row[1] + row[2]) * fabsf(p->inverse[z]);
    p->octant = like->octant;
}

/* The crowd of the first rays, as long as they are of one kind; 0: the first cannot be traced. */
ALWAYS_INLINE unsigned crowd_gather(Crowd *w, const Bvh *bvh, const Ray *ray, size_t count)
{
    unsigned n = 1;
    if (!probe_takes(ray))
        return 0;
    probe_init(&w->probe[0], ray, bvh->lo, bvh->hi);
    const unsigned kind = ray_kind(ray);
    for (; n < CROWD && n < count; n++) {
        if (!probe_takes(&ray[n]) || ray_kind(&ray[n]) != kind)
            break;
        crowd_probe(&w->probe[n], &ray[n], bvh, &w->probe[0]);
    }
    w->ray = ray;
    w->alive = n < CROWD ? (UINT64_C(1) << n) - 1 : ~UINT64_C(0);
    return n;
}

/* Answers to blocked[order[i]]. */
static void crowds_blocked(const Bvh *bvh, const Ray *ray, const uint32_t *order, size_t count,
                           bool *blocked)
{
    Crowd w;
    for (size_t i = 0; i < count;) {
        const unsigned n = crowd_gather(&w, bvh, ray + i, count - i);
        if (n == 0) {
            Hit hit;
            blocked[order[i]] = nearest_odd(bvh, &ray[i], &hit);
            i++;
            continue;
        }
        crowd_walk(&w, bvh);
        for (unsigned k = 0; k < n; k++)
            blocked[order[i + k]] = !(w.alive >> k & 1);
        i += n;
    }
}

#endif
