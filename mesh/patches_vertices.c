/* SPDX-License-Identifier: BSD-3-Clause */
/* Vertices: one per point and smooth surface side, and the grid tables that name them. */
#include <assert.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

/* --- corners that are one vertex -------------------------------------------------------------- */

static uint32_t node_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void node_unite(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = node_root(parent, a);
    b = node_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

static uint32_t next_corner(const PatchBuilder *b, uint32_t use)
{
    const unsigned corners = patches_corners(&b->surfaces->surface[use / 4]);
    return use % 4 + 1 == corners ? use - use % 4 : use + 1;
}

static void unite_corners(PatchBuilder *b)
{
    for (uint32_t use = 0; use < b->edges.use_count; use++) {
        const uint32_t other = b->mate[use];
        if (other == PATCH_NODE_NONE || other < use)
            continue;
        const bool alike = b->from[use] != b->from[other];
        const uint32_t first = alike ? next_corner(b, other) : other;
        const uint32_t second = alike ? other : next_corner(b, other);
        for (unsigned side = 0; side < 2; side++) {
            const unsigned other_side = alike ? side : 1 - side;
            if (!patches_side_used(b, use / 4, side)
                || !patches_side_used(b, other / 4, other_side))
                continue;
            node_unite(b->parent, 2 * use + side, 2 * first + other_side);
            node_unite(b->parent, 2 * next_corner(b, use) + side, 2 * second + other_side);
        }
    }
}

/* --- making vertices -------------------------------------------------------------------------- */

static bool reserve_vertices(PatchBuilder *b, uint32_t more)
{
    Patches *out = b->out;
    if (out->vertex_count > UINT32_MAX - 1 - more)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 patch vertices");
    return array_reserve((void **)&out->position, &b->position_capacity,
                         (size_t)out->vertex_count + more, sizeof *out->position,
                         "patch vertices", b->err);
}

static uint32_t add_vertex(PatchBuilder *b, Vec3 p)
{
    b->out->position[b->out->vertex_count] = p;
    return b->out->vertex_count++;
}

static bool make_corner(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *vertex)
{
    const uint32_t root = node_root(b->parent, 2 * use + side);
    if (b->corner_vertex[root] == PATCH_NONE) {
        if (!reserve_vertices(b, 1))
            return false;
        b->corner_vertex[root] = add_vertex(b, b->surfaces->position[b->from[use]]);
    }
    *vertex = b->corner_vertex[root];
    return true;
}

/* The points of an edge, always computed from its smaller end: bit for bit the same for all that
 * share the edge, smoothly or not. */
static bool make_run(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *run)
{
    const uint32_t owner = patches_edge_owner(b, use, side);
    const uint32_t e = b->edges.edge[use];
    const uint32_t count = b->point_first[e + 1] - b->point_first[e];
    if (b->run[owner] == PATCH_NONE) {
        if (!reserve_vertices(b, count))
            return false;
        const bool forward = b->from[use] < b->to[use];
        const Vec3 p = b->surfaces->position[forward ? b->from[use] : b->to[use]];
        const Vec3 q = b->surfaces->position[forward ? b->to[use] : b->from[use]];
        b->run[owner] = b->out->vertex_count;
        for (uint32_t k = 0; k < count; k++)
            add_vertex(b, vec3_lerp(p, q, b->fraction[b->point_first[e] + k]));
    }
    *run = b->run[owner];
    return true;
}

/* --- grids ------------------------------------------------------------------------------------ */

typedef struct {
    uint32_t *vertex;   /* [(nu + 1) * (nv + 1)] */
    uint32_t  surface, nu, nv;
    unsigned  side;
} Grid;

static uint32_t *grid_at(const Grid *g, uint32_t i, uint32_t j)
{
    assert(i <= g->nu && j <= g->nv);
    return &g->vertex[(size_t)j * (g->nu + 1) + i];
}

/* Grid point at division m of edge k, counted from its corner k. */
static uint32_t *grid_on_edge(const Grid *g, bool triangle, unsigned k, uint32_t m)
{
    if (k == 0)
        return grid_at(g, m, 0);
    if (triangle)
        return k == 1 ? grid_at(g, g->nu - m, m) : grid_at(g, 0, g->nv - m);
    return k == 1 ? grid_at(g, g->nu, m) : k == 2 ? grid_at(g, g->nu - m, g->nv)
                                                  : grid_at(g, 0, g->nv - m);
}

static bool fill_outline(PatchBuilder *b, const Grid *g)
{
    const Surface *f = &b->surfaces->surface[g->surface];
    const unsigned corners = patches_corners(f);
    const bool triangle = f->kind == SURFACE_TRIANGLE;
    for (unsigned k = 0; k < corners; k++) {
        const uint32_t use = 4 * g->surface + k;
        const uint32_t n = patches_edge_divisions(b, g->surface, k);
        uint32_t run = 0;
        if (!make_corner(b, use, g->side, grid_on_edge(g, triangle, k, 0))
            || !make_run(b, use, g->side, &run))
            return false;
        for (uint32_t m = 1; m < n; m++)
            *grid_on_edge(g, triangle, k, m) = run + patches_edge_point(b, use, m, n);
    }
    return true;
}

static bool fill_flat(PatchBuilder *b, const Grid *g)
{
    const bool triangle = b->surfaces->surface[g->surface].kind == SURFACE_TRIANGLE;
    if (!fill_outline(b, g) || !reserve_vertices(b, (g->nu - 1) * (g->nv - 1)))
        return false;
    for (uint32_t j = 1; j < g->nv; j++)
        for (uint32_t i = 1; triangle ? i + j < g->nu : i < g->nu; i++) {
            SurfacePoint at;
            surfaces_point(b->surfaces, g->surface, (double)i / g->nu, (double)j / g->nv, &at);
            *grid_at(g, i, j) = add_vertex(b, at.point);
        }
    return true;
}

/* Rows of a shape that are a single point. */
static bool row_is_point(const Shape *shape, uint32_t j, uint32_t nv)
{
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return j == 0 || j == nv;
    case SHAPE_DISC:
        return j == 0;
    case SHAPE_FRUSTUM:
        return j == nv && shape->ratio == 0;
    case SHAPE_TORUS:
        return false;
    }
    return false;
}

static bool fill_shape(PatchBuilder *b, const Grid *g)
{
    const Surface *f = &b->surfaces->surface[g->surface];
    const Shape *shape = &b->surfaces->shape[f->primitive - b->surfaces->triangle_count];
    if (!reserve_vertices(b, (g->nu + 1) * (g->nv + 1)))
        return false;
    for (uint32_t j = 0; j <= g->nv; j++) {
        const bool point = row_is_point(shape, j, g->nv);
        const bool again = shape->kind == SHAPE_TORUS && j == g->nv;
        for (uint32_t i = 0; i <= g->nu; i++) {
            uint32_t *vertex = grid_at(g, i, j);
            if (again)
                *vertex = *grid_at(g, i, 0);
            else if (i > 0 && (point || i == g->nu))
                *vertex = *grid_at(g, 0, j);
            else
                *vertex = add_vertex(b, shape_point(shape, (double)i / g->nu, (double)j / g->nv));
        }
    }
    return true;
}

static bool allocate_grids(PatchBuilder *b)
{
    Patches *out = b->out;
    uint64_t total = 0;
    for (uint32_t i = 0; i < out->surface_count; i++)
        for (unsigned side = 0; side < 2; side++) {
            out->grid_first[side][i] = (uint32_t)total;
            if (patches_side_used(b, i, side))
                total += (uint64_t)(out->nu[i] + 1) * (out->nv[i] + 1u);
            if (total >= UINT32_MAX)
                return error_set(b->err, ERROR_INPUT, "more than 2^32 points on the patches' grid");
        }
    out->grid_count = (uint32_t)total;
    out->grid_vertex = array_create(total, sizeof *out->grid_vertex, "patch grid", b->err);
    for (uint64_t i = 0; out->grid_vertex != NULL && i < total; i++)
        out->grid_vertex[i] = PATCH_NONE;
    return out->grid_vertex != NULL;
}

static bool allocate_nodes(PatchBuilder *b)
{
    const size_t nodes = 8 * (size_t)b->surfaces->count;
    b->parent = array_create(nodes, sizeof *b->parent, "patch corners", b->err);
    b->corner_vertex = array_create(nodes, sizeof *b->corner_vertex, "patch corners", b->err);
    b->run = array_create(nodes, sizeof *b->run, "patch corners", b->err);
    if (error_is_set(b->err))
        return false;
    for (size_t i = 0; i < nodes; i++) {
        b->parent[i] = (uint32_t)i;
        b->corner_vertex[i] = b->run[i] = PATCH_NONE;
    }
    return true;
}

bool patches_make_vertices(PatchBuilder *b)
{
    if (!allocate_grids(b) || !allocate_nodes(b))
        return false;
    unite_corners(b);
    Patches *out = b->out;
    for (uint32_t i = 0; i < out->surface_count; i++)
        for (unsigned side = 0; side < 2; side++) {
            if (!patches_side_used(b, i, side))
                continue;
            const Grid g = { .vertex = out->grid_vertex + out->grid_first[side][i], .surface = i,
                             .nu = out->nu[i], .nv = out->nv[i], .side = side };
            const bool shape = b->surfaces->surface[i].kind == SURFACE_SHAPE;
            if (!(shape ? fill_shape(b, &g) : fill_flat(b, &g)))
                return false;
        }
    return true;
}
