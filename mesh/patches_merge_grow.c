/* SPDX-License-Identifier: BSD-3-Clause */
/* Clusters grow from a seed over neighbours, nearest first, till they have the area of a patch.
 *
 * The next seed is a neighbour of an earlier cluster, so that clusters pack like a wall's stones
 * and little is left between them.
 */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "mesh/patches_merge.h"

/* How much a difference of normals counts beside one of place: a chord of 1, the most there may be,
 * like half a patch size. */
static const float NORMAL_WEIGHT = 0.25f;

typedef struct {
    Merge    *merge;
    uint64_t *heap;      /* [heap_count]  distance above, piece below; room for all pieces */
    uint32_t  heap_count;
    uint32_t *seen;      /* [count]  1 + the last cluster that has met a piece */
    uint32_t *queue;     /* [count]  pieces met and left: seeds to come, each once */
    uint32_t  head, tail;
    uint8_t  *queued;    /* [count] */
} Grower;

void merge_heap_push(uint64_t *heap, uint32_t *count, uint64_t key)
{
    uint32_t i = (*count)++;
    for (; i > 0 && heap[(i - 1) / 2] > key; i = (i - 1) / 2)
        heap[i] = heap[(i - 1) / 2];
    heap[i] = key;
}

uint64_t merge_heap_pop(uint64_t *heap, uint32_t *count)
{
    assert(*count > 0);
    const uint64_t least = heap[0], last = heap[--*count];
    uint32_t i = 0;
    for (uint32_t child; (child = 2 * i + 1) < *count; i = child) {
        child += child + 1 < *count && heap[child + 1] < heap[child];
        if (heap[child] >= last)
            break;
        heap[i] = heap[child];
    }
    heap[i] = last;
    return least;
}

static uint64_t distance_key(const float mean[MERGE_AXES], const MergePiece *piece, uint32_t i)
{
    float sum = 0;
    for (int k = 0; k < MERGE_AXES; k++) {
        const float d = piece->at[k] - mean[k];
        sum += (k < MERGE_PLACE ? 1 : NORMAL_WEIGHT) * d * d;
    }
    uint32_t bits; /* floats >= 0 are in the order of their bits */
    memcpy(&bits, &sum, sizeof bits);
    return (uint64_t)bits << 32 | i;
}

static void take_piece(Grower *g, uint32_t number, uint32_t i)
{
    Merge *m = g->merge;
    const MergePiece *piece = &m->piece[i];
    MergeCluster *c = &m->cluster[number];
    const MergeBox box = merge_piece_box(piece);
    if (c->area > 0)
        merge_box_add(&c->box, &box);
    else
        c->box = box;
    c->area += piece->area;
    float mean[MERGE_AXES];
    for (int k = 0; k < MERGE_AXES; k++) {
        c->moment[k] += (double)piece->area * piece->at[k];
        mean[k] = (float)(c->moment[k] / c->area);
    }
    m->cluster_of[i] = number;
    for (unsigned k = 0; k < 4; k++) {
        const uint32_t j = piece->next[k];
        if (j == MERGE_NONE || m->cluster_of[j] != MERGE_NONE || g->seen[j] == number + 1)
            continue;
        g->seen[j] = number + 1;
        merge_heap_push(g->heap, &g->heap_count, distance_key(mean, &m->piece[j], j));
    }
}

static void leave_piece(Grower *g, uint32_t i)
{
    if (g->queued[i])
        return;
    g->queued[i] = 1;
    g->queue[g->tail++] = i;
}

static void grow_cluster(Grower *g, uint32_t seed)
{
    Merge *m = g->merge;
    const uint32_t number = m->cluster_count++;
    MergeCluster *c = &m->cluster[number];
    *c = (MergeCluster){ .class = m->piece[seed].class };
    take_piece(g, number, seed);
    while (g->heap_count > 0) {
        const uint32_t i = (uint32_t)merge_heap_pop(g->heap, &g->heap_count);
        const MergePiece *piece = &m->piece[i];
        MergeBox box = merge_piece_box(piece);
        merge_box_add(&box, &c->box);
        /* Nearer to the aim with it than without it. */
        const bool enough = c->area + piece->area / 2 > merge_area;
        if (enough || !merge_box_fits(&box))
            leave_piece(g, i);
        else
            take_piece(g, number, i);
        if (enough)
            break;
    }
    for (uint32_t k = 0; k < g->heap_count; k++)
        leave_piece(g, (uint32_t)g->heap[k]);
    g->heap_count = 0;
}

bool merge_grow(Merge *m, Error *err)
{
    assert(m != NULL && err != NULL);
    Grower g = { .merge = m };
    g.heap = array_create(m->count, sizeof *g.heap, "patch pieces", err);
    g.seen = array_create(m->count, sizeof *g.seen, "patch pieces", err);
    g.queue = array_create(m->count, sizeof *g.queue, "patch pieces", err);
    g.queued = array_create(m->count, sizeof *g.queued, "patch pieces", err);
    m->cluster_count = 0;
    if (!error_is_set(err)) {
        for (uint32_t i = 0; i < m->count; i++)
            m->cluster_of[i] = MERGE_NONE;
        for (uint32_t i = 0; i < m->count; i++) {
            if (m->cluster_of[i] == MERGE_NONE)
                grow_cluster(&g, i);
            for (; g.head < g.tail; g.head++)
                if (m->cluster_of[g.queue[g.head]] == MERGE_NONE)
                    grow_cluster(&g, g.queue[g.head]);
        }
    }
    array_free(g.heap);
    array_free(g.seen);
    array_free(g.queue);
    array_free(g.queued);
    return !error_is_set(err);
}
