/* SPDX-License-Identifier: BSD-3-Clause */
/* Vertices: one per point and smooth surface side. */
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

static void unite_corners(PatchBuilder *b)
{
    for (uint32_t use = 0; use < b->edges.use_count; use++) {
        const uint32_t other = b->mate[use];
        if (other == PATCH_NODE_NONE || other < use)
            continue;
        const bool alike = b->from[use] != b->from[other];
        const uint32_t use_end = patches_next_use(b, use), other_end = patches_next_use(b, other);
        for (unsigned side = 0; side < 2; side++) {
            const unsigned other_side = patches_mate_side(b, use, side);
            if (!patches_side_used(b, patches_whole_use(b, use) / 4, side)
                || !patches_side_used(b, patches_whole_use(b, other) / 4, other_side))
                continue;
            node_unite(b->parent, 2 * use + side, 2 * (alike ? other_end : other) + other_side);
            node_unite(b->parent, 2 * use_end + side,
                       2 * (alike ? other : other_end) + other_side);
        }
    }
}

bool patches_start_vertices(PatchBuilder *b)
{
    const size_t nodes = 2 * (size_t)b->use_count;
    b->parent = array_create(nodes, sizeof *b->parent, "patch corners", b->err);
    b->corner_vertex = array_create(nodes, sizeof *b->corner_vertex, "patch corners", b->err);
    b->run = array_create(nodes, sizeof *b->run, "patch corners", b->err);
    if (error_is_set(b->err))
        return false;
    for (size_t i = 0; i < nodes; i++) {
        b->parent[i] = (uint32_t)i;
        b->corner_vertex[i] = b->run[i] = PATCH_NONE;
    }
    unite_corners(b);
    return true;
}

/* --- making vertices -------------------------------------------------------------------------- */

bool patches_add_vertex(PatchBuilder *b, Vec3 p, uint32_t *vertex)
{
    Patches *out = b->out;
    if (out->vertex_count == UINT32_MAX - 1)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 patch vertices");
    if (!array_reserve((void **)&out->position, &b->position_capacity,
                       (size_t)out->vertex_count + 1, sizeof *out->position, "patch vertices",
                       b->err))
        return false;
    *vertex = out->vertex_count;
    out->position[out->vertex_count++] = p;
    return true;
}

bool patches_corner_vertex(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *vertex)
{
    const uint32_t root = node_root(b->parent, 2 * use + side);
    if (b->corner_vertex[root] == PATCH_NONE
        && !patches_add_vertex(b, b->surfaces->position[b->from[use]], &b->corner_vertex[root]))
        return false;
    *vertex = b->corner_vertex[root];
    return true;
}

/* Positions are always computed from the smaller end: bit for bit the same for all that share the
 * edge, smoothly or not. */
bool patches_run_vertices(PatchBuilder *b, uint32_t use, unsigned side, uint32_t *first)
{
    const uint32_t owner = patches_edge_owner(b, use, side);
    const uint32_t list = 2 * b->edges.edge[use] + patches_edge_class(b, use, side);
    if (b->run[owner] == PATCH_NONE) {
        const bool forward = b->from[use] < b->to[use];
        const Vec3 p = b->surfaces->position[forward ? b->from[use] : b->to[use]];
        const Vec3 q = b->surfaces->position[forward ? b->to[use] : b->from[use]];
        b->run[owner] = b->out->vertex_count;
        for (uint32_t k = b->point_first[list]; k < b->point_first[list + 1]; k++) {
            uint32_t vertex;
            if (!patches_add_vertex(b, vec3_lerp(p, q, b->fraction[k]), &vertex))
                return false;
        }
    }
    *first = b->run[owner];
    return true;
}
