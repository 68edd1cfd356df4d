/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays by kind (major axis and signs of the direction), then by cells of direction and origin, the
 * bits of both interleaved so that a cell's rays spread about as far by the one as by the other
 * over half of the scene. One pass of counting; within a cell the caller's order stays. */
#include "raycast/sort.h"

#include <assert.h>
#include <math.h>

#define KINDS 24u
#define CELL_BITS_MAX 10u
#define DIMENSIONS 5 /* of a cell: two slopes, three coordinates */
#define LEVELS 8u
/* Rays that a cell should get: a packet's worth, and some. */
#define CELL_RAYS 16u

typedef struct {
    float    lo[3], scale[DIMENSIONS];   /* to 0 .. 2^LEVELS - 1 */
    uint16_t spread[DIMENSIONS][1u << LEVELS];
    unsigned bits;
} Cells;

static void origin_box(const Ray *ray, size_t count, float lo[3], float hi[3])
{
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (size_t i = 0; i < count; i++) {
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
    float hi[3], extent[DIMENSIONS], size = 0;
    origin_box(ray, count, cells->lo, hi);
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, bvh->hi[k] - bvh->lo[k]);
    /* A slope of 1 over half the scene. */
    extent[0] = extent[1] = 0.5f * size;
    for (int k = 0; k < 3; k++)
        extent[2 + k] = hi[k] - cells->lo[k];
    unsigned used[DIMENSIONS] = { 0 }, dimension[CELL_BITS_MAX];
    cells->bits = 0;
    float left[DIMENSIONS];
    for (int k = 0; k < DIMENSIONS; k++) {
        left[k] = extent[k] < INFINITY ? extent[k] : 0;
        const float range = k < 2 ? 1 : extent[k];
        cells->scale[k] = range > 0 && range < INFINITY ? (float)(1u << LEVELS) / range : 0;
    }
    while (cells->bits < CELL_BITS_MAX && (size_t)CELL_RAYS << cells->bits < 4 * count / 3 / 8) {
        unsigned largest = 0;
        for (unsigned k = 1; k < DIMENSIONS; k++)
            largest = left[k] > left[largest] ? k : largest;
        if (used[largest] == LEVELS)
            break;
        left[largest] /= 2;
        used[largest]++;
        dimension[cells->bits++] = largest;
    }
    for (unsigned k = 0; k < DIMENSIONS; k++)
        for (unsigned q = 0; q < 1u << LEVELS; q++) {
            unsigned from = LEVELS, key = 0;
            for (unsigned b = 0; b < cells->bits; b++)
                if (dimension[b] == k)
                    key |= (q >> --from & 1) << (cells->bits - 1 - b);
            cells->spread[k][q] = (uint16_t)key;
        }
}

static unsigned quantised(float x)
{
    /* NaN too ends somewhere. */
    return x >= 0 && x < (float)(1u << LEVELS) ? (unsigned)x : x > 0 ? (1u << LEVELS) - 1 : 0;
}

static uint32_t ray_key(const Cells *cells, const Ray *ray)
{
    const float ax = fabsf(ray->dx), ay = fabsf(ray->dy), az = fabsf(ray->dz);
    const unsigned axis = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    const float z = axis == 0 ? ax : axis == 1 ? ay : az;
    const float x = axis == 0 ? ay : axis == 1 ? az : ax;
    const float y = axis == 0 ? az : axis == 1 ? ax : ay;
    const unsigned octant = (unsigned)(signbit(ray->dx) != 0) | (unsigned)(signbit(ray->dy) != 0) << 1
                            | (unsigned)(signbit(ray->dz) != 0) << 2;
    const float inverse = 1 / z;
    uint32_t cell = cells->spread[0][quantised(x * inverse * cells->scale[0])];
    cell |= cells->spread[1][quantised(y * inverse * cells->scale[1])];
    cell |= cells->spread[2][quantised((ray->ox - cells->lo[0]) * cells->scale[2])];
    cell |= cells->spread[3][quantised((ray->oy - cells->lo[1]) * cells->scale[3])];
    cell |= cells->spread[4][quantised((ray->oz - cells->lo[2]) * cells->scale[4])];
    return (axis * 8 + octant) << cells->bits | cell;
}

void rays_sort(const Bvh *bvh, const Ray *ray, size_t count, uint32_t *order)
{
    assert(count <= SORT_MOST && order != NULL);
    Cells cells;
    uint32_t first[(KINDS << CELL_BITS_MAX) + 1];
    uint16_t key[SORT_MOST];
    cells_init(&cells, bvh, ray, count);
    const uint32_t keys = KINDS << cells.bits;
    for (uint32_t i = 0; i <= keys; i++)
        first[i] = 0;
    for (size_t i = 0; i < count; i++) {
        key[i] = (uint16_t)ray_key(&cells, &ray[i]);
        first[key[i] + 1]++;
    }
    for (uint32_t i = 0; i < keys; i++)
        first[i + 1] += first[i];
    for (size_t i = 0; i < count; i++)
        order[first[key[i]]++] = (uint32_t)i;
}
