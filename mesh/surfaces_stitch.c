/* SPDX-License-Identifier: BSD-3-Clause */
/* T-junctions: corners that lie inside open edges become vertices of these.
 *
 * Only edges of one triangle are looked at, and only their ends: a corner that merely touches an
 * edge whose faces meet is none. Each open edge is cut at the ends of others that lie on it; a cut
 * stays where at least one of the two pieces it parts runs along a piece of another triangle. So
 * two rows of bricks fit, neither of which has whole edges in common with the other.
 */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/internal.h"
#include "mesh/point_tree.h"

/* In a surface without holes a corner lies inside at most a few open edges. Where thousands of
 * edges lie in one line on each other, all with ends of their own, cuts would be as many as pairs:
 * beyond so many per open edge the rest stays uncut. */
enum { MOST_PER_EDGE = 64 };

/* A cut of open edge number `edge`. */
typedef struct {
    uint32_t edge;
    Stitch   at;
    uint32_t face;    /* of a triangle that has the corner */
} Cut;

typedef struct {
    const Pieces *pieces;
    const Vec3   *position;
    Repair       *repair;
    PointTree     tree;       /* ends of open edges */
    uint32_t     *open;       /* [open_count]  uses, rising */
    uint32_t      open_count;
    Cut          *cut;        /* [cut_count]  by edge and fraction */
    uint32_t      cut_count;
    size_t        cut_capacity;
    uint32_t      edge;       /* the open edge that is searched now */
} Stitcher;

static bool find_open(Stitcher *s, const Edges *edges, uint32_t vertex_count)
{
    Error *err = s->repair->err;
    uint32_t count = 0;
    for (uint32_t e = 0; e < edges->count; e++)
        count += edges->first[e + 1] - edges->first[e] == 1;
    s->open = array_create(count, sizeof *s->open, "open edges", err);
    uint8_t *ends = array_create(vertex_count, sizeof *ends, "open edges", err);
    uint32_t *vertex = array_create(2 * (size_t)count, sizeof *vertex, "open edges", err);
    if (!error_is_set(err)) {
        for (uint32_t use = 0; use < edges->use_count; use++) {
            const uint32_t e = edges->edge[use];
            if (edges->first[e + 1] - edges->first[e] != 1)
                continue;
            s->open[s->open_count++] = use;
            ends[s->pieces->corner[use]] = ends[s->pieces->corner[use_next(use)]] = 1;
        }
        uint32_t found = 0;
        for (uint32_t v = 0; v < vertex_count; v++)
            if (ends[v])
                vertex[found++] = v;
        point_tree_create(&s->tree, s->position, vertex, found, err);
    }
    array_free(ends);
    array_free(vertex);
    return !error_is_set(err);
}

static bool add_cut(void *context, uint32_t vertex, double fraction)
{
    Stitcher *s = context;
    const uint32_t use = s->open[s->edge];
    if (vertex == s->pieces->corner[use] || vertex == s->pieces->corner[use_next(use)])
        return true;
    if (s->cut_count / MOST_PER_EDGE >= s->open_count)
        return false;
    if (!array_reserve((void **)&s->cut, &s->cut_capacity, (size_t)s->cut_count + 1,
                       sizeof *s->cut, "T-junctions", s->repair->err))
        return false;
    s->cut[s->cut_count++] = (Cut){ s->edge, { vertex, SURFACE_NONE, fraction }, DEFECT_NO_FACE };
    return true;
}

static int cut_compare(const void *a, const void *b)
{
    const Cut *x = a, *y = b;
    if (x->at.fraction != y->at.fraction)
        return x->at.fraction < y->at.fraction ? -1 : 1;
    return (x->at.vertex > y->at.vertex) - (x->at.vertex < y->at.vertex);
}

static bool find_cuts(Stitcher *s)
{
    for (s->edge = 0; s->edge < s->open_count; s->edge++) {
        const uint32_t use = s->open[s->edge], start = s->cut_count;
        const Vec3 p = s->position[s->pieces->corner[use]];
        const Vec3 q = s->position[s->pieces->corner[use_next(use)]];
        const bool whole = point_tree_along(&s->tree, p, q, repair_reach(s->repair, p, q),
                                            add_cut, s);
        if (error_is_set(s->repair->err))
            return false;
        if (!whole) {
            s->cut_count = start;
            s->repair->many_junctions = true;
            break;
        }
        if (s->cut_count > start)
            qsort(s->cut + start, s->cut_count - start, sizeof *s->cut, cut_compare);
    }
    return true;
}

/* --- which cuts stay -------------------------------------------------------------------------- */

/* Pieces of open edges: links of edge i are numbered from i + the number of cuts before it on. */
typedef struct {
    uint32_t *from, *to;  /* [links] */
    uint32_t *piece;      /* [links] */
    Edges     edges;
} Links;

static bool links_create(Links *links, const Stitcher *s, uint32_t vertex_count)
{
    Error *err = s->repair->err;
    const uint32_t count = s->open_count + s->cut_count;
    *links = (Links){ 0 };
    links->from = array_create(count, sizeof *links->from, "T-junctions", err);
    links->to = array_create(count, sizeof *links->to, "T-junctions", err);
    links->piece = array_create(count, sizeof *links->piece, "T-junctions", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0, cut = 0, link = 0; i < s->open_count; i++) {
        uint32_t from = s->pieces->corner[s->open[i]];
        for (;; link++) {
            const bool last = cut == s->cut_count || s->cut[cut].edge != i;
            links->piece[link] = s->open[i] / 3;
            links->from[link] = from;
            links->to[link] = last ? s->pieces->corner[use_next(s->open[i])]
                                   : s->cut[cut].at.vertex;
            from = links->to[link];
            if (last)
                break;
            cut++;
        }
        link++;
    }
    return edges_create(&links->edges, links->from, links->to, count, vertex_count, err);
}

static void links_clear(Links *links)
{
    array_free(links->from);
    array_free(links->to);
    array_free(links->piece);
    edges_clear(&links->edges);
}

/* Another triangle that has a piece of an edge along this one, or PIECE_NONE. */
static uint32_t link_partner(const Links *links, uint32_t link)
{
    const uint32_t e = links->edges.edge[link];
    for (uint32_t k = links->edges.first[e]; k < links->edges.first[e + 1]; k++)
        if (links->piece[links->edges.use[k]] != links->piece[link])
            return links->piece[links->edges.use[k]];
    return PIECE_NONE;
}

static void keep_cuts(Stitcher *s, const Links *links)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->cut_count; i++) {
        Cut cut = s->cut[i];
        const uint32_t before = link_partner(links, cut.edge + i);
        const uint32_t after = link_partner(links, cut.edge + i + 1);
        const uint32_t partner = before != PIECE_NONE ? before : after;
        if (partner == PIECE_NONE)
            continue;
        cut.face = s->pieces->face[partner];
        s->cut[kept++] = cut;
    }
    s->cut_count = kept;
}

static bool list_cuts(Stitcher *s)
{
    const bool repaired = !s->repair->options->keep_junctions;
    for (uint32_t i = 0; i < s->cut_count; i++) {
        const Cut *cut = &s->cut[i];
        const uint32_t use = s->open[cut->edge];
        const Vec3 p = s->position[s->pieces->corner[use]];
        const Vec3 q = s->position[s->pieces->corner[use_next(use)]];
        const Vec3 at = s->position[cut->at.vertex];
        const Vec3 foot = vec3_mad(p, cut->at.fraction, vec3_sub(q, p));
        if (!repair_report(s->repair, &(Defect){
                .kind = DEFECT_T_JUNCTION, .repaired = repaired, .face = s->pieces->face[use / 3],
                .other = cut->face, .at = at, .measure = vec3_length(vec3_sub(at, foot)) }))
            return false;
    }
    return true;
}

static bool stitches_fill(Stitches *stitches, const Stitcher *s)
{
    Error *err = s->repair->err;
    const size_t uses = 3 * (size_t)s->pieces->count;
    stitches->first = array_create(uses + 1, sizeof *stitches->first, "T-junctions", err);
    stitches->stitch = array_create(s->cut_count, sizeof *stitches->stitch, "T-junctions", err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < s->cut_count; i++) {
        stitches->stitch[i] = s->cut[i].at;
        stitches->first[s->open[s->cut[i].edge] + 1]++;
    }
    for (size_t use = 0; use < uses; use++)
        stitches->first[use + 1] += stitches->first[use];
    stitches->count = s->cut_count;
    return true;
}

bool stitches_create(Stitches *stitches, const Pieces *pieces, const Edges *edges,
                     const Weld *weld, Repair *repair)
{
    assert(stitches != NULL && edges->use_count == 3 * pieces->count);
    *stitches = (Stitches){ 0 };
    Stitcher s = { .pieces = pieces, .position = weld->position, .repair = repair };
    Links links = { 0 };
    if (find_open(&s, edges, weld->vertex_count) && find_cuts(&s) && s.cut_count > 0
        && links_create(&links, &s, weld->vertex_count)) {
        keep_cuts(&s, &links);
        list_cuts(&s);
        if (s.cut_count > 0 && !repair->options->keep_junctions && !error_is_set(repair->err)
            && stitches_fill(stitches, &s))
            repair->repairs.stitched = s.cut_count;
    }
    links_clear(&links);
    point_tree_clear(&s.tree);
    array_free(s.open);
    array_free(s.cut);
    if (error_is_set(repair->err))
        stitches_clear(stitches);
    return !error_is_set(repair->err);
}

void stitches_clear(Stitches *stitches)
{
    array_free(stitches->first);
    array_free(stitches->stitch);
    *stitches = (Stitches){ 0 };
}
