/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/packet_walk.h -- a packet of rays through the tree. */
#ifndef RAYCAST_PACKET_WALK_H
#define RAYCAST_PACKET_WALK_H

#include "raycast/packet_leaf.h"

/* --- nodes ----------------------------------------------------------------------------------- */

/* Bits of the slots that any ray of the packet may reach, in the order of visits: bit 7 first.
 * near[]: where they are entered at the earliest, slot by slot. */
LANES_INLINE unsigned range_slots(const Range *p, unsigned octant, const Node *node,
                                  float t_limit, float near[NODE_WIDTH])
{
    __m256 t0 = _mm256_set1_ps(p->t_min_least), t1 = _mm256_set1_ps(t_limit);
    for (unsigned k = 0; k < 3; k++) {
        const unsigned negative = octant >> k & 1;
        const __m256 from = _mm256_set1_ps(p->inverse_from[k]);
        const __m256 to = _mm256_set1_ps(p->inverse_to[k]);
        const __m256 a = _mm256_sub_ps(_mm256_load_ps(node->plane[2 * k + negative]),
                                       _mm256_set1_ps(p->near_origin[k]));
        const __m256 b = _mm256_sub_ps(_mm256_load_ps(node->plane[2 * k + 1 - negative]),
                                       _mm256_set1_ps(p->far_origin[k]));
        t0 = _mm256_max_ps(t0, _mm256_min_ps(_mm256_mul_ps(a, from), _mm256_mul_ps(a, to)));
        t1 = _mm256_min_ps(t1, _mm256_max_ps(_mm256_mul_ps(b, from), _mm256_mul_ps(b, to)));
    }
    _mm256_store_ps(near, t0);
    unsigned slots = (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(t0, t1, _CMP_LE_OQ));
    if (octant & 1)
        slots = (slots & 0xaa) >> 1 | (slots & 0x55) << 1;
    if (octant & 2)
        slots = (slots & 0xcc) >> 2 | (slots & 0x33) << 2;
    if (octant & 4)
        slots = (slots & 0xf0) >> 4 | (slots & 0x0f) << 4;
    return slots;
}

typedef struct {
    Floats   near[BVH_STACK]; /* NaN in lanes that do not go there: no limit is behind it */
    uint32_t child[BVH_STACK];
    uint32_t top;
} PacketStack;

/* Pushes the children that rays of `lanes` reach, far ones first. */
LANES_INLINE void packet_push(const Packet *p, const Node *node, unsigned lanes,
                              PacketStack *stack)
{
    const Floats outside = floats_all(NAN);
    const float most = floats_most(floats_pick(lanes, p->limit, floats_all(-INFINITY)));
    _Alignas(32) float all[NODE_WIDTH];
    unsigned slots = range_slots(&p->range, p->octant, node, most, all);
    Floats inverse[3], near_add[3], far_add[3];
    for (int k = 0; k < 3; k++) {
        inverse[k] = p->inverse[k];
        near_add[k] = p->near_add[k];
        far_add[k] = p->far_add[k];
    }
    const unsigned nx = p->octant & 1, ny = p->octant >> 1 & 1, nz = p->octant >> 2 & 1;
    for (; slots != 0; slots &= slots - 1) {
        const unsigned s = (unsigned)__builtin_ctz(slots) ^ p->octant;
        const Floats x0 = floats_fused(floats_all(node->plane[nx][s]), inverse[0], near_add[0]);
        const Floats y0 = floats_fused(floats_all(node->plane[2 + ny][s]), inverse[1], near_add[1]);
        const Floats z0 = floats_fused(floats_all(node->plane[4 + nz][s]), inverse[2], near_add[2]);
        const Floats x1 = floats_fused(floats_all(node->plane[1 - nx][s]), inverse[0], far_add[0]);
        const Floats y1 = floats_fused(floats_all(node->plane[3 - ny][s]), inverse[1], far_add[1]);
        const Floats z1 = floats_fused(floats_all(node->plane[5 - nz][s]), inverse[2], far_add[2]);
        const Floats t0 = floats_max(floats_max(x0, y0), floats_max(z0, p->t_min));
        const Floats t1 = floats_min(floats_min(x1, y1), floats_min(z1, p->limit));
        const unsigned hit = floats_less_equal(t0, t1) & lanes;
        stack->near[stack->top] = floats_pick(hit, t0, outside);
        stack->child[stack->top] = node->child[s];
        stack->top += hit != 0;
    }
}

/* `lanes` through the subtree below `child`, which they enter at `near`. */
LANES_INLINE void packet_walk(Packet *p, const Bvh *bvh, const Bundle *b, unsigned lanes,
                              uint32_t below, const Floats *near, bool any)
{
    PacketStack stack;
    stack.top = 1;
    stack.child[0] = below;
    stack.near[0] = floats_pick(lanes, *near, floats_all(NAN));
    while (stack.top > 0 || p->tasks > 0) {
        if (stack.top == 0) {
            packet_walk_alone(p, bvh, b, any);
            continue;
        }
        stack.top--;
        /* Not <: an equally near hit that comes before may be in there. */
        unsigned here = floats_less_equal(stack.near[stack.top], p->limit);
        if (any)
            here &= ~p->blocked;
        const uint32_t child = stack.child[stack.top];
        if (here == 0)
            continue;
        if (__builtin_popcount(here) <= p->few || child_is_shape(child))
            packet_alone(p, bvh, b, child, &stack.near[stack.top], here, any);
        else if (child_is_leaf(child))
            packet_leaf(p, bvh, child, here, any);
        else
            packet_push(p, &bvh->node[child], here, &stack);
        if (any && (lanes & ~p->blocked) == 0)
            return;
    }
}

#endif
