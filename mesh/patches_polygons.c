/* SPDX-License-Identifier: BSD-3-Clause */
/* Corners of every patch: its cell's grid points, and what lies between on the surface's edges. */
#include <assert.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

typedef struct {
    PatchBuilder *b;
    const uint32_t *grid;     /* of this surface and side */
    uint32_t      surface, nu, nv;
    uint32_t      start, end; /* corners so far */
    unsigned      side;
    bool          turned;     /* (s, t) runs clockwise seen from the side */
    uint32_t      run[4];     /* first vertex of the points on each edge */
    bool          plain[4];   /* the edge has no points but this surface's own */
} Polygon;

static bool add_corner(Polygon *p, uint32_t vertex)
{
    PatchBuilder *b = p->b;
    assert(vertex != PATCH_NONE && vertex < b->out->vertex_count);
    if (p->end > p->start && b->out->corner[p->end - 1] == vertex)
        return true; /* a pole: the cell has one corner less */
    if (p->end == UINT32_MAX)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 patch corners");
    if (!array_reserve((void **)&b->out->corner, &b->corner_capacity, (size_t)p->end + 1,
                       sizeof *b->out->corner, "patch corners", b->err))
        return false;
    b->out->corner[p->end++] = vertex;
    return true;
}

/* Grid point (i, j), preceded by what lies on edge k before it: divisions m to m + 1. */
static bool add_along(Polygon *p, unsigned k, uint32_t m, uint32_t n)
{
    PatchBuilder *b = p->b;
    if (p->plain[k])
        return true;
    const uint32_t use = 4 * p->surface + k, e = b->edges.edge[use];
    const uint32_t count = b->point_first[e + 1] - b->point_first[e];
    const bool forward = b->from[use] < b->to[use];
    /* Points strictly between the two divisions, by index along the edge. */
    const uint32_t before = forward ? m : m + 1, after = forward ? m + 1 : m;
    uint32_t low = 0, high = count;
    if (before != (forward ? 0 : n))
        low = patches_edge_point(b, use, before, n) + 1;
    if (after != (forward ? n : 0))
        high = patches_edge_point(b, use, after, n);
    for (uint32_t i = low; i < high; i++)
        if (!add_corner(p, p->run[k] + (forward ? i : high - 1 - (i - low))))
            return false;
    return true;
}

static uint32_t grid_at(const Polygon *p, uint32_t i, uint32_t j)
{
    return p->grid[(size_t)j * (p->nu + 1) + i];
}

static bool add_quad(Polygon *p, uint32_t i, uint32_t j)
{
    return add_corner(p, grid_at(p, i, j))
        && (j > 0 || add_along(p, 0, i, p->nu))
        && add_corner(p, grid_at(p, i + 1, j))
        && (i + 1 < p->nu || add_along(p, 1, j, p->nv))
        && add_corner(p, grid_at(p, i + 1, j + 1))
        && (j + 1 < p->nv || add_along(p, 2, p->nu - 1 - i, p->nu))
        && add_corner(p, grid_at(p, i, j + 1))
        && (i > 0 || add_along(p, 3, p->nv - 1 - j, p->nv));
}

static bool add_triangle(Polygon *p, uint32_t i, uint32_t j, bool upper)
{
    const uint32_t n = p->nu;
    if (upper)
        return add_corner(p, grid_at(p, i + 1, j)) && add_corner(p, grid_at(p, i + 1, j + 1))
            && add_corner(p, grid_at(p, i, j + 1));
    return add_corner(p, grid_at(p, i, j))
        && (j > 0 || add_along(p, 0, i, n))
        && add_corner(p, grid_at(p, i + 1, j))
        && (i + j + 1 < n || add_along(p, 1, j, n))
        && add_corner(p, grid_at(p, i, j + 1))
        && (i > 0 || add_along(p, 2, n - 1 - j, n));
}

/* Ends the polygon and turns it counter-clockwise. */
static void close_polygon(Polygon *p)
{
    Patches *out = p->b->out;
    if (p->end - 1 > p->start && out->corner[p->end - 1] == out->corner[p->start])
        p->end--;
    if (p->turned)
        for (uint32_t i = p->start, j = p->end - 1; i < j; i++, j--) {
            const uint32_t swap = out->corner[i];
            out->corner[i] = out->corner[j];
            out->corner[j] = swap;
        }
    p->start = p->end;
    out->first_corner[++out->count] = p->end;
}

/* Normals are defined by the solid, not by the parameters: a disc's angle and radius turn the other
 * way than its normal, and a mirroring map turns any shape. */
static bool parameters_turned(const Surfaces *s, const Surface *f)
{
    if (f->kind != SURFACE_SHAPE)
        return false;
    const Shape *shape = &s->shape[f->primitive - s->triangle_count];
    return (shape->kind == SHAPE_DISC) != (affine_determinant(&shape->to_world) < 0);
}

static void start_side(Polygon *p)
{
    const PatchBuilder *b = p->b;
    const Surface *f = &b->surfaces->surface[p->surface];
    const unsigned corners = patches_corners(f);
    p->turned = parameters_turned(b->surfaces, f) != (p->side == 1);
    for (unsigned k = 0; k < corners; k++) {
        const uint32_t use = 4 * p->surface + k, e = b->edges.edge[use];
        p->run[k] = b->run[patches_edge_owner(b, use, p->side)];
        p->plain[k] = b->point_first[e + 1] - b->point_first[e]
                   == patches_edge_divisions(b, p->surface, k) - 1;
    }
    for (unsigned k = corners; k < 4; k++)
        p->plain[k] = true;
}

static bool make_side(Polygon *p)
{
    const bool triangle = p->b->surfaces->surface[p->surface].kind == SURFACE_TRIANGLE;
    for (uint32_t j = 0; j < p->nv; j++)
        for (uint32_t i = 0; i < (triangle ? p->nu - j : p->nu); i++) {
            if (!(triangle ? add_triangle(p, i, j, false) : add_quad(p, i, j)))
                return false;
            close_polygon(p);
            if (triangle && i + j + 1 < p->nu) {
                if (!add_triangle(p, i, j, true))
                    return false;
                close_polygon(p);
            }
        }
    return true;
}

bool patches_make_polygons(PatchBuilder *b)
{
    Patches *out = b->out;
    const uint32_t expected = out->count;
    Polygon p = { .b = b };
    out->count = 0;
    for (uint32_t i = 0; i < out->surface_count; i++)
        for (unsigned side = 0; side < 2; side++) {
            if (!patches_side_used(b, i, side))
                continue;
            p.surface = i;
            p.side = side;
            p.nu = out->nu[i];
            p.nv = out->nv[i];
            p.grid = out->grid_vertex + out->grid_first[side][i];
            start_side(&p);
            assert(out->first[side][i] == out->count);
            if (!make_side(&p))
                return false;
        }
    assert(out->count == expected);
    return out->count == expected;
}
