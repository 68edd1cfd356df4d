/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_light.c -- light over links between nodes, down to patches and up again; and
 * importance the other way. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/clusters_internal.h"

enum { GATHER_NODES = 4096 };

/* No factor is so sure that it may not change at all: where all are sure, rows are filled by
 * scaling them. */
static const double LEAST_LOOSENESS = 0.02;

/* Rays of a node that tell what share of its view meets nothing: to 0.03 where it is half. */
static const double ESCAPE_RAYS = 256;

/* Standard errors by which halves' shares may be apart and still be taken for one share: what is
 * farther apart lies on two sides of a wall, and would give its light to the sky. */
static const double ESCAPES_APART = 3;

/* Importance that a step still moves, of all: below, it is spread. */
static const double LEAST_MOVED = 1e-9;

/* Of a factor with this relative error: times the factor, it is the variance. */
static double looseness_of(double factor, double relative)
{
    const double error = fmin(1, fmax(relative, LEAST_LOOSENESS));
    return factor * error * error;
}

static double looseness(const ClusterLink *link)
{
    const double error = fabs((double)link->error), factor = link->factor;
    return looseness_of(factor, error < factor ? error / factor : 1);
}

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* --- shares that escape ----------------------------------------------------------------------- */

/* Whether rays of two nodes tell one share, as far as so few can. */
static bool escapes_alike(const ClusterLight *l, uint32_t a, uint32_t b, double each)
{
    const ClusterNode *node = l->links->tree->node;
    const double rays_a = (node[a].end - node[a].begin) * each;
    const double rays_b = (node[b].end - node[b].begin) * each;
    const double share = (rays_a * l->escape[a] + rays_b * l->escape[b]) / (rays_a + rays_b);
    const double apart = l->escape[a] - l->escape[b];
    return apart * apart <= ESCAPES_APART * ESCAPES_APART * share * (1 - share) *
                                (1 / rays_a + 1 / rays_b);
}

/* Rays of a node tell it for all below, where these have too few of their own. */
static void find_escapes(ClusterLight *l)
{
    const ClusterTree *tree = l->links->tree;
    const Links *own = l->links->shooter.places->links;
    const double each = (double)own->rays / fmax(1, own->count);
    for (uint32_t n = tree->count; n-- > 0;) {
        const ClusterNode *node = &tree->node[n];
        const uint32_t c = node->child;
        const double lost = c == 0 ? node->area * own->escape[tree->patch[node->begin]]
                                   : tree->node[c].area * l->escape[c] +
                                     tree->node[c + 1].area * l->escape[c + 1];
        l->escape[n] = node->area > 0 ? lost / node->area : 0;
        const double escapes = l->escape[n] * (node->end - node->begin) * each;
        l->escape_looseness[n] = (float)(1 / sqrt(fmax(1, escapes)));
    }
    for (uint32_t n = 0; n < tree->count; n++) {
        const uint32_t c = tree->node[n].child;
        const uint32_t fewest = c == 0 ? 0 : tree->node[c].end - tree->node[c].begin <
                                             tree->node[c + 1].end - tree->node[c + 1].begin
                                                 ? c : c + 1;
        if (c == 0 || (tree->node[fewest].end - tree->node[fewest].begin) * each >= ESCAPE_RAYS ||
            !escapes_alike(l, c, c + 1, each))
            continue;
        for (uint32_t k = c; k < c + 2; k++) {
            l->escape[k] = l->escape[n];
            l->escape_looseness[k] = l->escape_looseness[n];
        }
    }
}

/* --- gathering -------------------------------------------------------------------------------- */

static void gather_nodes(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const ClusterLight *l = context;
    (void)worker;
    for (uint32_t n = begin; n < end; n++) {
        ClusterIrradiance here = { .rows = 0 };
        for (uint64_t k = l->links->first[n]; k < l->links->first[n + 1]; k++) {
            const ClusterLink *link = &l->links->link[k];
            const double *from = &l->sent[(size_t)link->from * ROOM_BANDS];
            const double factor = link->factor, loose = factor * looseness(link);
            here.rows += factor;
            here.loose_rows += loose;
            here.loosest = fmax(here.loosest, looseness(link));
            for (unsigned b = 0; b < ROOM_BANDS; b++) {
                here.light[b] += factor * from[b];
                here.loose[b] += loose * from[b];
            }
        }
        l->here[n] = here;
    }
}

/* Down to the leaves. */
static void gather(ClusterLight *l)
{
    const ClusterTree *tree = l->links->tree;
    parallel_for(tree->count, GATHER_NODES, l->links->threads, gather_nodes, l, NULL, NULL);
    for (uint32_t n = 0; n < tree->count; n++) {
        const uint32_t child = tree->node[n].child;
        const ClusterIrradiance *above = &l->here[n];
        for (uint32_t c = child; c < child + 2 && child != 0; c++) {
            ClusterIrradiance *here = &l->here[c];
            here->rows += above->rows;
            here->loose_rows += above->loose_rows;
            here->loosest = fmax(here->loosest, above->loosest);
            for (unsigned b = 0; b < ROOM_BANDS; b++) {
                here->light[b] += above->light[b];
                here->loose[b] += above->loose[b];
            }
        }
    }
}

/* Each row and its escape sum to 1: what lacks goes to factors by their variances, the escape's
 * too, as far as none gets negative; what lacks then goes to all. */
static void fill_row(ClusterLight *l, uint32_t n)
{
    const uint32_t leaf = l->links->tree->node[n].begin;
    const ClusterIrradiance *here = &l->here[n];
    const double escape = l->escape[n], loose = looseness_of(escape, l->escape_looseness[n]);
    const double all = here->loose_rows + escape * loose;
    const double least = -1 / fmax(here->loosest, loose);
    const double fill = all > 0 ? fmax(least, (1 - here->rows - escape) / all) : 0;
    const double sum = here->rows + escape + fill * all;
    l->fill[leaf] = (float)fill;
    l->scale[leaf] = sum > 0 ? (float)(1 / sum) : 1;
}

void cluster_light_fill(ClusterLight *l)
{
    const ClusterTree *tree = l->links->tree;
    double sum = 0;
    gather(l);
    for (uint32_t n = 0; n < tree->count; n++) {
        if (tree->node[n].child != 0)
            continue;
        const double lack = 1 - l->here[n].rows - l->escape[n];
        fill_row(l, n);
        sum += tree->node[n].area * lack * lack;
    }
    l->rows = tree->count > 0 ? sqrt(sum / tree->node[0].area) : 0;
}

/* --- reflecting ------------------------------------------------------------------------------- */

double cluster_light_sweep(ClusterLight *l, double *radiosity, double *irradiance)
{
    const ClusterTree *tree = l->links->tree;
    const SolveProblem *p = l->problem;
    double moved[ROOM_BANDS] = { 0 }, power[ROOM_BANDS] = { 0 }, most = 0;
    gather(l);
    for (uint32_t n = 0; n < tree->count; n++) {
        const ClusterNode *node = &tree->node[n];
        if (node->child != 0)
            continue;
        const ClusterIrradiance *here = &l->here[n];
        for (unsigned b = 0; b < ROOM_BANDS; b++) {
            const size_t at = (size_t)tree->patch[node->begin] * ROOM_BANDS + b;
            const double outside = p->received != NULL ? p->received[at] : 0;
            irradiance[at] = outside + l->scale[node->begin] *
                                           (here->light[b] + l->fill[node->begin] * here->loose[b]);
            const double sent = p->emission[at] + p->reflectance[at] * irradiance[at];
            moved[b] += node->area * fabs(sent - radiosity[at]);
            power[b] += node->area * sent;
            radiosity[at] = sent;
        }
    }
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        if (power[b] > 0)
            most = fmax(most, moved[b] / power[b]);
    return most;
}

void cluster_light_pull(ClusterLight *l, const double *radiosity)
{
    const ClusterTree *tree = l->links->tree;
    for (uint32_t n = tree->count; n-- > 0;) {
        const ClusterNode *node = &tree->node[n];
        double *out = &l->sent[(size_t)n * ROOM_BANDS];
        if (node->child == 0) {
            memcpy(out, &radiosity[(size_t)tree->patch[node->begin] * ROOM_BANDS],
                   ROOM_BANDS * sizeof *out);
            l->uneven[n] = 0;
            continue;
        }
        const ClusterNode *c = &tree->node[node->child];
        const double first = node->area > 0 ? c[0].area / node->area : 0, second = 1 - first;
        const double *from = &l->sent[(size_t)node->child * ROOM_BANDS];
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            out[b] = first * from[b] + second * from[ROOM_BANDS + b];
        const double apart = luminance(from) - luminance(from + ROOM_BANDS);
        l->uneven[n] = first * l->uneven[node->child] + second * l->uneven[node->child + 1] +
                       first * second * apart * apart;
    }
}

void cluster_light_escaped(const ClusterLight *l, const double *radiosity,
                           double escaped[ROOM_BANDS])
{
    const ClusterTree *tree = l->links->tree;
    memset(escaped, 0, ROOM_BANDS * sizeof *escaped);
    for (uint32_t n = 0; n < tree->count; n++) {
        const ClusterNode *node = &tree->node[n];
        if (node->child != 0)
            continue;
        const double loose = looseness_of(l->escape[n], l->escape_looseness[n]);
        const double share = l->escape[n] * (1 + l->fill[node->begin] * loose) *
                             l->scale[node->begin];
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            escaped[b] += node->area * share *
                          radiosity[(size_t)tree->patch[node->begin] * ROOM_BANDS + b];
    }
}

/* --- importance ------------------------------------------------------------------------------- */

/* What is asked of each node: sums over its leaves of rho * importance, and of that times what
 * their rows are filled with. */
static void ask(ClusterLight *l, unsigned b, double *plain, double *filled)
{
    const ClusterTree *tree = l->links->tree;
    for (uint32_t n = tree->count; n-- > 0;) {
        const ClusterNode *node = &tree->node[n];
        const uint32_t c = node->child;
        if (c != 0) {
            plain[n] = plain[c] + plain[c + 1];
            filled[n] = filled[c] + filled[c + 1];
            continue;
        }
        const size_t at = (size_t)tree->patch[node->begin] * ROOM_BANDS + b;
        plain[n] = l->problem->reflectance[at] * l->scale[node->begin] *
                   l->meaning[(size_t)n * ROOM_BANDS + b];
        filled[n] = l->fill[node->begin] * plain[n];
    }
}

/* One step of a band; returns what it moved, of all there is. */
static double spread_meaning(ClusterLight *l, const double *seen, unsigned b, double *plain,
                             double *filled, double *back)
{
    const ClusterTree *tree = l->links->tree;
    double moved = 0, all = 0;
    ask(l, b, plain, filled);
    memset(back, 0, tree->count * sizeof *back);
    for (size_t k = 0; k < l->links->count; k++) {
        const ClusterLink *link = &l->links->link[k];
        back[link->from] += link->factor * (plain[link->to] + looseness(link) * filled[link->to]);
    }
    for (uint32_t n = 0; n < tree->count; n++) {
        const ClusterNode *node = &tree->node[n];
        for (uint32_t c = node->child; c < node->child + 2 && c > 0; c++)
            back[c] += back[n] * tree->node[c].area / node->area;
        if (node->child != 0)
            continue;
        double *here = &l->meaning[(size_t)n * ROOM_BANDS + b];
        const double now = seen[tree->patch[node->begin]] + back[n];
        moved += fabs(now - *here);
        all += fabs(now);
        *here = now;
    }
    return all > 0 ? moved / all : 0;
}

void cluster_light_meaning(ClusterLight *l, const double *seen, uint32_t sweeps)
{
    /* The irradiance of nodes is not needed meanwhile. */
    const ClusterTree *tree = l->links->tree;
    double *scratch = (double *)l->here;
    assert(sizeof *l->here >= 3 * sizeof *scratch && l->meaning != NULL);
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        for (uint32_t k = 0; k < sweeps; k++)
            if (spread_meaning(l, seen, b, scratch, scratch + tree->count,
                               scratch + 2 * (size_t)tree->count) < LEAST_MOVED)
                break;
    for (uint32_t n = tree->count; n-- > 0;) {
        const uint32_t c = tree->node[n].child;
        for (unsigned b = 0; b < ROOM_BANDS && c != 0; b++)
            l->meaning[(size_t)n * ROOM_BANDS + b] = l->meaning[(size_t)c * ROOM_BANDS + b] +
                                                     l->meaning[((size_t)c + 1) * ROOM_BANDS + b];
    }
}

/* --- memory ----------------------------------------------------------------------------------- */

bool cluster_light_create(ClusterLight *light, const ClusterLinks *links,
                          const SolveProblem *problem, bool importance, Error *err)
{
    static const char what[] = "light of clusters";
    const size_t nodes = links->tree->count;
    *light = (ClusterLight){ .links = links, .problem = problem };
    light->sent = array_create(nodes * ROOM_BANDS, sizeof *light->sent, what, err);
    light->uneven = array_create(nodes, sizeof *light->uneven, what, err);
    light->here = array_create(nodes, sizeof *light->here, what, err);
    light->escape = array_create(nodes, sizeof *light->escape, what, err);
    light->escape_looseness = array_create(nodes, sizeof *light->escape_looseness, what, err);
    light->fill = array_create(links->tree->leaves, sizeof *light->fill, what, err);
    light->scale = array_create(links->tree->leaves, sizeof *light->scale, what, err);
    if (importance)
        light->meaning = array_create(nodes * ROOM_BANDS, sizeof *light->meaning, what, err);
    if (!error_is_set(err))
        find_escapes(light);
    return !error_is_set(err);
}

void cluster_light_clear(ClusterLight *light)
{
    array_free(light->sent);
    array_free(light->uneven);
    array_free(light->here);
    array_free(light->escape);
    array_free(light->escape_looseness);
    array_free(light->fill);
    array_free(light->scale);
    array_free(light->meaning);
    *light = (ClusterLight){ .links = NULL };
}
