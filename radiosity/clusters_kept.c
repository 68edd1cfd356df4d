/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of a run over links between clusters as bytes: a head, radiosity of patches, importance
 * of nodes and their weight where it guides, links; then rays of each finished chunk of the last
 * reflection, and for each of its patches what both halves brought and what escaped. */
#include "radiosity/clusters_kept.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/clusters_internal.h"

static const char what[] = "links that are kept";

struct ClustersKept {
    unsigned char *bytes;
    size_t         size, capacity;
    size_t         gathered;  /* where the last reflection begins, while it is under way */
    const ClustersGathered *under_way; /* whose finished chunks are yet to be copied */
    bool           full;      /* something was put or loaded */
};

/* One patch of the last reflection. */
typedef struct {
    double came[CLUSTER_HALVES][ROOM_BANDS];
    double escape;
} GatheredPatch;

ClustersKept *clusters_kept_create(Error *err)
{
    return array_create(1, sizeof(ClustersKept), what, err);
}

ClustersKept *clusters_kept_destroy(ClustersKept *kept)
{
    if (kept != NULL)
        array_free(kept->bytes);
    return array_free(kept);
}

/* --- where things are ------------------------------------------------------------------------- */

static size_t radiosity_bytes(const ClustersHead *head)
{
    return (size_t)head->patches * ROOM_BANDS * sizeof(double);
}

static size_t meaning_bytes(const ClustersHead *head)
{
    return head->guided ? (size_t)head->nodes * ROOM_BANDS * sizeof(double) : 0;
}

static size_t weight_bytes(const ClustersHead *head)
{
    return head->guided ? (size_t)head->nodes * sizeof(double) : 0;
}

/* All but the last reflection. */
static size_t links_end(const ClustersHead *head)
{
    return sizeof *head + radiosity_bytes(head) + meaning_bytes(head) + weight_bytes(head) +
           (size_t)head->links * sizeof(ClusterLink);
}

enum { PIECES = 3 };

/* All but links, in their order. */
typedef struct {
    void  *array[PIECES];
    size_t size[PIECES];
} Pieces;

static Pieces find_pieces(const ClustersHead *head, const ClustersState *state)
{
    return (Pieces){ { state->radiosity, state->meaning, state->weight },
                     { radiosity_bytes(head), meaning_bytes(head), weight_bytes(head) } };
}

static size_t gathered_bytes(uint32_t patches, uint32_t chunks)
{
    return chunks * sizeof(uint32_t) + (size_t)patches * sizeof(GatheredPatch);
}

static uint32_t chunk_count(uint32_t patches)
{
    return patches / CLUSTER_GATHER_CHUNK + (patches % CLUSTER_GATHER_CHUNK > 0);
}

/* --- the last reflection ---------------------------------------------------------------------- */

static void copy_chunk(ClustersKept *kept, const ClustersGathered *g, uint32_t chunk, uint32_t rays)
{
    const uint32_t chunks = chunk_count(g->patches), begin = chunk * CLUSTER_GATHER_CHUNK;
    const uint32_t left = g->patches - begin;
    const uint32_t count = left < CLUSTER_GATHER_CHUNK ? left : CLUSTER_GATHER_CHUNK;
    unsigned char *to = kept->bytes + kept->gathered;
    for (uint32_t k = begin; k < begin + count; k++) {
        const uint32_t patch = g->patch[k];
        GatheredPatch  one = { .escape = g->escape[patch] };
        for (unsigned half = 0; half < CLUSTER_HALVES; half++)
            memcpy(one.came[half], &g->came[half][(size_t)patch * ROOM_BANDS],
                   sizeof one.came[half]);
        memcpy(to + gathered_bytes(k, chunks), &one, sizeof one);
    }
    memcpy(to + chunk * sizeof rays, &rays, sizeof rays);
}

/* What has been finished since the last time. */
static void copy_finished(ClustersKept *kept)
{
    const ClustersGathered *g = kept->under_way;
    for (uint32_t chunk = 0; g != NULL && chunk < chunk_count(g->patches); chunk++) {
        uint32_t copied;
        memcpy(&copied, kept->bytes + kept->gathered + chunk * sizeof copied, sizeof copied);
        const uint32_t rays = atomic_load_explicit(&g->done[chunk], memory_order_acquire);
        if (copied == 0 && rays > 0)
            copy_chunk(kept, g, chunk, rays);
    }
}

static void take_chunks(const ClustersKept *kept, const ClustersGathered *g)
{
    const uint32_t chunks = chunk_count(g->patches);
    const unsigned char *from = kept->bytes + kept->gathered;
    for (uint32_t k = 0; k < g->patches; k++) {
        const uint32_t patch = g->patch[k], chunk = k / CLUSTER_GATHER_CHUNK;
        uint32_t       rays;
        GatheredPatch  one;
        memcpy(&rays, from + chunk * sizeof rays, sizeof rays);
        if (rays == 0)
            continue;
        memcpy(&one, from + gathered_bytes(k, chunks), sizeof one);
        atomic_store_explicit(&g->done[chunk], rays, memory_order_relaxed);
        g->escape[patch] = (float)one.escape;
        for (unsigned half = 0; half < CLUSTER_HALVES; half++)
            memcpy(&g->came[half][(size_t)patch * ROOM_BANDS], one.came[half],
                   sizeof one.came[half]);
    }
}

static bool make_room(ClustersKept *kept, size_t size, Error *err)
{
    if (!array_reserve((void **)&kept->bytes, &kept->capacity, size, 1, what, err))
        return false;
    kept->size = size;
    return true;
}

bool clusters_kept_gather(ClustersKept *kept, const ClustersGathered *gathered, Error *err)
{
    ClustersHead head = { .links = 0 };
    assert(kept->under_way == NULL);
    if (kept->full)
        memcpy(&head, kept->bytes, sizeof head);
    if (!head.ended)
        return true; /* the last round was broken off: that before it is kept */
    const uint32_t chunks = chunk_count(gathered->patches);
    const size_t begin = links_end(&head), size = gathered_bytes(gathered->patches, chunks);
    kept->gathered = begin;
    if (head.gathered == 0) {
        if (!make_room(kept, begin + size, err))
            return false;
        memset(kept->bytes + begin, 0, size);
        head.gathered = gathered->patches;
        memcpy(kept->bytes, &head, sizeof head);
    } else if (head.gathered != gathered->patches)
        return error_set(err, ERROR_INPUT, "what was kept is of other patches than there are");
    else
        take_chunks(kept, gathered);
    kept->under_way = gathered;
    return true;
}

void clusters_kept_gathered(ClustersKept *kept)
{
    if (kept != NULL) {
        copy_finished(kept);
        kept->under_way = NULL;
    }
}

/* --- rounds ----------------------------------------------------------------------------------- */

bool clusters_kept_put(ClustersKept *kept, const ClustersHead *head, const ClustersState *from,
                       Error *err)
{
    assert(kept->under_way == NULL && head->links == from->links->count);
    /* With room for the last reflection where it comes next; not twice what there was. */
    const uint32_t n = head->patches;
    const size_t end = links_end(head);
    array_free(kept->bytes);
    *kept = (ClustersKept){ .bytes = NULL };
    if (!make_room(kept, end + (head->ended ? gathered_bytes(n, chunk_count(n)) : 0), err))
        return false;
    kept->size = end;
    memcpy(kept->bytes, head, sizeof *head);
    const Pieces pieces = find_pieces(head, from);
    unsigned char *at = kept->bytes + sizeof *head;
    for (unsigned k = 0; k < PIECES; at += pieces.size[k++])
        if (pieces.size[k] > 0)
            memcpy(at, pieces.array[k], pieces.size[k]);
    if (head->links > 0)
        memcpy(at, from->links->link, (size_t)head->links * sizeof(ClusterLink));
    kept->full = true;
    return true;
}

bool clusters_kept_get(const ClustersKept *kept, ClustersHead *head, const ClustersState *to,
                       Error *err)
{
    if (kept == NULL || !kept->full)
        return false;
    memcpy(head, kept->bytes, sizeof *head);
    if (head->nodes != to->links->tree->count || (head->guided != 0) != (to->meaning != NULL))
        return error_set(err, ERROR_INPUT, "what was kept is of another tree of clusters");
    const Pieces pieces = find_pieces(head, to);
    const unsigned char *at = kept->bytes + sizeof *head;
    for (unsigned k = 0; k < PIECES; at += pieces.size[k++])
        if (pieces.size[k] > 0)
            memcpy(pieces.array[k], at, pieces.size[k]);
    return cluster_links_set(to->links, at, (size_t)head->links, err);
}

/* --- files ------------------------------------------------------------------------------------ */

void *clusters_kept_bytes(ClustersKept *kept, size_t *size)
{
    const bool full = kept != NULL && kept->full;
    if (full)
        copy_finished(kept);
    *size = full ? kept->size : 0;
    return full ? kept->bytes : NULL;
}

static bool finite_doubles(const unsigned char *bytes, size_t size)
{
    for (size_t at = 0; at < size; at += sizeof(double)) {
        double value;
        memcpy(&value, bytes + at, sizeof value);
        if (!(isfinite(value) && value >= 0))
            return false;
    }
    return true;
}

/* Links rise by the node they go to. */
static bool links_fit(const unsigned char *bytes, const ClustersHead *head)
{
    uint32_t before = 0;
    for (size_t k = 0; k < head->links; k++) {
        ClusterLink link;
        memcpy(&link, bytes + k * sizeof link, sizeof link);
        if (link.to < before || link.to >= head->nodes || link.from >= head->nodes ||
            !(link.factor >= 0 && link.factor <= 1) || !isfinite(link.error))
            return false;
        before = link.to;
    }
    return true;
}

static bool head_fits(const ClustersHead *head, size_t size, uint32_t patches)
{
    return head->patches == patches && head->nodes / 2 <= patches && head->rounds > 0 &&
           head->links <= size / sizeof(ClusterLink) && isfinite(head->threshold) &&
           head->threshold > 0 && isfinite(head->error) && head->error >= 0 &&
           head->gathered <= (head->ended ? patches : 0) &&
           size == links_end(head) + gathered_bytes(head->gathered, chunk_count(head->gathered));
}

bool clusters_kept_load(ClustersKept *kept, void *bytes, size_t size, uint32_t patches)
{
    ClustersHead head;
    array_free(kept->bytes);
    *kept = (ClustersKept){ .bytes = bytes, .size = size, .capacity = size };
    if (bytes == NULL || size < sizeof head)
        return false;
    memcpy(&head, kept->bytes, sizeof head);
    if (!head_fits(&head, size, patches))
        return false;
    const unsigned char *at = kept->bytes + sizeof head;
    const size_t values = radiosity_bytes(&head) + meaning_bytes(&head) + weight_bytes(&head);
    const size_t gathered = (size_t)head.gathered * sizeof(GatheredPatch);
    kept->full = finite_doubles(at, values) && links_fit(at + values, &head) &&
                 finite_doubles(kept->bytes + size - gathered, gathered);
    return kept->full;
}
