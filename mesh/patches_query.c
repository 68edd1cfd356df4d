/* SPDX-License-Identifier: BSD-3-Clause */
/* Questions about patches: which one is at (s, t), a point of one, weights of vertices. */
#include <assert.h>
#include <math.h>

#include "math/sampling.h"
#include "mesh/patches_internal.h"

/* Points of a patch keep this far, in cells, from its rim: (i + a) / n * n must fall into cell i,
 * and at i = 2^16 a double is off by 2^-36 after the two roundings. */
static const double CELL_MARGIN = 0x1p-32;

/* Row of a triangle's grid that patch `index` lies in: largest j with n^2 - (n-j)^2 <= index. */
static uint32_t triangle_row(uint32_t n, uint32_t index)
{
    const uint64_t rest = (uint64_t)n * n - index; /* (n-j)^2 >= rest */
    uint64_t root = (uint64_t)sqrt((double)rest);
    while (root * root < rest)
        root++;
    while ((root - 1) * (root - 1) >= rest)
        root--;
    return n - (uint32_t)root;
}

PatchCell patches_cell(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                       uint32_t index)
{
    assert(index < patches_of_side(patches, surfaces, surface));
    const uint32_t n = patches->nu[surface];
    if (surfaces->surface[surface].kind != SURFACE_TRIANGLE)
        return (PatchCell){ .i = index % n, .j = index / n };
    const uint32_t j = triangle_row(n, index);
    const uint32_t left = index - (n * n - (n - j) * (n - j));
    return (PatchCell){ .i = left / 2, .j = j, .upper = left % 2 };
}

/* Cell of x in 0 .. n - 1; outside, the nearest one; a NaN gives 0. */
static inline uint32_t cell_of(double x, uint32_t n)
{
    return !(x > 0) ? 0 : x < n ? (uint32_t)x : n - 1;
}

uint32_t patches_at(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                    unsigned side, double s, double t)
{
    const uint32_t first = patches->first[side][surface];
    if (first == PATCH_NONE)
        return PATCH_NONE;
    const uint32_t n = patches->nu[surface];
    if (surfaces->surface[surface].kind != SURFACE_TRIANGLE) {
        const uint32_t nv = patches->nv[surface];
        return first + cell_of(t * nv, nv) * n + cell_of(s * n, n);
    }
    const double x = s * n, y = t * n;
    const uint32_t j = cell_of(y, n), i = cell_of(x, n - j);
    const uint32_t upper = i + j + 1 < n && (x - i) + (y - j) > 1;
    return first + n * n - (n - j) * (n - j) + 2 * i + upper;
}

static double keep_inside(double a) { return fmin(fmax(a, CELL_MARGIN), 1 - CELL_MARGIN); }

static void triangle_cell_point(PatchCell cell, uint32_t n, double a, double b, double *s,
                                double *t)
{
    double u, v;
    sampling_triangle(a, b, &u, &v);
    u = CELL_MARGIN + u * (1 - 3 * CELL_MARGIN);
    v = CELL_MARGIN + v * (1 - 3 * CELL_MARGIN);
    *s = (cell.upper ? cell.i + 1 - u : cell.i + u) / n;
    *t = (cell.upper ? cell.j + 1 - v : cell.j + v) / n;
}

void patches_point(const Patches *patches, const Surfaces *surfaces, uint32_t patch, double a,
                   double b, PatchPoint *out)
{
    assert(patch < patches->count && out != NULL);
    const uint32_t surface = patches->surface[patch];
    const unsigned side = patches->side[patch];
    const uint32_t nu = patches->nu[surface], nv = patches->nv[surface];
    const PatchCell cell = patches_cell(patches, surfaces, surface,
                                        patch - patches->first[side][surface]);
    const bool triangle = surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    if (triangle) {
        triangle_cell_point(cell, nu, a, b, &out->s, &out->t);
    } else {
        out->s = (cell.i + keep_inside(a)) / nu;
        out->t = (cell.j + keep_inside(b)) / nv;
    }
    surfaces_point(surfaces, surface, out->s, out->t, &out->point);
    if (side == 1)
        out->point.normal = vec3_scale(out->point.normal, -1);
    out->surface = surface;
    out->weight = triangle ? 1 : out->point.density / ((double)nu * nv * patches->area[patch]);
}

static int interpolate_triangle(const uint32_t *grid, uint32_t n, double s, double t,
                                uint32_t vertex[PATCH_WEIGHTS], double weight[PATCH_WEIGHTS])
{
    const double x = fmax(s * n, 0), y = fmax(t * n, 0);
    const uint32_t j = cell_of(y, n), i = cell_of(x, n - j), row = n + 1;
    const double u = fmin(x - i, 1), v = fmin(y - j, 1);
    if (i + j + 1 < n && u + v > 1) {
        vertex[0] = grid[(size_t)(j + 1) * row + i + 1];
        vertex[1] = grid[(size_t)(j + 1) * row + i];
        vertex[2] = grid[(size_t)j * row + i + 1];
        weight[1] = 1 - u;
        weight[2] = 1 - v;
        weight[0] = u + v - 1;
        return 3;
    }
    /* Past the hypotenuse by rounding: back onto it. */
    const double scale = 1 / fmax(u + v, 1);
    vertex[0] = grid[(size_t)j * row + i];
    vertex[1] = grid[(size_t)j * row + i + 1];
    vertex[2] = grid[(size_t)(j + 1) * row + i];
    weight[1] = u * scale;
    weight[2] = v * scale;
    weight[0] = fmax(1 - weight[1] - weight[2], 0);
    return 3;
}

int patches_interpolate(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                        unsigned side, double s, double t, uint32_t vertex[PATCH_WEIGHTS],
                        double weight[PATCH_WEIGHTS])
{
    assert(surface < patches->surface_count && side < 2);
    if (patches->first[side][surface] == PATCH_NONE)
        return 0;
    const uint32_t *grid = patches->grid_vertex + patches->grid_first[side][surface];
    const uint32_t nu = patches->nu[surface], nv = patches->nv[surface], row = nu + 1;
    if (surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        return interpolate_triangle(grid, nu, s, t, vertex, weight);
    const uint32_t i = cell_of(s * nu, nu), j = cell_of(t * nv, nv);
    const double u = fmin(fmax(s * nu - i, 0), 1), v = fmin(fmax(t * nv - j, 0), 1);
    vertex[0] = grid[(size_t)j * row + i];
    vertex[1] = grid[(size_t)j * row + i + 1];
    vertex[2] = grid[(size_t)(j + 1) * row + i + 1];
    vertex[3] = grid[(size_t)(j + 1) * row + i];
    weight[0] = (1 - u) * (1 - v);
    weight[1] = u * (1 - v);
    weight[2] = u * v;
    weight[3] = (1 - u) * v;
    return 4;
}

double patches_weight(const Patches *patches, const Surfaces *surfaces, uint32_t patch,
                      uint32_t surface, double s, double t)
{
    if (surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        return 1;
    SurfacePoint at;
    surfaces_point(surfaces, surface, s, t, &at);
    const double cells = (double)patches->nu[surface] * patches->nv[surface];
    return at.density / (cells * patches->area[patch]);
}

double patches_extent(const Patches *patches, const Surfaces *surfaces, uint32_t patch)
{
    (void)surfaces;
    return sqrt(patches->area[patch]);
}

Patches *patches_split(const Patches *patches, const Surfaces *surfaces, const uint8_t *split,
                       uint32_t **parent, Error *err)
{
    (void)patches;
    (void)surfaces;
    (void)split;
    *parent = NULL;
    error_set(err, ERROR_FAILED, "cannot split yet");
    return NULL;
}
