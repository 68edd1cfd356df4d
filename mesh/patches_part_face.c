/* SPDX-License-Identifier: BSD-3-Clause */
/* The outline of a part of a cell, as far as that lies on the cell's own outline; between, it is
 * straight. Vertices that other cells share stay shared where they belong to the part beyond doubt:
 * so values go on smoothly on its own side of what parts the cell, and nowhere else. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/slicers.h"
#include "mesh/patches_part.h"

static const char what[] = "patch corners";

/* Halvings of a cell's edge until a crossing is known: to the last bits that a picture shows. */
enum { HALVINGS = 40 };

/* The rim of a coat or disc lies on what it touches there, and belongs to the part that it is the
 * rim of: so it is looked at this share of the cell further in. */
static const double INWARDS = 1.0 / 64;

typedef struct {
    PatchBuilder     *b;
    const Patches    *cells;
    const PartedCell *cell;     /* of these: surface, cell, nu, nv and slicers */
    const PatchPart  *part;
    unsigned          side, corners;
    uint32_t          end;      /* of out->corner */
} Liner;

static bool add_corner(Liner *l, uint32_t vertex, double along)
{
    PatchBuilder *b = l->b;
    if (l->end == UINT32_MAX)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 patch corners");
    if (!array_reserve((void **)&b->out->corner, &b->corner_capacity, (size_t)l->end + 1,
                       sizeof *b->out->corner, what, b->err)
        || !array_reserve((void **)&b->out->corner_along, &b->along_capacity, (size_t)l->end + 1,
                          sizeof *b->out->corner_along, what, b->err))
        return false;
    b->out->corner[l->end] = vertex;
    b->out->corner_along[l->end++] = along;
    return true;
}

/* Which rims of a surface there are at v = 0 and 1: where it ends, not in a point. */
static bool has_rim(const PartedCell *c, bool upper)
{
    const Shape *shape = patches_shape(c->surfaces, &c->surfaces->surface[c->surface]);
    if (shape == NULL)
        return false;
    return shape->kind == SHAPE_FRUSTUM ? !upper || shape->ratio > 0
                                        : shape->kind == SHAPE_DISC && upper;
}

/* Place on the cell's outline: k and the fraction of the way from corner k to the next. */
static void outline_place(const Liner *l, double along, double *s, double *t)
{
    static const double quad[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0, 0 } };
    static const double triangle[4][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 0, 0 } };
    const PartedCell *c = l->cell;
    const PatchCell cell = c->cell;
    const unsigned k = (unsigned)fmin(along, l->corners - 1);
    const double f = along - k;
    const double *p = l->corners == 3 ? triangle[k] : quad[k];
    const double *q = l->corners == 3 ? triangle[k + 1] : quad[k + 1];
    double u = p[0] + f * (q[0] - p[0]), v = p[1] + f * (q[1] - p[1]);
    u = cell.upper ? 1 - u : u;
    v = cell.upper ? 1 - v : v;
    *s = (cell.i + u) / c->nu;
    *t = (cell.j + v) / c->nv;
}

static bool belongs(const Liner *l, double along)
{
    const PartedCell *c = l->cell;
    SurfacePoint at;
    uint32_t signs;
    double s, t;
    outline_place(l, along, &s, &t);
    if (t == 0 && has_rim(c, false))
        t = INWARDS / c->nv;
    else if (t == 1 && has_rim(c, true))
        t = 1 - INWARDS / c->nv;
    surfaces_point(c->surfaces, c->surface, s, t, &at);
    return slicer_signs(c->surfaces, c->slicer, c->slicers, at.point, &signs)
        && signs == l->part->signs;
}

/* A vertex where the outline leaves or enters the part, between a place of it and one that is not;
 * along rises from 0 to the number of corners. */
static bool add_crossing(Liner *l, double in, double out)
{
    for (unsigned k = 0; k < HALVINGS; k++) {
        const double middle = (in + out) / 2;
        if (belongs(l, middle))
            in = middle;
        else
            out = middle;
    }
    SurfacePoint at;
    uint32_t vertex;
    double s, t;
    /* Corners are those that are whole numbers. */
    const double along = in == floor(in) ? (in + out) / 2 : in;
    outline_place(l, along, &s, &t);
    surfaces_point(l->cell->surfaces, l->cell->surface, s, t, &at);
    return patches_add_vertex(l->b, at.point, &vertex)
        && add_corner(l, vertex, along == floor(along) ? nextafter(along, 0.5) : along);
}

/* A part with no outline to speak of: a square that stands on its corner. */
static bool add_diamond(Liner *l)
{
    static const double place[4][2] = { { 0.5, 0 }, { 1, 0.5 }, { 0.5, 1 }, { 0, 0.5 } };
    const PartedCell *c = l->cell;
    const PatchPart *part = l->part;
    const bool turned = patches_turned(c->surfaces, &c->surfaces->surface[c->surface], l->side);
    for (unsigned k = 0; k < 4; k++) {
        const double *p = place[turned ? 3 - k : k];
        const double a = part->a0 + p[0] * (double)(part->a1 - part->a0);
        const double b = part->b0 + p[1] * (double)(part->b1 - part->b0);
        SurfacePoint at;
        uint32_t vertex;
        double s, t;
        patches_cell_place(l->corners == 3, c->cell, c->nu, c->nv, a, b, &s, &t);
        surfaces_point(c->surfaces, c->surface, s, t, &at);
        if (!patches_add_vertex(l->b, at.point, &vertex)
            || !add_corner(l, vertex, (l->corners == 3 ? k * 0.75 : k) + 0.125))
            return false;
    }
    return true;
}

static bool copy_face(Liner *l, uint32_t face)
{
    const Patches *cells = l->cells;
    for (uint32_t k = cells->first_corner[face]; k < cells->first_corner[face + 1]; k++)
        if (!add_corner(l, cells->corner[k], cells->corner_along[k]))
            return false;
    return true;
}

static bool part_face(Liner *l, uint32_t face)
{
    const Patches *cells = l->cells;
    const uint32_t first = cells->first_corner[face];
    const uint32_t count = cells->first_corner[face + 1] - first, start = l->end;
    const double round = l->corners;
    for (uint32_t k = 0; k < count; k++) {
        double from = cells->corner_along[first + k];
        double to = cells->corner_along[first + (k + 1) % count];
        /* Corner 0 is where the way round ends as well. */
        from = from == 0 && to > round / 2 ? round : from;
        to = to == 0 && from > round / 2 ? round : to;
        const bool in = belongs(l, from), on = belongs(l, to);
        if (in && !add_corner(l, cells->corner[first + k], cells->corner_along[first + k]))
            return false;
        if (in != on && !add_crossing(l, in ? from : to, in ? to : from))
            return false;
    }
    if (l->end - start >= 3)
        return true;
    l->end = start;
    return add_diamond(l);
}

/* Vertices that only the faces of parted cells had are no more. */
static bool drop_vertices(PatchBuilder *b, uint32_t corners)
{
    Patches *out = b->out;
    uint32_t *number = array_create(out->vertex_count, sizeof *number, what, b->err);
    uint32_t count = 0;
    if (number == NULL)
        return false;
    for (uint32_t k = 0; k < corners; k++)
        number[out->corner[k]] = 1;
    for (uint32_t v = 0; v < out->vertex_count; v++)
        if (number[v] != 0) {
            out->position[count] = out->position[v];
            number[v] = count++;
        }
    for (uint32_t k = 0; k < corners; k++)
        out->corner[k] = number[out->corner[k]];
    out->vertex_count = count;
    array_free(number);
    return true;
}

bool patches_part_faces(PatchParter *p)
{
    PatchBuilder *b = p->b;
    Patches *out = b->out;
    PartedCell *c = &p->cell;
    Liner l = { .b = b, .cells = &p->cells, .cell = c };
    c->surfaces = b->surfaces;
    for (uint32_t face = 0; face < out->face_count; face++) {
        const uint32_t n = out->face_patch[face], i = p->row[n].cell;
        const uint32_t old_face = p->cells.face_of[i] + (face - out->face_of[n]);
        const PatchPart *part = patches_part_of(out, n);
        bool ok = true;
        if (part == NULL) {
            ok = copy_face(&l, old_face);
        } else {
            const PatchParted *parted = &out->parted[part->parted];
            c->surface = out->surface[n];
            c->cell = out->cell[n];
            c->nu = ldexp(out->nu[c->surface], c->cell.level);
            c->nv = ldexp(out->nv[c->surface], c->cell.level);
            c->slicers = parted->slicers;
            for (uint32_t k = 0; k < c->slicers; k++)
                c->slicer[k] = out->part_slicer[parted->first_slicer + k];
            l.part = part;
            l.side = out->side[n];
            l.corners = b->surfaces->surface[c->surface].kind == SURFACE_TRIANGLE ? 3 : 4;
            ok = part_face(&l, old_face);
        }
        if (!ok)
            return false;
        out->first_corner[face + 1] = l.end;
    }
    return drop_vertices(b, l.end);
}
