/* SPDX-License-Identifier: BSD-3-Clause */
/* Where vertices lie on edges: all points that the surfaces there want, each once. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_internal.h"

/* One surface's side at an edge. */
typedef struct {
    uint32_t use, surface;
    unsigned side, k;       /* edge of the surface */
    uint32_t divisions;     /* base divisions of that edge */
    bool     divided;
    double   start, end;    /* of the use, along the surface's edge */
} EdgeNode;

typedef struct {
    PatchBuilder   *b;
    const EdgeNode *node;
    uint32_t        count;   /* of b->fraction */
    double          finest;  /* shortest cell at this edge, as a part of the use */
} EdgePoints;

static bool append_point(EdgePoints *points, double fraction)
{
    PatchBuilder *b = points->b;
    if (points->count == UINT32_MAX)
        return error_set(b->err, ERROR_INPUT, "more than 2^32 points on edges");
    if (!array_reserve((void **)&b->fraction, &b->fraction_capacity, (size_t)points->count + 1,
                       sizeof *b->fraction, "edge points", b->err))
        return false;
    b->fraction[points->count++] = fraction;
    return true;
}

static bool whole_edge(const EdgeNode *node) { return node->start == 0 && node->end == 1; }

/* m / n of the surface's edge, as a fraction of the use from its smaller vertex. k / n of a whole
 * edge is the same double from whichever end it is counted, and for all k / n that are equal. */
static bool append_mark(EdgePoints *points, uint32_t m, uint32_t n)
{
    const PatchBuilder *b = points->b;
    const EdgeNode *node = points->node;
    const bool forward = b->from[node->use] < b->to[node->use];
    if (whole_edge(node))
        return append_point(points, (double)(forward ? m : n - m) / n);
    const double length = node->end - node->start, at = (double)m / n;
    const double fraction = (forward ? at - node->start : node->end - at) / length;
    return fraction <= 0 || fraction >= 1 || append_point(points, fraction);
}

static bool tree_mark(void *context, uint32_t mark, uint32_t length)
{
    EdgePoints *points = context;
    const uint32_t n = points->node->divisions << PATCH_LEVELS;
    const double use = points->node->end - points->node->start;
    points->finest = fmin(points->finest, length / (n * use));
    return mark == n || append_mark(points, mark, n);
}

static bool append_node(EdgePoints *points, const EdgeNode *node)
{
    const PatchBuilder *b = points->b;
    const uint32_t n = node->divisions;
    points->node = node;
    if (node->divided)
        return patches_edge_marks(b->out, b->surfaces, node->surface, node->side, node->k,
                                  tree_mark, points);
    points->finest = fmin(points->finest, 1 / (n * (node->end - node->start)));
    /* Even spacing is the same from both ends: a whole edge's points rise already. */
    const bool whole = whole_edge(node);
    for (uint32_t m = 1; m < n; m++)
        if (!(whole ? append_point(points, (double)m / n) : append_mark(points, m, n)))
            return false;
    return true;
}

/* Fractions nearer than positions are known are one point, but never so far apart that two points
 * of one surface would meet. */
static double merge_distance(const PatchBuilder *b, uint32_t use, double finest)
{
    const Vec3 p = b->surfaces->position[b->from[use]], q = b->surfaces->position[b->to[use]];
    const Vec3 most = vec3_max(vec3_max(p, q), vec3_scale(vec3_min(p, q), -1));
    const double length = vec3_length(vec3_sub(q, p));
    return fmin(position_tolerance(fmax(most.x, fmax(most.y, most.z))) / length, finest / 4);
}

static int fraction_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts the points from `start` on, drops those that fall together or onto the use's ends. */
static void merge_points(EdgePoints *points, uint32_t start, uint32_t use)
{
    double *fraction = points->b->fraction;
    const double apart = merge_distance(points->b, use, points->finest);
    qsort(fraction + start, points->count - start, sizeof *fraction, fraction_compare);
    uint32_t kept = start;
    for (uint32_t i = start; i < points->count; i++) {
        const double before = kept == start ? 0 : fraction[kept - 1];
        if (fraction[i] - before > apart && 1 - fraction[i] > apart)
            fraction[kept++] = fraction[i];
    }
    points->count = kept;
}

static EdgeNode edge_node(const PatchBuilder *b, uint32_t use, unsigned side)
{
    const uint32_t whole = patches_whole_use(b, use), surface = whole / 4;
    EdgeNode node = { .use = use, .surface = surface, .side = side, .k = whole % 4 };
    node.divisions = patches_edge_divisions(b->out, surface, node.k);
    node.divided = b->out->tree_first[side][surface] != PATCH_NONE;
    patches_use_span(b, use, &node.start, &node.end);
    return node;
}

/* All points of edge e for one class of nodes. */
static bool edge_points(EdgePoints *points, uint32_t e, unsigned class)
{
    enum { REMEMBERED = 8 };
    PatchBuilder *b = points->b;
    const uint32_t start = points->count;
    uint32_t seen[REMEMBERED], seen_count = 0;
    bool several = false;
    points->finest = 1;
    for (uint32_t i = b->edges.first[e]; i < b->edges.first[e + 1]; i++)
        for (unsigned side = 0; side < 2; side++) {
            const uint32_t use = b->edges.use[i];
            const EdgeNode node = edge_node(b, use, side);
            if (!patches_side_used(b, node.surface, side)
                || patches_edge_class(b, use, side) != class)
                continue;
            const bool plain = whole_edge(&node) && !node.divided;
            bool again = false;
            for (uint32_t k = 0; plain && k < seen_count; k++)
                again = again || seen[k] == node.divisions;
            if (again)
                continue;
            if (plain && seen_count < REMEMBERED)
                seen[seen_count++] = node.divisions;
            several = several || points->count > start || !plain;
            if (!append_node(points, &node))
                return false;
        }
    if (several && points->count > start)
        merge_points(points, start, b->edges.use[b->edges.first[e]]);
    return true;
}

/* Whether nobody wants a point on edge e, as is usual among small surfaces. */
static bool edge_is_bare(const PatchBuilder *b, uint32_t e)
{
    const Patches *out = b->out;
    for (uint32_t i = b->edges.first[e]; i < b->edges.first[e + 1]; i++) {
        const uint32_t whole = patches_whole_use(b, b->edges.use[i]), surface = whole / 4;
        if (patches_edge_divisions(out, surface, whole % 4) > 1
            || out->tree_first[0][surface] != PATCH_NONE
            || out->tree_first[1][surface] != PATCH_NONE)
            return false;
    }
    return true;
}

bool patches_find_points(PatchBuilder *b)
{
    EdgePoints points = { .b = b };
    b->point_first = array_create(2 * (size_t)b->edges.count + 1, sizeof *b->point_first, "edges",
                                  b->err);
    if (b->point_first == NULL
        || !array_reserve((void **)&b->fraction, &b->fraction_capacity, 1, sizeof *b->fraction,
                          "edge points", b->err))
        return false;
    for (uint32_t e = 0; e < b->edges.count; e++)
        for (unsigned class = 0, bare = edge_is_bare(b, e); class < 2; class++) {
            if (!bare && !edge_points(&points, e, class))
                return false;
            b->point_first[2 * e + class + 1] = points.count;
        }
    return true;
}
