/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/point_tree.h -- which of many points lie along a line or in a region. This folder only.
 *
 * Method   the points in Morton order, a tree of boxes over halves of that order [morton66].
 */
#ifndef MESH_POINT_TREE_H
#define MESH_POINT_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

enum { POINT_TREE_LEAF = 8 }; /* most points of a node that is not divided further */

typedef struct {
    Vec3 lo, hi;
} PointBox;

typedef struct {
    const Vec3 *position;
    uint32_t   *point;     /* [count]  index into position, in Morton order */
    uint32_t    count;
    PointBox   *box;       /* of node i, with children 2 i and 2 i + 1; the root is 1 */
} PointTree;

/* vertex    [count]  indices into position; positions are kept by reference.
 * fails     false and ERROR_MEMORY; *tree is then empty. */
bool point_tree_create(PointTree *tree, const Vec3 *position, const uint32_t *vertex,
                       uint32_t count, Error *err);
/* Frees everything inside, leaves { 0 }. */
void point_tree_clear(PointTree *tree);

/* Calls `found` for every point no further than `reach` from the line through p and q whose foot is
 * strictly between them, with its share of the way, until that returns false.
 * Returns false when it did. */
bool point_tree_along(const PointTree *tree, Vec3 p, Vec3 q, double reach,
                      bool (*found)(void *context, uint32_t vertex, double fraction),
                      void *context);

/* Keeps the first `count` of tree->point, which the caller has moved there in their order. */
void point_tree_shorten(PointTree *tree, uint32_t count);

/* Calls `found` for every point whose boxes `meets` says yes to, until it returns false. Returns
 * false when it did.
 * hot    inline, so that both are known to the compiler. */
static inline bool point_tree_visit(const PointTree *tree,
                                    bool (*meets)(void *context, const PointBox *box),
                                    bool (*found)(void *context, uint32_t vertex), void *context)
{
    enum { DEPTH = 32 }; /* halvings of 2^32 points */
    struct { uint32_t node, begin, end; } stack[DEPTH + 1] = { { 1, 0, tree->count } };
    for (int top = tree->count > 0; top > 0;) {
        const uint32_t node = stack[--top].node, begin = stack[top].begin, end = stack[top].end;
        if (!meets(context, &tree->box[node]))
            continue;
        if (end - begin > POINT_TREE_LEAF) {
            const uint32_t middle = begin + (end - begin) / 2;
            stack[top].node = 2 * node + 1;
            stack[top].begin = middle;
            stack[top++].end = end;
            stack[top].node = 2 * node;
            stack[top].begin = begin;
            stack[top++].end = middle;
            continue;
        }
        for (uint32_t i = begin; i < end; i++)
            if (!found(context, tree->point[i]))
                return false;
    }
    return true;
}

#endif
