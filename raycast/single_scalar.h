/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/single_scalar.h -- one ray against a node and groups in plain C: one box and one triangle
 * after the other. Also what the bench program counts the steps of. */
#ifndef RAYCAST_SINGLE_SCALAR_H
#define RAYCAST_SINGLE_SCALAR_H

#include "raycast/probe.h"

static inline float smaller(float a, float b) { return a < b ? a : b; }
static inline float larger(float a, float b) { return a > b ? a : b; }

static inline uint32_t scalar_push(const Node *node, const Probe *p, float t_limit, bool any,
                                   float *near, uint32_t *child, uint32_t *next)
{
    uint32_t count = 0;
    (void)any;
    for (unsigned i = 0; i < NODE_WIDTH; i++) {
        const unsigned slot = i ^ p->octant;
        float from = p->t_min, to = t_limit;
        for (unsigned k = 0; k < 3; k++) {
            const unsigned negative = p->octant >> k & 1;
            from = larger(from, node->plane[2 * k + negative][slot] * p->inverse[k]
                                    + p->near_add[k]);
            to = smaller(to, node->plane[2 * k + 1 - negative][slot] * p->inverse[k]
                                 + p->far_add[k]);
        }
        near[count] = from;
        child[count] = node->child[slot];
        count += from <= to;
    }
    *next = count > 0 ? child[count - 1] : CHILD_NONE;
    return count > 0 ? count - 1 : 0;
}

static inline bool scalar_group(const TriangleGroup *group, const Probe *p, uint32_t place,
                                Best *best)
{
    bool found = false;
    for (int i = 0; i < (int)GROUP_WIDTH && group->primitive[i] != RAY_MISS; i++)
        found |= probe_lane(p, group, i, place, best);
    return found;
}

static inline bool scalar_groups(const TriangleGroup *group, uint32_t count, const Probe *p,
                                 uint32_t place, bool any, Best *best)
{
    bool found = false;
    for (uint32_t g = 0; g < count && !(any && found); g++)
        found |= scalar_group(&group[g], p, place + g * GROUP_WIDTH, best);
    return found;
}

#endif
