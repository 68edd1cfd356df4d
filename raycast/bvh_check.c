/* SPDX-License-Identifier: BSD-3-Clause */
/* The invariants of a finished tree: every box holds all primitives below it, each primitive is
 * there exactly once, nothing in the arrays is left out, and the depth is within the stack's. Where
 * triangles are cut, each is there at least once, boxes hold the boxes of leaves, and those of a
 * triangle together reach as far as it does. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "raycast/internal.h"

typedef struct {
    double lo[3], hi[3];
} Extent;

typedef struct {
    const Bvh *bvh;
    uint8_t   *seen; /* [triangle_count + shape_count] */
    Extent    *held; /* [triangle_count]  where triangles are cut: their leaves' boxes; else NULL */
    uint64_t   primitives, nodes, groups;
} Check;

static Extent extent_empty(void)
{
    return (Extent){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
}

static void extent_join(Extent *e, const Extent *other)
{
    for (int k = 0; k < 3; k++) {
        e->lo[k] = fmin(e->lo[k], other->lo[k]);
        e->hi[k] = fmax(e->hi[k], other->hi[k]);
    }
}

static bool extent_holds(const Extent *outer, const Extent *inner)
{
    for (int k = 0; k < 3; k++)
        if (!(outer->lo[k] <= inner->lo[k] && inner->hi[k] <= outer->hi[k]))
            return false;
    return true;
}

static Extent node_extent(const Node *node, uint32_t slot)
{
    Extent e;
    for (int k = 0; k < 3; k++) {
        e.lo[k] = (double)node->plane[2 * k][slot];
        e.hi[k] = (double)node->plane[2 * k + 1][slot];
    }
    return e;
}

/* Each of the following adds what it found to *below. */

static bool primitive_seen(Check *c, uint32_t primitive)
{
    const bool again = c->held != NULL && primitive < c->bvh->triangle_count;
    if (primitive >= c->bvh->triangle_count + c->bvh->shape_count
        || (c->seen[primitive] && !again))
        return false;
    c->primitives += !c->seen[primitive];
    c->seen[primitive] = 1;
    return true;
}

static Extent triangle_extent(const TriangleGroup *group, uint32_t lane)
{
    Extent e = extent_empty();
    for (int i = 0; i < 3; i++) {
        Extent p;
        for (int k = 0; k < 3; k++)
            p.lo[k] = p.hi[k] = (double)group->vertex[i][k][lane];
        extent_join(&e, &p);
    }
    return e;
}

/* A part of the triangle is in this box, which is all that the boxes above must hold. */
static bool part_check(Check *c, uint32_t primitive, const Extent *whole, const Extent *box)
{
    for (int k = 0; k < 3; k++)
        if (!(whole->lo[k] <= box->hi[k] && box->lo[k] <= whole->hi[k]))
            return false;
    extent_join(&c->held[primitive], box);
    return true;
}

static bool parts_reach(const Check *c)
{
    for (uint32_t i = 0; c->held != NULL && i < c->bvh->group_count; i++)
        for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
            const uint32_t primitive = c->bvh->group[i].primitive[lane];
            if (primitive == RAY_MISS)
                continue;
            const Extent whole = triangle_extent(&c->bvh->group[i], lane);
            if (!extent_holds(&c->held[primitive], &whole))
                return false;
        }
    return true;
}

static bool group_check(Check *c, const TriangleGroup *group, const Extent *box, Extent *below)
{
    bool ended = false;
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
        if (group->primitive[lane] == RAY_MISS) {
            ended = true;
            continue;
        }
        if (ended || !primitive_seen(c, group->primitive[lane]))
            return false;
        const Extent whole = triangle_extent(group, lane);
        if (c->held == NULL)
            extent_join(below, &whole);
        else if (!part_check(c, group->primitive[lane], &whole, box))
            return false;
    }
    return group->primitive[0] != RAY_MISS;
}

static bool shape_check(Check *c, uint32_t i, Extent *below)
{
    if (i >= c->bvh->shape_count)
        return false;
    Vec3 lo, hi;
    shape_bounds(&c->bvh->shape[i], &lo, &hi);
    const Extent bounds = { { lo.x, lo.y, lo.z }, { hi.x, hi.y, hi.z } };
    extent_join(below, &bounds);
    return primitive_seen(c, c->bvh->triangle_count + i);
}

static bool node_check(Check *c, uint32_t index, uint32_t depth, Extent *below);

static bool child_check(Check *c, uint32_t child, uint32_t depth, const Extent *box,
                        Extent *below)
{
    const Bvh *bvh = c->bvh;
    if (child_is_shape(child))
        return shape_check(c, child_shape_index(child), below);
    if (!child_is_leaf(child))
        return node_check(c, child, depth + 1, below);
    const uint32_t first = child_group(child), count = child_group_count(child);
    if (first + count > bvh->group_count)
        return false;
    c->groups += count;
    for (uint32_t i = 0; i < count; i++)
        if (!group_check(c, &bvh->group[first + i], box, below))
            return false;
    if (c->held != NULL)
        extent_join(below, box);
    return true;
}

static bool node_check(Check *c, uint32_t index, uint32_t depth, Extent *below)
{
    /* More than there are: some are met twice. A tree from a file may be anything. */
    if (index >= c->bvh->node_count || depth > BVH_DEPTH || c->nodes >= c->bvh->node_count)
        return false;
    const Node *node = &c->bvh->node[index];
    c->nodes++;
    for (uint32_t s = 0; s < NODE_WIDTH; s++) {
        const Extent box = node_extent(node, s);
        if (node->child[s] == CHILD_NONE) {
            if (node->plane[0][s] <= node->plane[1][s])
                return false;
            continue;
        }
        Extent inside = extent_empty();
        if (!child_check(c, node->child[s], depth, &box, &inside) || !extent_holds(&box, &inside))
            return false;
        extent_join(below, &inside);
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
    if (bvh->cut)
        c.held = array_create(bvh->triangle_count, sizeof *c.held, "boxes of a check", &err);
    if (error_is_set(&err)) {
        array_free(c.seen);
        return false;
    }
    for (uint32_t i = 0; bvh->cut && i < bvh->triangle_count; i++)
        c.held[i] = extent_empty();
    Extent all = { { 0 }, { 0 } }, found = extent_empty();
    for (int k = 0; k < 3; k++) {
        all.lo[k] = (double)bvh->lo[k];
        all.hi[k] = (double)bvh->hi[k];
    }
    const bool good = node_check(&c, 0, 1, &found) && extent_holds(&all, &found)
                      && c.nodes == bvh->node_count && c.groups == bvh->group_count
                      && c.primitives + bvh->flat_count == total && parts_reach(&c);
    array_free(c.seen);
    array_free(c.held);
    return good;
}
