/* SPDX-License-Identifier: BSD-3-Clause */
/* A tree whose primitives have moved: the same nodes and groups with new corners and boxes. Groups
 * and the boxes of leaves by all threads; then boxes of nodes, children before parents, which the
 * order of the nodes makes a loop from the last to the first (bvh_build.c). */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "raycast/build.h"
#include "raycast/probe.h"

#define REFIT_CHUNK 4096u

typedef struct {
    Bvh              *bvh;
    const Primitives *in;
} RefitContext;

static void group_move(const RefitContext *c, TriangleGroup *group)
{
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++) {
        const uint32_t primitive = group->primitive[lane];
        float corner[3][3];
        if (primitive == RAY_MISS)
            continue;
        /* All corners in one place: never hit, whatever rounding does to it. */
        const bool area = probe_corners(c->in, primitive, corner);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                group->vertex[i][k][lane] = corner[area ? i : 0][k];
    }
}

static void groups_move(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    RefitContext *c = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        group_move(c, &c->bvh->group[i]);
}

static Box group_box(const TriangleGroup *group, Box box)
{
    for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++)
        for (int i = 0; i < 3 && group->primitive[lane] != RAY_MISS; i++)
            box = box_point(box, (Float4){ group->vertex[i][0][lane], group->vertex[i][1][lane],
                                           group->vertex[i][2][lane], 0 });
    return box;
}

/* Around what a leaf holds. */
static Box leaf_box(const Bvh *bvh, uint32_t child)
{
    Box box = box_empty();
    if (child_is_shape(child)) {
        float lo[3], hi[3];
        if (shape_box(&bvh->shape[child_shape_index(child)], lo, hi))
            box = (Box){ { lo[0], lo[1], lo[2], 0 }, { hi[0], hi[1], hi[2], 0 } };
        return box;
    }
    const uint32_t first = child_group(child);
    for (uint32_t i = 0; i < child_group_count(child); i++)
        box = group_box(&bvh->group[first + i], box);
    return box;
}

static void leaves_fit(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const RefitContext *c = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        Node *node = &c->bvh->node[i];
        for (uint32_t s = 0; s < NODE_WIDTH; s++)
            if (node->child[s] != CHILD_NONE && child_is_leaf(node->child[s]))
                node_set_box(node, s, leaf_box(c->bvh, node->child[s]));
    }
}

static Box node_box(const Node *node)
{
    Box box = box_empty();
    for (uint32_t s = 0; s < NODE_WIDTH; s++)
        for (int k = 0; k < 3 && node->child[s] != CHILD_NONE; k++) {
            box.lo[k] = fminf(box.lo[k], node->plane[2 * k][s]);
            box.hi[k] = fmaxf(box.hi[k], node->plane[2 * k + 1][s]);
        }
    return box;
}

static void nodes_fit(Bvh *bvh)
{
    for (uint32_t i = bvh->node_count; i-- > 0;) {
        Node *node = &bvh->node[i];
        for (uint32_t s = 0; s < NODE_WIDTH; s++)
            if (node->child[s] != CHILD_NONE && !child_is_leaf(node->child[s])) {
                assert(node->child[s] > i);
                node_set_box(node, s, node_box(&bvh->node[node->child[s]]));
            }
    }
    const Box all = node_box(&bvh->node[0]);
    for (int k = 0; k < 3 && bvh->group_count + bvh->shape_count > 0; k++) {
        bvh->lo[k] = all.lo[k];
        bvh->hi[k] = all.hi[k];
    }
}

/* Whether the tree holds all of these; it leaves out triangles that had no area. */
static bool refs_are_there(const Bvh *bvh, const Ref *ref, uint32_t count, Error *err)
{
    uint8_t *there = array_create(bvh->triangle_count, 1, "triangles of a tree", err);
    if (there == NULL)
        return false;
    for (uint32_t g = 0; g < bvh->group_count; g++)
        for (uint32_t lane = 0; lane < GROUP_WIDTH; lane++)
            if (bvh->group[g].primitive[lane] != RAY_MISS)
                there[bvh->group[g].primitive[lane]] = 1;
    for (uint32_t i = 0; i < count && !error_is_set(err); i++)
        if (ref[i].primitive < bvh->triangle_count && !there[ref[i].primitive])
            error_set(err, ERROR_INPUT, "triangle %u had no area when the tree was made, and has "
                      "now: a new tree is needed", ref[i].primitive);
    array_free(there);
    return !error_is_set(err);
}

/* The same checks as for a new tree; nothing was changed yet when one fails. */
static bool moved_check(const Bvh *bvh, const Primitives *moved, unsigned threads, Error *err)
{
    uint32_t count;
    Ref *ref = refs_create(moved, threads, &count, err);
    const bool good = ref != NULL && (bvh->flat_count == 0
                                      || refs_are_there(bvh, ref, count, err));
    array_free(ref);
    return good;
}

bool bvh_refit(Bvh *bvh, const Primitives *moved, unsigned threads, Error *err)
{
    assert(bvh != NULL && moved != NULL && err != NULL);
    assert(moved->triangle_count == bvh->triangle_count && moved->shape_count == bvh->shape_count);
    if (error_is_set(err) || !moved_check(bvh, moved, threads, err))
        return false;
    RefitContext c = { .bvh = bvh, .in = moved };
    parallel_for(bvh->group_count, REFIT_CHUNK, threads, groups_move, &c, NULL, NULL);
    if (bvh->shape_count > 0)
        memcpy(bvh->shape, moved->shape, bvh->shape_count * sizeof *bvh->shape);
    parallel_for(bvh->node_count, REFIT_CHUNK, threads, leaves_fit, &c, NULL, NULL);
    nodes_fit(bvh);
    return true;
}
