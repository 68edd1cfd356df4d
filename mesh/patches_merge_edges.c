/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges that a third surface shares: it may stand there as a wall does, or lie there as a slab
 * below a box does, and what is on the two sides of it need not see the same light. */
#include <assert.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

/* Uses of all edges, cut at their stitches: 4 i + k starts edge k of surface i, and 4 * count + j
 * starts at stitch j. */
typedef struct {
    const Surfaces *surfaces;
    uint32_t       *from, *to;
} EdgeUses;

static uint32_t corner_vertex(const Surfaces *s, const Surface *f, unsigned k)
{
    return s->corner[3 * (size_t)f->primitive + (k == 3 ? 5 : k)];
}

static void fill_edge(const EdgeUses *uses, uint32_t whole, uint32_t from, uint32_t to)
{
    const Surfaces *s = uses->surfaces;
    uint32_t use = whole;
    uses->from[use] = from;
    for (uint32_t j = s->stitch_first != NULL ? s->stitch_first[whole] : 0;
         s->stitch_first != NULL && j < s->stitch_first[whole + 1]; j++) {
        uses->to[use] = s->stitch[j].vertex;
        use = 4 * s->count + j;
        uses->from[use] = s->stitch[j].vertex;
    }
    uses->to[use] = to;
}

static bool is_shared(const Surfaces *s, const Edges *edges, uint32_t whole)
{
    uint32_t use = whole;
    const uint32_t last = s->stitch_first != NULL ? s->stitch_first[whole + 1] : 0;
    for (uint32_t j = s->stitch_first != NULL ? s->stitch_first[whole] : 0;; j++) {
        const uint32_t e = edges->edge[use];
        if (e != EDGE_NONE && edges->first[e + 1] - edges->first[e] > 2)
            return true;
        if (j >= last)
            return false;
        use = 4 * s->count + j;
    }
}

bool merge_shared_edges(const Surfaces *s, uint8_t *shared, Error *err)
{
    assert(s != NULL && shared != NULL && err != NULL);
    const uint32_t stitches = s->stitch_first != NULL ? s->stitch_first[4 * (size_t)s->count] : 0;
    const uint32_t count = 4 * s->count + stitches;
    EdgeUses uses = { .surfaces = s };
    Edges edges = { 0 };
    uses.from = array_create(count, sizeof *uses.from, "patch edges", err);
    uses.to = array_create(count, sizeof *uses.to, "patch edges", err);
    for (uint32_t i = 0; i < s->count && !error_is_set(err); i++) {
        const Surface *f = &s->surface[i];
        const unsigned corners = patches_corners(f);
        for (unsigned k = 0; k < corners; k++)
            fill_edge(&uses, 4 * i + k, corner_vertex(s, f, k),
                      corner_vertex(s, f, (k + 1) % corners));
    }
    const bool ok = !error_is_set(err)
                 && edges_create(&edges, uses.from, uses.to, count, s->vertex_count, err);
    array_free(uses.from);
    array_free(uses.to);
    for (uint32_t i = 0; ok && i < s->count; i++) {
        shared[i] = 0;
        for (unsigned k = 0; k < patches_corners(&s->surface[i]); k++)
            shared[i] |= (uint8_t)(is_shared(s, &edges, 4 * i + k) << k);
    }
    edges_clear(&edges);
    return ok;
}
