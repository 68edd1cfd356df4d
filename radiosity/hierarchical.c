/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/hierarchical.c -- gathers light over links between nodes until it no longer changes,
 * then a few times over the rows of patches. */
#include "radiosity/hierarchical.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"

/* Rays that leave the scene, of a node: fewer do not tell how much its children differ in it. */
static const double LEAST_ESCAPES = 16;

typedef struct {
    const SolveSystem *system;
    Tree       tree;
    NodeLinks  links;
    double    *radiosity;   /* [tree.count * bands] */
    double    *irradiance;  /* [tree.count * bands]  of its own links, later with those above */
    double    *known;       /* [count * bands]  of leaves, by links straight from lamps */
    double    *share;       /* [tree.count]  of a node's view that its links take up */
    double    *escape;      /* [tree.count]  share of the view that meets nothing */
    double    *known_share; /* [count]  of a leaf's view, by its links straight from lamps */
} Hierarchy;

/* Whether a link ends at a patch and begins at lamps, which that patch has sampled itself. */
static bool is_known(const Hierarchy *h, const NodeLink *link)
{
    return h->tree.node[link->to].child == 0 && h->tree.lamp[link->from];
}

/* --- shares of the view ----------------------------------------------------------------------- */

/* Shares that escape: rays of a node tell it for all below, as far down as there are enough. */
static void find_escapes(Hierarchy *h)
{
    const Tree *tree = &h->tree;
    const Links *flat = h->system->links;
    for (uint32_t n = tree->count; n-- > 0;) {
        const TreeNode *node = &tree->node[n];
        const uint32_t c = node->child, patch = tree->patch[node->begin];
        const double lost = c == 0 ? node->area * flat->escape[patch]
                                   : tree->node[c].area * h->escape[c] +
                                     tree->node[c + 1].area * h->escape[c + 1];
        h->escape[n] = node->area > 0 ? lost / node->area : 0;
    }
    for (uint32_t n = 0; n < tree->count; n++) {
        const TreeNode *node = &tree->node[n];
        const double rays = h->escape[n] * (node->end - node->begin) * h->links.rays;
        if (node->child != 0 && rays < LEAST_ESCAPES)
            h->escape[node->child] = h->escape[node->child + 1] = h->escape[n];
    }
}

/* Shares of the view of all patches that links take up, those of nodes above included. */
static void find_shares(Hierarchy *h)
{
    const Tree *tree = &h->tree;
    memset(h->share, 0, tree->count * sizeof *h->share);
    memset(h->known_share, 0, h->system->links->count * sizeof *h->known_share);
    for (size_t k = 0; k < h->links.count; k++) {
        const NodeLink *link = &h->links.link[k];
        const TreeNode *to = &tree->node[link->to];
        *(is_known(h, link) ? &h->known_share[to->begin] : &h->share[link->to]) +=
            link->share / to->area;
    }
    for (uint32_t n = 0; n < tree->count; n++)
        for (uint32_t c = 0; c < 2 && tree->node[n].child != 0; c++)
            h->share[tree->node[n].child + c] += h->share[n];
}

/* Links of several levels make up a patch's view, each right in the mean over its node: together
 * they need not fill it. What is known of the patch alone stays. */
static double fill_of(const Hierarchy *h, uint32_t node)
{
    const double known = fmin(h->known_share[h->tree.node[node].begin], 1);
    const double others = h->share[node] + h->escape[node];
    return others > 0 ? (1 - known) / others : 0;
}

/* --- gathering -------------------------------------------------------------------------------- */

static void gather(Hierarchy *h)
{
    const unsigned bands = h->system->bands;
    memset(h->irradiance, 0, (size_t)h->tree.count * bands * sizeof *h->irradiance);
    memset(h->known, 0, (size_t)h->system->links->count * bands * sizeof *h->known);
    for (size_t k = 0; k < h->links.count; k++) {
        const NodeLink *link = &h->links.link[k];
        const TreeNode *to = &h->tree.node[link->to];
        const double factor = link->share / to->area;
        const double *from = &h->radiosity[(size_t)link->from * bands];
        double *out = is_known(h, link) ? &h->known[(size_t)to->begin * bands]
                                        : &h->irradiance[(size_t)link->to * bands];
        for (unsigned b = 0; b < bands; b++)
            out[b] += factor * from[b];
    }
}

/* Light of nodes down to their children; at a patch it is reflected. Returns the power by which
 * that differs from what was sent out, relative to all. */
static double push(Hierarchy *h, Solution *solution)
{
    const SolveSystem *system = h->system;
    const SolveProblem *problem = system->problem;
    const unsigned bands = system->bands;
    double *const sum = system->chunk_sum;
    memset(sum, 0, bands * sizeof *sum);
    for (uint32_t n = 0; n < h->tree.count; n++) {
        const TreeNode *node = &h->tree.node[n];
        const double *here = &h->irradiance[(size_t)n * bands];
        for (uint32_t c = 0; c < 2 && node->child != 0; c++)
            for (unsigned b = 0; b < bands; b++)
                h->irradiance[(size_t)(node->child + c) * bands + b] += here[b];
        if (node->child != 0)
            continue;
        const uint32_t patch = h->tree.patch[node->begin];
        const double fill = fill_of(h, n);
        for (unsigned b = 0; b < bands; b++) {
            const size_t at = (size_t)patch * bands + b;
            const double outside = problem->received != NULL ? problem->received[at] : 0;
            const double light = outside + h->known[(size_t)node->begin * bands + b] +
                                 fill * here[b];
            const double sent = problem->emission[at] + problem->reflectance[at] * light;
            sum[b] += node->area * fabs(sent - solution->radiosity[at]);
            solution->irradiance[at] = light;
            solution->radiosity[at] = sent;
        }
    }
    return solve_relative(system, sum);
}

/* What nodes send out, from their patches up. */
static void pull(Hierarchy *h, const Solution *solution)
{
    const unsigned bands = h->system->bands;
    for (uint32_t n = h->tree.count; n-- > 0;) {
        const TreeNode *node = &h->tree.node[n];
        double *out = &h->radiosity[(size_t)n * bands];
        if (node->child == 0) {
            const uint32_t patch = h->tree.patch[node->begin];
            memcpy(out, &solution->radiosity[(size_t)patch * bands], bands * sizeof *out);
            continue;
        }
        const TreeNode *a = &h->tree.node[node->child];
        const double first = node->area > 0 ? a->area / node->area : 0;
        const double second = node->area > 0 ? a[1].area / node->area : 0;
        const double *from = &h->radiosity[(size_t)node->child * bands];
        for (unsigned b = 0; b < bands; b++)
            out[b] = first * from[b] + second * from[bands + b];
    }
}

/* --- until it no longer changes --------------------------------------------------------------- */

static bool hierarchy_create(Hierarchy *h, const SolveSystem *system, Error *err)
{
    static const char what[] = "light of nodes";
    const size_t bands = system->bands, count = system->links->count;
    *h = (Hierarchy){ .system = system };
    if (!tree_create(&h->tree, system, err) ||
        !node_links_create(&h->links, system, &h->tree, err))
        return false;
    const size_t nodes = h->tree.count;
    h->radiosity = array_create(nodes * bands, sizeof *h->radiosity, what, err);
    h->irradiance = array_create(nodes * bands, sizeof *h->irradiance, what, err);
    h->known = array_create(count * bands, sizeof *h->known, what, err);
    h->share = array_create(nodes, sizeof *h->share, what, err);
    h->escape = array_create(nodes, sizeof *h->escape, what, err);
    h->known_share = array_create(count, sizeof *h->known_share, what, err);
    return !error_is_set(err);
}

static void hierarchy_clear(Hierarchy *h)
{
    array_free(h->radiosity);
    array_free(h->irradiance);
    array_free(h->known);
    array_free(h->share);
    array_free(h->escape);
    array_free(h->known_share);
    node_links_clear(&h->links);
    tree_clear(&h->tree);
}

/* As light spreads, more links carry much: they are refined between gathers. */
static bool iterate(Hierarchy *h, Solution *solution, Error *err)
{
    const SolveSystem *system = h->system;
    SolveStall stall = { 0 };
    bool done = false;
    pull(h, solution);
    while (!done && solution->iterations < system->max_iterations) {
        uint64_t refined;
        if (!node_links_refine(&h->links, h->radiosity, &refined, err))
            return false;
        if (refined > 0 || solution->iterations == 0)
            find_shares(h);
        gather(h);
        solution->unshot = solution->residual = push(h, solution);
        solution->iterations++;
        pull(h, solution);
        done = refined == 0 && (solution->residual <= system->tolerance ||
                                solve_stalled(&stall, solution->residual));
        const double passes = solution->iterations * (double)h->links.count /
                              fmax(1, (double)h->links.entries);
        done = solve_report(system, solution->residual, passes, NULL, NULL) || done;
    }
    return true;
}

/* Last reflections over what the rays of each patch say: each forgives most of what links between
 * nodes have wrong, for a patch gathers from many, and gives light its detail on patches. Three
 * cost less than the links that would have to be refined for as much
 * (tests/accuracy/two_percent.sh). */
enum { LAST_REFLECTIONS = 3 };

typedef struct {
    const SolveSystem *system;
    const double *radiosity;
    double       *next, *irradiance;
} LastReflection;

enum { LAST_CHUNK = 256 };

/* Light of one patch by its own row, made whole as nodes' views are: what it has sampled of lamps
 * itself stays, the rest fills what is left. */
static void gather_whole(const LastReflection *last, uint32_t i, const LinksRow *row, double *out)
{
    const SolveSystem *system = last->system;
    const uint8_t *lamp = system->links->lamp;
    const unsigned bands = system->bands;
    double known = 0, others = 0;
    for (uint64_t k = 0; k < row->count; k++)
        *(lamp != NULL && lamp[row->source[k]] != 0 ? &known : &others) += row->form_factor[k];
    const double left = fmax(0, 1 - system->links->escape[i] - known);
    const double fill = others > 0 ? left / others : 0;
    for (unsigned b = 0; b < bands; b++)
        out[b] = system->problem->received != NULL
                     ? system->problem->received[(size_t)i * bands + b] : 0;
    for (uint64_t k = 0; k < row->count; k++) {
        const uint32_t j = row->source[k];
        const double f = row->form_factor[k] * (lamp != NULL && lamp[j] != 0 ? 1 : fill);
        for (unsigned b = 0; b < bands; b++)
            out[b] += f * last->radiosity[(size_t)j * bands + b];
    }
}

static void last_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const LastReflection *last = context;
    const SolveSystem *system = last->system;
    const unsigned bands = system->bands;
    for (uint32_t i = begin; i < end; i++) {
        const LinksRow row = links_row(system->links, i, &system->scratch[worker]);
        gather_whole(last, i, &row, &last->irradiance[(size_t)i * bands]);
        for (size_t k = (size_t)i * bands; k < ((size_t)i + 1) * bands; k++)
            last->next[k] = system->problem->emission[k] +
                            system->problem->reflectance[k] * last->irradiance[k];
    }
    links_leave(system->links, begin, end);
}

static bool gather_last(const SolveSystem *system, Solution *solution, Error *err)
{
    const size_t values = (size_t)solution->count * solution->bands;
    double *next = array_create(values, sizeof *next, "the last reflections", err);
    if (next == NULL)
        return false;
    LastReflection last = { system, solution->radiosity, next, solution->irradiance };
    for (int k = 0; k < LAST_REFLECTIONS; k++) {
        parallel_for(solution->count, LAST_CHUNK, system->threads, last_chunk, &last, NULL, NULL);
        memcpy(solution->radiosity, next, values * sizeof *next);
    }
    array_free(next);
    return true;
}

bool solve_hierarchical(const SolveSystem *system, Solution *solution, Error *err)
{
    Hierarchy h;
    bool good = hierarchy_create(&h, system, err);
    if (good) {
        find_escapes(&h);
        solve_start(system, system->problem->emission, solution->radiosity);
        good = iterate(&h, solution, err) && gather_last(system, solution, err);
    }
    hierarchy_clear(&h);
    return good;
}
