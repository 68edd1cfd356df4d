/* SPDX-License-Identifier: BSD-3-Clause */
/* One merged patch in two: from one end of its longest way over neighbours to half its area. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

typedef struct {
    const Surfaces *surfaces;
    const uint32_t *piece;   /* [count]  as given */
    uint32_t        count;
    double          area;
    uint64_t       *order;   /* [count]  surface above, its place in piece below, rising */
    uint64_t       *along;   /* [count]  how far along the longest way above, place below, rising */
    uint32_t       *rank;    /* [count]  where in `along` */
    uint64_t       *heap;    /* [count]  ranks of pieces met and not yet taken */
    uint32_t        heap_count;
    uint8_t        *met;     /* [count] */
} Splitter;

static Vec3 surface_middle(const Surfaces *s, uint32_t surface)
{
    const bool triangle = s->surface[surface].kind == SURFACE_TRIANGLE;
    SurfacePoint at;
    surfaces_point(s, surface, triangle ? 1.0 / 3 : 0.5, triangle ? 1.0 / 3 : 0.5, &at);
    return at.point;
}

/* Floats >= 0 are in the order of their bits. */
static uint32_t float_bits(float f)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

static void order_pieces(Splitter *sp)
{
    Vec3 lo = surface_middle(sp->surfaces, sp->piece[0]), hi = lo;
    for (uint32_t i = 0; i < sp->count; i++) {
        const Vec3 p = surface_middle(sp->surfaces, sp->piece[i]);
        lo = vec3_min(lo, p);
        hi = vec3_max(hi, p);
        sp->area += sp->surfaces->surface[sp->piece[i]].area;
        sp->order[i] = (uint64_t)sp->piece[i] << 32 | i;
    }
    const Vec3 w = vec3_sub(hi, lo);
    const int axis = w.x >= w.y && w.x >= w.z ? 0 : w.y >= w.z ? 1 : 2;
    for (uint32_t i = 0; i < sp->count; i++) {
        const Vec3 p = surface_middle(sp->surfaces, sp->piece[i]);
        const float way = (float)vec3_axis(vec3_sub(p, lo), axis);
        sp->along[i] = (uint64_t)float_bits(way) << 32 | i;
    }
    edges_sort_keys(sp->order, sp->count);
    edges_sort_keys(sp->along, sp->count);
    for (uint32_t i = 0; i < sp->count; i++)
        sp->rank[(uint32_t)sp->along[i]] = i;
}

/* Where a surface stands in piece, or MERGE_NONE. */
static uint32_t place_of(const Splitter *sp, uint32_t surface)
{
    uint32_t lo = 0, hi = sp->count - 1;
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (sp->order[middle] >> 32 < surface)
            lo = middle + 1;
        else
            hi = middle;
    }
    return sp->order[lo] >> 32 == surface ? (uint32_t)sp->order[lo] : MERGE_NONE;
}

static void meet(Splitter *sp, uint32_t place)
{
    if (sp->met[place])
        return;
    sp->met[place] = 1;
    merge_heap_push(sp->heap, &sp->heap_count, sp->rank[place]);
}

/* Part 0 is taken piece by piece, the rest is part 1. */
static void take_half(Splitter *sp, uint32_t *part)
{
    double taken = 0;
    for (uint32_t i = 0; i < sp->count; i++)
        part[i] = 1;
    for (uint32_t n = 0, next = 0; n + 1 < sp->count; n++) {
        while (sp->heap_count == 0) /* what is connected is used up */
            meet(sp, (uint32_t)sp->along[next++]);
        const uint32_t rank = (uint32_t)merge_heap_pop(sp->heap, &sp->heap_count);
        const uint32_t place = (uint32_t)sp->along[rank];
        const Surface *f = &sp->surfaces->surface[sp->piece[place]];
        if (n > 0 && taken + f->area / 2 > sp->area / 2)
            return;
        part[place] = 0;
        taken += f->area;
        for (unsigned k = 0; k < patches_corners(f); k++) {
            const uint32_t other = f->neighbour[k] == SURFACE_NONE
                                 ? MERGE_NONE : place_of(sp, f->neighbour[k]);
            if (other != MERGE_NONE)
                meet(sp, other);
        }
    }
}

bool merge_split(const Surfaces *surfaces, unsigned side, const uint32_t *piece, uint32_t count,
                 uint32_t *part, uint32_t *parts, Error *err)
{
    assert(surfaces != NULL && side < 2 && piece != NULL && count >= 2 && part != NULL);
    assert(parts != NULL && err != NULL);
    (void)side; /* both lie alike */
    Splitter sp = { .surfaces = surfaces, .piece = piece, .count = count };
    sp.order = array_create(count, sizeof *sp.order, "patch pieces", err);
    sp.along = array_create(count, sizeof *sp.along, "patch pieces", err);
    sp.rank = array_create(count, sizeof *sp.rank, "patch pieces", err);
    sp.heap = array_create(count, sizeof *sp.heap, "patch pieces", err);
    sp.met = array_create(count, sizeof *sp.met, "patch pieces", err);
    *parts = 2;
    if (!error_is_set(err)) {
        order_pieces(&sp);
        take_half(&sp, part);
    }
    array_free(sp.order);
    array_free(sp.along);
    array_free(sp.rank);
    array_free(sp.heap);
    array_free(sp.met);
    return !error_is_set(err);
}
