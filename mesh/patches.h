/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches.h -- surfaces cut into patches: the flat arrays that solvers work on.
 *
 * Each side of a surface that is in use (front 0, back 1) has patches of its own, cut on a grid:
 * quads and shapes nu x nv cells of (s,t), triangles n x n congruent ones (nu = nv = n). Both sides
 * of a surface are cut alike. Patches of one side of one surface are consecutive.
 *
 *   quad, shape   cell (i, j), i < nu, j < nv:             first + j * nu + i
 *   triangle      cell (i, j, upper), i + j (+ 1) < n:     first + n^2 - (n-j)^2 + 2 i + upper
 *
 * Vertices carry values (radiosity is smoothed to them): patches that continue each other smoothly
 * on the same side with the same material share them; at creases and material borders there are
 * several vertices at one position, bit for bit equal, so that the mesh has no crack.
 * A patch is a polygon: its 3 or 4 corners, and between them vertices of finer neighbours on its
 * edges (T-vertices are built in on both sides).
 * Units    scene units.
 * Threads  never changes once made.
 */
#ifndef MESH_PATCHES_H
#define MESH_PATCHES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "mesh/surfaces.h"

#define PATCH_NONE UINT32_MAX

typedef struct {
    double   size;         /* greatest wanted patch edge, scene units; 0: from `wanted` */
    uint32_t wanted;       /* total number of patches aimed at; 0: 10,000 */
    const uint8_t *sides;  /* [surfaces->count]  bit 0: front in use, bit 1: back; NULL: both */
} PatchOptions;

typedef struct {
    uint32_t  count;
    uint32_t *surface;     /* [count] */
    uint8_t  *side;        /* [count]  0 front, 1 back */
    uint32_t *material;    /* [count] */
    uint32_t *group;       /* [count] */
    double   *area;        /* [count]  > 0; exact on shapes */
    Vec3     *centre;      /* [count]  on the surface */
    Vec3     *normal;      /* [count]  unit, at the centre, out of the patch's side */
    uint32_t *first_corner;/* [count + 1] */
    uint32_t *corner;      /* [first_corner[count]]  vertices, counter-clockwise from its side */
    uint32_t  vertex_count;
    Vec3     *position;    /* [vertex_count] */
    /* per surface */
    uint32_t  surface_count;
    uint32_t *first[2];    /* [surface_count]  first patch of front / back; PATCH_NONE: unused */
    uint16_t *nu, *nv;     /* [surface_count]  divisions; triangles: nu = nv */
    /* vertices of the grid of side k: grid_vertex[grid_first[k][surface] + j * (nu + 1) + i] for
     * quads and shapes; triangles use the lower left half of an (n+1) x (n+1) grid, the rest is
     * PATCH_NONE. */
    uint32_t *grid_first[2];
    uint32_t *grid_vertex;
    uint32_t  grid_count;
    double    size;        /* the patch edge that was used */
    double    total_area;
} Patches;

/* owns   the caller frees with patches_destroy.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT when more than 2^31 patches would be made. */
Patches *patches_create(const Surfaces *surfaces, const PatchOptions *options,
                        const Monitor *monitor, Error *err);
Patches *patches_destroy(Patches *patches);

/* Patch at (s, t) of a surface's side, or PATCH_NONE when that side is not in use. s and t may be
 * off [0,1] by rounding.
 * hot    checks nothing in release builds. */
uint32_t patches_at(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                    unsigned side, double s, double t);

/* A point of patch i for (a, b) in [0,1)^2, with the (s, t) it lies at. On shapes and bent quads
 * points are not area-uniform: weight them by density * (range of (s,t)) / area.
 * `weight` gets that factor; its mean over (a, b) is 1. normal points out of the patch's side. */
typedef struct {
    SurfacePoint point;
    double       s, t;
    double       weight;
} PatchPoint;
void patches_point(const Patches *patches, const Surfaces *surfaces, uint32_t patch, double a,
                   double b, PatchPoint *out);

/* Vertices and weights (sum 1) that interpolate vertex values at (s, t) of a surface's side: 3 or 4
 * of them; returns how many, 0 for an unused side. */
int patches_interpolate(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                        unsigned side, double s, double t, uint32_t vertex[4], double weight[4]);

/* Invariants: areas positive, sum over sides = area of the surface's sides in use, indices in
 * range, each patch found again by patches_at at its centre, polygons closed. */
bool patches_check(const Patches *patches, const Surfaces *surfaces);

#endif
