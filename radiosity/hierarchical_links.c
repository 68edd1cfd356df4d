/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/hierarchical_links.c -- links between nodes, refined where they carry much. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "radiosity/hierarchical.h"
#include "radiosity/links_store.h"

/* A link that carries less than this share of a patch's mean share of all power stays: what it has
 * wrong is a part of that. Found by trying on the Cornell box (tests/accuracy/two_percent.sh): less
 * cost time and gained nothing that the last reflections do not give. */
static const double LEAST_POWER = 0.1;

/* Rays that a link between others than lamps is to be known by: one could not tell which of its
 * halves it belongs to. */
static const double LEAST_RAYS = 2;

static const char what[] = "links between nodes";

static bool push_link(NodeLinks *links, const NodeLink *link, Error *err)
{
    if (!array_reserve((void **)&links->link, &links->capacity, links->count + 1,
                       sizeof *links->link, what, err))
        return false;
    links->link[links->count++] = *link;
    return true;
}

/* --- between roots ---------------------------------------------------------------------------- */

static uint64_t root_pair(const Tree *tree, const Entry *e)
{
    return (uint64_t)tree->root[e->to] << 32 | tree->root[e->from];
}

/* Of each part, links lie together, for its patches do; of those to one root, those from lamps are
 * put last. */
static void order_entries(NodeLinks *links, uint64_t begin, uint64_t end)
{
    const uint8_t *lamp = links->tree->lamp;
    uint64_t at = begin;
    for (uint64_t k = begin; k < end; k++)
        if (!lamp[links->tree->root[links->entry[k].from]]) {
            const Entry swap = links->entry[k];
            links->entry[k] = links->entry[at];
            links->entry[at++] = swap;
        }
}

static bool link_roots(NodeLinks *links, Error *err)
{
    const Tree *tree = links->tree;
    for (uint64_t begin = 0, end; begin < links->entries; begin = end) {
        const uint32_t to = tree->root[links->entry[begin].to];
        for (end = begin + 1;
             end < links->entries && tree->root[links->entry[end].to] == to;)
            end++;
        order_entries(links, begin, end);
    }
    for (uint64_t begin = 0, end; begin < links->entries; begin = end) {
        const uint64_t pair = root_pair(tree, &links->entry[begin]);
        double share = 0;
        for (end = begin; end < links->entries &&
                          root_pair(tree, &links->entry[end]) == pair; end++)
            share += links->entry[end].share;
        const NodeLink link = { .begin = begin, .end = end, .to = (uint32_t)(pair >> 32),
                                .from = (uint32_t)pair, .share = share };
        if (!push_link(links, &link, err))
            return false;
    }
    return true;
}

bool node_links_create(NodeLinks *links, const SolveSystem *system, const Tree *tree, Error *err)
{
    const Links *flat = system->links;
    const uint64_t nonzeros = flat->first[flat->count];
    const uint64_t rays = flat->rays > nonzeros ? flat->rays : nonzeros;
    *links = (NodeLinks){ .system = system, .tree = tree,
                          .rays = flat->count > 0 ? (double)rays / flat->count : 0 };
    links->entry = array_create(nonzeros, sizeof *links->entry, what, err);
    if (error_is_set(err))
        return false;
    for (uint32_t place = 0; place < flat->count; place++) {
        const uint32_t i = tree->patch[place];
        const LinksRow row = links_row(flat, i, &system->scratch[0]);
        for (uint64_t k = 0; k < row.count; k++)
            if (row.form_factor[k] > 0)
                links->entry[links->entries++] =
                    (Entry){ place, tree->place[row.source[k]],
                             (float)(flat->area[i] * row.form_factor[k]) };
    }
    return link_roots(links, err);
}

void node_links_clear(NodeLinks *links)
{
    array_free(links->entry);
    array_free(links->link);
    *links = (NodeLinks){ 0 };
}

/* --- refining --------------------------------------------------------------------------------- */

/* What nodes send out as a share of the power, of the band with the most: times A F of a link the
 * share that goes over it, the oracle of [smits94]. */
static double *node_powers(const NodeLinks *links, const double *radiosity, Error *err)
{
    const SolveSystem *system = links->system;
    const unsigned bands = system->bands;
    double *power = array_create(links->tree->count, sizeof *power, what, err);
    for (uint32_t n = 0; power != NULL && n < links->tree->count; n++)
        for (unsigned b = 0; b < bands; b++)
            if (system->power[b] > 0) {
                const double share = radiosity[(size_t)n * bands + b] / system->power[b];
                power[n] = share > power[n] ? share : power[n];
            }
    return power;
}

/* Which end is to give way to its children, or neither. Lamps are sampled from each patch. */
typedef enum { END_NONE, END_TO, END_FROM } LinkEnd;

static LinkEnd choose_end(const NodeLinks *links, const NodeLink *link)
{
    const TreeNode *to = &links->tree->node[link->to], *from = &links->tree->node[link->from];
    const double rays = link->share / to->area * (to->end - to->begin) * links->rays;
    if (!links->tree->lamp[link->from] && rays < LEAST_RAYS)
        return END_NONE;
    if (to->child != 0 && (from->child == 0 || to->area >= from->area))
        return END_TO;
    return from->child != 0 ? END_FROM : END_NONE;
}

/* Brings the entries of the first child to the front; returns where those of the other begin, and
 * the shares of both. */
static uint64_t part_entries(NodeLinks *links, const NodeLink *link, LinkEnd end, uint32_t middle,
                             double share[2])
{
    uint64_t at = link->begin;
    double first = 0, other = 0;
    /* Without branches: which way an entry goes is not to be foreseen. */
    for (uint64_t k = link->begin; k < link->end; k++) {
        const Entry e = links->entry[k], front = links->entry[at];
        const bool second = (end == END_TO ? e.to : e.from) >= middle;
        first += second ? 0 : e.share;
        other += second ? e.share : 0;
        links->entry[k] = second ? e : front;
        links->entry[at] = second ? front : e;
        at += !second;
    }
    share[0] = first;
    share[1] = other;
    return at;
}

static bool refine_link(NodeLinks *links, size_t k, LinkEnd end, Error *err)
{
    const NodeLink link = links->link[k];
    const TreeNode *node = &links->tree->node[end == END_TO ? link.to : link.from];
    NodeLink part[2] = { link, link };
    double share[2];
    part[0].end = part[1].begin = part_entries(links, &link, end,
                                               links->tree->node[node->child].end, share);
    for (unsigned c = 0; c < 2; c++) {
        part[c].share = share[c];
        *(end == END_TO ? &part[c].to : &part[c].from) = node->child + c;
    }
    const bool first = part[0].begin < part[0].end, second = part[1].begin < part[1].end;
    assert(first || second);
    links->link[k] = first ? part[0] : part[1];
    return !first || !second || push_link(links, &part[1], err);
}

bool node_links_refine(NodeLinks *links, const double *radiosity, uint64_t *refined, Error *err)
{
    const double least = LEAST_POWER / links->system->links->count;
    double *power = node_powers(links, radiosity, err);
    *refined = 0;
    for (size_t k = 0; power != NULL && k < links->count; k++)
        for (;;) {
            const NodeLink *link = &links->link[k];
            const LinkEnd end = power[link->from] * link->share > least
                                    ? choose_end(links, link) : END_NONE;
            if (end == END_NONE || !refine_link(links, k, end, err))
                break;
            ++*refined;
        }
    array_free(power);
    return !error_is_set(err);
}
