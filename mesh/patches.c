/* SPDX-License-Identifier: BSD-3-Clause */
/* The way from surfaces to patches: divide, find edges, make vertices, polygons, measures. */
#include "mesh/patches.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

static bool allocate_surfaces(PatchBuilder *b)
{
    Patches *out = b->out;
    const uint32_t n = out->surface_count = b->surfaces->count;
    out->nu = array_create(n, sizeof *out->nu, "patches", b->err);
    out->nv = array_create(n, sizeof *out->nv, "patches", b->err);
    for (unsigned side = 0; side < 2; side++) {
        out->first[side] = array_create(n, sizeof *out->first[side], "patches", b->err);
        out->first_face[side] = array_create(n, sizeof *out->first_face[side], "patches", b->err);
        out->tree_first[side] = array_create(n, sizeof *out->tree_first[side], "patches", b->err);
        out->grid_first[side] = array_create(n, sizeof *out->grid_first[side], "patches", b->err);
    }
    return !error_is_set(b->err);
}

static void number_patches(PatchBuilder *b)
{
    Patches *out = b->out;
    for (uint32_t i = 0; i < out->surface_count; i++)
        for (unsigned side = 0; side < 2; side++) {
            out->first[side][i] = out->tree_first[side][i] = PATCH_NONE;
            if (patches_side_used(b, i, side)) {
                out->first[side][i] = out->first_face[side][i] = out->count;
                out->count += patches_of_side(out, b->surfaces, i);
            }
        }
}

static bool allocate_patches(PatchBuilder *b)
{
    Patches *out = b->out;
    const uint32_t n = out->count;
    Error *err = b->err;
    out->surface = array_create(n, sizeof *out->surface, "patches", err);
    out->side = array_create(n, sizeof *out->side, "patches", err);
    out->material = array_create(n, sizeof *out->material, "patches", err);
    out->group = array_create(n, sizeof *out->group, "patches", err);
    out->area = array_create(n, sizeof *out->area, "patches", err);
    out->centre = array_create(n, sizeof *out->centre, "patches", err);
    out->normal = array_create(n, sizeof *out->normal, "patches", err);
    out->cell = array_create(n, sizeof *out->cell, "patches", err);
    out->first_piece = array_create((size_t)n + 1, sizeof *out->first_piece, "patches", err);
    out->piece = array_create(0, sizeof *out->piece, "patches", err);
    out->piece_end = array_create(0, sizeof *out->piece_end, "patches", err);
    out->tree = array_create(0, sizeof *out->tree, "patches", err);
    out->face_of = array_create(n, sizeof *out->face_of, "patches", err);
    out->face_patch = array_create(n, sizeof *out->face_patch, "patches", err);
    out->face_count = n;
    out->first_corner = array_create((size_t)n + 1, sizeof *out->first_corner, "patches", err);
    b->corner_capacity = 4 * (size_t)n;
    out->corner = array_create(b->corner_capacity, sizeof *out->corner, "patch corners", err);
    return !error_is_set(err);
}

/* Area of s0..s1, t0..t1 that lies under the diagonal t = s, in units of (s, t). */
static double under_diagonal(double s0, double s1, double t0, double t1)
{
    if (s0 >= t1)
        return (s1 - s0) * (t1 - t0);
    if (s1 <= t0)
        return 0;
    /* The integral over s of clamp(s - t0, 0, t1 - t0): a slope, then a plateau. */
    const double from = fmax(s0, t0), to = fmin(s1, t1);
    const double slope = (to - from) * ((to - t0) + (from - t0)) / 2;
    return slope + fmax(s1 - t1, 0) * (t1 - t0);
}

static double quad_cell_area(const Surfaces *s, uint32_t surface, double s0, double s1, double t0,
                             double t1)
{
    SurfacePoint under, over;
    surfaces_point(s, surface, 1, 0, &under);
    surfaces_point(s, surface, 0, 1, &over);
    const double whole = (s1 - s0) * (t1 - t0), part = under_diagonal(s0, s1, t0, t1);
    return under.density * part + over.density * (whole - part);
}

static double cell_area(const PatchBuilder *b, uint32_t surface, PatchCell cell)
{
    const Surface *f = &b->surfaces->surface[surface];
    const double nu = b->out->nu[surface], nv = b->out->nv[surface];
    if (f->kind == SURFACE_TRIANGLE)
        return f->area / (nu * nv);
    const double s0 = cell.i / nu, s1 = (cell.i + 1) / nu;
    const double t0 = cell.j / nv, t1 = (cell.j + 1) / nv;
    if (f->kind == SURFACE_QUAD)
        return quad_cell_area(b->surfaces, surface, s0, s1, t0, t1);
    return shape_area(&b->surfaces->shape[f->primitive - b->surfaces->triangle_count], s0, s1, t0,
                      t1);
}

static void cell_centre(const PatchBuilder *b, uint32_t surface, PatchCell cell, SurfacePoint *at)
{
    const double nu = b->out->nu[surface], nv = b->out->nv[surface];
    double within = 0.5;
    if (b->surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        within = cell.upper ? 2.0 / 3 : 1.0 / 3;
    surfaces_point(b->surfaces, surface, (cell.i + within) / nu, (cell.j + within) / nv, at);
}

static void measure_side(PatchBuilder *b, uint32_t surface, unsigned side)
{
    Patches *out = b->out;
    const uint32_t first = out->first[side][surface];
    const uint32_t front = out->first[0][surface];
    const uint32_t count = patches_of_side(out, b->surfaces, surface);
    for (uint32_t k = 0; k < count; k++) {
        const PatchCell cell = patches_cell(out, b->surfaces, surface, k);
        const uint32_t i = first + k;
        SurfacePoint at;
        cell_centre(b, surface, cell, &at);
        out->surface[i] = surface;
        out->side[i] = (uint8_t)side;
        out->cell[i] = cell;
        out->face_of[i] = out->face_patch[i] = i;
        out->material[i] = surfaces_material(b->surfaces, surface, side);
        out->group[i] = surfaces_group(b->surfaces, surface, side);
        out->centre[i] = at.point;
        out->normal[i] = side == 0 ? at.normal : vec3_scale(at.normal, -1);
        /* Both sides are cut alike. */
        out->area[i] = side == 1 && front != PATCH_NONE ? out->area[front + k]
                                                        : cell_area(b, surface, cell);
        out->total_area += out->area[i];
    }
}

static void builder_clear(PatchBuilder *b)
{
    edges_clear(&b->edges);
    array_free(b->from);
    array_free(b->to);
    array_free(b->mate);
    array_free(b->point_first);
    array_free(b->fraction);
    array_free(b->parent);
    array_free(b->corner_vertex);
    array_free(b->run);
}

static bool build(PatchBuilder *b, const PatchOptions *options, const Monitor *monitor)
{
    if (!allocate_surfaces(b) || !patches_divide(b, options, monitor))
        return false;
    number_patches(b);
    if (!patches_find_edges(b) || !patches_make_vertices(b) || !allocate_patches(b)
        || !patches_make_polygons(b))
        return false;
    for (uint32_t i = 0; i < b->out->surface_count; i++)
        for (unsigned side = 0; side < 2; side++)
            if (patches_side_used(b, i, side))
                measure_side(b, i, side);
    return true;
}

Patches *patches_create(const Surfaces *surfaces, const PatchOptions *options,
                        const Monitor *monitor, Error *err)
{
    assert(surfaces != NULL && options != NULL && err != NULL);
    assert(options->size >= 0);
    if (error_is_set(err))
        return NULL;
    PatchBuilder b = { .surfaces = surfaces, .sides = options->sides, .err = err };
    b.out = array_create(1, sizeof *b.out, "patches", err);
    if (b.out == NULL)
        return NULL;
    const bool ok = build(&b, options, monitor);
    builder_clear(&b);
    return ok ? b.out : patches_destroy(b.out);
}

Patches *patches_destroy(Patches *patches)
{
    if (patches == NULL)
        return NULL;
    array_free(patches->surface);
    array_free(patches->side);
    array_free(patches->material);
    array_free(patches->group);
    array_free(patches->area);
    array_free(patches->centre);
    array_free(patches->normal);
    array_free(patches->cell);
    array_free(patches->first_piece);
    array_free(patches->piece);
    array_free(patches->piece_end);
    array_free(patches->tree);
    array_free(patches->face_of);
    array_free(patches->face_patch);
    array_free(patches->first_corner);
    array_free(patches->corner);
    array_free(patches->position);
    array_free(patches->nu);
    array_free(patches->nv);
    array_free(patches->grid_vertex);
    for (unsigned side = 0; side < 2; side++) {
        array_free(patches->first[side]);
        array_free(patches->grid_first[side]);
        array_free(patches->first_face[side]);
        array_free(patches->tree_first[side]);
    }
    array_free(patches);
    return NULL;
}
