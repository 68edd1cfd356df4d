/* SPDX-License-Identifier: BSD-3-Clause */
/* Welding by hash grids: one grid per power of two of the tolerances, all in one table. */
#include "mesh/weld.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/array.h"

enum {
    LEVELS = 63,      /* powers of two of the tolerance, from the largest down; below them: exact */
    CELL_FACTOR = 16, /* cell edge / tolerance: a search seldom looks into a second cell */
};

/* Cells further than this many from the origin cannot be told apart in 64 bits; a position out
 * there is out of the reach of a level this fine (position_tolerance: 2^21 tolerances). */
static const double CELL_LIMIT = 0x1p40;

typedef struct {
    const Vec3 *position;
    const double *tolerance;
    Weld      *weld;
    uint32_t  *head;     /* [mask + 1]  first vertex of a bucket */
    uint32_t  *next;     /* [vertex_count]  next vertex of the same bucket */
    uint32_t  *origin;   /* [vertex_count]  the position it came from */
    uint32_t   mask;
    int        top;      /* exponent of the largest tolerance */
    uint64_t   used;     /* levels that hold a vertex */
} Grid;

static int tolerance_level(const Grid *grid, double tolerance)
{
    int exponent = 0;
    if (!(tolerance > 0))
        return LEVELS;
    (void)frexp(tolerance, &exponent);
    const int level = grid->top - exponent;
    return level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : level;
}

static double level_cell(const Grid *grid, int level)
{
    return ldexp(CELL_FACTOR, grid->top - level);
}

static uint32_t cell_hash(const Grid *grid, int level, int64_t x, int64_t y, int64_t z)
{
    uint64_t h = (uint64_t)level + 1;
    h = (h ^ (uint64_t)x) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 29) ^ (uint64_t)y) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 32) ^ (uint64_t)z) * 0x94D049BB133111EBu;
    return (uint32_t)(h >> 32) & grid->mask;
}

/* Bucket of a position that only equal ones are welded to. */
static uint32_t exact_bucket(const Grid *grid, Vec3 p)
{
    int64_t bits[3];
    const double x[3] = { p.x + 0.0, p.y + 0.0, p.z + 0.0 }; /* -0 is 0 */
    memcpy(bits, x, sizeof bits);
    return cell_hash(grid, LEVELS, bits[0], bits[1], bits[2]);
}

/* The best vertex of one bucket: nearest, then first made. */
static void bucket_search(const Grid *grid, uint32_t bucket, uint32_t i, double *best,
                          uint32_t *vertex)
{
    const Vec3 p = grid->position[i];
    for (uint32_t v = grid->head[bucket]; v != WELD_NONE; v = grid->next[v]) {
        const double reach = fmin(grid->tolerance[i], grid->tolerance[grid->origin[v]]);
        const double distance = vec3_length(vec3_sub(p, grid->weld->position[v]));
        if (distance <= reach && (distance < *best || (distance == *best && v < *vertex))) {
            *best = distance;
            *vertex = v;
        }
    }
}

static void level_search(const Grid *grid, int level, uint32_t i, double *best, uint32_t *vertex)
{
    const Vec3 p = grid->position[i];
    if (level == LEVELS) {
        bucket_search(grid, exact_bucket(grid, p), i, best, vertex);
        return;
    }
    const double cell = level_cell(grid, level);
    const double reach = fmin(grid->tolerance[i], cell / CELL_FACTOR);
    if (fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) / cell > CELL_LIMIT)
        return;
    int64_t lo[3], hi[3];
    for (int k = 0; k < 3; k++) {
        lo[k] = (int64_t)floor((vec3_axis(p, k) - reach) / cell);
        hi[k] = (int64_t)floor((vec3_axis(p, k) + reach) / cell);
    }
    for (int64_t z = lo[2]; z <= hi[2]; z++)
        for (int64_t y = lo[1]; y <= hi[1]; y++)
            for (int64_t x = lo[0]; x <= hi[0]; x++)
                bucket_search(grid, cell_hash(grid, level, x, y, z), i, best, vertex);
}

static void grid_insert(Grid *grid, uint32_t i)
{
    Weld *weld = grid->weld;
    const Vec3 p = grid->position[i];
    const int level = tolerance_level(grid, grid->tolerance[i]);
    const double cell = level_cell(grid, level);
    const uint32_t v = weld->vertex_count++;
    weld->position[v] = p;
    weld->vertex[i] = v;
    grid->origin[v] = i;
    if (level < LEVELS && fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))) / cell > CELL_LIMIT)
        return; /* found by nobody: it stays a vertex of its own */
    const uint32_t bucket = level == LEVELS
        ? exact_bucket(grid, p)
        : cell_hash(grid, level, (int64_t)floor(p.x / cell), (int64_t)floor(p.y / cell),
                    (int64_t)floor(p.z / cell));
    grid->next[v] = grid->head[bucket];
    grid->head[bucket] = v;
    grid->used |= UINT64_C(1) << level;
}

static void grid_weld(Grid *grid, uint32_t count)
{
    Weld *weld = grid->weld;
    for (uint32_t i = 0; i < count; i++) {
        weld->vertex[i] = WELD_NONE;
        if (!(grid->tolerance[i] >= 0) || !vec3_finite(grid->position[i]))
            continue;
        double best = INFINITY;
        uint32_t vertex = WELD_NONE;
        for (uint64_t levels = grid->used; levels != 0; levels &= levels - 1)
            level_search(grid, __builtin_ctzll(levels), i, &best, &vertex);
        if (vertex == WELD_NONE) {
            grid_insert(grid, i);
        } else {
            weld->vertex[i] = vertex;
            weld->welded++;
        }
    }
}

static int largest_exponent(const double *tolerance, uint32_t count)
{
    double largest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (isfinite(tolerance[i]))
            largest = fmax(largest, tolerance[i]);
    int exponent = 0;
    (void)frexp(largest, &exponent);
    return exponent;
}

bool weld_create(Weld *weld, const Vec3 *position, const double *tolerance, uint32_t count,
                 Error *err)
{
    assert(weld != NULL && err != NULL);
    assert(count == 0 || (position != NULL && tolerance != NULL));
    uint32_t buckets = 1;
    while (buckets < count && buckets < UINT32_C(1) << 31)
        buckets *= 2;
    *weld = (Weld){ 0 };
    Grid grid = { .position = position, .tolerance = tolerance, .weld = weld,
                  .mask = buckets - 1, .top = largest_exponent(tolerance, count) };
    weld->vertex = array_create(count, sizeof *weld->vertex, "vertices", err);
    weld->position = array_create(count, sizeof *weld->position, "vertices", err);
    grid.head = array_create(buckets, sizeof *grid.head, "vertex grid", err);
    grid.next = array_create(count, sizeof *grid.next, "vertex grid", err);
    grid.origin = array_create(count, sizeof *grid.origin, "vertex grid", err);
    if (error_is_set(err)) {
        weld_clear(weld);
    } else {
        for (uint32_t b = 0; b < buckets; b++)
            grid.head[b] = WELD_NONE;
        grid_weld(&grid, count);
    }
    array_free(grid.head);
    array_free(grid.next);
    array_free(grid.origin);
    return !error_is_set(err);
}

void weld_clear(Weld *weld)
{
    array_free(weld->vertex);
    array_free(weld->position);
    *weld = (Weld){ 0 };
}
