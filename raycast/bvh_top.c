/* SPDX-License-Identifier: BSD-3-Clause */
/* Long ranges cut by all threads: each chunk fills bins of its own; their counts tell where in the
 * other array each chunk's references go. Chunks do not depend on the threads, minima, maxima and
 * counts not on the order in which they are joined. */
#include <assert.h>

#include "base/array.h"
#include "raycast/build.h"

#define CUT_CHUNK 8192u

typedef struct {
    Bins     bins;
    Box      centre[2];
    uint32_t left_before; /* references of the chunks before that go to the left */
} Chunk;

typedef struct {
    const Range  *range;
    const Ref    *from;
    Ref          *to;
    const BinMap *map;
    Chunk        *chunk;
} CutContext;

static void chunk_fill(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    CutContext *c = context;
    (void)worker;
    bins_fill(&c->chunk[begin / CUT_CHUNK].bins, c->map, c->from + begin, end - begin);
}

static void chunk_scatter(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    CutContext *c = context;
    Chunk *chunk = &c->chunk[begin / CUT_CHUNK];
    const Split *split = &c->range->split;
    (void)worker;
    chunk->centre[0] = chunk->centre[1] = box_empty();
    refs_scatter(c->from + begin, end - begin, c->map, split, c->to + chunk->left_before,
                 c->to + split->left + (begin - chunk->left_before), chunk->centre);
}

bool range_cut_together(const RefSet *set, Range *range, Box centre[2], Error *err)
{
    const uint32_t count = range->end - range->begin, chunks = (count - 1) / CUT_CHUNK + 1;
    assert(count >= SPLIT_TOGETHER && set->threads > 0);
    const BinMap map = bin_map(range);
    CutContext c = { .range = range, .from = set->ref[range->where] + range->begin,
                     .to = set->ref[1 - range->where] + range->begin, .map = &map };
    c.chunk = array_create(chunks, sizeof *c.chunk, "chunks of a cut", err);
    if (c.chunk == NULL)
        return false;
    parallel_for(count, CUT_CHUNK, set->threads, chunk_fill, &c, NULL, NULL);
    Bins all;
    bins_clear(&all, &map);
    for (uint32_t i = 0; i < chunks; i++)
        bins_join(&all, &c.chunk[i].bins, &map);
    float cost;
    range->split = bins_split(&all, &map, &cost);
    const Split *split = &range->split;
    if (split->axis != SPLIT_HALVES) {
        uint32_t left = 0;
        for (uint32_t i = 0; i < chunks; i++) {
            c.chunk[i].left_before = left;
            for (int j = 0; j < split->bin; j++)
                left += c.chunk[i].bins.count[split->axis][j];
        }
        assert(left == split->left);
        parallel_for(count, CUT_CHUNK, set->threads, chunk_scatter, &c, NULL, NULL);
        for (uint32_t i = 0; i < chunks; i++)
            for (int s = 0; s < 2; s++)
                centre[s] = box_join(centre[s], c.chunk[i].centre[s]);
    }
    array_free(c.chunk);
    return true;
}
