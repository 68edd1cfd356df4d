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
/* Rays that a cell should get on the average over all kinds: those of a tile of patches leave by
 * half of them, and cells of less than a packet's rays would mix neighbours all the same. Small
 * blocks are of rays to the nearest hit in small trees, where sorting is dear next to tracing. */
#define CELL_RAYS 4u
#define CELL_RAYS_SMALL 12u
#define CELL_SMALL 16384u /* rays in a block */
#define RAY_KINDS 24u

struct Cells {
    float    lo[3];
    float    scale[CELL_DIMENSIONS]; /* to 0 .. 2^CELL_LEVELS - 1 */
    uint16_t spread[CELL_DIMENSIONS][1u << CELL_LEVELS]; /* place along a dimension -> its bits */
    unsigned bits;
};

/* Memory for sorting up to `most` rays: `ray` are copies, ray[i] was at order[i]. */
#define SORT_MOST BVH_BLOCK
typedef struct {
    void     *memory; /* the block all of it lies in */
    size_t    most;
    Ray      *ray;    /* on a line of the cache, as nothing else here must be */
    uint32_t *key, *order;
    uint32_t *first;  /* SORT_FIRST(most) */
    Cells     cells;
} Sorter;

/* Keys, and one more. A bit more for cells needs more than CELL_RAYS rays for each: twice that many
 * keys are never more than half of the rays, unless they are the kinds alone. */
#define SORT_FIRST(most) ((most) / 2 + RAY_KINDS + 1)

/* Fills sorter->ray and sorter->order[0..count-1]; count <= sorter->most. */
void rays_sort(Sorter *sorter, const Bvh *bvh, const Ray *ray, size_t count);

#endif
