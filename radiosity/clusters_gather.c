/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_gather.c -- the last reflection: what clusters send, gathered by each patch
 * over a row of factors of its own [reichert92], which is cast, used and dropped. It gives light
 * its detail back and forgives most of what links have wrong. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/clusters_internal.h"

enum { HALVES = CLUSTER_HALVES };

/* Share of the mean weight, by number or area, that a patch gathers at least: more than importance
 * leaves to all by their areas. */
static const double LEAST_WEIGHT = 0.1;

typedef struct {
    const ClusterLinks *links;
    const double *radiosity; /* [patches * ROOM_BANDS]  what is gathered */
    uint32_t      seed;
    LampTable     lamps;
    uint32_t     *patch;     /* [patches]  those that gather */
    uint32_t      patches;
    RowTile      *tile;      /* [threads] */
    double       *came[HALVES]; /* [patches * ROOM_BANDS]  irradiance */
    float        *escape;    /* [patches]  of both rows, their sum */
    atomic_uint  *done;      /* [chunks]  rays it took, once it is finished */
} LastGather;

static uint32_t chunk_count(uint32_t patches)
{
    return patches / CLUSTER_GATHER_CHUNK + (patches % CLUSTER_GATHER_CHUNK > 0);
}

/* A row made whole: what is known of lamps stays, all else fills what is left. Where nothing else
 * is there, or where lamps take up more than there is, it is they who fill it. */
static void gather_row(const LastGather *last, const RowCast *row, double *out)
{
    double known = 0, others = 0;
    for (uint32_t k = 0; k < row->links; k++)
        *(last->lamps.probability[row->source[k]] > 0 ? &known : &others) += row->form_factor[k];
    const double whole = fmax(0, 1 - row->escape);
    const double lamps = known > 0 && (others <= 0 || known > whole) ? whole / known : 1;
    const double fill = others > 0 ? fmax(0, whole - known) / others : 0;
    for (uint32_t k = 0; k < row->links; k++) {
        const uint32_t j = row->source[k];
        const double f = row->form_factor[k] * (last->lamps.probability[j] > 0 ? lamps : fill);
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            out[b] += f * last->radiosity[(size_t)j * ROOM_BANDS + b];
    }
}

static void gather_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const LastGather *last = context;
    const ClusterLinks *links = last->links;
    const Room *room = links->shooter.room;
    RowTile *tile = &last->tile[worker];
    atomic_uint *done = &last->done[begin / CLUSTER_GATHER_CHUNK];
    const uint64_t before = tile->cast;
    if (atomic_load_explicit(done, memory_order_relaxed) > 0)
        return; /* by an earlier run */
    for (uint32_t first = begin; first < end; first += tile->most) {
        const uint32_t count = end - first < tile->most ? end - first : tile->most;
        const uint32_t *patch = &last->patch[first];
        for (unsigned half = 0; half < HALVES; half++) {
            for (uint32_t k = 0; k < count; k++)
                tile->row[k].begin = half * tile->all.rays;
            row_tile_cast(tile, room, &last->lamps, patch, count, last->seed);
            for (uint32_t k = 0; k < count; k++) {
                const RowCast *row = row_tile_row(tile, room, &last->lamps, k);
                gather_row(last, row, &last->came[half][(size_t)patch[k] * ROOM_BANDS]);
                last->escape[patch[k]] += (float)row->escape;
            }
        }
    }
    const uint64_t cast = tile->cast - before;
    atomic_store_explicit(done, cast > 0 ? (unsigned)cast : 1, memory_order_release);
}

static double luminance(const double *v)
{
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

/* Noise of single patches evened out over those around them, as the stochastic solver does. */
static bool even_out(LastGather *last, ClustersReport *report, Error *err)
{
    const ClusterLinks *links = last->links;
    const double *area = links->shooter.places->links->area;
    const size_t n = (size_t)links->shooter.room->patches->count * ROOM_BANDS;
    EvenTree tree;
    if (!even_tree_create(links->shooter.room, area, links->threads, &tree, err))
        return false;
    for (unsigned half = 0; half < HALVES; half++)
        for (size_t k = 0; k < n; k++)
            last->came[half][k] *= area[k / ROOM_BANDS];
    report->groups = even_tree_fit(&tree, area, last->came);
    for (unsigned half = 0; half < HALVES; half++)
        for (size_t k = 0; k < n; k++)
            last->came[half][k] = area[k / ROOM_BANDS] > 0
                                      ? last->came[half][k] / area[k / ROOM_BANDS] : 0;
    even_tree_clear(&tree);
    return true;
}

/* By what must be multiplied what patches gathered, for all power to be absorbed or to escape;
 * escaped gets the latter. */
static double balance(const LastGather *last, const SolveProblem *p, unsigned band,
                      double *escaped)
{
    assert(band < ROOM_BANDS);
    const ClusterTree *tree = last->links->tree;
    double lost = 0, sent = 0, gone = 0;
    *escaped = 0;
    for (uint32_t k = 0; k < tree->leaves; k++) {
        const double area = tree->before[k + 1] - tree->before[k];
        const size_t at = (size_t)tree->patch[k] * ROOM_BANDS + band;
        const double rho = p->reflectance[at], open = last->escape[tree->patch[k]] / HALVES;
        const double outside = p->received != NULL ? p->received[at] : 0;
        const double came = (last->came[0][at] + last->came[1][at]) / HALVES;
        const double own = p->emission[at] + rho * outside; /* sent but for what was gathered */
        sent += area * (p->emission[at] + rho * outside);
        gone += area * open * own;
        lost += area * came * (1 - rho + rho * open);
        *escaped += area * open * rho * came;
    }
    const double scale = lost > 0 ? (sent - gone) / lost : 1;
    *escaped = gone + scale * *escaped;
    return scale;
}

/* The mean of both halves; returns its standard error, over areas and relative to the mean. */
static double take(const LastGather *last, const SolveProblem *p, Solution *solution,
                   ClustersReport *report)
{
    const ClusterTree *tree = last->links->tree;
    double noise = 0, sum = 0;
    for (unsigned b = 0; b < ROOM_BANDS; b++)
        report->scale[b] = balance(last, p, b, &report->escaped[b]);
    for (uint32_t k = 0; k < tree->leaves; k++) {
        const double area = tree->before[k + 1] - tree->before[k];
        const size_t first = (size_t)tree->patch[k] * ROOM_BANDS;
        for (size_t at = first; at < first + ROOM_BANDS; at++) {
            const double outside = p->received != NULL ? p->received[at] : 0;
            const double came = (last->came[0][at] + last->came[1][at]) / HALVES;
            solution->irradiance[at] = outside + report->scale[at % ROOM_BANDS] * came;
            solution->radiosity[at] = p->emission[at] +
                                      p->reflectance[at] * solution->irradiance[at];
        }
        const double apart = (luminance(&last->came[0][first]) -
                              luminance(&last->came[1][first])) / HALVES;
        noise += area * apart * apart;
        sum += area * luminance(&solution->irradiance[first]);
    }
    return sum > 0 ? sqrt(noise * tree->before[tree->leaves]) / sum : 0;
}

/* Chooses who gathers; the others have their irradiance already. With importance there are patches
 * that next to nothing of what is seen comes from. */
static void choose(LastGather *last, const double *weight, const SolveProblem *p,
                   const Solution *solution)
{
    const ClusterTree *tree = last->links->tree;
    const Links *places = last->links->shooter.places->links;
    const double least = LEAST_WEIGHT / tree->leaves;
    for (uint32_t n = 0; n < tree->count; n++) {
        const uint32_t patch = tree->patch[tree->node[n].begin];
        if (tree->node[n].child != 0)
            continue;
        if (weight[n] >= fmin(least, LEAST_WEIGHT * tree->node[n].area / tree->node[0].area)) {
            last->patch[last->patches++] = patch;
            continue;
        }
        last->escape[patch] = HALVES * places->escape[patch];
        for (size_t at = (size_t)patch * ROOM_BANDS; at < ((size_t)patch + 1) * ROOM_BANDS; at++)
            for (unsigned half = 0; half < HALVES; half++)
                last->came[half][at] = solution->irradiance[at] -
                                       (p->received != NULL ? p->received[at] : 0);
    }
}

static bool create(LastGather *last, const ClustersOptions *options, Error *err)
{
    static const char what[] = "the last reflection";
    const ClusterLinks *links = last->links;
    const Room *room = links->shooter.room;
    const size_t n = (size_t)room->patches->count * ROOM_BANDS;
    const uint32_t rays = (options->gather + HALVES - 1) / HALVES;
    if (!lamp_table_create(room, &last->lamps, err))
        return false;
    const uint32_t sights = last->lamps.count > 0 ? (options->sights + HALVES - 1) / HALVES : 0;
    last->patch = array_create(room->patches->count, sizeof *last->patch, what, err);
    last->escape = array_create(room->patches->count, sizeof *last->escape, what, err);
    last->tile = array_create(links->threads, sizeof *last->tile, what, err);
    last->done = array_create(chunk_count(room->patches->count), sizeof *last->done, what, err);
    for (unsigned k = 0; k < HALVES; k++)
        last->came[k] = array_create(n, sizeof *last->came[k], what, err);
    for (unsigned k = 0; k < links->threads && !error_is_set(err); k++)
        row_tile_create(&last->tile[k], rays, sights, err);
    return !error_is_set(err);
}

/* Gathers, and keeps what is finished where that is wanted; false: it was stopped, or failed. */
static bool gather_all(LastGather *last, ClustersKept *kept, const Monitor *monitor, double left,
                       ClustersReport *report, Error *err)
{
    const Progress progress = { .stage = "solve", .energy_left = left };
    const ClustersGathered gathered = { { last->came[0], last->came[1] }, last->escape,
                                        last->patch, last->patches, last->done };
    if (kept != NULL && !clusters_kept_gather(kept, &gathered, err))
        return false;
    const bool all = parallel_for(last->patches, CLUSTER_GATHER_CHUNK, last->links->threads,
                                  gather_chunk, last, monitor, &progress);
    clusters_kept_gathered(kept);
    for (uint32_t k = 0; k < chunk_count(last->patches); k++)
        report->gather_rays += atomic_load_explicit(&last->done[k], memory_order_relaxed);
    return all;
}

bool clusters_gather(const ClusterLinks *links, const SolveProblem *problem,
                     const ClustersOptions *options, const double *weight, Solution *solution,
                     ClustersReport *report, const Monitor *monitor, Error *err)
{
    assert(options->gather > 0 && solution->count == links->shooter.room->patches->count);
    LastGather last = { .links = links, .radiosity = solution->radiosity, .seed = options->seed };
    if (create(&last, options, err)) {
        choose(&last, weight, problem, solution);
        report->gathered_patches = last.patches;
        report->gathered = gather_all(&last, options->kept, monitor, solution->unshot, report,
                                      err);
        if (report->gathered && even_out(&last, report, err))
            report->noise = take(&last, problem, solution, report);
    }
    for (unsigned k = 0; k < links->threads && last.tile != NULL; k++)
        row_tile_clear(&last.tile[k]);
    array_free(last.tile);
    for (unsigned k = 0; k < HALVES; k++)
        array_free(last.came[k]);
    array_free(last.patch);
    array_free(last.escape);
    array_free(last.done);
    lamp_table_clear(&last.lamps);
    return !error_is_set(err);
}
