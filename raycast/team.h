/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/team.h -- several packets of one kind through the tree together.
 *
 * What costs the same for one ray and for many is done once for all of them: boxes and triangles
 * are tested against the ranges of the whole team before any ray is asked, triangles also for their
 * depth: most rays start on a surface, whose triangles would else be decided in double for each
 * packet. A packet of which no ray is left in a subtree is passed over. A subtree that only one
 * packet reaches is walked by that packet.
 */
#ifndef RAYCAST_TEAM_H
#define RAYCAST_TEAM_H

#include "raycast/packet_walk.h"

#define TEAM 4u /* packets */

typedef struct {
    Packet   packet[TEAM];
    Bundle   bundle[TEAM];
    unsigned lanes[TEAM];
    Range    range;
} Team;

typedef struct {
    Floats   near[BVH_STACK][TEAM]; /* of the packets in `lanes` */
    uint16_t lanes[BVH_STACK][TEAM];
    uint32_t child[BVH_STACK];
    uint32_t top;
} TeamStack;

LANES_INLINE void team_push(const Team *t, const Node *node, const unsigned lanes[TEAM],
                            TeamStack *stack)
{
    const unsigned octant = t->packet[0].octant;
    Floats limit = floats_all(-INFINITY);
    for (unsigned i = 0; i < TEAM; i++)
        limit = floats_max(limit, floats_pick(lanes[i], t->packet[i].limit, limit));
    _Alignas(32) float all[NODE_WIDTH];
    unsigned slots = range_slots(&t->range, octant, node, floats_most(limit), all);
    const unsigned nx = octant & 1, ny = octant >> 1 & 1, nz = octant >> 2 & 1;
    for (; slots != 0; slots &= slots - 1) {
        const unsigned s = (unsigned)__builtin_ctz(slots) ^ octant;
        const Floats near[3] = { floats_all(node->plane[nx][s]), floats_all(node->plane[2 + ny][s]),
                                 floats_all(node->plane[4 + nz][s]) };
        const Floats far[3] = { floats_all(node->plane[1 - nx][s]),
                                floats_all(node->plane[3 - ny][s]),
                                floats_all(node->plane[5 - nz][s]) };
        unsigned hits = 0;
        for (unsigned i = 0; i < TEAM; i++) {
            const Packet *p = &t->packet[i];
            const Floats x0 = floats_fused(near[0], p->inverse[0], p->near_add[0]);
            const Floats y0 = floats_fused(near[1], p->inverse[1], p->near_add[1]);
            const Floats z0 = floats_fused(near[2], p->inverse[2], p->near_add[2]);
            const Floats x1 = floats_fused(far[0], p->inverse[0], p->far_add[0]);
            const Floats y1 = floats_fused(far[1], p->inverse[1], p->far_add[1]);
            const Floats z1 = floats_fused(far[2], p->inverse[2], p->far_add[2]);
            const Floats t0 = floats_max(floats_max(x0, y0), floats_max(z0, p->t_min));
            const Floats t1 = floats_min(floats_min(x1, y1), floats_min(z1, p->limit));
            const unsigned hit = floats_less_equal(t0, t1) & lanes[i];
            stack->near[stack->top][i] = t0;
            stack->lanes[stack->top][i] = (uint16_t)hit;
            hits |= hit;
        }
        stack->child[stack->top] = node->child[s];
        stack->top += hits != 0;
    }
}

LANES_INLINE void team_leaf(Team *t, const Bvh *bvh, uint32_t leaf, const unsigned lanes[TEAM],
                            bool any)
{
    const uint32_t begin = child_group(leaf), end = begin + child_group_count(leaf);
    for (uint32_t g = begin; g < end; g++) {
        const TriangleGroup *group = &bvh->group[g];
        unsigned left = packet_filter(&t->range, t->packet[0].axis, group);
        if (left == 0)
            continue;
        _Alignas(16) float depth[GROUP_WIDTH];
        unsigned behind;
        _mm_store_ps(depth, packet_depths(&t->range, t->packet[0].axis, t->packet[0].backward,
                                          group, &behind));
        left &= ~behind;
        for (; left != 0; left &= left - 1) {
            const unsigned k = (unsigned)__builtin_ctz(left);
            for (unsigned i = 0; i < TEAM; i++) {
                Packet *p = &t->packet[i];
                unsigned here = any ? lanes[i] & ~p->blocked : lanes[i];
                here &= floats_less_equal(floats_all(depth[k]), p->limit * p->size);
                if (here != 0)
                    packet_triangle(p, group, k, g * GROUP_WIDTH, here, any);
            }
        }
    }
}

/* Kept out of line: the code of a packet's walk is long. */
static __attribute__((noinline)) void team_packet(Team *t, unsigned i, const Bvh *bvh,
                                                  uint32_t child, const Floats *near,
                                                  unsigned lanes, bool any)
{
    Packet *p = &t->packet[i];
    if (!p->ranged)
        packets_range(p, &t->lanes[i], 1, &p->range);
    p->ranged = true;
    if (any)
        packet_walk(p, bvh, &t->bundle[i], lanes, child, near, true);
    else
        packet_walk(p, bvh, &t->bundle[i], lanes, child, near, false);
}

LANES_INLINE void team_walk(Team *t, const Bvh *bvh, bool any)
{
    TeamStack stack;
    stack.top = 1;
    stack.child[0] = 0;
    for (unsigned i = 0; i < TEAM; i++) {
        stack.near[0][i] = t->packet[i].t_min;
        stack.lanes[0][i] = (uint16_t)t->lanes[i];
    }
    while (stack.top > 0) {
        const uint32_t at = --stack.top, child = stack.child[at];
        const int few = child_is_shape(child) ? (int)LANES : t->packet[0].few;
        unsigned lanes[TEAM], packets = 0, last = 0;
        for (unsigned i = 0; i < TEAM; i++) {
            const Packet *p = &t->packet[i];
            lanes[i] = stack.lanes[at][i] & floats_less_equal(stack.near[at][i], p->limit);
            if (any)
                lanes[i] &= ~p->blocked;
            if (lanes[i] != 0 && __builtin_popcount(lanes[i]) <= few) {
                packet_alone(&t->packet[i], bvh, &t->bundle[i], child, &stack.near[at][i],
                             lanes[i], any);
                lanes[i] = 0;
            }
            packets += lanes[i] != 0;
            last = lanes[i] != 0 ? i : last;
        }
        if (packets == 0)
            continue;
        if (packets == 1)
            team_packet(t, last, bvh, child, &stack.near[at][last], lanes[last], any);
        else if (child_is_leaf(child))
            team_leaf(t, bvh, child, lanes, any);
        else
            team_push(t, &bvh->node[child], lanes, &stack);
    }
    for (unsigned i = 0; i < TEAM; i++)
        if (t->packet[i].tasks > 0)
            packet_walk_alone(&t->packet[i], bvh, &t->bundle[i], any);
}

#endif
