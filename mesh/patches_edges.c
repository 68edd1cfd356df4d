/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges between surfaces: where their points lie, and which surfaces go on smoothly across. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_internal.h"

static void surface_corners(const Surfaces *s, const Surface *f, uint32_t corner[4])
{
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    corner[0] = c[0];
    corner[1] = c[1];
    corner[2] = c[2];
    corner[3] = f->kind == SURFACE_QUAD ? c[5] : c[0];
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
            b->from[4 * i + k] = edge ? corner[k] : 0;
            b->to[4 * i + k] = edge ? corner[(k + 1) % corners] : 0;
            b->mate[4 * i + k] = PATCH_NODE_NONE;
        }
    }
}

/* --- mates ------------------------------------------------------------------------------------ */

/* Front normal of the triangle that has edge k. */
static Vec3 use_normal(const Surfaces *s, uint32_t use)
{
    const Surface *f = &s->surface[use / 4];
    const bool second = f->kind == SURFACE_QUAD && use % 4 >= 2;
    return surfaces_normal(s, f->primitive + second, 0, 0);
}

/* The neighbour's use of the same edge. */
static uint32_t opposite_use(const PatchBuilder *b, uint32_t use)
{
    const uint32_t neighbour = b->surfaces->surface[use / 4].neighbour[use % 4];
    if (neighbour == SURFACE_NONE)
        return PATCH_NODE_NONE;
    for (uint32_t other = 4 * neighbour; other < 4 * neighbour + 4; other++)
        if (b->edges.edge[other] == b->edges.edge[use]
            && b->surfaces->surface[neighbour].neighbour[other % 4] == use / 4)
            return other;
    return PATCH_NODE_NONE;
}

static bool smooth(const PatchBuilder *b, uint32_t use, uint32_t other)
{
    const Surface *f = &b->surfaces->surface[use / 4], *g = &b->surfaces->surface[other / 4];
    if (f->material != g->material || f->back_material != g->back_material)
        return false;
    const double cosine = vec3_dot(use_normal(b->surfaces, use), use_normal(b->surfaces, other));
    /* Wound alike, they run along their edge in opposite directions. */
    const bool alike = b->from[use] != b->from[other];
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

uint32_t patches_edge_owner(const PatchBuilder *b, uint32_t use, unsigned side)
{
    const uint32_t node = 2 * use + side, other = b->mate[use];
    if (other == PATCH_NODE_NONE)
        return node;
    const unsigned other_side = b->from[use] != b->from[other] ? side : 1 - side;
    const uint32_t other_node = 2 * other + other_side;
    return patches_side_used(b, other / 4, other_side) && other_node < node ? other_node : node;
}

/* --- points ----------------------------------------------------------------------------------- */

static int fraction_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Fractions nearer than positions are known are one point. */
static double merge_distance(const PatchBuilder *b, uint32_t use)
{
    const Vec3 p = b->surfaces->position[b->from[use]], q = b->surfaces->position[b->to[use]];
    const Vec3 most = vec3_max(vec3_max(p, q), vec3_scale(vec3_min(p, q), -1));
    const double length = vec3_length(vec3_sub(q, p));
    /* Never so far that two points of one surface meet: 1/65535 apart at least. */
    return fmin(position_tolerance(fmax(most.x, fmax(most.y, most.z))) / length,
                0.25 / UINT16_MAX);
}

static bool append_fractions(PatchBuilder *b, uint32_t *count, uint32_t n)
{
    if (!array_reserve((void **)&b->fraction, &b->fraction_capacity, (size_t)*count + n,
                       sizeof *b->fraction, "edge points", b->err))
        return false;
    if (*count > UINT32_MAX - n)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 points on edges");
    for (uint32_t m = 1; m < n; m++)
        b->fraction[(*count)++] = (double)m / n;
    return true;
}

static uint32_t use_divisions(const PatchBuilder *b, uint32_t use)
{
    return patches_edge_divisions(b, use / 4, use % 4);
}

/* All points that the surfaces at an edge want there, each once, rising. k / n is the same double
 * from whichever end it is counted as an integer, and for all k / n that are equal. */
static bool edge_fractions(PatchBuilder *b, uint32_t e, uint32_t *count)
{
    const uint32_t *use = b->edges.use + b->edges.first[e];
    const uint32_t uses = b->edges.first[e + 1] - b->edges.first[e];
    const uint32_t start = *count;
    bool equal = true;
    if (!append_fractions(b, count, use_divisions(b, use[0])))
        return false;
    for (uint32_t k = 1; k < uses; k++) {
        const uint32_t n = use_divisions(b, use[k]);
        bool seen = false;
        for (uint32_t j = 0; j < k && !seen && j < 8; j++)
            seen = use_divisions(b, use[j]) == n;
        if (seen)
            continue;
        equal = false;
        if (!append_fractions(b, count, n))
            return false;
    }
    if (equal)
        return true;
    const double apart = merge_distance(b, use[0]);
    qsort(b->fraction + start, *count - start, sizeof *b->fraction, fraction_compare);
    uint32_t kept = start;
    for (uint32_t i = start; i < *count; i++)
        if (kept == start || b->fraction[i] - b->fraction[kept - 1] > apart)
            b->fraction[kept++] = b->fraction[i];
    *count = kept;
    return true;
}

uint32_t patches_edge_point(const PatchBuilder *b, uint32_t use, uint32_t m, uint32_t n)
{
    assert(m > 0 && m < n);
    const uint32_t e = b->edges.edge[use];
    const uint32_t along = b->from[use] < b->to[use] ? m : n - m;
    const double *fraction = b->fraction + b->point_first[e];
    const uint32_t count = b->point_first[e + 1] - b->point_first[e];
    if (count == n - 1)
        return along - 1;
    const double wanted = (double)along / n;
    uint32_t low = 0, high = count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (fraction[middle] < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    /* A merged point has gone into the one before it. */
    if (low == count || (low > 0 && wanted - fraction[low - 1] < fraction[low] - wanted))
        low--;
    return low;
}

bool patches_find_edges(PatchBuilder *b)
{
    const size_t uses = 4 * (size_t)b->surfaces->count;
    b->from = array_create(uses, sizeof *b->from, "edges", b->err);
    b->to = array_create(uses, sizeof *b->to, "edges", b->err);
    b->mate = array_create(uses, sizeof *b->mate, "edges", b->err);
    if (error_is_set(b->err))
        return false;
    fill_uses(b);
    if (!edges_create(&b->edges, b->from, b->to, (uint32_t)uses, b->surfaces->vertex_count,
                      b->err))
        return false;
    find_mates(b);
    b->point_first = array_create((size_t)b->edges.count + 1, sizeof *b->point_first, "edges",
                                  b->err);
    if (b->point_first == NULL || !append_fractions(b, &(uint32_t){ 0 }, 1))
        return false;
    uint32_t count = 0;
    for (uint32_t e = 0; e < b->edges.count; e++) {
        if (!edge_fractions(b, e, &count))
            return false;
        b->point_first[e + 1] = count;
    }
    return true;
}
