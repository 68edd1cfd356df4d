/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_links.c -- links between nodes, refined where they leave too much uncertain:
 * depth first, a slab of links at a time whose rays are traced together. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/clusters_internal.h"

/* Links whose rays are traced before any of them is refined. */
enum { SLAB = 16 * CANDIDATE_CHUNK };

/* Most rays of a link between patches. */
enum { RAYS_MOST = 256 };

/* Copies of links while they are sorted: as they were found, and in order. */
enum { COPIES = 2 };

static const char what[] = "links between clusters";

/* --- what is to be refined -------------------------------------------------------------------- */

static bool is_inner(const ClusterLinks *links, uint32_t node)
{
    return links->tree->node[node].child != 0;
}

static double excess(const ClusterOracle *o, const ClusterLink *link)
{
    return o->light[link->from] * fabs((double)link->error) * sqrt(o->weight[link->to]);
}

static bool is_refinable(const ClusterLinks *links, const ClusterOracle *o,
                         const ClusterLink *link)
{
    return link->error > 0 && !links->spent && !links->full && !links->stopped &&
           excess(o, link) > o->threshold;
}

double cluster_links_error(const ClusterLinks *links, const ClusterOracle *oracle)
{
    double sum = 0;
    for (size_t k = 0; k < links->count; k++) {
        const double e = excess(oracle, &links->link[k]);
        sum += e * e;
    }
    return sqrt(sum);
}

/* --- the stack -------------------------------------------------------------------------------- */

static bool push(ClusterLinks *links, const Candidate *c, Error *err)
{
    if (!array_reserve((void **)&links->stack, &links->stack_capacity, links->stacked + 1,
                       sizeof *links->stack, what, err))
        return false;
    links->stack[links->stacked++] = *c;
    return true;
}

static bool finish(ClusterLinks *links, const ClusterLink *link, Error *err)
{
    if (!(link->error > 0) && !(link->factor > 0) && !(link->error < 0))
        return true; /* they face away from each other */
    if (!array_reserve((void **)&links->link, &links->capacity, links->count + 1,
                       sizeof *links->link, what, err))
        return false;
    links->link[links->count++] = *link;
    return true;
}

static bool within(const ClusterNode *node, uint32_t place)
{
    return place >= node->begin && place < node->end;
}

/* A candidate between smaller nodes, with those of the samples that fall to it. */
static bool push_part(ClusterLinks *links, const Candidate *whole, uint32_t to, uint32_t from,
                      Error *err)
{
    Candidate part = { .to = to, .from = from };
    if (to == from && !is_inner(links, to))
        return true; /* a patch does not see itself */
    for (uint32_t k = 0; k < whole->count; k++) {
        const ClusterSample *s = &whole->sample[k];
        if (within(&links->tree->node[to], s->to) && within(&links->tree->node[from], s->from))
            part.sample[part.count++] = *s;
    }
    return push(links, &part, err);
}

/* A node with itself: its halves with themselves and each other. */
static bool push_self(ClusterLinks *links, const Candidate *whole, Error *err)
{
    const uint32_t child = links->tree->node[whole->to].child;
    for (uint32_t k = 0; k < 4; k++)
        if (!push_part(links, whole, child + k / 2, child + k % 2, err))
            return false;
    return true;
}

/* The larger end gives way; where both are patches, more rays are cast: their numbers, in the sums,
 * stand for those cast already. */
static bool push_parts(ClusterLinks *links, const Candidate *c, Error *err)
{
    assert(c->to != c->from);
    const ClusterNode *to = &links->tree->node[c->to], *from = &links->tree->node[c->from];
    const bool split_to = to->child != 0 && (from->child == 0 || to->area >= from->area);
    if (to->child == 0 && from->child == 0) {
        Candidate more = *c;
        candidate_sum(links, &more);
        return push(links, &more, err);
    }
    for (uint32_t k = 0; k < 2; k++)
        if (!push_part(links, c, split_to ? to->child + k : c->to,
                       split_to ? c->from : from->child + k, err))
            return false;
    return true;
}

/* --- slabs ------------------------------------------------------------------------------------ */

typedef struct {
    const ClusterLinks *links;
    Candidate *candidate;
} SlabPass;

static void sample_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const SlabPass *pass = context;
    CandidateScratch *scratch = &pass->links->scratch[worker];
    scratch->rays += candidates_sample(pass->links, scratch, &pass->candidate[begin], end - begin);
}

static void count_rays(ClusterLinks *links)
{
    for (unsigned k = 0; k < links->threads; k++) {
        links->rays += links->scratch[k].rays;
        links->scratch[k].rays = 0;
    }
    links->spent = links->rays >= links->most_rays;
    links->full = links->most_links > 0 && links->count * COPIES >= links->most_links;
    links->stopped = links->stopped || monitor_stop(links->monitor);
    if (links->count > links->largest)
        links->largest = links->count;
}

/* Takes a sampled candidate for a link, or parts it. Samples by which it was decided that a link
 * may stay are no measure of it: those that happened to be small would be kept more often. */
static bool settle(ClusterLinks *links, const ClusterOracle *oracle, const Candidate *c,
                   Error *err)
{
    ClusterLink link = candidate_link(links, c);
    const bool patches = !is_inner(links, c->to) && !is_inner(links, c->from);
    const uint32_t taken = c->taken + c->count;
    if (patches && taken >= RAYS_MOST)
        link.error = -link.error;
    if (c->error <= 0 && is_refinable(links, oracle, &link))
        return push_parts(links, c, err);
    if (c->error > 0 || !(link.error > 0) || taken > CANDIDATE_SAMPLES)
        return finish(links, &link, err);
    const Candidate kept = { .to = c->to, .from = c->from, .error = link.error };
    return push(links, &kept, err);
}

/* Works the stack off. */
static bool drain(ClusterLinks *links, const ClusterOracle *oracle, Candidate *slab, Error *err)
{
    while (links->stacked > 0) {
        const uint32_t count = links->stacked < SLAB ? (uint32_t)links->stacked : SLAB;
        uint32_t real = 0;
        links->stacked -= count;
        memcpy(slab, links->stack + links->stacked, count * sizeof *slab);
        for (uint32_t k = 0; k < count; k++) {
            if (slab[k].to != slab[k].from)
                slab[real++] = slab[k];
            else if (!push_self(links, &slab[k], err))
                return false;
        }
        SlabPass pass = { .links = links, .candidate = slab };
        parallel_for(real, CANDIDATE_CHUNK, links->threads, sample_chunk, &pass, NULL, NULL);
        count_rays(links);
        for (uint32_t k = 0; k < real; k++)
            if (!settle(links, oracle, &slab[k], err))
                return false;
    }
    return true;
}

/* --- all links -------------------------------------------------------------------------------- */

/* Where links to each node begin, once they are in order. */
static void count_links(ClusterLinks *links)
{
    const uint32_t nodes = links->tree->count;
    memset(links->first, 0, ((size_t)nodes + 1) * sizeof *links->first);
    for (size_t k = 0; k < links->count; k++)
        links->first[links->link[k].to + 1]++;
    for (uint32_t n = 0; n < nodes; n++)
        links->first[n + 1] += links->first[n];
}

/* Links in the order of the nodes they go to, others as they come. */
static bool sort_links(ClusterLinks *links, Error *err)
{
    const uint32_t nodes = links->tree->count;
    ClusterLink *sorted = array_create(links->count, sizeof *sorted, what, err);
    if (sorted == NULL)
        return false;
    count_links(links);
    for (size_t k = 0; k < links->count; k++)
        sorted[links->first[links->link[k].to]++] = links->link[k];
    for (uint32_t n = nodes; n > 0; n--)
        links->first[n] = links->first[n - 1];
    links->first[0] = 0;
    array_free(links->link);
    links->link = sorted;
    links->capacity = links->count;
    return true;
}

bool cluster_links_set(ClusterLinks *links, const unsigned char *bytes, size_t count, Error *err)
{
    if (count > 0 && !array_reserve((void **)&links->link, &links->capacity, count,
                                    sizeof *links->link, what, err))
        return false;
    links->count = count;
    if (count > 0)
        memcpy(links->link, bytes, count * sizeof *links->link);
    count_links(links);
    return true;
}

/* Links that give way leave their places; those behind move up. */
static bool part_all(ClusterLinks *links, const ClusterOracle *oracle, Candidate *slab,
                     uint64_t *refined, Error *err)
{
    const size_t old = links->count;
    assert(links->stacked == 0 && oracle->threshold > 0);
    for (size_t k = 0; k < old; k++) {
        const ClusterLink link = links->link[k];
        if (!is_refinable(links, oracle, &link))
            continue;
        ++*refined;
        links->link[k].to = UINT32_MAX;
        const Candidate whole = { .to = link.to, .from = link.from };
        const bool patches = !is_inner(links, link.to) && !is_inner(links, link.from);
        if (!(patches ? push(links, &whole, err) : push_parts(links, &whole, err)) ||
            (links->stacked >= SLAB && !drain(links, oracle, slab, err)))
            return false;
    }
    if (!drain(links, oracle, slab, err))
        return false;
    size_t kept = 0;
    for (size_t k = 0; k < links->count; k++)
        if (links->link[k].to != UINT32_MAX)
            links->link[kept++] = links->link[k];
    links->count = kept;
    return true;
}

bool cluster_links_refine(ClusterLinks *links, const ClusterOracle *oracle, uint64_t *refined,
                          Error *err)
{
    Candidate *slab = array_create(SLAB, sizeof *slab, what, err);
    *refined = 0;
    if (slab == NULL)
        return false;
    bool good = true;
    if (links->first[links->tree->count] == 0) { /* the first time */
        const Candidate root = { 0 };
        ++*refined;
        good = (links->tree->leaves < 2 || push(links, &root, err)) &&
               drain(links, oracle, slab, err);
    }
    good = good && part_all(links, oracle, slab, refined, err) && sort_links(links, err);
    array_free(slab);
    return good;
}

bool cluster_links_create(ClusterLinks *links, const Room *room, const OpenPlaces *places,
                          const ClusterTree *tree, const ClustersOptions *options,
                          const Monitor *monitor, Error *err)
{
    const size_t rays = (size_t)CANDIDATE_CHUNK * CANDIDATE_SAMPLES;
    const uint32_t each = options->rays > 0 ? options->rays : 256;
    *links = (ClusterLinks){ .shooter = { .room = room, .places = places }, .tree = tree,
                             .monitor = monitor, .seed = options->seed,
                             .threads = parallel_threads(options->threads),
                             .most_rays = (uint64_t)each * tree->leaves,
                             .most_links = options->memory / sizeof *links->link };
    links->first = array_create((size_t)tree->count + 1, sizeof *links->first, what, err);
    links->scratch = array_create(links->threads, sizeof *links->scratch, what, err);
    if (error_is_set(err))
        return false;
    for (unsigned k = 0; k < links->threads; k++) {
        CandidateScratch *s = &links->scratch[k];
        s->ray = array_create(rays, sizeof *s->ray, what, err);
        s->blocked = array_create(rays, sizeof *s->blocked, what, err);
        s->sample = array_create(rays, sizeof(ClusterSample *), what, err);
    }
    return !error_is_set(err);
}

void cluster_links_clear(ClusterLinks *links)
{
    for (unsigned k = 0; k < links->threads && links->scratch != NULL; k++) {
        array_free(links->scratch[k].ray);
        array_free(links->scratch[k].blocked);
        array_free(links->scratch[k].sample);
    }
    array_free(links->scratch);
    array_free(links->stack);
    array_free(links->first);
    array_free(links->link);
    *links = (ClusterLinks){ 0 };
}
