/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays into cells (sort.h): one pass of counting; within a cell the caller's order stays. */
#include "raycast/sort.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Around some of the origins: places beyond it go to the last cells. */
#define SAMPLE_STEP 64

static void origin_box(const Ray *ray, size_t count, float lo[3], float hi[3])
{
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (size_t i = 0; i < count; i += SAMPLE_STEP) {
        const float o[3] = { ray[i].ox, ray[i].oy, ray[i].oz };
        for (int k = 0; k < 3; k++) {
            lo[k] = o[k] < lo[k] ? o[k] : lo[k];
            hi[k] = o[k] > hi[k] ? o[k] : hi[k];
        }
    }
}

/* Gives one bit after the other to the dimension whose cells are largest. */
static void cells_init(Cells *cells, const Bvh *bvh, const Ray *ray, size_t count)
{
    float hi[3], left[CELL_DIMENSIONS], size = 0;
    unsigned used[CELL_DIMENSIONS] = { 0 }, dimension[CELL_BITS_MAX];
    origin_box(ray, count, cells->lo, hi);
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, bvh->hi[k] - bvh->lo[k]);
    for (int k = 0; k < CELL_DIMENSIONS; k++) {
        /* A slope of 1 over half the scene. */
        const float range = k < 2 ? 1 : hi[k - 2] - cells->lo[k - 2];
        left[k] = k < 2 ? size / 2 : range < INFINITY ? range : 0;
        cells->scale[k] = range > 0 && range < INFINITY ? (float)(1u << CELL_LEVELS) / range : 0;
    }
    const size_t rays = count <= CELL_SMALL ? CELL_RAYS_SMALL : CELL_RAYS;
    for (cells->bits = 0; cells->bits < CELL_BITS_MAX; cells->bits++) {
        unsigned largest = 0;
        for (unsigned k = 1; k < CELL_DIMENSIONS; k++)
            largest = left[k] > left[largest] ? k : largest;
        if (rays * RAY_KINDS << cells->bits >= count || used[largest] == CELL_LEVELS)
            break;
        left[largest] /= 2;
        used[largest]++;
        dimension[cells->bits] = largest;
    }
    memset(cells->spread, 0, sizeof cells->spread);
    for (unsigned k = 0; k < CELL_DIMENSIONS; k++)
        for (unsigned place = 0; used[k] > 0 && place < 1u << CELL_LEVELS; place++) {
            unsigned from = CELL_LEVELS;
            for (unsigned b = 0; b < cells->bits; b++)
                if (dimension[b] == k)
                    cells->spread[k][place] |= (uint16_t)((place >> --from & 1)
                                                          << (cells->bits - 1 - b));
        }
}

void rays_sort(Sorter *sorter, const Bvh *bvh, const Ray *ray, size_t count)
{
    assert(count <= sorter->most && bvh->kernel->keys != NULL);
    cells_init(&sorter->cells, bvh, ray, count);
    const uint32_t keys = RAY_KINDS << sorter->cells.bits;
    uint32_t *first = sorter->first;
    assert(keys < SORT_FIRST(sorter->most));
    memset(first, 0, (keys + 1) * sizeof *first);
    bvh->kernel->keys(&sorter->cells, ray, count, sorter->key);
    for (size_t i = 0; i < count; i++)
        first[sorter->key[i] + 1]++;
    for (uint32_t i = 0; i < keys; i++)
        first[i + 1] += first[i];
    for (size_t i = 0; i < count; i++) {
        const uint32_t to = first[sorter->key[i]]++;
        sorter->order[to] = (uint32_t)i;
        sorter->ray[to] = ray[i];
    }
}
