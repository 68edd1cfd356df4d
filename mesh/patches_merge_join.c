/* SPDX-License-Identifier: BSD-3-Clause */
/* Fragments are joined across gaps: leaves, screws, letters, each too small for a patch.
 *
 * Only whole parts are: a fragment of a larger part may be what a wall left of a floor, and a
 * closed part that is seen from within is a room of its own. All of a class are halved again and
 * again, by place and normal, until they keep the limits of a cluster. What is a fragment even then
 * is joined by place alone, whatever its normals. The patch is a mean over its pieces.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

/* Parts have between half of this and all of it, about; so their mean is near the aim. */
static const double PART_AREA_MOST = 1.4;

typedef struct {
    float    at[MERGE_AXES];
    float    area;
    uint32_t cluster;
} Fragment;

typedef struct {
    Merge    *merge;
    Fragment *item;       /* [count]  by class, in the order of their clusters */
    uint32_t  count;
    uint32_t *first;      /* [class_count + 1] */
    uint32_t  class_count;
    uint32_t *parent;     /* [cluster_count]  cluster that a cluster was joined to, or itself */
    uint8_t  *loose;      /* [cluster_count]  1: a whole part, to be joined across gaps */
    bool      normals;    /* normals count */
} Joiner;

/* One part on the side in use. */
typedef struct {
    uint32_t cluster;     /* of its first piece */
    uint32_t first;       /* its first piece, which volumes are counted from */
    bool     whole;       /* it has no other cluster, and nothing that is no piece */
    double   volume;      /* three times that behind its sides: < 0 when they look inwards */
} Part;

static void swap_items(Fragment *a, Fragment *b)
{
    const Fragment t = *a;
    *a = *b;
    *b = t;
}

static void join_items(Joiner *j, uint32_t begin, uint32_t end)
{
    Merge *m = j->merge;
    uint32_t least = j->item[begin].cluster;
    for (uint32_t i = begin + 1; i < end; i++)
        least = j->item[i].cluster < least ? j->item[i].cluster : least;
    MergeCluster *c = &m->cluster[least];
    for (uint32_t i = begin; i < end; i++) {
        const uint32_t other = j->item[i].cluster;
        if (other == least)
            continue;
        MergeCluster *o = &m->cluster[other];
        merge_box_add(&c->box, &o->box);
        c->area += o->area;
        for (int k = 0; k < MERGE_AXES; k++)
            c->moment[k] += o->moment[k];
        o->area = 0;
        j->parent[other] = least;
    }
}

/* Where to cut a range of items. */
typedef struct {
    int   axis;
    float lo, hi;         /* of the centroids along it */
    double area;          /* of all */
    double parts;         /* wanted along the axis when they are so far apart that it decides */
    bool   fits;          /* the box of the centroids keeps the limits */
} Spread;

/* The axis along which centroids are furthest apart beside its limit. */
static Spread spread_of(const Joiner *j, uint32_t begin, uint32_t end)
{
    MergeBox box = { .longest = 0 };
    Spread spread = { .area = 0 };
    for (int k = 0; k < MERGE_AXES; k++)
        box.lo[k] = box.hi[k] = j->item[begin].at[k];
    for (uint32_t i = begin; i < end; i++) {
        const Fragment *f = &j->item[i];
        spread.area += f->area;
        for (int k = 0; k < MERGE_AXES; k++) {
            box.lo[k] = f->at[k] < box.lo[k] ? f->at[k] : box.lo[k];
            box.hi[k] = f->at[k] > box.hi[k] ? f->at[k] : box.hi[k];
        }
    }
    spread.fits = merge_box_fits(&box, j->normals);
    double most = -1, boxes = 1;
    for (int k = 0; k < (j->normals ? MERGE_AXES : MERGE_PLACE); k++) {
        /* edge of a cube with the diagonal that a box may have */
        const double limit = (k < MERGE_PLACE ? merge_extent_most : merge_chord_most) / sqrt(3);
        const double width = ((double)box.hi[k] - box.lo[k]) / limit;
        boxes *= fmax(1, width);
        if (width > most) {
            most = width;
            spread.axis = k;
        }
    }
    spread.lo = box.lo[spread.axis];
    spread.hi = box.hi[spread.axis];
    spread.parts = boxes > spread.area ? fmax(2, ceil(most)) : 0;
    return spread;
}

/* The cut is at a whole number of parts, not always in the middle: halves of halves would make the
 * number of clusters jump by twos when the size changes a little. */
static float find_cut(const Joiner *j, uint32_t begin, uint32_t end, const Spread *spread)
{
    enum { BINS = 64 }; /* fine enough beside what the areas of fragments differ by */
    const double lo = spread->lo, width = (double)spread->hi - lo;
    if (spread->parts > 0)
        return (float)(lo + width * floor(spread->parts / 2) / spread->parts);
    const double parts = fmax(2, round(spread->area / merge_area));
    const double wanted = spread->area * floor(parts / 2) / parts;
    double bin[BINS] = { 0 };
    for (uint32_t i = begin; i < end; i++) {
        const double at = width > 0 ? (j->item[i].at[spread->axis] - lo) / width : 0;
        bin[(int)fmin(at * BINS, BINS - 1)] += j->item[i].area;
    }
    double sum = 0;
    int k = 0;
    while (k < BINS - 1 && sum + bin[k] / 2 < wanted)
        sum += bin[k++];
    return (float)(lo + width * k / BINS);
}

/* Items up to the cut along an axis come first; returns where the others begin. None is empty. */
static uint32_t part_items(Fragment *item, uint32_t begin, uint32_t end, int axis, float cut)
{
    uint32_t lo = begin, hi = end;
    while (lo < hi) {
        if (item[lo].at[axis] <= cut)
            lo++;
        else
            swap_items(&item[lo], &item[--hi]);
    }
    return lo > begin && lo < end ? lo : begin + (end - begin) / 2;
}

static bool is_part(const Joiner *j, uint32_t begin, uint32_t end, const Spread *spread)
{
    const MergeCluster *cluster = j->merge->cluster;
    if (end - begin < 2)
        return true;
    if (spread->area > PART_AREA_MOST || !spread->fits)
        return false;
    MergeBox box = cluster[j->item[begin].cluster].box;
    for (uint32_t i = begin + 1; i < end; i++)
        merge_box_add(&box, &cluster[j->item[i].cluster].box);
    return merge_box_fits(&box, j->normals);
}

/* Halves until a part is a cluster. The smaller half goes first and the loop takes the larger one,
 * so that the calls nest no deeper than log2 of the count. */
static void join_range(Joiner *j, uint32_t begin, uint32_t end)
{
    for (;;) {
        const Spread spread = spread_of(j, begin, end);
        if (is_part(j, begin, end, &spread)) {
            /* A fragment still, and as wide as may be, would only be harder to join by place. */
            if (!j->normals || spread.area >= merge_fragment)
                join_items(j, begin, end);
            return;
        }
        const float cut = find_cut(j, begin, end, &spread);
        const uint32_t middle = part_items(j->item, begin, end, spread.axis, cut);
        if (middle - begin <= end - middle) {
            join_range(j, begin, middle);
            begin = middle;
        } else {
            join_range(j, middle, end);
            end = middle;
        }
    }
}

/* Finds the parts that are one cluster. */
static void find_parts(const Merge *m, Part *part)
{
    const Surfaces *s = m->surfaces;
    for (uint32_t k = 0; k < s->part_count; k++)
        part[k] = (Part){ .cluster = MERGE_NONE, .whole = true };
    for (uint32_t surface = 0; surface < s->count; surface++) {
        if (!merge_side_used(m, surface))
            continue;
        Part *p = &part[s->part[surface]];
        const uint32_t i = m->local[surface];
        if (i == MERGE_NONE) {
            p->whole = false;
            continue;
        }
        if (p->cluster == MERGE_NONE) {
            p->cluster = m->cluster_of[i];
            p->first = i;
        }
        p->whole = p->whole && p->cluster == m->cluster_of[i];
        const float *at = m->piece[i].at, *from = m->piece[p->first].at;
        for (int k = 0; k < MERGE_PLACE; k++)
            p->volume += (double)m->piece[i].area * (at[k] - from[k]) * at[MERGE_PLACE + k];
    }
}

static bool mark_loose(Joiner *j, Error *err)
{
    const Surfaces *s = j->merge->surfaces;
    Part *part = array_create(s->part_count, sizeof *part, "patch pieces", err);
    if (part == NULL)
        return false;
    find_parts(j->merge, part);
    for (uint32_t k = 0; k < s->part_count; k++)
        if (part[k].cluster != MERGE_NONE && part[k].whole)
            j->loose[part[k].cluster] = !s->part_closed[k] || part[k].volume > 0;
    array_free(part);
    return true;
}

static bool is_fragment(const Joiner *j, uint32_t c)
{
    const MergeCluster *cluster = &j->merge->cluster[c];
    return j->loose[c] && cluster->area > 0 && cluster->area < merge_fragment;
}

/* Fragments by class, a counting sort: their order is that of the clusters. */
static void list_fragments(Joiner *j)
{
    const Merge *m = j->merge;
    for (uint32_t k = 0; k <= j->class_count; k++)
        j->first[k] = 0;
    for (uint32_t c = 0; c < m->cluster_count; c++)
        if (is_fragment(j, c))
            j->first[m->cluster[c].class]++;
    uint32_t sum = 0;
    for (uint32_t k = 0; k <= j->class_count; k++) {
        sum += j->first[k];
        j->first[k] = sum;
    }
    j->count = sum;
    for (uint32_t c = m->cluster_count; c-- > 0;) {
        const MergeCluster *cluster = &m->cluster[c];
        if (!is_fragment(j, c))
            continue;
        Fragment *f = &j->item[--j->first[cluster->class]];
        f->cluster = c;
        f->area = (float)cluster->area;
        for (int k = 0; k < MERGE_AXES; k++)
            f->at[k] = (float)(cluster->moment[k] / cluster->area);
    }
}

static void join_fragments(Joiner *j, bool normals)
{
    Merge *m = j->merge;
    j->normals = normals;
    list_fragments(j);
    for (uint32_t c = 0; c < m->cluster_count; c++)
        j->parent[c] = c;
    for (uint32_t k = 0; k < j->class_count; k++)
        if (j->first[k + 1] - j->first[k] > 1)
            join_range(j, j->first[k], j->first[k + 1]);
    for (uint32_t i = 0; i < m->count; i++)
        m->cluster_of[i] = j->parent[m->cluster_of[i]];
}

bool merge_join(Merge *m, Error *err)
{
    assert(m != NULL && err != NULL);
    Joiner j = { .merge = m };
    j.loose = array_create(m->cluster_count, sizeof *j.loose, "patch pieces", err);
    if (j.loose == NULL || !mark_loose(&j, err)) {
        array_free(j.loose);
        return false;
    }
    for (uint32_t c = 0; c < m->cluster_count; c++) {
        j.count += is_fragment(&j, c);
        if (m->cluster[c].class >= j.class_count)
            j.class_count = m->cluster[c].class + 1;
    }
    j.item = array_create(j.count, sizeof *j.item, "patch pieces", err);
    j.first = array_create((size_t)j.class_count + 1, sizeof *j.first, "patch pieces", err);
    j.parent = array_create(m->cluster_count, sizeof *j.parent, "patch pieces", err);
    if (!error_is_set(err)) {
        join_fragments(&j, true);
        join_fragments(&j, false);
    }
    array_free(j.item);
    array_free(j.first);
    array_free(j.parent);
    array_free(j.loose);
    return !error_is_set(err);
}
