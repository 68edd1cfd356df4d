/* SPDX-License-Identifier: BSD-3-Clause */
/* Weights of vertices at a place: bilinear or linear between a cell's corners, bent along edges
 * that carry vertices of finer neighbours so that it follows them [coons67]. */
#include <assert.h>
#include <math.h>

#include "mesh/patches_internal.h"

/* A place in a cell, and the cell's face. */
typedef struct {
    uint32_t cell;
    double   u, v;   /* in the cell; of a triangle: weights of its corners 1 and 2 */
} Place;

static double clamp_unit(double x) { return fmin(fmax(x, 0), 1); }

static Place place_in_quad(const Patches *p, uint32_t surface, unsigned side, double s, double t)
{
    const uint32_t nu = p->nu[surface], nv = p->nv[surface];
    const uint32_t i = patches_cell_of(s * nu, nu), j = patches_cell_of(t * nv, nv);
    const uint32_t base = j * nu + i;
    Place at = { .cell = base, .u = clamp_unit(s * nu - i), .v = clamp_unit(t * nv - j) };
    if (p->tree_count == 0 || p->tree_first[side][surface] == PATCH_NONE)
        return at;
    const uint32_t root = p->tree[p->tree_first[side][surface] + base];
    at.cell = patches_walk_quad(p->tree, root, &at.u, &at.v);
    return at;
}

static Place place_in_triangle(const Patches *p, uint32_t surface, unsigned side, double s,
                               double t)
{
    const uint32_t n = p->nu[surface];
    const double x = fmax(s * n, 0), y = fmax(t * n, 0);
    const uint32_t j = patches_cell_of(y, n), i = patches_cell_of(x, n - j);
    double u = fmin(x - i, 1), v = fmin(y - j, 1);
    const bool upper = i + j + 1 < n && u + v > 1;
    const uint32_t base = n * n - (n - j) * (n - j) + 2 * i + upper;
    /* Past the hypotenuse by rounding: back onto it. */
    const double scale = upper ? 1 : 1 / fmax(u + v, 1);
    u = upper ? 1 - u : u * scale;
    v = upper ? 1 - v : v * scale;
    Place at = { .cell = base, .u = u, .v = v };
    if (p->tree_count == 0 || p->tree_first[side][surface] == PATCH_NONE)
        return at;
    const uint32_t root = p->tree[p->tree_first[side][surface] + base];
    at.cell = patches_walk_triangle(p->tree, root, upper, &at.u, &at.v);
    return at;
}

/* --- edges with vertices between -------------------------------------------------------------- */

/* One edge of a cell at the place's foot on it: the vertices before and after. */
typedef struct {
    double   f;         /* foot, fraction of the edge */
    double   blend;     /* share of this edge at the place */
    double   low, high; /* fractions of the two */
    uint32_t low_vertex, high_vertex; /* PATCH_NONE: the edge's corner */
} CellEdge;

/* Goes once round the face: finds the corners, and on each edge the vertices next to the foot. */
static void scan_face(const Patches *p, uint32_t face, unsigned corners, CellEdge edge[4],
                      uint32_t vertex[4])
{
    for (unsigned k = 0; k < corners; k++)
        vertex[k] = PATCH_NONE;
    for (uint32_t c = p->first_corner[face]; c < p->first_corner[face + 1]; c++) {
        const double along = p->corner_along[c];
        const unsigned k = (unsigned)along;
        const double fraction = along - k;
        assert(k < corners);
        if (fraction == 0) {
            vertex[k] = p->corner[c];
        } else if (fraction <= edge[k].f) {
            if (fraction > edge[k].low) {
                edge[k].low = fraction;
                edge[k].low_vertex = p->corner[c];
            }
        } else if (fraction < edge[k].high) {
            edge[k].high = fraction;
            edge[k].high_vertex = p->corner[c];
        }
    }
    /* At a pole two corners are one vertex, which stands for the first of them. */
    for (unsigned k = 1; k < corners; k++)
        if (vertex[k] == PATCH_NONE)
            vertex[k] = vertex[k - 1];
}

/* Puts curve - line of every edge on top of the corners' weights; returns how many vertices. */
static int bend_edges(const CellEdge edge[4], unsigned corners, uint32_t vertex[PATCH_WEIGHTS],
                      double weight[PATCH_WEIGHTS])
{
    int count = (int)corners;
    for (unsigned k = 0; k < corners; k++) {
        const CellEdge *e = &edge[k];
        if (!(e->blend > 0) || (e->low_vertex == PATCH_NONE && e->high_vertex == PATCH_NONE))
            continue;
        const unsigned next = (k + 1) % corners;
        const double part = (e->f - e->low) / (e->high - e->low);
        const double low = e->blend * (1 - part), high = e->blend * part;
        weight[k] -= e->blend * (1 - e->f);
        weight[next] -= e->blend * e->f;
        if (e->low_vertex == PATCH_NONE) {
            weight[k] += low;
        } else {
            vertex[count] = e->low_vertex;
            weight[count++] = low;
        }
        if (e->high_vertex == PATCH_NONE) {
            weight[next] += high;
        } else {
            vertex[count] = e->high_vertex;
            weight[count++] = high;
        }
    }
    assert(count <= PATCH_WEIGHTS);
    return count;
}

static int bent_quad(const Patches *p, uint32_t face, double u, double v,
                     uint32_t vertex[PATCH_WEIGHTS], double weight[PATCH_WEIGHTS])
{
    CellEdge edge[4] = { { .f = u, .blend = 1 - v }, { .f = v, .blend = u },
                         { .f = 1 - u, .blend = v }, { .f = 1 - v, .blend = 1 - u } };
    for (unsigned k = 0; k < 4; k++) {
        edge[k].high = 1;
        edge[k].low_vertex = edge[k].high_vertex = PATCH_NONE;
    }
    scan_face(p, face, 4, edge, vertex);
    return bend_edges(edge, 4, vertex, weight);
}

static int bent_triangle(const Patches *p, uint32_t face, uint32_t vertex[PATCH_WEIGHTS],
                         double weight[PATCH_WEIGHTS])
{
    CellEdge edge[4];
    for (unsigned k = 0; k < 3; k++) {
        const double a = weight[k], b = weight[(k + 1) % 3];
        edge[k] = (CellEdge){ .f = a + b > 0 ? b / (a + b) : 0, .blend = a + b, .high = 1,
                              .low_vertex = PATCH_NONE, .high_vertex = PATCH_NONE };
    }
    scan_face(p, face, 3, edge, vertex);
    return bend_edges(edge, 3, vertex, weight);
}

/* --- parts of cells --------------------------------------------------------------------------- */

/* The cell's corners that belong to another part give way to a vertex of this one's own. */
static int interpolate_part(const Patches *p, const PatchPart *part, unsigned corners,
                            uint32_t vertex[PATCH_WEIGHTS])
{
    const uint32_t face = p->face_of[part->patch];
    uint32_t own = PATCH_NONE;
    for (unsigned k = 0; k < corners; k++)
        vertex[k] = PATCH_NONE;
    for (uint32_t c = p->first_corner[face]; c < p->first_corner[face + 1]; c++) {
        const unsigned k = (unsigned)p->corner_along[c];
        if (p->corner_along[c] == k)
            vertex[k] = p->corner[c];
        else if (own == PATCH_NONE)
            own = p->corner[c];
    }
    if (own == PATCH_NONE)
        own = p->corner[p->first_corner[face]];
    for (unsigned k = 0; k < corners; k++)
        vertex[k] = vertex[k] == PATCH_NONE ? own : vertex[k];
    return (int)corners;
}

static bool is_parted(const Patches *p, uint32_t leaf)
{
    return p->parted_count > 0 && (leaf & PATCH_PARTED) != 0;
}

/* --- both kinds ------------------------------------------------------------------------------- */

static int interpolate_triangle(const Patches *p, const Surfaces *surfaces, uint32_t surface,
                                unsigned side, double s, double t, uint32_t vertex[PATCH_WEIGHTS],
                                double weight[PATCH_WEIGHTS])
{
    const Place at = place_in_triangle(p, surface, side, s, t);
    weight[1] = at.u;
    weight[2] = at.v;
    weight[0] = fmax(1 - weight[1] - weight[2], 0);
    if (is_parted(p, at.cell)) {
        const PatchPart *part = patches_part_at(p, surfaces, surface, at.cell, s, t);
        return part == NULL ? 0 : interpolate_part(p, part, 3, vertex);
    }
    const uint32_t face = p->first_face[side][surface] + at.cell;
    const uint32_t first = p->first_corner[face];
    if (p->first_corner[face + 1] - first != 3)
        return bent_triangle(p, face, vertex, weight);
    vertex[0] = p->corner[first];
    vertex[1] = p->corner[first + (side == 0 ? 1 : 2)];
    vertex[2] = p->corner[first + (side == 0 ? 2 : 1)];
    return 3;
}

int patches_interpolate(const Patches *patches, const Surfaces *surfaces, uint32_t surface,
                        unsigned side, double s, double t, uint32_t vertex[PATCH_WEIGHTS],
                        double weight[PATCH_WEIGHTS])
{
    assert(surface < patches->surface_count && side < 2);
    if (patches->first[side][surface] == PATCH_NONE)
        return 0;
    const Surface *f = &surfaces->surface[surface];
    if (f->kind == SURFACE_TRIANGLE)
        return interpolate_triangle(patches, surfaces, surface, side, s, t, vertex, weight);
    const Place at = place_in_quad(patches, surface, side, s, t);
    weight[0] = (1 - at.u) * (1 - at.v);
    weight[1] = at.u * (1 - at.v);
    weight[2] = at.u * at.v;
    weight[3] = (1 - at.u) * at.v;
    if (is_parted(patches, at.cell)) {
        const PatchPart *part = patches_part_at(patches, surfaces, surface, at.cell, s, t);
        return part == NULL ? 0 : interpolate_part(patches, part, 4, vertex);
    }
    const uint32_t face = patches->first_face[side][surface] + at.cell;
    const uint32_t *corner = patches->corner + patches->first_corner[face];
    /* A shape's cell at a pole has a corner less. */
    if (patches->first_corner[face + 1] - patches->first_corner[face] != 4
        || f->kind == SURFACE_SHAPE)
        return bent_quad(patches, face, at.u, at.v, vertex, weight);
    vertex[0] = corner[0];
    vertex[1] = corner[side == 0 ? 1 : 3];
    vertex[2] = corner[2];
    vertex[3] = corner[side == 0 ? 3 : 1];
    return 4;
}
