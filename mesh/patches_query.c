/* SPDX-License-Identifier: BSD-3-Clause */
/* Questions about patches: which one is at (s, t), a point of one, its weight and extent. */
#include <assert.h>
#include <math.h>

#include "math/sampling.h"
#include "mesh/slicers.h"
#include "mesh/patches_internal.h"

/* Points of a patch keep this far, in base cells, from its rim: (i + a) / n * n must fall into cell
 * i, and at i = 2^16 a double is off by 2^-36 after the two roundings. */
static const double CELL_MARGIN = 0x1p-32;

/* The tree of a side, PATCH_NONE when nothing there is divided. */
static inline uint32_t side_tree(const Patches *p, uint32_t surface, unsigned side)
{
    return p->tree_count == 0 ? PATCH_NONE : p->tree_first[side][surface];
}

static uint32_t triangle_at(const Patches *p, uint32_t surface, unsigned side, double s, double t)
{
    const uint32_t n = p->nu[surface], tree = side_tree(p, surface, side);
    const double x = s * n, y = t * n;
    const uint32_t j = patches_cell_of(y, n), i = patches_cell_of(x, n - j);
    double u = x - i, v = y - j;
    const uint32_t upper = i + j + 1 < n && u + v > 1;
    const uint32_t base = n * n - (n - j) * (n - j) + 2 * i + upper;
    if (tree == PATCH_NONE)
        return base;
    u = upper ? 1 - u : u;
    v = upper ? 1 - v : v;
    return patches_walk_triangle(p->tree, p->tree[tree + base], upper, &u, &v);
}

const PatchPart *patches_part_at(const Patches *p, const Surfaces *surfaces, uint32_t surface,
                                 uint32_t leaf, double s, double t)
{
    const PatchParted *parted = &p->parted[leaf & ~PATCH_PARTED];
    SurfacePoint at;
    uint32_t signs;
    surfaces_point(surfaces, surface, s, t, &at);
    if (!slicer_signs(surfaces, p->part_slicer + parted->first_slicer, parted->slicers, at.point,
                      &signs))
        return NULL;
    for (uint32_t k = parted->first_part; k < parted->first_part + parted->parts; k++)
        if (p->part[k].signs == signs)
            return &p->part[k];
    return NULL;
}

/* Of a tree's leaf, or a cell's number. */
static inline uint32_t patch_of_leaf(const Patches *p, const Surfaces *surfaces, uint32_t surface,
                                     uint32_t first, uint32_t leaf, double s, double t)
{
    if (p->parted_count == 0 || (leaf & PATCH_PARTED) == 0)
        return first + leaf;
    const PatchPart *part = patches_part_at(p, surfaces, surface, leaf, s, t);
    return part == NULL ? PATCH_NONE : part->patch;
}

uint32_t patches_at(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                    unsigned side, double s, double t)
{
    const uint32_t first = patches->first[side][surface];
    if (first == PATCH_NONE)
        return PATCH_NONE;
    if (surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        return patch_of_leaf(patches, surfaces, surface, first,
                             triangle_at(patches, surface, side, s, t), s, t);
    const uint32_t nu = patches->nu[surface], nv = patches->nv[surface];
    const uint32_t tree = side_tree(patches, surface, side);
    const uint32_t i = patches_cell_of(s * nu, nu), j = patches_cell_of(t * nv, nv);
    const uint32_t base = j * nu + i;
    if (tree == PATCH_NONE)
        return first + base;
    double u = s * nu - i, v = t * nv - j;
    const uint32_t leaf = patches_walk_quad(patches->tree, patches->tree[tree + base], &u, &v);
    return patch_of_leaf(patches, surfaces, surface, first, leaf, s, t);
}

static double keep_inside(double a, double margin) { return fmin(fmax(a, margin), 1 - margin); }

/* (a, b) shifted until it lies in the part, by steps of the sequence that fills squares most evenly
 * [roberts18]: all of the part is as likely as before. A part that fills less than 1 % of its box
 * may be missed; then its own place stands for it. */
static void part_place(const PatchPart *part, const PatchParted *parted, const Patches *p,
                       const Surfaces *surfaces, uint32_t patch, double a, double b,
                       PatchPoint *out)
{
    enum { TRIES = 256 };
    static const double step[2] = { 0.75487766624669276, 0.56984029099805327 };
    const uint32_t surface = p->surface[patch];
    const bool triangle = surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const double nu = ldexp(p->nu[surface], p->cell[patch].level);
    const double nv = ldexp(p->nv[surface], p->cell[patch].level);
    const double margin = ldexp(CELL_MARGIN, p->cell[patch].level);
    for (unsigned k = 0; k < TRIES; k++) {
        const double x = a + k * step[0], y = b + k * step[1];
        const double u = part->a0 + (x - floor(x)) * (double)(part->a1 - part->a0);
        const double v = part->b0 + (y - floor(y)) * (double)(part->b1 - part->b0);
        uint32_t signs;
        patches_cell_place(triangle, p->cell[patch], nu, nv, keep_inside(u, margin),
                           keep_inside(v, margin), &out->s, &out->t);
        surfaces_point(surfaces, surface, out->s, out->t, &out->point);
        if (slicer_signs(surfaces, p->part_slicer + parted->first_slicer, parted->slicers,
                         out->point.point, &signs)
            && signs == part->signs)
            return;
    }
    out->s = part->s;
    out->t = part->t;
    surfaces_point(surfaces, surface, out->s, out->t, &out->point);
}

static void triangle_cell_point(PatchCell cell, double n, double margin, double a, double b,
                                double *s, double *t)
{
    double u, v;
    sampling_triangle(a, b, &u, &v);
    u = margin + u * (1 - 3 * margin);
    v = margin + v * (1 - 3 * margin);
    *s = (cell.upper ? cell.i + 1 - u : cell.i + u) / n;
    *t = (cell.upper ? cell.j + 1 - v : cell.j + v) / n;
}

/* The piece of a merged patch that *a falls on; *a becomes the place within its share. */
static uint32_t choose_piece(const Patches *p, uint32_t patch, double *a)
{
    const uint32_t first = p->first_piece[patch];
    uint32_t low = first, high = p->first_piece[patch + 1] - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (p->piece_end[middle] <= *a)
            low = middle + 1;
        else
            high = middle;
    }
    const double start = low == first ? 0 : p->piece_end[low - 1];
    *a = (*a - start) / (p->piece_end[low] - start);
    return p->piece[low];
}

/* Area of what (a, b) runs over: the patch, or one piece of it. */
static double sampled_area(const Patches *p, const Surfaces *s, uint32_t patch, uint32_t surface)
{
    return patches_is_merged(p, patch) ? s->surface[surface].area : p->area[patch];
}

void patches_point(const Patches *patches, const Surfaces *surfaces, uint32_t patch, double a,
                   double b, PatchPoint *out)
{
    assert(patch < patches->count && out != NULL);
    const PatchCell cell = patches->cell[patch];
    uint32_t surface = patches->surface[patch];
    if (patches_is_merged(patches, patch))
        surface = choose_piece(patches, patch, &a);
    const double scale = (double)(1u << cell.level), margin = CELL_MARGIN * scale;
    const double nu = patches->nu[surface] * scale, nv = patches->nv[surface] * scale;
    const bool triangle = surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const PatchPart *part = patches_part_of(patches, patch);
    if (part != NULL) {
        part_place(part, &patches->parted[part->parted], patches, surfaces, patch, a, b, out);
    } else if (triangle) {
        triangle_cell_point(cell, nu, margin, a, b, &out->s, &out->t);
    } else {
        out->s = (cell.i + keep_inside(a, margin)) / nu;
        out->t = (cell.j + keep_inside(b, margin)) / nv;
    }
    if (part == NULL)
        surfaces_point(surfaces, surface, out->s, out->t, &out->point);
    if (patches->side[patch] == 1)
        out->point.normal = vec3_scale(out->point.normal, -1);
    out->surface = surface;
    const double share = part == NULL ? 1 : part->share;
    out->weight = triangle ? 1 : share * out->point.density
                                     / (nu * nv * sampled_area(patches, surfaces, patch, surface));
}

double patches_weight(const Patches *patches, const Surfaces *surfaces, uint32_t patch,
                      uint32_t surface, double s, double t)
{
    if (surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        return 1;
    SurfacePoint at;
    surfaces_point(surfaces, surface, s, t, &at);
    const double scale = (double)(1u << patches->cell[patch].level);
    const double cells = (patches->nu[surface] * scale) * (patches->nv[surface] * scale);
    const PatchPart *part = patches_part_of(patches, patch);
    const double share = part == NULL ? 1 : part->share;
    return share * at.density / (cells * sampled_area(patches, surfaces, patch, surface));
}

/* --- extent ----------------------------------------------------------------------------------- */

/* Length of an edge from (s0, t0) to (s1, t1), along two chords: of an arc of 45 degrees 99 %. */
static double edge_length(const Surfaces *surfaces, uint32_t surface, const double from[2],
                          const double to[2])
{
    SurfacePoint a, b, c;
    surfaces_point(surfaces, surface, from[0], from[1], &a);
    surfaces_point(surfaces, surface, (from[0] + to[0]) / 2, (from[1] + to[1]) / 2, &b);
    surfaces_point(surfaces, surface, to[0], to[1], &c);
    return vec3_length(vec3_sub(b.point, a.point)) + vec3_length(vec3_sub(c.point, b.point));
}

double patches_extent(const Patches *patches, const Surfaces *surfaces, uint32_t patch)
{
    assert(patch < patches->count);
    if (patches_is_merged(patches, patch))
        return sqrt(patches->area[patch]);
    const uint32_t surface = patches->surface[patch];
    const PatchCell cell = patches->cell[patch];
    const double nu = ldexp(patches->nu[surface], cell.level);
    const double nv = ldexp(patches->nv[surface], cell.level);
    const bool triangle = surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const double s0 = cell.i / nu, s1 = (cell.i + 1) / nu;
    const double t0 = cell.j / nv, t1 = (cell.j + 1) / nv;
    /* All cells of a triangle are alike: the lower one of the square serves for both. */
    const double corner[4][2] = { { s0, t0 }, { s1, t0 }, { triangle ? s0 : s1, t1 }, { s0, t1 } };
    const unsigned corners = triangle ? 3 : 4;
    double extent = 0;
    for (unsigned k = 0; k < corners; k++)
        extent = fmax(extent, edge_length(surfaces, surface, corner[k],
                                          corner[(k + 1) % corners]));
    return extent;
}
