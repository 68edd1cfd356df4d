/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/point_tree.h -- which of many points lie along a line. This folder only.
 *
 * Method   the points in Morton order, a tree of boxes over halves of that order [morton66].
 */
#ifndef MESH_POINT_TREE_H
#define MESH_POINT_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

typedef struct {
    const Vec3 *position;
    uint32_t   *point;     /* [count]  index into position, in Morton order */
    uint32_t    count;
    Vec3       *lo, *hi;   /* [boxes]  of node i, with children 2 i and 2 i + 1; the root is 1 */
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

#endif
