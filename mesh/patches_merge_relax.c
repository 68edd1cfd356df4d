/* SPDX-License-Identifier: BSD-3-Clause */
/* Clusters made better: remnants go to a neighbour, pieces at a border to the nearer cluster.
 *
 * The sweeps are those of Lloyd's method, with place and normal as in variational shape
 * approximation [cohen-steiner04], but only borders move, and never past a limit.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

enum { SWEEPS = 3 }; /* afterwards hardly a piece moves */

/* A cluster of less than this is left over between others: one of them is better off with it. */
static const double REMNANT = 0.5;

/* As in growing. */
static const double NORMAL_WEIGHT = 0.25;

typedef struct {
    Merge    *merge;
    uint32_t *parent;    /* [cluster_count]  union-find over clusters */
    uint32_t *first;     /* [cluster_count + 1] */
    uint32_t *member;    /* [count]  pieces by cluster */
} Relaxer;

static uint32_t cluster_root(uint32_t *parent, uint32_t c)
{
    while (parent[c] != c) {
        parent[c] = parent[parent[c]];
        c = parent[c];
    }
    return c;
}

static double distance(const MergeCluster *c, const float at[MERGE_AXES])
{
    const double inverse = 1 / c->area;
    double sum = 0;
    for (int k = 0; k < MERGE_AXES; k++) {
        const double d = at[k] - c->moment[k] * inverse;
        sum += (k < MERGE_PLACE ? 1 : NORMAL_WEIGHT) * d * d;
    }
    return sum;
}

static void list_members(Relaxer *r)
{
    const Merge *m = r->merge;
    for (uint32_t c = 0; c <= m->cluster_count; c++)
        r->first[c] = 0;
    for (uint32_t i = 0; i < m->count; i++)
        r->first[m->cluster_of[i]]++;
    for (uint32_t c = 0, sum = 0; c <= m->cluster_count; c++) {
        sum += r->first[c];
        r->first[c] = sum; /* the end; filling from behind makes it the start */
    }
    for (uint32_t i = m->count; i-- > 0;)
        r->member[--r->first[m->cluster_of[i]]] = i;
}

/* Cluster beside piece i over edge k, or MERGE_NONE. */
static uint32_t cluster_beside(const Merge *m, uint32_t i, unsigned k)
{
    const uint32_t j = m->piece[i].next[k];
    return j == MERGE_NONE ? MERGE_NONE : m->cluster_of[j];
}

/* The neighbour that remnant c fits best, or c. Pieces it has taken in itself are not asked. */
static uint32_t best_host(Relaxer *r, uint32_t c)
{
    const Merge *m = r->merge;
    const MergeCluster *remnant = &m->cluster[c];
    float at[MERGE_AXES];
    for (int k = 0; k < MERGE_AXES; k++)
        at[k] = (float)(remnant->moment[k] / remnant->area);
    uint32_t best = c;
    double least = INFINITY;
    for (uint32_t n = r->first[c]; n < r->first[c + 1]; n++) {
        const uint32_t i = r->member[n];
        for (unsigned k = 0; k < 4; k++) {
            uint32_t host = cluster_beside(m, i, k);
            if (host == MERGE_NONE || (host = cluster_root(r->parent, host)) == c)
                continue;
            const MergeCluster *h = &m->cluster[host];
            MergeBox box = h->box;
            merge_box_add(&box, &remnant->box);
            const double d = distance(h, at);
            if (h->area + remnant->area > merge_area_most || !merge_box_fits(&box)
                || !(d < least))
                continue;
            least = d;
            best = host;
        }
    }
    return best;
}

/* Remnants are given to others. Never to one that looks elsewhere, however small they are: below a
 * box on a slab is another room than beside it. */
static void give_away(Relaxer *r)
{
    Merge *m = r->merge;
    list_members(r);
    for (uint32_t c = 0; c < m->cluster_count; c++)
        r->parent[c] = c;
    for (uint32_t c = 0; c < m->cluster_count; c++) {
        MergeCluster *remnant = &m->cluster[c];
        if (!(remnant->area > 0 && remnant->area < REMNANT))
            continue;
        const uint32_t host = best_host(r, c);
        if (host == c)
            continue;
        MergeCluster *h = &m->cluster[host];
        merge_box_add(&h->box, &remnant->box);
        h->area += remnant->area;
        for (int k = 0; k < MERGE_AXES; k++)
            h->moment[k] += remnant->moment[k];
        remnant->area = 0;
        r->parent[c] = host;
    }
    for (uint32_t i = 0; i < m->count; i++)
        m->cluster_of[i] = cluster_root(r->parent, m->cluster_of[i]);
}

static void move_piece(Merge *m, uint32_t i, uint32_t to)
{
    const MergePiece *piece = &m->piece[i];
    MergeCluster *a = &m->cluster[m->cluster_of[i]], *b = &m->cluster[to];
    const MergeBox box = merge_piece_box(piece);
    a->area -= piece->area;
    b->area += piece->area;
    for (int k = 0; k < MERGE_AXES; k++) {
        a->moment[k] -= (double)piece->area * piece->at[k];
        b->moment[k] += (double)piece->area * piece->at[k];
    }
    merge_box_add(&b->box, &box);
    m->cluster_of[i] = to;
}

/* Gives each piece at a border to the nearest cluster beside it. */
static void move_borders(Merge *m)
{
    for (uint32_t i = 0; i < m->count; i++) {
        const MergePiece *piece = &m->piece[i];
        const uint32_t own = m->cluster_of[i];
        if (m->cluster[own].area - piece->area < REMNANT)
            continue;
        double least = -1; /* distance to the own one, found when it is needed */
        uint32_t best = own;
        for (unsigned k = 0; k < 4; k++) {
            const uint32_t other = cluster_beside(m, i, k);
            if (other == MERGE_NONE || other == best || other == own)
                continue;
            const MergeCluster *c = &m->cluster[other];
            MergeBox box = merge_piece_box(piece);
            merge_box_add(&box, &c->box);
            if (least < 0)
                least = distance(&m->cluster[own], piece->at);
            const double d = distance(c, piece->at);
            if (d < least && c->area + piece->area <= merge_area_most
                && merge_box_fits(&box)) {
                least = d;
                best = other;
            }
        }
        if (best != own)
            move_piece(m, i, best);
    }
}

/* Boxes that have only grown become those of their pieces again. */
static void fit_boxes(Merge *m)
{
    MergeBox empty = { .longest = 0 };
    for (int k = 0; k < MERGE_AXES; k++) {
        empty.lo[k] = INFINITY;
        empty.hi[k] = -INFINITY;
    }
    for (uint32_t c = 0; c < m->cluster_count; c++)
        m->cluster[c].box = empty;
    for (uint32_t i = 0; i < m->count; i++) {
        const MergeBox box = merge_piece_box(&m->piece[i]);
        merge_box_add(&m->cluster[m->cluster_of[i]].box, &box);
    }
}

bool merge_relax(Merge *m, Error *err)
{
    assert(m != NULL && err != NULL);
    Relaxer r = { .merge = m };
    r.parent = array_create(m->cluster_count, sizeof *r.parent, "patch pieces", err);
    r.first = array_create((size_t)m->cluster_count + 1, sizeof *r.first, "patch pieces", err);
    r.member = array_create(m->count, sizeof *r.member, "patch pieces", err);
    if (!error_is_set(err)) {
        give_away(&r);
        for (int k = 0; k < SWEEPS; k++) {
            move_borders(m);
            fit_boxes(m);
        }
        give_away(&r);
    }
    array_free(r.parent);
    array_free(r.first);
    array_free(r.member);
    return !error_is_set(err);
}
