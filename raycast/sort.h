/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/sort.h -- an order in which rays that go the same way are neighbours.
 *
 * A ray's key is its kind (major axis and signs of the direction: what rays of a packet must have
 * in common), below it a cell of direction and origin, the bits of both interleaved so that the
 * rays of a cell spread about as far by the one as by the other over half of the scene.
 */
#ifndef RAYCAST_SORT_H
#define RAYCAST_SORT_H

#include "raycast/internal.h"

#define CELL_DIMENSIONS 5 /* two slopes, three coordinates */
#define CELL_LEVELS 5u    /* bits of a dimension, at most: a table fits a register */
#define CELL_BITS_MAX 12u
#define RAY_KINDS 24u

struct Cells {
    float    lo[3];
    float    scale[CELL_DIMENSIONS]; /* to 0 .. 2^CELL_LEVELS - 1 */
    uint16_t spread[CELL_DIMENSIONS][1u << CELL_LEVELS]; /* place along a dimension -> its bits */
    unsigned bits;
};

/* Memory for sorting up to SORT_MOST rays: `ray` are copies, ray[i] was at order[i]. */
#define SORT_MOST BVH_BLOCK
typedef struct {
    _Alignas(64) Ray ray[SORT_MOST];
    Cells    cells;
    void    *memory; /* the block it lies in */
    uint32_t key[SORT_MOST], order[SORT_MOST];
    uint32_t first[(RAY_KINDS << CELL_BITS_MAX) + 1];
} Sorter;

/* Fills sorter->ray and sorter->order[0..count-1]; count <= SORT_MOST. */
void rays_sort(Sorter *sorter, const Bvh *bvh, const Ray *ray, size_t count);

#endif
