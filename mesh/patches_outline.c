/* SPDX-License-Identifier: BSD-3-Clause */
/* The vertices round one side of a flat surface: corners, stitches, and the points of its edges. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

static bool add_entry(PatchOutline *o, uint32_t *count, uint32_t vertex, double fraction,
                      Error *err)
{
    if (!array_reserve((void **)&o->vertex, &o->vertex_capacity, (size_t)*count + 1,
                       sizeof *o->vertex, "outline", err)
        || !array_reserve((void **)&o->fraction, &o->fraction_capacity, (size_t)*count + 1,
                          sizeof *o->fraction, "outline", err))
        return false;
    o->vertex[*count] = vertex;
    o->fraction[(*count)++] = fraction;
    return true;
}

/* What lies inside of a use, in its direction. */
static bool add_run(PatchBuilder *b, PatchOutline *o, uint32_t *count, uint32_t use, unsigned side)
{
    const uint32_t list = 2 * b->edges.edge[use] + patches_edge_class(b, use, side);
    const uint32_t first = b->point_first[list], points = b->point_first[list + 1] - first;
    uint32_t run;
    double start, end;
    if (points == 0)
        return true;
    if (!patches_run_vertices(b, use, side, &run))
        return false;
    const bool forward = b->from[use] < b->to[use];
    patches_use_span(b, use, &start, &end);
    for (uint32_t k = 0; k < points; k++) {
        const uint32_t at = forward ? k : points - 1 - k;
        const double fraction = forward ? b->fraction[first + at] : 1 - b->fraction[first + at];
        if (!add_entry(o, count, run + at, start + fraction * (end - start), b->err))
            return false;
    }
    return true;
}

bool patches_outline(PatchBuilder *b, uint32_t surface, unsigned side, PatchOutline *o)
{
    const unsigned corners = patches_corners(&b->surfaces->surface[surface]);
    uint32_t count = 0;
    for (unsigned k = 0; k < corners; k++) {
        const uint32_t whole = 4 * surface + k, last = 4 * surface + (k + 1) % corners;
        o->first[k] = count;
        for (uint32_t use = whole; use != last; use = patches_next_use(b, use)) {
            uint32_t vertex;
            double start, end;
            assert(b->edges.edge[use] != EDGE_NONE);
            patches_use_span(b, use, &start, &end);
            if (!patches_corner_vertex(b, use, side, &vertex)
                || !add_entry(o, &count, vertex, start, b->err)
                || !add_run(b, o, &count, use, side))
                return false;
        }
        uint32_t vertex;
        if (!patches_corner_vertex(b, last, side, &vertex)
            || !add_entry(o, &count, vertex, 1, b->err))
            return false;
    }
    o->first[corners] = count;
    return true;
}

uint32_t patches_outline_entry(const PatchOutline *o, unsigned k, double fraction)
{
    uint32_t low = o->first[k], high = o->first[k + 1] - 1;
    assert(high > low);
    /* The first entry not before it. */
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (o->fraction[middle] < fraction)
            low = middle + 1;
        else
            high = middle;
    }
    /* A point that fell together with another is within rounding of it, on either side. */
    if (low > o->first[k] && fraction - o->fraction[low - 1] < o->fraction[low] - fraction)
        low--;
    return low;
}
