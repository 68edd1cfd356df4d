/* SPDX-License-Identifier: BSD-3-Clause */
/* References to a tree of pairs, from the top: each set is parted by the middles of its boxes
 * [wald07] or by a plane that cuts triangles [stich09], whichever costs less. A set lies in a
 * stretch of an array that has room for the references that cuts add; what is left of the room goes
 * to both sides in the middle between them. Long sets are cut in chunks by all threads, and what is
 * below a fixed share of the whole is a task of its own; neither depends on the number of threads,
 * and joining boxes not on the order. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "raycast/pairs.h"

/* References that cuts may add: this share of the primitives. */
#define ROOM_SHARE 0.3

#define CUT_CHUNK 8192u
#define TASK_REFS_MIN 1024u
#define TASKS_WANTED 32u
/* Free choice of the cut for this many levels, halves after that: fewer than 2^32 references. */
#define DEPTH_FREE 56u
/* Planes are tried where the sides' boxes have more than this share of the root's surface in
 * common: elsewhere they gain nothing that is worth the time [stich09]. */
#define OVERLAP_LEAST 1e-5f
/* Below, planes cost time and gained nothing that could be measured. */
#define CHOP_REFS_LEAST 16u

typedef struct {
    Range    range;    /* its split is not used */
    uint32_t from, to; /* its stretch: from <= range.begin, range.end <= to */
    uint32_t node;     /* its pair's number; those below it follow, 2 (to - from) - 1 in all */
} Stretch;

typedef struct {
    RefSet            set;
    const Primitives *in;
    Pair             *pair;
    float             overlap_least;
    Stretch          *task;
    size_t            task_count, task_capacity;
    uint32_t          task_refs;
} PairBuilder;

typedef struct {
    union {
        Bins     bins;
        ChopBins chops;
    } part;
    uint32_t sides[2], before[2];
    Box      box[2], centre[2];
} CutChunk;

typedef struct {
    const PairBuilder *b;
    const Stretch     *s;
    Ref               *from, *to[2]; /* to[1]: where the right side begins */
    BinMap             bin_map;
    Split              split;
    ChopMap            chop_map;
    Chop               chop;
    uint32_t           count, chunk_refs, chunks;
    CutChunk          *chunk;
} Cut;

/* --- in chunks ------------------------------------------------------------------------------- */

static void fill_bins(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Cut *c = context;
    (void)worker;
    bins_fill(&c->chunk[begin / c->chunk_refs].part.bins, &c->bin_map, c->from + begin,
              end - begin);
}

static void fill_chops(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Cut *c = context;
    (void)worker;
    chops_fill(&c->chunk[begin / c->chunk_refs].part.chops, &c->chop_map, c->b->in,
               c->from + begin, end - begin);
}

/* Which side each reference goes to, and how many that are. */
static void count_sides(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Cut *c = context;
    CutChunk *chunk = &c->chunk[begin / c->chunk_refs];
    (void)worker;
    chunk->sides[0] = chunk->sides[1] = 0;
    if (c->chop.axis >= 0) {
        chop_sides(&c->chop, c->b->in, c->from + begin, end - begin, chunk->sides);
        return;
    }
    for (uint32_t i = begin; i < end; i++) {
        const int axis = c->split.axis;
        const bool left = axis >= 0 ? bin_of(&c->bin_map, box_centre(ref_box(&c->from[i])))[axis]
                                          < c->split.bin
                                    : i < c->count / 2;
        c->from[i].unused = left ? CHOP_LEFT : CHOP_RIGHT;
        chunk->sides[!left]++;
    }
}

static void scatter(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Cut *c = context;
    CutChunk *chunk = &c->chunk[begin / c->chunk_refs];
    (void)worker;
    for (int s = 0; s < 2; s++)
        chunk->box[s] = chunk->centre[s] = box_empty();
    chop_scatter(&c->chop, c->b->in, c->from + begin, end - begin, c->to[0] + chunk->before[0],
                 c->to[1] + chunk->before[1], chunk->box, chunk->centre);
}

static void chunks_run(Cut *c, ParallelBody body)
{
    if (c->chunks == 1)
        body(c, 0, c->count, 0);
    else
        parallel_for(c->count, c->chunk_refs, c->b->set.threads, body, c, NULL, NULL);
}

/* --- one cut --------------------------------------------------------------------------------- */

/* The best parting by middles. */
static float decide_middles(Cut *c)
{
    float cost;
    c->bin_map = bin_map(&c->s->range);
    chunks_run(c, fill_bins);
    for (uint32_t i = 1; i < c->chunks; i++)
        bins_join(&c->chunk[0].part.bins, &c->chunk[i].part.bins, &c->bin_map);
    c->split = bins_split(&c->chunk[0].part.bins, &c->bin_map, &cost);
    return cost;
}

/* Whether planes are worth trying: the sides overlap, and there is room. */
static bool may_chop(const Cut *c)
{
    const Stretch *s = c->s;
    if (c->count < CHOP_REFS_LEAST || s->to - s->from == c->count)
        return false;
    Box common = s->range.box;
    for (int k = 0; k < 2 && c->split.axis >= 0; k++) {
        common.lo = float4_max(common.lo, c->split.box[k].lo);
        common.hi = float4_min(common.hi, c->split.box[k].hi);
    }
    for (int k = 0; k < 3; k++)
        if (common.lo[k] > common.hi[k])
            return false;
    return box_area(common) > c->b->overlap_least;
}

static void cut_decide(Cut *c)
{
    c->chop.axis = SPLIT_NONE;
    c->split.axis = SPLIT_HALVES;
    if (c->s->range.depth >= DEPTH_FREE)
        return;
    const float cost = decide_middles(c);
    if (!may_chop(c))
        return;
    c->chop_map = chop_map(c->s->range.box);
    chunks_run(c, fill_chops);
    for (uint32_t i = 1; i < c->chunks; i++)
        chops_join(&c->chunk[0].part.chops, &c->chunk[i].part.chops);
    c->chop = chops_cheapest(&c->chunk[0].part.chops, &c->chop_map);
    if (c->chop.axis >= 0 && !(c->chop.cost < cost))
        c->chop.axis = SPLIT_NONE;
}

static void sum_sides(Cut *c, uint32_t sides[2])
{
    chunks_run(c, count_sides);
    sides[0] = sides[1] = 0;
    for (uint32_t i = 0; i < c->chunks; i++)
        for (int s = 0; s < 2; s++) {
            c->chunk[i].before[s] = sides[s];
            sides[s] += c->chunk[i].sides[s];
        }
}

/* Both sides have fewer references than the whole, and they fit: else not by a plane. */
static void cut_count(Cut *c, uint32_t sides[2])
{
    sum_sides(c, sides);
    if (c->chop.axis >= 0
        && (sides[0] == 0 || sides[1] == 0 || sides[0] >= c->count || sides[1] >= c->count
            || sides[0] + sides[1] > c->s->to - c->s->from)) {
        c->chop.axis = SPLIT_NONE;
        sum_sides(c, sides);
    }
    assert(sides[0] > 0 && sides[1] > 0);
}

static void cut_carry_out(Cut *c, const uint32_t sides[2], Stretch side[2])
{
    const Stretch *s = c->s;
    const uint32_t room = s->to - s->from - sides[0] - sides[1];
    const uint32_t middle = s->from + sides[0]
                            + (uint32_t)((uint64_t)room * sides[0] / (sides[0] + sides[1]));
    Ref *to = c->b->set.ref[1 - s->range.where];
    c->to[0] = to + s->from;
    c->to[1] = to + s->to - sides[1];
    chunks_run(c, scatter);
    const uint32_t end[2] = { middle, s->to }, begin[2] = { s->from, s->to - sides[1] };
    for (int k = 0; k < 2; k++) {
        Range *r = &side[k].range;
        *r = (Range){ .begin = begin[k], .end = begin[k] + sides[k], .depth = s->range.depth + 1,
                      .where = 1 - s->range.where, .box = box_empty(), .centre = box_empty() };
        side[k].to = end[k];
        side[k].from = k == 0 ? s->from : middle;
        side[k].node = k == 0 ? s->node + 1 : s->node + 2 * (middle - s->from);
        for (uint32_t i = 0; i < c->chunks; i++) {
            r->box = box_join(r->box, c->chunk[i].box[k]);
            r->centre = box_join(r->centre, c->chunk[i].centre[k]);
        }
    }
}

static bool stretch_cut(const PairBuilder *b, const Stretch *s, Stretch side[2], Error *err)
{
    CutChunk one;
    Cut c = { .b = b, .s = s, .from = b->set.ref[s->range.where] + s->range.begin,
              .count = s->range.end - s->range.begin, .chunks = 1, .chunk = &one };
    c.chunk_refs = c.count;
    if (c.count >= SPLIT_TOGETHER) {
        c.chunk_refs = CUT_CHUNK;
        c.chunks = (c.count - 1) / CUT_CHUNK + 1;
        c.chunk = array_create(c.chunks, sizeof *c.chunk, "chunks of a cut", err);
        if (c.chunk == NULL)
            return false;
    }
    uint32_t sides[2];
    cut_decide(&c);
    cut_count(&c, sides);
    cut_carry_out(&c, sides, side);
    if (c.chunk != &one)
        array_free(c.chunk);
    return true;
}

/* --- the tree -------------------------------------------------------------------------------- */

static bool stretch_build(PairBuilder *b, const Stretch *s, bool tasks, Error *err)
{
    const uint32_t count = s->range.end - s->range.begin;
    Pair *pair = &b->pair[s->node];
    pair_set_box(pair, s->range.box);
    pair->left = b->set.ref[s->range.where][s->range.begin].primitive;
    pair->right = PAIR_ONE;
    if (count == 1)
        return true;
    if (tasks && count <= b->task_refs) {
        if (!array_reserve((void **)&b->task, &b->task_capacity, b->task_count + 1,
                           sizeof *b->task, "tasks of the build", err))
            return false;
        b->task[b->task_count++] = *s;
        return true;
    }
    Stretch side[2];
    if (!stretch_cut(b, s, side, err))
        return false;
    pair->left = side[0].node;
    pair->right = side[1].node;
    return stretch_build(b, &side[0], tasks, err) && stretch_build(b, &side[1], tasks, err);
}

/* Tasks are shorter than what takes memory of its own: they cannot fail. */
static void task_run(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    PairBuilder *b = context;
    Error err = { 0 };
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        stretch_build(b, &b->task[i], false, &err);
    assert(!error_is_set(&err));
}

static uint32_t count_refs(const Pairs *pairs)
{
    uint32_t refs = 0;
    for (uint32_t i = 0; i < pairs->count; i++)
        refs += pairs->pair[i].right == PAIR_ONE;
    return refs;
}

static bool builder_reserve(PairBuilder *b, Pairs *pairs, Ref *ref, uint32_t count, Error *err)
{
    const uint64_t room = (uint64_t)(ROOM_SHARE * count), most = UINT32_MAX / 2 - count;
    const uint32_t all = count + (uint32_t)(room < most ? room : most);
    size_t capacity[3] = { 0 };
    pairs->count = 2 * all - 1;
    if (!array_reserve((void **)&b->set.ref[0], &capacity[0], all, sizeof(Ref),
                       "references to primitives", err))
        return false;
    memcpy(b->set.ref[0], ref, count * sizeof *ref);
    if (!array_reserve((void **)&b->set.ref[1], &capacity[1], all, sizeof(Ref),
                       "references to primitives", err))
        return false;
    pairs->pair = b->pair = array_create(pairs->count, sizeof(Pair), "pairs of a tree", err);
    return b->pair != NULL;
}

bool pairs_build(Pairs *pairs, const Primitives *in, Ref *ref, uint32_t count, unsigned threads,
                 Error *err)
{
    assert(pairs != NULL && in != NULL && ref != NULL && count > 0);
    *pairs = (Pairs){ 0 };
    PairBuilder b = { .in = in, .set = { .threads = parallel_threads(threads),
                                         .triangle_count = in->triangle_count } };
    bool good = builder_reserve(&b, pairs, ref, count, err);
    array_free(ref);
    if (good) {
        Stretch all = { .range = range_all(&b.set, count), .to = pairs->count / 2 + 1 };
        const uint32_t share = count / TASKS_WANTED;
        b.task_refs = share < TASK_REFS_MIN    ? TASK_REFS_MIN
                      : share < SPLIT_TOGETHER ? share
                                               : SPLIT_TOGETHER - 1;
        b.overlap_least = OVERLAP_LEAST * box_area(all.range.box);
        good = stretch_build(&b, &all, true, err);
    }
    if (good) {
        parallel_for((uint32_t)b.task_count, 1, threads, task_run, &b, NULL, NULL);
        pairs->refs = count_refs(pairs);
    }
    array_free(b.task);
    array_free(b.set.ref[0]);
    array_free(b.set.ref[1]);
    return good;
}
