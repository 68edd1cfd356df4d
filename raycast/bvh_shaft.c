/* SPDX-License-Identifier: BSD-3-Clause */
/* A walk through the tree that leaves out boxes on the outer side of a plane. */
#include "raycast/shaft.h"

#include <assert.h>

#include "raycast/internal.h"

typedef struct {
    const Bvh   *bvh;
    const Plane *plane;
    uint32_t     planes;
    double       slack;
    ShaftVisit   visit;
    void        *user;
} Walk;

/* The corner of the box furthest along the plane's normal decides. */
static bool box_outside(const Walk *w, const float lo[3], const float hi[3])
{
    for (uint32_t k = 0; k < w->planes; k++) {
        const Plane *p = &w->plane[k];
        const double reach = p->normal.x * (double)(p->normal.x > 0 ? hi[0] : lo[0]) +
                             p->normal.y * (double)(p->normal.y > 0 ? hi[1] : lo[1]) +
                             p->normal.z * (double)(p->normal.z > 0 ? hi[2] : lo[2]);
        if (reach <= p->offset + w->slack)
            return true;
    }
    return false;
}

static bool visit_groups(const Walk *w, uint32_t child)
{
    const TriangleGroup *group = &w->bvh->group[child_group(child)];
    for (uint32_t i = 0; i < child_group_count(child); i++, group++)
        for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
            if (group->primitive[lane] == RAY_MISS)
                break;
            float lo[3], hi[3];
            for (int k = 0; k < 3; k++) {
                lo[k] = hi[k] = group->vertex[0][k][lane];
                for (int c = 1; c < 3; c++) {
                    lo[k] = fminf(lo[k], group->vertex[c][k][lane]);
                    hi[k] = fmaxf(hi[k], group->vertex[c][k][lane]);
                }
            }
            if (!box_outside(w, lo, hi) && !w->visit(w->user, group->primitive[lane]))
                return false;
        }
    return true;
}

static bool visit_child(const Walk *w, uint32_t child, uint32_t *stack, uint32_t *height)
{
    if (child_is_shape(child))
        return w->visit(w->user, w->bvh->triangle_count + child_shape_index(child));
    if (child_is_leaf(child))
        return visit_groups(w, child);
    assert(*height < BVH_STACK);
    stack[(*height)++] = child;
    return true;
}

bool bvh_shaft(const Bvh *bvh, const Plane *plane, uint32_t planes, double slack,
               ShaftVisit visit, void *user)
{
    assert(bvh != NULL && visit != NULL && (planes == 0 || plane != NULL));
    const Walk w = { bvh, plane, planes, slack, visit, user };
    uint32_t stack[BVH_STACK], height = 0;
    if (bvh->node_count > 0)
        stack[height++] = 0;
    while (height > 0) {
        const Node *node = &bvh->node[stack[--height]];
        for (uint32_t s = 0; s < NODE_WIDTH; s++) {
            if (node->child[s] == CHILD_NONE)
                continue;
            const float lo[3] = { node->plane[0][s], node->plane[2][s], node->plane[4][s] };
            const float hi[3] = { node->plane[1][s], node->plane[3][s], node->plane[5][s] };
            if (!box_outside(&w, lo, hi) && !visit_child(&w, node->child[s], stack, &height))
                return false;
        }
    }
    return true;
}
