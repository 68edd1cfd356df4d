/* SPDX-License-Identifier: BSD-3-Clause */
/* Where to cut a range of references, by the surface-area heuristic over bins [wald07], and the
 * cutting itself, from one array into another without branches on what goes where.
 *
 * Cost: a box weighs with its surface, that is the chance that a ray passing through the parent
 * meets it; what is in it costs one per group of triangles begun. */
#include <assert.h>
#include <math.h>

#include "raycast/build.h"

#define BINS_FEW 8
#define BINS_FEW_BELOW 64u    /* references: few bins see as much as many, and cost less */
#define BINS_TWO_FROM 96u

/* A leaf holds triangles only, or one shape. */
static bool may_be_leaf(const RefSet *set, const Range *r)
{
    const uint32_t count = r->end - r->begin;
    if (count == 1)
        return true;
    if (count > LEAF_REFS_MAX)
        return false;
    const Ref *ref = set->ref[r->where];
    for (uint32_t i = r->begin; set->shapes && i < r->end; i++)
        if (ref[i].primitive >= set->triangle_count)
            return false;
    return true;
}

/* --- bins ------------------------------------------------------------------------------------ */

BinMap bin_map(const Range *r)
{
    BinMap map = { .lo = r->centre.lo,
                   .bins = r->end - r->begin < BINS_FEW_BELOW ? BINS_FEW : BINS_MAX };
    const Float4 extent = r->centre.hi - r->centre.lo;
    for (int k = 0; k < 3; k++) {
        const float scale = (float)map.bins / extent[k];
        map.scale[k] = extent[k] > 0 && isfinite(scale) ? scale : 0;
        map.last[k] = (float)(map.bins - 1);
    }
    return map;
}

void bins_clear(Bins *bins, const BinMap *map)
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < map->bins; i++) {
            bins->box[k][i] = box_empty();
            bins->count[k][i] = 0;
        }
}

static inline void bins_add(Bins *bins, const BinMap *map, const Ref *ref)
{
    const Box box = ref_box(ref);
    const Int4 bin = bin_of(map, box_centre(box));
    for (int k = 0; k < 3; k++) {
        Box *b = &bins->box[k][bin[k]];
        *b = box_join(*b, box);
        bins->count[k][bin[k]]++;
    }
}

void bins_join(Bins *bins, const Bins *other, const BinMap *map)
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < map->bins; i++) {
            bins->box[k][i] = box_join(bins->box[k][i], other->box[k][i]);
            bins->count[k][i] += other->count[k][i];
        }
}

/* Neighbours mostly fall into one bin, and each would wait for the other's box: so they fill bins
 * in turns. */
void bins_fill(Bins *bins, const BinMap *map, const Ref *ref, uint32_t count)
{
    const BinMap m = *map; /* in registers: nothing that is written below can be it */
    uint32_t i = 0;
    bins_clear(bins, map);
    if (count >= BINS_TWO_FROM) {
        Bins other;
        bins_clear(&other, map);
        for (; i + 1 < count; i += 2) {
            bins_add(bins, &m, &ref[i]);
            bins_add(&other, &m, &ref[i + 1]);
        }
        bins_join(bins, &other, map);
    }
    for (; i < count; i++)
        bins_add(bins, &m, &ref[i]);
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

Split bins_split(const Bins *bins, const BinMap *map, float *cost)
{
    Split split = { .axis = SPLIT_HALVES, .box = { box_empty(), box_empty() } };
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
    for (int i = 0; i < map->bins && split.axis != SPLIT_HALVES; i++) {
        Box *box = &split.box[i >= split.bin];
        *box = box_join(*box, bins->box[split.axis][i]);
        split.left += i < split.bin ? bins->count[split.axis][i] : 0;
    }
    return split;
}

void range_decide(const RefSet *set, Range *range)
{
    const uint32_t count = range->end - range->begin;
    const bool leaf = may_be_leaf(set, range);
    range->split.axis = SPLIT_NONE;
    if (leaf && count <= GROUP_WIDTH)
        return;
    range->split.axis = SPLIT_HALVES;
    if (range->depth >= BVH_DEPTH_FREE)
        return;
    range->split.axis = SPLIT_LATER;
    if (set->threads > 0 && count >= SPLIT_TOGETHER)
        return;

    const BinMap map = bin_map(range);
    Bins bins;
    bins_fill(&bins, &map, set->ref[range->where] + range->begin, count);
    float cost;
    range->split = bins_split(&bins, &map, &cost);
    const float area = box_area(range->box);
    if (leaf && !(COST_NODE * area + cost < area * groups_of(count)))
        range->split.axis = SPLIT_NONE;
}

/* --- the cut --------------------------------------------------------------------------------- */

Range range_all(const RefSet *set, uint32_t count)
{
    Range all = { .end = count, .box = box_empty(), .centre = box_empty() };
    for (uint32_t i = 0; i < count; i++) {
        const Box box = ref_box(&set->ref[0][i]);
        all.box = box_join(all.box, box);
        all.centre = box_point(all.centre, box_centre(box));
    }
    return all;
}

void refs_scatter(const Ref *ref, uint32_t count, const BinMap *map, const Split *split, Ref *left,
                  Ref *right, Box centre[2])
{
    const Int4 empty_lo = (Int4)box_empty().lo, empty_hi = (Int4)box_empty().hi;
    const int axis = split->axis;
    /* The same arithmetic as bin_of: a number below the whole number `bin` before it is cut off is
     * below it after. */
    const float origin = map->lo[axis], scale = map->scale[axis], bin = (float)split->bin;
    Box low = centre[0], high = centre[1];
    for (uint32_t i = 0; i < count; i++) {
        const Ref *r = &ref[i];
        const int goes = -((r->lo[axis] + r->hi[axis] - origin) * scale < bin);
        const Int4 middle = (Int4)box_centre(ref_box(r));
        const Int4 to_left = { goes, goes, goes, goes }, to_right = ~to_left;
        *(goes ? left : right) = *r;
        left -= goes;
        right += 1 + goes;
        low.lo = float4_min(low.lo, (Float4)((middle & to_left) | (empty_lo & to_right)));
        low.hi = float4_max(low.hi, (Float4)((middle & to_left) | (empty_hi & to_right)));
        high.lo = float4_min(high.lo, (Float4)((middle & to_right) | (empty_lo & to_left)));
        high.hi = float4_max(high.hi, (Float4)((middle & to_right) | (empty_hi & to_left)));
    }
    centre[0] = low;
    centre[1] = high;
}

static void halve(const RefSet *set, Range *r, Box centre[2])
{
    r->split.left = (r->end - r->begin) / 2;
    r->split.box[0] = r->split.box[1] = box_empty();
    for (uint32_t i = 0; i < r->end - r->begin; i++) {
        const Box box = ref_box(&set->ref[r->where][r->begin + i]);
        const int side = i >= r->split.left;
        r->split.box[side] = box_join(r->split.box[side], box);
        centre[side] = box_point(centre[side], box_centre(box));
    }
}

static void cut_alone(const RefSet *set, const Range *r, Box centre[2])
{
    const BinMap map = bin_map(r);
    Ref *to = set->ref[1 - r->where] + r->begin;
    refs_scatter(set->ref[r->where] + r->begin, r->end - r->begin, &map, &r->split, to,
                 to + r->split.left, centre);
}

bool range_cut(const RefSet *set, const Range *range, Range *left, Range *right, Error *err)
{
    assert(range->split.axis != SPLIT_NONE && range->end - range->begin >= 2);
    Range r = *range;
    Box centre[2] = { box_empty(), box_empty() };
    if (r.split.axis == SPLIT_LATER && !range_cut_together(set, &r, centre, err))
        return false;
    if (r.split.axis == SPLIT_HALVES)
        halve(set, &r, centre);
    else if (range->split.axis != SPLIT_LATER)
        cut_alone(set, &r, centre);
    const uint32_t middle = r.begin + r.split.left;
    assert(r.begin < middle && middle < r.end);
    const uint32_t where = r.split.axis == SPLIT_HALVES ? r.where : 1 - r.where;
    *left = (Range){ .begin = r.begin, .end = middle, .depth = r.depth + 1, .where = where,
                     .box = r.split.box[0], .centre = centre[0] };
    *right = (Range){ .begin = middle, .end = r.end, .depth = r.depth + 1, .where = where,
                      .box = r.split.box[1], .centre = centre[1] };
    range_decide(set, left);
    range_decide(set, right);
    return true;
}
