/* SPDX-License-Identifier: BSD-3-Clause */
/* What is left over of different parts is put together by place: leaves of a plant, pebbles. No
 * edge says that they are in one room, so each of them needs a free way through the air. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/patches_merge.h"

/* Clusters of less area look for others; as remnants do that have neighbours. */
static const double REMNANT = 0.5;

/* Of what lies about the same place no more than so many are asked, the last ones first: work
 * stays in proportion to the number of clusters. */
enum { ASKED_MOST = 6 };

typedef struct {
    uint32_t class;
    int32_t  at[MERGE_PLACE]; /* cell of a grid of patch sizes */
    uint32_t cluster;
} Left;

typedef struct {
    Merge              *merge;
    const PatchOptions *options;
    Left               *left;     /* [count] */
    uint32_t            count;
    uint32_t           *host;     /* [cluster_count]  what a cluster has become part of */
    uint32_t           *piece;    /* [cluster_count]  the largest piece of each */
} Joiner;

static int by_place(const void *a, const void *b)
{
    const Left *x = a, *y = b;
    if (x->class != y->class)
        return x->class < y->class ? -1 : 1;
    for (int k = 0; k < MERGE_PLACE; k++)
        if (x->at[k] != y->at[k])
            return x->at[k] < y->at[k] ? -1 : 1;
    return (x->cluster > y->cluster) - (x->cluster < y->cluster);
}

static bool is_same_place(const Left *x, const Left *y)
{
    return x->class == y->class && x->at[0] == y->at[0] && x->at[1] == y->at[1]
        && x->at[2] == y->at[2];
}

/* Whether the middle of a piece is so far from its edges that what starts just above it starts on
 * this side of whatever stands there. */
static bool is_broad(const Surfaces *s, uint32_t surface)
{
    static const double MARGIN = 4; /* offsets, as of seams */
    const Surface *f = &s->surface[surface];
    const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, vec3_length(vec3_sub(s->position[c[(k + 1) % 3]],
                                                     s->position[c[k]])));
    /* The middle is a third of the least height from the edges. */
    const double height = (f->kind == SURFACE_QUAD ? 1 : 2) * f->area / longest;
    return height / 3 > MARGIN * ray_offset(s->largest_coordinate);
}

static void find_pieces(Joiner *j)
{
    const Merge *m = j->merge;
    for (uint32_t c = 0; c < m->cluster_count; c++)
        j->piece[c] = MERGE_NONE;
    for (uint32_t i = 0; i < m->count; i++) {
        uint32_t *piece = &j->piece[m->cluster_of[i]];
        if (*piece == MERGE_NONE || m->piece[i].area > m->piece[*piece].area)
            *piece = i;
    }
}

static void list_left(Joiner *j)
{
    const Merge *m = j->merge;
    for (uint32_t c = 0; c < m->cluster_count; c++) {
        const MergeCluster *cluster = &m->cluster[c];
        j->host[c] = c;
        if (!(cluster->area > 0 && cluster->area < REMNANT)
            || !is_broad(m->surfaces, m->piece[j->piece[c]].surface))
            continue;
        Left *left = &j->left[j->count++];
        *left = (Left){ .class = cluster->class, .cluster = c };
        for (int k = 0; k < MERGE_PLACE; k++)
            left->at[k] = (int32_t)fmin(floor(cluster->moment[k] / cluster->area), INT32_MAX);
    }
    qsort(j->left, j->count, sizeof *j->left, by_place);
}

/* The middle of a cluster's largest piece, seen from its side. */
static SurfacePoint cluster_point(const Joiner *j, uint32_t cluster)
{
    const Merge *m = j->merge;
    const uint32_t surface = m->piece[j->piece[cluster]].surface;
    const bool triangle = m->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
    SurfacePoint at;
    surfaces_point(m->surfaces, surface, triangle ? 1.0 / 3 : 0.5, triangle ? 1.0 / 3 : 0.5, &at);
    if (m->side == 1)
        at.normal = vec3_scale(at.normal, -1);
    return at;
}

static bool may_join(const Joiner *j, uint32_t host, uint32_t cluster)
{
    const MergeCluster *h = &j->merge->cluster[host], *c = &j->merge->cluster[cluster];
    MergeBox box = h->box;
    merge_box_add(&box, &c->box);
    if (h->area + c->area > merge_area_most || !merge_box_fits(&box))
        return false;
    const SurfacePoint a = cluster_point(j, host), b = cluster_point(j, cluster);
    return j->options->joined(j->options->joined_context, &a, &b);
}

static void join(Joiner *j, uint32_t host, uint32_t cluster)
{
    MergeCluster *h = &j->merge->cluster[host], *c = &j->merge->cluster[cluster];
    merge_box_add(&h->box, &c->box);
    h->area += c->area;
    for (int k = 0; k < MERGE_AXES; k++)
        h->moment[k] += c->moment[k];
    c->area = 0;
    j->host[cluster] = host;
}

/* Those of one place, left[begin..end): each to an earlier one, or it stays. */
static void join_place(Joiner *j, uint32_t begin, uint32_t end)
{
    uint32_t hosts = begin; /* left[begin..hosts) are those that others may join */
    for (uint32_t n = begin; n < end; n++) {
        const uint32_t cluster = j->left[n].cluster;
        const uint32_t first = hosts - begin > ASKED_MOST ? hosts - ASKED_MOST : begin;
        uint32_t k = hosts;
        while (k > first && !may_join(j, j->left[k - 1].cluster, cluster))
            k--;
        if (k > first)
            join(j, j->left[k - 1].cluster, cluster);
        else
            j->left[hosts++].cluster = cluster;
    }
}

bool merge_join(Merge *m, const PatchOptions *options, Error *err)
{
    static const char what[] = "patch pieces";
    assert(m != NULL && options != NULL && err != NULL);
    if (options->joined == NULL)
        return true;
    Joiner j = { .merge = m, .options = options };
    j.left = array_create(m->cluster_count, sizeof *j.left, what, err);
    j.host = array_create(m->cluster_count, sizeof *j.host, what, err);
    j.piece = array_create(m->cluster_count, sizeof *j.piece, what, err);
    if (!error_is_set(err)) {
        find_pieces(&j);
        list_left(&j);
        for (uint32_t begin = 0, end; begin < j.count; begin = end) {
            end = begin + 1;
            while (end < j.count && is_same_place(&j.left[begin], &j.left[end]))
                end++;
            join_place(&j, begin, end);
        }
        for (uint32_t i = 0; i < m->count; i++)
            m->cluster_of[i] = j.host[m->cluster_of[i]];
    }
    array_free(j.left);
    array_free(j.host);
    array_free(j.piece);
    return !error_is_set(err);
}
