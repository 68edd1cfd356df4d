/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges between surfaces, piece by piece where others' corners lie on them, and which surfaces go
 * on smoothly across. */
#include <assert.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_internal.h"

/* --- uses ------------------------------------------------------------------------------------- */

static void surface_corners(const Surfaces *s, const Surface *f, uint32_t corner[4])
{
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    corner[0] = c[0];
    corner[1] = c[1];
    corner[2] = c[2];
    corner[3] = f->kind == SURFACE_QUAD ? c[5] : c[0];
}

/* The edge that starts with use 4 i + k, cut at its stitches. */
static void fill_edge(PatchBuilder *b, uint32_t whole, uint32_t from, uint32_t to)
{
    const Surfaces *s = b->surfaces;
    uint32_t use = whole;
    b->from[use] = from;
    if (s->stitch_first != NULL)
        for (uint32_t j = s->stitch_first[whole]; j < s->stitch_first[whole + 1]; j++) {
            b->stitch_use[j] = whole;
            b->to[use] = from == to ? to : s->stitch[j].vertex;
            use = 4 * s->count + j;
            b->from[use] = from == to ? from : s->stitch[j].vertex;
        }
    b->to[use] = to;
}

static void fill_uses(PatchBuilder *b)
{
    for (uint32_t i = 0; i < b->surfaces->count; i++) {
        const Surface *f = &b->surfaces->surface[i];
        const unsigned corners = patches_corners(f);
        const bool used = patches_side_used(b, i, 0) || patches_side_used(b, i, 1);
        uint32_t corner[4];
        if (corners > 0)
            surface_corners(b->surfaces, f, corner);
        for (unsigned k = 0; k < 4; k++) {
            const bool edge = used && k < corners;
            fill_edge(b, 4 * i + k, edge ? corner[k] : 0, edge ? corner[(k + 1) % corners] : 0);
        }
    }
    for (uint32_t use = 0; use < b->use_count; use++)
        b->mate[use] = PATCH_NODE_NONE;
}

/* Stitches of the edge that a use lies on, and the next one after the use's start. */
static void use_stitches(const PatchBuilder *b, uint32_t use, uint32_t *next, uint32_t *end)
{
    const uint32_t whole = patches_whole_use(b, use);
    *next = *end = 0;
    if (b->surfaces->stitch_first == NULL)
        return;
    *next = use == whole ? b->surfaces->stitch_first[whole] : use - 4 * b->surfaces->count + 1;
    *end = b->surfaces->stitch_first[whole + 1];
}

uint32_t patches_next_use(const PatchBuilder *b, uint32_t use)
{
    const uint32_t whole = patches_whole_use(b, use);
    const unsigned corners = patches_corners(&b->surfaces->surface[whole / 4]);
    uint32_t next, end;
    use_stitches(b, use, &next, &end);
    if (next < end)
        return 4 * b->surfaces->count + next;
    return whole % 4 + 1 == corners ? whole - whole % 4 : whole + 1;
}

void patches_use_span(const PatchBuilder *b, uint32_t use, double *start, double *end)
{
    uint32_t next, last;
    use_stitches(b, use, &next, &last);
    *start = use < 4 * b->surfaces->count
           ? 0 : b->surfaces->stitch[use - 4 * b->surfaces->count].fraction;
    *end = next < last ? b->surfaces->stitch[next].fraction : 1;
}

/* --- mates ------------------------------------------------------------------------------------ */

/* Front normal of the triangle that has the use. */
static Vec3 use_normal(const PatchBuilder *b, uint32_t use)
{
    const uint32_t whole = patches_whole_use(b, use);
    const Surface *f = &b->surfaces->surface[whole / 4];
    const bool second = f->kind == SURFACE_QUAD && whole % 4 >= 2;
    return surfaces_normal(b->surfaces, f->primitive + second, 0, 0);
}

static uint32_t use_neighbour(const PatchBuilder *b, uint32_t use)
{
    const uint32_t whole = 4 * b->surfaces->count;
    return use < whole ? b->surfaces->surface[use / 4].neighbour[use % 4]
                       : b->surfaces->stitch[use - whole].neighbour;
}

/* Whether `other` is the use of the same edge by a surface that sees this use's as its own. */
static bool uses_meet(const PatchBuilder *b, uint32_t use, uint32_t other)
{
    return other != use && b->edges.edge[other] == b->edges.edge[use]
        && use_neighbour(b, other) == patches_whole_use(b, use) / 4;
}

/* The neighbour's use of the same edge. */
static uint32_t opposite_use(const PatchBuilder *b, uint32_t use)
{
    const Surfaces *s = b->surfaces;
    const uint32_t neighbour = use_neighbour(b, use);
    if (neighbour == SURFACE_NONE)
        return PATCH_NODE_NONE;
    for (uint32_t other = 4 * neighbour; other < 4 * neighbour + 4; other++)
        if (uses_meet(b, use, other))
            return other;
    if (s->stitch_first != NULL)
        for (uint32_t j = s->stitch_first[4 * neighbour]; j < s->stitch_first[4 * neighbour + 4];
             j++)
            if (uses_meet(b, use, 4 * s->count + j))
                return 4 * s->count + j;
    return PATCH_NODE_NONE;
}

static bool smooth(const PatchBuilder *b, uint32_t use, uint32_t other)
{
    const Surface *f = &b->surfaces->surface[patches_whole_use(b, use) / 4];
    const Surface *g = &b->surfaces->surface[patches_whole_use(b, other) / 4];
    /* Wound alike, they run along their edge in opposite directions. */
    const bool alike = b->from[use] != b->from[other];
    if (f->material != g->material || f->back_material != g->back_material)
        return false;
    const double cosine = vec3_dot(use_normal(b, use), use_normal(b, other));
    return (alike ? cosine : -cosine) >= TOLERANCE_CREASE_COSINE;
}

static void find_mates(PatchBuilder *b)
{
    for (uint32_t use = 0; use < b->edges.use_count; use++) {
        if (b->edges.edge[use] == EDGE_NONE)
            continue;
        const uint32_t other = opposite_use(b, use);
        if (other == PATCH_NODE_NONE || other < use || !smooth(b, use, other))
            continue;
        b->mate[use] = other;
        b->mate[other] = use;
    }
}

unsigned patches_edge_class(const PatchBuilder *b, uint32_t use, unsigned side)
{
    const uint32_t e = b->edges.edge[use];
    const uint32_t count = b->edges.first[e + 1] - b->edges.first[e];
    const uint32_t first = b->edges.use[b->edges.first[e]];
    if (count > 2)
        return 0;
    /* Wound alike, the second runs against the first. */
    return use == first || b->from[use] != b->from[first] ? side : 1 - side;
}

uint32_t patches_edge_owner(const PatchBuilder *b, uint32_t use, unsigned side)
{
    const uint32_t node = 2 * use + side, other = b->mate[use];
    if (other == PATCH_NODE_NONE)
        return node;
    const unsigned other_side = patches_mate_side(b, use, side);
    const uint32_t other_node = 2 * other + other_side;
    const bool used = patches_side_used(b, patches_whole_use(b, other) / 4, other_side);
    return used && other_node < node ? other_node : node;
}

bool patches_find_edges(PatchBuilder *b)
{
    const Surfaces *s = b->surfaces;
    const uint32_t stitches = s->stitch_first == NULL ? 0 : s->stitch_first[4 * (size_t)s->count];
    const uint64_t uses = 4 * (uint64_t)s->count + stitches;
    if (uses > UINT32_MAX / 2)
        return error_set(b->err, ERROR_INPUT, "more than 2^31 edges of surfaces");
    b->use_count = (uint32_t)uses;
    b->from = array_create(uses, sizeof *b->from, "edges", b->err);
    b->to = array_create(uses, sizeof *b->to, "edges", b->err);
    b->mate = array_create(uses, sizeof *b->mate, "edges", b->err);
    b->stitch_use = array_create(stitches, sizeof *b->stitch_use, "edges", b->err);
    if (error_is_set(b->err))
        return false;
    fill_uses(b);
    if (!edges_create(&b->edges, b->from, b->to, b->use_count, s->vertex_count, b->err))
        return false;
    find_mates(b);
    return true;
}
