/* SPDX-License-Identifier: BSD-3-Clause */
/* The invariants of a finished tree. */
#include <assert.h>

#include "base/array.h"
#include "raycast/build.h"

typedef struct {
    const Bvh *bvh;
    uint8_t   *seen; /* [triangle_count + shape_count]  bit per primitive would be smaller */
    uint64_t   primitives, nodes, groups;
} Check;

static Box node_box(const Node *node, uint32_t slot)
{
    Box box = box_empty();
    for (int k = 0; k < 3; k++) {
        box.lo[k] = node->plane[2 * k][slot];
        box.hi[k] = node->plane[2 * k + 1][slot];
    }
    return box;
}

static bool box_holds(Box outer, const float lo[3], const float hi[3])
{
    for (int k = 0; k < 3; k++)
        if (!(outer.lo[k] <= lo[k] && hi[k] <= outer.hi[k]))
            return false;
    return true;
}

static bool primitive_seen(Check *c, uint32_t primitive)
{
    if (primitive >= c->bvh->triangle_count + c->bvh->shape_count || c->seen[primitive])
        return false;
    c->seen[primitive] = 1;
    c->primitives++;
    return true;
}

static bool group_check(Check *c, const TriangleGroup *group, Box box)
{
    bool ended = false;
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
        if (group->primitive[lane] == RAY_MISS) {
            ended = true;
            continue;
        }
        if (ended || !primitive_seen(c, group->primitive[lane]))
            return false;
        for (int i = 0; i < 3; i++) {
            const float p[3] = { group->vertex[i][0][lane], group->vertex[i][1][lane],
                                 group->vertex[i][2][lane] };
            if (!box_holds(box, p, p))
                return false;
        }
    }
    return group->primitive[0] != RAY_MISS;
}

static bool shape_check(Check *c, uint32_t i, Box box)
{
    if (i >= c->bvh->shape_count)
        return false;
    Vec3 lo, hi;
    shape_bounds(&c->bvh->shape[i], &lo, &hi);
    for (int k = 0; k < 3; k++)
        if (!((double)box.lo[k] <= vec3_axis(lo, k) && vec3_axis(hi, k) <= (double)box.hi[k]))
            return false;
    return primitive_seen(c, c->bvh->triangle_count + i);
}

static bool node_check(Check *c, uint32_t index, Box box, uint32_t depth);

static bool child_check(Check *c, uint32_t child, Box box, uint32_t depth)
{
    const Bvh *bvh = c->bvh;
    if (child_is_shape(child))
        return shape_check(c, child_shape_index(child), box);
    if (!child_is_leaf(child))
        return node_check(c, child, box, depth + 1);
    const uint32_t first = child_group(child), count = child_group_count(child);
    if (first + count > bvh->group_count)
        return false;
    c->groups += count;
    for (uint32_t i = 0; i < count; i++)
        if (!group_check(c, &bvh->group[first + i], box))
            return false;
    return true;
}

static bool node_check(Check *c, uint32_t index, Box box, uint32_t depth)
{
    if (index >= c->bvh->node_count || depth > BVH_DEPTH)
        return false;
    const Node *node = &c->bvh->node[index];
    c->nodes++;
    for (uint32_t s = 0; s < NODE_WIDTH; s++) {
        const Box inner = node_box(node, s);
        if (node->child[s] == CHILD_NONE) {
            if (inner.lo[0] <= inner.hi[0])
                return false;
            continue;
        }
        const float lo[3] = { inner.lo[0], inner.lo[1], inner.lo[2] };
        const float hi[3] = { inner.hi[0], inner.hi[1], inner.hi[2] };
        if (!box_holds(box, lo, hi) || !child_check(c, node->child[s], inner, depth))
            return false;
    }
    return true;
}

bool bvh_check(const Bvh *bvh)
{
    assert(bvh != NULL);
    Error err = { 0 };
    const size_t total = (size_t)bvh->triangle_count + bvh->shape_count;
    Check c = { .bvh = bvh };
    c.seen = array_create(total, 1, "marks of a check", &err);
    if (c.seen == NULL)
        return false;
    Box all = box_empty();
    for (int k = 0; k < 3; k++) {
        all.lo[k] = bvh->lo[k];
        all.hi[k] = bvh->hi[k];
    }
    const bool good = node_check(&c, 0, all, 1) && c.nodes == bvh->node_count
                      && c.groups == bvh->group_count
                      && c.primitives + bvh->flat_count == total;
    array_free(c.seen);
    return good;
}
