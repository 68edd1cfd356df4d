/* SPDX-License-Identifier: BSD-3-Clause */
/* Quadtrees divided in balance: where a cell is divided, cells of its own size must be there over
 * all its edges, on the same surface and on those that continue it smoothly. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

/* Grids of surfaces that meet may differ: over their edge a cell may be this much longer than the
 * one that is divided. Lengths change by factors of 2: this rounds to the nearest of them, so that
 * two grids never take turns in dividing each other. */
static const double LONGER_MOST = 1.4142135623730951;

/* Cells that overlap by less than this part of one only touch: far more than fractions are off by,
 * far less than any overlap that matters. */
static const double OVERLAP_LEAST = 1e-3;

static bool wish_for(PatchForest *f, uint32_t surface, unsigned side, PatchCell cell)
{
    if (!array_reserve((void **)&f->wish, &f->wish_capacity, f->wish_count + 1, sizeof *f->wish,
                       "patch trees", f->b->err))
        return false;
    f->wish[f->wish_count++] = (PatchWish){ .surface = surface, .cell = cell,
                                            .side = (uint8_t)side };
    return true;
}

/* --- neighbours ------------------------------------------------------------------------------- */

static bool wrap(uint32_t *x, int step, uint32_t n, bool round)
{
    if (step < 0 ? *x > 0 : *x + 1 < n) {
        *x = step < 0 ? *x - 1 : *x + 1;
        return true;
    }
    *x = step < 0 ? n - 1 : 0;
    return round;
}

/* The cell of the same size over edge k; false at the outline. */
static bool cell_across(const PatchForest *f, uint32_t surface, PatchCell cell, unsigned k,
                        PatchCell *other)
{
    const Surface *at = &f->b->surfaces->surface[surface];
    const Shape *shape = patches_shape(f->b->surfaces, at);
    const uint32_t nu = (uint32_t)f->b->out->nu[surface] << cell.level;
    const uint32_t nv = (uint32_t)f->b->out->nv[surface] << cell.level;
    *other = cell;
    if (at->kind == SURFACE_TRIANGLE) {
        other->upper = !cell.upper;
        if (cell.upper) {
            other->j += k == 0;
            other->i += k == 2;
            return true;
        }
        other->j -= k == 0;
        other->i -= k == 2;
        return k == 0 ? cell.j > 0 : k == 2 ? cell.i > 0 : cell.i + cell.j + 1 < nu;
    }
    if (k % 2 == 1)
        return wrap(&other->i, k == 1 ? 1 : -1, nu, shape != NULL);
    return wrap(&other->j, k == 2 ? 1 : -1, nv, shape != NULL && shape->kind == SHAPE_TORUS);
}

/* Place of a cell on an edge of its surface: interval m of the edge's divisions at its level. */
static uint32_t cell_on_edge(const PatchForest *f, uint32_t surface, PatchCell cell, unsigned k)
{
    const bool triangle = f->b->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const uint32_t nu = (uint32_t)f->b->out->nu[surface] << cell.level;
    const uint32_t nv = (uint32_t)f->b->out->nv[surface] << cell.level;
    return k == 0 ? cell.i : k == 1 ? cell.j : triangle || k == 3 ? nv - 1 - cell.j
                                                                  : nu - 1 - cell.i;
}

/* Longest edge of a cell. */
static double cell_extent(const PatchBuilder *b, uint32_t surface, unsigned level)
{
    const unsigned corners = patches_corners(&b->surfaces->surface[surface]);
    const Vec3 *p = b->surfaces->position;
    double extent = 0;
    for (unsigned k = 0; k < corners; k++) {
        const Vec3 start = p[b->from[4 * surface + k]];
        const Vec3 end = p[b->from[4 * surface + (k + 1) % corners]];
        extent = fmax(extent, vec3_length(vec3_sub(end, start)) /
                                  patches_edge_divisions(b->out, surface, k));
    }
    return ldexp(extent, -(int)level);
}

/* Part low..high of a use must have cells no longer than LONGER_MOST * length there, all as
 * fractions of the use from its own start, or no larger than LONGER_MOST * extent: by the edge
 * alone, a long cell with one very short edge would divide what lies there to its last level. */
static bool wish_on_use(PatchForest *f, uint32_t use, unsigned side, double low, double high,
                        double length, double extent)
{
    const PatchBuilder *b = f->b;
    const uint32_t whole = patches_whole_use(b, use), surface = whole / 4, k = whole % 4;
    const bool triangle = b->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    const uint32_t first = f->old->first[side][surface];
    if (first == PATCH_NONE || patches_is_merged(f->old, first))
        return true;
    double start, end;
    patches_use_span(b, use, &start, &end);
    unsigned level = 0;
    double cells = patches_edge_divisions(b->out, surface, k);
    while (level < PATCH_LEVELS && 1 / (cells * (end - start)) > LONGER_MOST * length
           && cell_extent(b, surface, level) > LONGER_MOST * extent) {
        level++;
        cells *= 2;
    }
    if (level == 0)
        return true;
    const double from = (start + low * (end - start)) * cells;
    const double to = (start + high * (end - start)) * cells;
    const uint32_t last = (uint32_t)fmin(ceil(to - OVERLAP_LEAST), cells);
    const uint32_t nu = (uint32_t)b->out->nu[surface] << level;
    const uint32_t nv = (uint32_t)b->out->nv[surface] << level;
    for (uint32_t m = (uint32_t)fmax(floor(from + OVERLAP_LEAST), 0); m < last; m++)
        if (!wish_for(f, surface, side, patches_edge_cell(triangle, nu, nv, k, m, level)))
            return false;
    return true;
}

/* What a cell that is divided asks of the surfaces over edge k of its own surface. */
static bool wish_across_edge(PatchForest *f, uint32_t surface, unsigned side, PatchCell cell,
                             unsigned k)
{
    const PatchBuilder *b = f->b;
    const double cells = ldexp(patches_edge_divisions(b->out, surface, k), cell.level);
    const double from = cell_on_edge(f, surface, cell, k) / cells, to = from + 1 / cells;
    const double extent = cell_extent(b, surface, cell.level);
    const uint32_t whole = 4 * surface + k;
    for (uint32_t use = whole; patches_whole_use(b, use) == whole; use = patches_next_use(b, use)) {
        double start, end;
        patches_use_span(b, use, &start, &end);
        const double length = end - start;
        const double low = fmax((from - start) / length, 0), high = fmin((to - start) / length, 1);
        const uint32_t mate = b->mate[use];
        if (mate == PATCH_NODE_NONE || !(low < high))
            continue;
        const bool alike = b->from[use] != b->from[mate];
        if (!wish_on_use(f, mate, patches_mate_side(b, use, side), alike ? 1 - high : low,
                         alike ? 1 - low : high, 1 / (cells * length), extent))
            return false;
    }
    return true;
}

static bool wish_neighbours(PatchForest *f, uint32_t surface, unsigned side, PatchCell cell)
{
    const SurfaceKind kind = f->b->surfaces->surface[surface].kind;
    for (unsigned k = 0; k < (kind == SURFACE_TRIANGLE ? 3 : 4); k++) {
        PatchCell other;
        const bool inside = cell_across(f, surface, cell, k, &other);
        if (inside ? cell.level > 0 && !wish_for(f, surface, side, other)
                   : kind != SURFACE_SHAPE && !wish_across_edge(f, surface, side, cell, k))
            return false;
    }
    return true;
}

/* --- dividing --------------------------------------------------------------------------------- */

static bool grow_tree(PatchForest *f, uint32_t more)
{
    Patches *out = f->b->out;
    if (more >= PATCH_DIVIDED - out->tree_count)
        return error_set(f->b->err, ERROR_INPUT, "more than 2^31 patches");
    out->tree_count += more;
    return array_reserve((void **)&out->tree, &f->tree_capacity, out->tree_count,
                         sizeof *out->tree, "patch trees", f->b->err);
}

static bool plant_tree(PatchForest *f, uint32_t surface, unsigned side)
{
    Patches *out = f->b->out;
    const uint32_t base = patches_base_count(out, f->b->surfaces, surface);
    const uint32_t first = out->tree_count;
    if (!grow_tree(f, base))
        return false;
    for (uint32_t k = 0; k < base; k++)
        out->tree[first + k] = k;
    out->tree_first[side][surface] = first;
    return true;
}

/* Quarters keep the number of what they are part of. */
static bool divide_leaf(PatchForest *f, uint32_t slot)
{
    const uint32_t quarter = f->b->out->tree_count;
    if (!grow_tree(f, 4))
        return false;
    uint32_t *tree = f->b->out->tree;
    for (uint32_t q = 0; q < 4; q++)
        tree[quarter + q] = tree[slot];
    tree[slot] = quarter | PATCH_DIVIDED;
    return true;
}

/* Divides what is larger than the cell at its place, and wishes for the neighbours of that. */
static bool fulfil(PatchForest *f, const PatchWish *wish)
{
    const Patches *out = f->b->out;
    const bool triangle = f->b->surfaces->surface[wish->surface].kind == SURFACE_TRIANGLE;
    PatchCell path[PATCH_LEVELS + 1];
    unsigned quarter[PATCH_LEVELS + 1];
    path[wish->cell.level] = wish->cell;
    for (unsigned level = wish->cell.level; level > 0; level--)
        path[level - 1] = patches_cell_parent(triangle, path[level], &quarter[level]);
    if (wish->cell.level == 0)
        return true;
    if (out->tree_first[wish->side][wish->surface] == PATCH_NONE
        && !plant_tree(f, wish->surface, wish->side))
        return false;
    uint32_t slot = out->tree_first[wish->side][wish->surface]
                  + patches_base_index(triangle, out->nu[wish->surface], path[0]);
    for (unsigned level = 0; level < wish->cell.level; level++) {
        if (!(out->tree[slot] & PATCH_DIVIDED)
            && (!divide_leaf(f, slot)
                || !wish_neighbours(f, wish->surface, wish->side, path[level])))
            return false;
        slot = (out->tree[slot] & ~PATCH_DIVIDED) + quarter[level + 1];
    }
    return true;
}

bool patches_forest_divide(PatchForest *f, uint32_t surface, unsigned side, PatchCell cell)
{
    const bool triangle = f->b->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    if (cell.level == PATCH_LEVELS)
        return true;
    if (!wish_for(f, surface, side, patches_cell_child(triangle, cell, 0)))
        return false;
    while (f->wish_count > 0) {
        const PatchWish wish = f->wish[--f->wish_count];
        if (!fulfil(f, &wish))
            return false;
    }
    return true;
}
