/* SPDX-License-Identifier: BSD-3-Clause */
/* Corners of every face: its cell's own, and what lies between on edges shared with finer cells. */
#include <assert.h>

#include "base/array.h"
#include "mesh/patches_internal.h"
#include "mesh/patches_lattice.h"

typedef struct {
    PatchBuilder *b;
    PatchLattice  lattice;
    PatchOutline  outline;
    uint32_t      surface;
    unsigned      side, corners;  /* corners of a cell */
    bool          flat, triangle, divided;
    bool          turned;         /* (s, t) runs clockwise seen from the side */
    bool          plain[4];       /* the edge has no points but this side's own, evenly spaced */
    uint32_t      nu, nv;         /* lattice steps along the edges */
    unsigned      fine;           /* level of a lattice step */
    uint32_t      start, end;     /* corners of the face so far */
} FaceMaker;

typedef struct {
    uint32_t i, j;
} LatticePoint;

/* --- points of the lattice -------------------------------------------------------------------- */

/* Poles, seams and the torus' second seam: one point has one place in the lattice. */
static LatticePoint shape_place(const FaceMaker *m, LatticePoint p)
{
    const Shape *shape = patches_shape(m->b->surfaces, &m->b->surfaces->surface[m->surface]);
    bool pole = false;
    switch (shape->kind) {
    case SHAPE_SPHERE:
        pole = p.j == 0 || p.j == m->nv;
        break;
    case SHAPE_DISC:
        pole = p.j == 0;
        break;
    case SHAPE_FRUSTUM:
        pole = p.j == m->nv && shape->ratio == 0;
        break;
    case SHAPE_TORUS:
        p.j = p.j == m->nv ? 0 : p.j;
        break;
    }
    p.i = pole || p.i == m->nu ? 0 : p.i;
    return p;
}

/* Whether a lattice point lies on edge k of a flat surface, and how far along. */
static bool on_edge(const FaceMaker *m, LatticePoint p, unsigned k, uint32_t *along)
{
    if (k == 0) {
        *along = p.i;
        return p.j == 0;
    }
    if (k == 1) {
        *along = p.j;
        return (m->triangle ? p.i + p.j : p.i) == m->nu;
    }
    if (m->triangle || k == 3) {
        *along = m->nv - p.j;
        return p.i == 0;
    }
    *along = m->nu - p.i;
    return p.j == m->nv;
}

static uint32_t edge_steps(const FaceMaker *m, unsigned k) { return k % 2 == 0 ? m->nu : m->nv; }

static uint32_t outline_entry(const FaceMaker *m, unsigned k, uint32_t along)
{
    if (m->plain[k])
        return m->outline.first[k] + along;
    return patches_outline_entry(&m->outline, k, (double)along / edge_steps(m, k));
}

/* Vertex of a lattice point, made when it is not there yet. */
static bool lattice_vertex(FaceMaker *m, LatticePoint p, uint32_t *vertex)
{
    uint32_t along;
    for (unsigned k = 0; m->flat && k < m->corners; k++)
        if (on_edge(m, p, k, &along)) {
            *vertex = m->outline.vertex[outline_entry(m, k, along)];
            return true;
        }
    if (!m->flat)
        p = shape_place(m, p);
    uint32_t *slot = lattice_slot(&m->lattice, p.i, p.j);
    if (*slot == PATCH_NONE) {
        SurfacePoint at;
        surfaces_point(m->b->surfaces, m->surface, (double)p.i / m->nu, (double)p.j / m->nv, &at);
        if (!patches_add_vertex(m->b, at.point, slot))
            return false;
    }
    *vertex = *slot;
    return true;
}

/* Vertex at a point inside of the surface or on a seam; PATCH_NONE: no cell has a corner there. */
static uint32_t lattice_known(const FaceMaker *m, LatticePoint p)
{
    if (!m->flat)
        p = shape_place(m, p);
    return lattice_find(&m->lattice, p.i, p.j);
}

/* Corner k of a cell. */
static LatticePoint cell_corner(const FaceMaker *m, PatchCell cell, unsigned k)
{
    const uint32_t step = 1u << (m->fine - cell.level);
    uint32_t i = cell.i, j = cell.j;
    if (cell.upper) {
        i += k != 1;
        j += k != 2;
    } else if (m->triangle) {
        i += k == 1;
        j += k == 2;
    } else {
        i += k == 1 || k == 2;
        j += k >= 2;
    }
    return (LatticePoint){ i * step, j * step };
}

/* --- faces ------------------------------------------------------------------------------------ */

static bool add_corner(FaceMaker *m, uint32_t vertex, double along)
{
    PatchBuilder *b = m->b;
    Patches *out = b->out;
    assert(vertex < out->vertex_count);
    if (m->end > m->start && out->corner[m->end - 1] == vertex)
        return true; /* a pole: the cell has one corner less */
    if (m->end == UINT32_MAX)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 patch corners");
    if (!array_reserve((void **)&out->corner, &b->corner_capacity, (size_t)m->end + 1,
                       sizeof *out->corner, "patch corners", b->err)
        || !array_reserve((void **)&out->corner_along, &b->along_capacity, (size_t)m->end + 1,
                          sizeof *out->corner_along, "patch corners", b->err))
        return false;
    out->corner_along[m->end] = along;
    out->corner[m->end++] = vertex;
    return true;
}

/* What lies on edge k of the surface between two lattice steps. */
static bool add_outline(FaceMaker *m, unsigned k, uint32_t from, uint32_t to)
{
    if (m->plain[k])
        return true;
    const double steps = edge_steps(m, k);
    const uint32_t end = outline_entry(m, k, to);
    for (uint32_t entry = outline_entry(m, k, from) + 1; entry < end; entry++) {
        const double at = (m->outline.fraction[entry] * steps - from) / (to - from);
        if (!add_corner(m, m->outline.vertex[entry], k + at))
            return false;
    }
    return true;
}

/* What lies between corners k and k + 1 of a cell: on the outline whatever is there, inside the
 * middle when the neighbour is divided once more. */
static bool add_between(FaceMaker *m, PatchCell cell, unsigned k)
{
    const LatticePoint a = cell_corner(m, cell, k);
    const LatticePoint b = cell_corner(m, cell, (k + 1) % m->corners);
    const uint32_t step = 1u << (m->fine - cell.level);
    uint32_t from;
    /* Edge k of a cell is parallel to the surface's edge k. */
    if (m->flat && !cell.upper && on_edge(m, a, k, &from))
        return add_outline(m, k, from, from + step);
    if (!m->divided || step == 1)
        return true;
    const LatticePoint middle = { (a.i + b.i) / 2, (a.j + b.j) / 2 };
    const uint32_t vertex = lattice_known(m, middle);
    return vertex == PATCH_NONE || add_corner(m, vertex, k + 0.5);
}

static void turn_face(FaceMaker *m)
{
    Patches *out = m->b->out;
    for (uint32_t i = m->start + 1, j = m->end - 1; i < j; i++, j--) {
        const uint32_t vertex = out->corner[i];
        const double along = out->corner_along[i];
        out->corner[i] = out->corner[j];
        out->corner_along[i] = out->corner_along[j];
        out->corner[j] = vertex;
        out->corner_along[j] = along;
    }
}

static bool make_face(FaceMaker *m, PatchCell cell, uint32_t face)
{
    Patches *out = m->b->out;
    m->start = m->end;
    for (unsigned k = 0; k < m->corners; k++) {
        uint32_t vertex;
        if (!lattice_vertex(m, cell_corner(m, cell, k), &vertex)
            || !add_corner(m, vertex, k) || !add_between(m, cell, k))
            return false;
    }
    if (m->end - 1 > m->start && out->corner[m->end - 1] == out->corner[m->start])
        m->end--;
    if (m->turned)
        turn_face(m);
    out->first_corner[face + 1] = m->end;
    return true;
}

static bool start_side(FaceMaker *m, uint32_t surface, unsigned side, uint32_t cells)
{
    const PatchBuilder *b = m->b;
    const Surface *f = &b->surfaces->surface[surface];
    m->surface = surface;
    m->side = side;
    m->flat = f->kind != SURFACE_SHAPE;
    m->triangle = f->kind == SURFACE_TRIANGLE;
    m->corners = m->triangle ? 3 : 4;
    m->divided = b->out->tree_first[side][surface] != PATCH_NONE;
    m->turned = patches_turned(b->surfaces, f, side);
    m->fine = m->divided ? PATCH_LEVELS : 0;
    m->nu = (uint32_t)b->out->nu[surface] << m->fine;
    m->nv = (uint32_t)b->out->nv[surface] << m->fine;
    if (m->flat && !patches_outline(m->b, surface, side, &m->outline))
        return false;
    for (unsigned k = 0; m->flat && k < m->corners; k++)
        m->plain[k] = !m->divided && m->outline.first[k + 1] - m->outline.first[k]
                                     == edge_steps(m, k) + 1;
    return m->divided ? lattice_sparse(&m->lattice, 4 * (size_t)cells, b->err)
                      : lattice_dense(&m->lattice, m->nu, m->nv, b->err);
}

/* Faces of the cells first_face on; vertices first where a cell asks for its neighbours'. */
static bool make_side(FaceMaker *m, uint32_t surface, unsigned side)
{
    const Patches *out = m->b->out;
    const uint32_t first = out->first[side][surface], face = out->first_face[side][surface];
    const bool merged = patches_is_merged(out, first);
    const uint32_t cells = merged ? 1 : patches_side_cells(out, m->b->surfaces, surface, side);
    const PatchCell *cell = out->cell + first;
    if (!start_side(m, surface, side, cells))
        return false;
    for (uint32_t c = 0; m->divided && c < cells; c++)
        for (unsigned k = 0; k < m->corners; k++) {
            uint32_t vertex;
            if (!lattice_vertex(m, cell_corner(m, cell[c], k), &vertex))
                return false;
        }
    for (uint32_t c = 0; c < cells; c++)
        if (!make_face(m, cell[c], face + c))
            return false;
    return true;
}

bool patches_make_faces(PatchBuilder *b)
{
    FaceMaker m = { .b = b };
    bool ok = true;
    for (uint32_t k = 0; ok && k < b->block_count; k++) {
        const uint32_t merged = b->block_merged[k], side = b->block[k] % 2;
        if (merged == PATCH_NONE)
            ok = make_side(&m, b->block[k] / 2, side);
        else
            for (uint32_t i = b->merged_first[merged]; ok && i < b->merged_first[merged + 1]; i++)
                ok = make_side(&m, b->merged_piece[i], side);
    }
    lattice_clear(&m.lattice);
    array_free(m.outline.vertex);
    array_free(m.outline.fraction);
    return ok;
}
