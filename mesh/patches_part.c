/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells that other surfaces part become several patches: found when all cells are there, then
 * everything is numbered anew. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "mesh/slicers.h"
#include "mesh/patches_part.h"

static const char what[] = "parts of patches";

/* --- one cell --------------------------------------------------------------------------------- */

/* The parts of the old cell that a cell is (a part of); none: NULL. */
static const PatchParted *old_parted(const PatchParter *p, uint32_t cell)
{
    const PatchPart *part = p->old == NULL ? NULL : patches_part_of(p->old, p->parent[cell]);
    return part == NULL ? NULL : &p->old->parted[part->parted];
}

static void prepare_cell(PatchParter *p, uint32_t i)
{
    const Patches *cells = &p->cells;
    const uint32_t surface = cells->surface[i];
    p->cell.surfaces = p->b->surfaces;
    p->cell.surface = surface;
    p->cell.cell = cells->cell[i];
    p->cell.nu = ldexp(cells->nu[surface], cells->cell[i].level);
    p->cell.nv = ldexp(cells->nv[surface], cells->cell[i].level);
}

/* All of the cell as one part, for one that is whole and yet has to stand for several. */
static void add_whole(PatchParter *p, uint32_t i)
{
    PartedCell *c = &p->cell;
    const bool triangle = c->surfaces->surface[c->surface].kind == SURFACE_TRIANGLE;
    c->parts = 1;
    c->part[0] = (PatchPart){ .a1 = 1, .b1 = 1, .share = 1 };
    c->area[0] = p->cells.area[i];
    patches_cell_place(triangle, c->cell, c->nu, c->nv, 0.5, 0.5, &c->part[0].s, &c->part[0].t);
}

static uint32_t parent_of_part(const PatchParter *p, uint32_t i, const PatchPart *part)
{
    const uint32_t found = patches_at(p->old, p->b->surfaces, p->cells.surface[i],
                                      p->cells.side[i], part->s, part->t);
    return found == PATCH_NONE ? p->parent[i] : found;
}

/* Gives each part its parent, and each old patch whose place lies in the cell a part. */
static bool find_parents(PatchParter *p, uint32_t i)
{
    PartedCell *c = &p->cell;
    const PatchParted *old = old_parted(p, i);
    const uint32_t surface = p->cells.surface[i], side = p->cells.side[i];
    const uint32_t parts = old == NULL ? 0 : old->parts;
    uint32_t lost = 0;
    for (uint32_t k = 0; k < c->parts; k++)
        p->part_parent[k] = old == NULL ? p->parent[i] : parent_of_part(p, i, &c->part[k]);
    for (uint32_t m = 0; m < parts; m++) {
        const PatchPart *part = &p->old->part[old->first_part + m];
        bool has = patches_at(&p->cells, p->b->surfaces, surface, side, part->s, part->t) != i;
        for (uint32_t k = 0; k < c->parts; k++)
            has = has || p->part_parent[k] == part->patch;
        if (has)
            continue;
        if (c->parts == 0 && lost++ == 0) {
            p->parent[i] = part->patch;
            continue;
        }
        if (c->parts == 0) {
            add_whole(p, i);
            p->part_parent[0] = p->parent[i];
        }
        if (!patches_part_add(c, part->s, part->t))
            return error_set(p->b->err, ERROR_INPUT, "a patch has more than %d parts", PARTS_ROOM);
        p->part_parent[c->parts - 1] = part->patch;
    }
    if (c->parts == 0 && lost == 0 && old != NULL) {
        add_whole(p, i);
        p->parent[i] = parent_of_part(p, i, &c->part[0]);
        c->parts = 0;
    }
    return true;
}

static bool reserve_parts(PatchParter *p, uint32_t parts, uint32_t slicers)
{
    Patches *out = p->b->out;
    Error *err = p->b->err;
    return array_reserve((void **)&out->parted, &p->parted_capacity,
                         (size_t)out->parted_count + 1, sizeof *out->parted, what, err)
        && array_reserve((void **)&out->part, &p->part_capacity, (size_t)out->part_count + parts,
                         sizeof *out->part, what, err)
        && array_reserve((void **)&p->area, &p->area_capacity, (size_t)out->part_count + parts,
                         sizeof *p->area, what, err)
        && array_reserve((void **)&out->part_slicer, &p->slicer_capacity,
                         (size_t)p->slicers + slicers, sizeof *out->part_slicer, what, err);
}

static bool add_row(PatchParter *p, uint32_t cell, uint32_t part, uint32_t parent)
{
    if (p->rows == PATCH_PARTED)
        return error_set(p->b->err, ERROR_INPUT, "more than 2^30 patches, some in parts");
    if (!array_reserve((void **)&p->row, &p->row_capacity, (size_t)p->rows + 1, sizeof *p->row,
                       what, p->b->err))
        return false;
    p->row[p->rows] = (PatchRow){ cell, part, parent, p->rows };
    p->rows++;
    return true;
}

/* Keeps the parts of cell i, their areas made to sum up to the cell's. */
static bool keep_parts(PatchParter *p, uint32_t i)
{
    Patches *out = p->b->out;
    const PartedCell *c = &p->cell;
    if (!reserve_parts(p, c->parts, c->slicers))
        return false;
    double sum = 0;
    for (uint32_t k = 0; k < c->parts; k++)
        sum += c->area[k];
    const double scale = p->cells.area[i] / sum;
    out->parted[out->parted_count] = (PatchParted){
        .first_slicer = p->slicers, .slicers = (uint16_t)c->slicers,
        .first_part = out->part_count, .parts = (uint16_t)c->parts };
    for (uint32_t k = 0; k < c->slicers; k++)
        out->part_slicer[p->slicers++] = c->slicer[k];
    for (uint32_t k = 0; k < c->parts; k++) {
        const uint32_t part = out->part_count++;
        out->part[part] = c->part[k];
        out->part[part].parted = out->parted_count;
        /* The mean of patches_point's weights is 1. */
        out->part[part].share *= scale * c->nu * c->nv;
        p->area[part] = c->area[k] * scale;
        if (!add_row(p, i, part, p->old == NULL ? 0 : p->part_parent[k]))
            return false;
    }
    p->parted_of[i] = out->parted_count++;
    return true;
}

static bool find_parts(PatchParter *p)
{
    const Patches *cells = &p->cells;
    const Surfaces *s = p->b->surfaces;
    for (uint32_t i = 0; i < cells->count; i++) {
        const uint32_t surface = cells->surface[i];
        p->parted_of[i] = PATCH_NONE;
        p->cell.parts = 0;
        if (!patches_is_merged(cells, i) && s->cut_first[surface + 1] > s->cut_first[surface]) {
            const PatchParted *old = old_parted(p, i);
            prepare_cell(p, i);
            patches_part_cell(&p->cell, old == NULL ? NULL
                                                    : p->old->part_slicer + old->first_slicer,
                              old == NULL ? 0 : old->slicers);
            if (p->old != NULL && !find_parents(p, i))
                return false;
        }
        if (p->cell.parts > 0 ? !keep_parts(p, i)
                              : !add_row(p, i, PATCH_NONE, p->old == NULL ? 0 : p->parent[i]))
            return false;
    }
    return true;
}

/* --- all numbers anew ------------------------------------------------------------------------- */

static int by_parent(const void *a, const void *b)
{
    const PatchRow *x = a, *y = b;
    if (x->parent != y->parent)
        return x->parent < y->parent ? -1 : 1;
    return (x->order > y->order) - (x->order < y->order);
}

static uint32_t renumber_leaf(PatchParter *p, uint32_t leaf, uint32_t old_first, uint32_t first)
{
    const uint32_t cell = old_first + leaf;
    return p->parted_of[cell] != PATCH_NONE ? PATCH_PARTED | p->parted_of[cell]
                                            : p->number[cell] - first;
}

static void renumber_tree(PatchParter *p, uint32_t slot, uint32_t old_first, uint32_t first)
{
    uint32_t *tree = p->b->out->tree;
    if ((tree[slot] & PATCH_DIVIDED) == 0) {
        tree[slot] = renumber_leaf(p, tree[slot], old_first, first);
        return;
    }
    for (uint32_t q = 0; q < 4; q++)
        renumber_tree(p, (tree[slot] & ~PATCH_DIVIDED) + q, old_first, first);
}

static bool is_parted_side(const PatchParter *p, uint32_t surface, unsigned side)
{
    const Patches *cells = &p->cells;
    const uint32_t first = cells->first[side][surface];
    if (first == PATCH_NONE || patches_is_merged(cells, first))
        return false;
    const uint32_t count = patches_side_cells(cells, p->b->surfaces, surface, side);
    for (uint32_t i = first; i < first + count; i++)
        if (p->parted_of[i] != PATCH_NONE)
            return true;
    return false;
}

/* A tree for each side with parted cells, and all leaves by their new numbers. */
static bool make_trees(PatchParter *p)
{
    Patches *out = p->b->out;
    const Surfaces *s = p->b->surfaces;
    size_t capacity = 0;
    for (uint32_t k = 0; k < out->surface_count * 2; k++) {
        const uint32_t surface = k / 2, side = k % 2;
        const uint32_t base = patches_base_count(out, s, surface);
        const uint32_t old_first = p->cells.first[side][surface];
        if (out->tree_first[side][surface] == PATCH_NONE) {
            if (!is_parted_side(p, surface, side))
                continue;
            if (base >= PATCH_PARTED - out->tree_count)
                return error_set(p->b->err, ERROR_INPUT, "more than 2^30 patches");
            const uint32_t first = out->tree_count;
            if (!array_reserve((void **)&out->tree, &capacity, (size_t)first + base,
                               sizeof *out->tree, what, p->b->err))
                return false;
            for (uint32_t c = 0; c < base; c++)
                out->tree[first + c] = c;
            out->tree_first[side][surface] = first;
            out->tree_count = first + base;
        }
        for (uint32_t c = 0; c < base; c++)
            renumber_tree(p, out->tree_first[side][surface] + c, old_first,
                          out->first[side][surface]);
    }
    return true;
}

/* --- arrays ----------------------------------------------------------------------------------- */

static bool allocate(PatchParter *p)
{
    Patches *out = p->b->out;
    const Patches *cells = &p->cells;
    const size_t n = p->rows, surfaces = out->surface_count;
    const size_t pieces = cells->first_piece[cells->count];
    const size_t faces = cells->face_count - cells->count + n;
    Error *err = p->b->err;
    out->surface = array_create(n, sizeof *out->surface, what, err);
    out->side = array_create(n, sizeof *out->side, what, err);
    out->cell = array_create(n, sizeof *out->cell, what, err);
    out->material = array_create(n, sizeof *out->material, what, err);
    out->group = array_create(n, sizeof *out->group, what, err);
    out->area = array_create(n, sizeof *out->area, what, err);
    out->centre = array_create(n, sizeof *out->centre, what, err);
    out->normal = array_create(n, sizeof *out->normal, what, err);
    out->first_piece = array_create(n + 1, sizeof *out->first_piece, what, err);
    out->piece = array_create(pieces, sizeof *out->piece, what, err);
    out->piece_end = array_create(pieces, sizeof *out->piece_end, what, err);
    out->face_of = array_create(n, sizeof *out->face_of, what, err);
    out->face_patch = array_create(faces, sizeof *out->face_patch, what, err);
    out->first_corner = array_create(faces + 1, sizeof *out->first_corner, what, err);
    out->part_of = array_create(n, sizeof *out->part_of, what, err);
    out->corner = NULL;
    out->corner_along = NULL;
    p->b->corner_capacity = p->b->along_capacity = 0;
    for (unsigned side = 0; side < 2; side++) {
        out->first[side] = array_create(surfaces, sizeof *out->first[side], what, err);
        out->first_face[side] = array_create(surfaces, sizeof *out->first_face[side], what, err);
    }
    p->number = array_create(cells->count, sizeof *p->number, what, err);
    return !error_is_set(err);
}

/* What the cells had and the patches have not. */
static void free_cells(Patches *cells)
{
    array_free(cells->surface);
    array_free(cells->side);
    array_free(cells->cell);
    array_free(cells->material);
    array_free(cells->group);
    array_free(cells->area);
    array_free(cells->centre);
    array_free(cells->normal);
    array_free(cells->first_piece);
    array_free(cells->piece);
    array_free(cells->piece_end);
    array_free(cells->face_of);
    array_free(cells->face_patch);
    array_free(cells->first_corner);
    array_free(cells->corner);
    array_free(cells->corner_along);
    for (unsigned side = 0; side < 2; side++) {
        array_free(cells->first[side]);
        array_free(cells->first_face[side]);
    }
}

static void fill_patch(PatchParter *p, uint32_t n)
{
    Patches *out = p->b->out;
    const Patches *cells = &p->cells;
    const uint32_t i = p->row[n].cell, part = p->row[n].part;
    const unsigned side = out->side[n] = cells->side[i];
    out->surface[n] = cells->surface[i];
    out->cell[n] = cells->cell[i];
    out->material[n] = cells->material[i];
    out->group[n] = cells->group[i];
    out->part_of[n] = part;
    p->number[i] = n;
    if (part == PATCH_NONE) {
        out->area[n] = cells->area[i];
        out->centre[n] = cells->centre[i];
        out->normal[n] = cells->normal[i];
        return;
    }
    SurfacePoint at;
    out->part[part].patch = n;
    surfaces_point(p->b->surfaces, out->surface[n], out->part[part].s, out->part[part].t, &at);
    out->area[n] = p->area[part];
    out->centre[n] = at.point;
    out->normal[n] = side == 0 ? at.normal : vec3_scale(at.normal, -1);
}

/* Pieces and first patches and faces of surfaces; faces are numbered like patches. */
static void fill_places(PatchParter *p, uint32_t n)
{
    Patches *out = p->b->out;
    const Patches *cells = &p->cells;
    const uint32_t i = p->row[n].cell, side = out->side[n];
    const uint32_t from = cells->first_piece[i], pieces = cells->first_piece[i + 1] - from;
    const uint32_t at = out->first_piece[n], face = out->face_of[n];
    out->first_piece[n + 1] = at + pieces;
    if (pieces == 0 && out->first[side][out->surface[n]] == PATCH_NONE) {
        out->first[side][out->surface[n]] = n;
        out->first_face[side][out->surface[n]] = face;
    }
    for (uint32_t k = 0; k < pieces; k++) {
        out->piece[at + k] = cells->piece[from + k];
        out->piece_end[at + k] = cells->piece_end[from + k];
        out->first[side][out->piece[at + k]] = n;
        out->first_face[side][out->piece[at + k]] = face + k;
    }
    for (uint32_t k = 0; k < (pieces > 0 ? pieces : 1); k++)
        out->face_patch[face + k] = n;
    if (n + 1 < p->rows)
        out->face_of[n + 1] = face + (pieces > 0 ? pieces : 1);
}

static void fill(PatchParter *p)
{
    Patches *out = p->b->out;
    out->count = p->rows;
    out->face_count = p->cells.face_count - p->cells.count + p->rows;
    for (uint32_t i = 0; i < out->surface_count; i++)
        out->first[0][i] = out->first[1][i] = PATCH_NONE;
    for (uint32_t n = 0; n < p->rows; n++) {
        fill_patch(p, n);
        fill_places(p, n);
    }
}

bool patches_part(PatchBuilder *b, const Patches *old, uint32_t **parent)
{
    assert((old == NULL) == (parent == NULL));
    if (b->surfaces->cut_first == NULL)
        return true;
    PatchParter p = { .b = b, .old = old, .parent = parent == NULL ? NULL : *parent,
                      .cells = *b->out };
    p.parted_of = array_create(p.cells.count, sizeof *p.parted_of, what, b->err);
    bool ok = p.parted_of != NULL && find_parts(&p);
    if (ok && b->out->parted_count > 0) {
        if (old != NULL)
            qsort(p.row, p.rows, sizeof *p.row, by_parent);
        ok = allocate(&p);
        if (ok)
            fill(&p);
        ok = ok && make_trees(&p) && patches_part_faces(&p);
        free_cells(&p.cells);
        if (ok && old != NULL) {
            array_free(*parent);
            *parent = array_create(p.rows, sizeof **parent, what, b->err);
            for (uint32_t n = 0; *parent != NULL && n < p.rows; n++)
                (*parent)[n] = p.row[n].parent;
            ok = *parent != NULL;
        }
    }
    array_free(p.parted_of);
    array_free(p.number);
    array_free(p.area);
    array_free(p.row);
    return ok;
}
