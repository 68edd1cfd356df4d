/* SPDX-License-Identifier: BSD-3-Clause */
/* Where to cut a range of references, by the surface-area heuristic over bins [wald07], and the
 * cutting itself, which is threaded for long ranges in chunks that do not depend on the threads.
 *
 * Cost: a box weighs with its surface, that is the chance that a ray passing through the parent
 * meets it; what is in it costs one per group of triangles begun. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "raycast/build.h"

#define BINS_MAX 16
#define BINS_FEW 8
#define BINS_FEW_BELOW 64u    /* references: few bins see as much as many, and cost less */
#define SPLIT_CHUNK 16384u
#define SPLIT_PARALLEL 65536u /* references from which threads take part */
/* A visit to a node costs about as much as one to a group of triangles (measured). */
#define COST_NODE 1.0f
#define LEAF_REFS_MAX (LEAF_GROUPS_MAX * GROUP_WIDTH / 2)

typedef struct {
    Box      box[3][BINS_MAX];
    uint32_t count[3][BINS_MAX];
} Bins;

static float groups_of(uint32_t count)
{
    return (float)((count + GROUP_WIDTH - 1) / GROUP_WIDTH);
}

static bool is_shape(const RefSet *set, uint32_t i)
{
    return set->ref[i].primitive >= set->triangle_count;
}

/* A leaf holds triangles only, or one shape. */
static bool may_be_leaf(const RefSet *set, const Range *r)
{
    const uint32_t count = r->end - r->begin;
    if (count == 1)
        return true;
    if (count > LEAF_REFS_MAX)
        return false;
    for (uint32_t i = r->begin; i < r->end; i++)
        if (is_shape(set, i))
            return false;
    return true;
}

/* --- bins ------------------------------------------------------------------------------------ */

/* How middles are mapped to bins; an axis without extent has scale 0. */
typedef struct {
    Float4 lo, scale;
    int    bins;
} BinMap;

static BinMap bin_map(const Range *r)
{
    BinMap map = { .lo = r->centre.lo,
                   .bins = r->end - r->begin < BINS_FEW_BELOW ? BINS_FEW : BINS_MAX };
    const Float4 extent = r->centre.hi - r->centre.lo;
    for (int k = 0; k < 3; k++) {
        const float scale = (float)map.bins / extent[k];
        map.scale[k] = extent[k] > 0 && isfinite(scale) ? scale : 0;
    }
    return map;
}

static int bin_of(const BinMap *map, Float4 centre, int axis)
{
    const int bin = (int)((centre[axis] - map->lo[axis]) * map->scale[axis]);
    return bin < map->bins ? bin : map->bins - 1;
}

static void bins_clear(Bins *bins)
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < BINS_MAX; i++) {
            bins->box[k][i] = box_empty();
            bins->count[k][i] = 0;
        }
}

static void bins_fill(Bins *bins, const BinMap *map, const Ref *ref, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const Box box = ref_box(&ref[i]);
        const Float4 centre = box_centre(box);
        for (int k = 0; k < 3; k++) {
            const int bin = bin_of(map, centre, k);
            bins->box[k][bin] = box_join(bins->box[k][bin], box);
            bins->count[k][bin]++;
        }
    }
}

typedef struct {
    const Ref    *ref;
    const BinMap *map;
    Bins         *bins; /* [chunks] */
} BinsContext;

static void bins_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    BinsContext *c = context;
    Bins *bins = &c->bins[begin / SPLIT_CHUNK];
    (void)worker;
    bins_clear(bins);
    bins_fill(bins, c->map, c->ref + begin, end - begin);
}

/* Minima, maxima and counts: the order of the chunks does not matter. */
static bool bins_fill_parallel(Bins *bins, const BinMap *map, const Ref *ref, uint32_t count,
                               unsigned threads)
{
    Error none = { 0 };
    const uint32_t chunks = (count - 1) / SPLIT_CHUNK + 1;
    BinsContext c = { .ref = ref, .map = map };
    c.bins = array_create(chunks, sizeof *c.bins, "bins", &none);
    if (c.bins == NULL)
        return false;
    parallel_for(count, SPLIT_CHUNK, threads, bins_chunk, &c, NULL, NULL);
    for (uint32_t i = 0; i < chunks; i++)
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < map->bins; j++) {
                bins->box[k][j] = box_join(bins->box[k][j], c.bins[i].box[k][j]);
                bins->count[k][j] += c.bins[i].count[k][j];
            }
    array_free(c.bins);
    return true;
}

/* --- the decision ---------------------------------------------------------------------------- */

/* The cheapest cut along one axis: its cost is the sum over both sides of surface * groups. */
static float cheapest_on_axis(const Bins *bins, int axis, int count, int *cut)
{
    float right_cost[BINS_MAX];
    Box box = box_empty();
    uint32_t sum = 0;
    for (int i = count - 1; i > 0; i--) {
        box = box_join(box, bins->box[axis][i]);
        sum += bins->count[axis][i];
        right_cost[i] = sum > 0 ? box_area(box) * groups_of(sum) : INFINITY;
    }
    float best = INFINITY;
    box = box_empty();
    sum = 0;
    for (int i = 1; i < count; i++) {
        box = box_join(box, bins->box[axis][i - 1]);
        sum += bins->count[axis][i - 1];
        const float cost = sum > 0 ? box_area(box) * groups_of(sum) + right_cost[i] : INFINITY;
        if (cost < best) {
            best = cost;
            *cut = i;
        }
    }
    return best;
}

static Split cheapest_split(const Bins *bins, const BinMap *map, float *cost)
{
    Split split = { .axis = SPLIT_HALVES, .bins = map->bins };
    *cost = INFINITY;
    for (int k = 0; k < 3; k++) {
        int cut = 0;
        const float c = map->scale[k] > 0 ? cheapest_on_axis(bins, k, map->bins, &cut) : INFINITY;
        if (c < *cost) {
            *cost = c;
            split.axis = k;
            split.bin = cut;
        }
    }
    return split;
}

void range_decide(const RefSet *set, Range *range)
{
    const uint32_t count = range->end - range->begin;
    const bool leaf = may_be_leaf(set, range);
    range->split = (Split){ .axis = SPLIT_NONE };
    if (leaf && count <= GROUP_WIDTH)
        return;
    range->split.axis = SPLIT_HALVES;
    if (range->depth >= BVH_DEPTH_FREE)
        return;

    const BinMap map = bin_map(range);
    Bins bins;
    bins_clear(&bins);
    if (set->spare == NULL || count < SPLIT_PARALLEL
        || !bins_fill_parallel(&bins, &map, set->ref + range->begin, count, set->threads))
        bins_fill(&bins, &map, set->ref + range->begin, count);
    float cost;
    range->split = cheapest_split(&bins, &map, &cost);
    const float area = box_area(range->box);
    if (leaf && !(COST_NODE * area + cost < area * groups_of(count)))
        range->split.axis = SPLIT_NONE;
}

/* --- the cut --------------------------------------------------------------------------------- */

typedef struct {
    Box box, centre;
} Bounds;

static Bounds bounds_empty(void) { return (Bounds){ box_empty(), box_empty() }; }

static void bounds_add(Bounds *b, const Ref *ref)
{
    const Box box = ref_box(ref);
    b->box = box_join(b->box, box);
    b->centre = box_point(b->centre, box_centre(box));
}

static Range range_of(uint32_t begin, uint32_t end, uint32_t depth, const Bounds *b)
{
    return (Range){ .begin = begin, .end = end, .depth = depth, .box = b->box,
                    .centre = b->centre };
}

Range range_all(const RefSet *set, uint32_t count)
{
    Bounds b = bounds_empty();
    for (uint32_t i = 0; i < count; i++)
        bounds_add(&b, &set->ref[i]);
    return range_of(0, count, 0, &b);
}

static bool goes_left(const Range *r, const BinMap *map, const Ref *ref)
{
    return bin_of(map, box_centre(ref_box(ref)), r->split.axis) < r->split.bin;
}

/* From both ends inwards; returns where the right side begins. */
static uint32_t partition_here(RefSet *set, const Range *r, const BinMap *map, Bounds side[2])
{
    uint32_t i = r->begin, j = r->end;
    while (i < j) {
        if (goes_left(r, map, &set->ref[i])) {
            bounds_add(&side[0], &set->ref[i++]);
            continue;
        }
        bounds_add(&side[1], &set->ref[i]);
        const Ref swap = set->ref[i];
        set->ref[i] = set->ref[--j];
        set->ref[j] = swap;
    }
    return i;
}

static uint32_t halve(RefSet *set, const Range *r, Bounds side[2])
{
    const uint32_t middle = r->begin + (r->end - r->begin) / 2;
    for (uint32_t i = r->begin; i < r->end; i++)
        bounds_add(&side[i >= middle], &set->ref[i]);
    return middle;
}

typedef struct {
    Bounds   side[2];
    uint32_t left, left_before; /* this chunk's, and those of the chunks before it */
} ChunkCut;

typedef struct {
    const RefSet *set;
    const Range  *range;
    const BinMap *map;
    ChunkCut     *chunk;
    uint32_t      left_total;
} CutContext;

static void cut_count(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    CutContext *c = context;
    ChunkCut *chunk = &c->chunk[begin / SPLIT_CHUNK];
    const Ref *ref = c->set->ref + c->range->begin;
    (void)worker;
    chunk->side[0] = chunk->side[1] = bounds_empty();
    for (uint32_t i = begin; i < end; i++) {
        const bool left = goes_left(c->range, c->map, &ref[i]);
        bounds_add(&chunk->side[left ? 0 : 1], &ref[i]);
        chunk->left += left;
    }
}

static void cut_scatter(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    CutContext *c = context;
    const ChunkCut *chunk = &c->chunk[begin / SPLIT_CHUNK];
    const Ref *ref = c->set->ref + c->range->begin;
    Ref *left = c->set->spare + c->range->begin + chunk->left_before;
    Ref *right = c->set->spare + c->range->begin + c->left_total + (begin - chunk->left_before);
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        *(goes_left(c->range, c->map, &ref[i]) ? left++ : right++) = ref[i];
}

static void cut_copy_back(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const CutContext *c = context;
    const size_t from = (size_t)c->range->begin + begin;
    (void)worker;
    memcpy(c->set->ref + from, c->set->spare + from, (end - begin) * sizeof(Ref));
}

/* Keeps the order within both sides. Returns where the right side begins; 0: no memory. */
static uint32_t partition_parallel(RefSet *set, const Range *r, const BinMap *map, Bounds side[2],
                                   Error *err)
{
    const uint32_t count = r->end - r->begin, chunks = (count - 1) / SPLIT_CHUNK + 1;
    CutContext c = { .set = set, .range = r, .map = map };
    c.chunk = array_create(chunks, sizeof *c.chunk, "chunks of a cut", err);
    if (c.chunk == NULL)
        return 0;
    parallel_for(count, SPLIT_CHUNK, set->threads, cut_count, &c, NULL, NULL);
    for (uint32_t i = 0; i < chunks; i++) {
        c.chunk[i].left_before = c.left_total;
        c.left_total += c.chunk[i].left;
        for (int s = 0; s < 2; s++) {
            side[s].box = box_join(side[s].box, c.chunk[i].side[s].box);
            side[s].centre = box_join(side[s].centre, c.chunk[i].side[s].centre);
        }
    }
    parallel_for(count, SPLIT_CHUNK, set->threads, cut_scatter, &c, NULL, NULL);
    parallel_for(count, SPLIT_CHUNK, set->threads, cut_copy_back, &c, NULL, NULL);
    array_free(c.chunk);
    return r->begin + c.left_total;
}

bool range_cut(RefSet *set, const Range *range, Range *left, Range *right, Error *err)
{
    assert(range->split.axis != SPLIT_NONE && range->end - range->begin >= 2);
    Bounds side[2] = { bounds_empty(), bounds_empty() };
    uint32_t middle;
    if (range->split.axis == SPLIT_HALVES) {
        middle = halve(set, range, side);
    } else {
        const BinMap map = bin_map(range);
        const bool together = set->spare != NULL && range->end - range->begin >= SPLIT_PARALLEL;
        middle = together ? partition_parallel(set, range, &map, side, err)
                          : partition_here(set, range, &map, side);
        if (error_is_set(err))
            return false;
    }
    assert(range->begin < middle && middle < range->end);
    *left = range_of(range->begin, middle, range->depth + 1, &side[0]);
    *right = range_of(middle, range->end, range->depth + 1, &side[1]);
    range_decide(set, left);
    range_decide(set, right);
    return true;
}
