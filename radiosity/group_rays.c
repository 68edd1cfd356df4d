/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_rays.c -- hemisphere rays of whole classes, scrambling by scrambling: for pairs
 * of sides that nothing better is known for, and for what escapes. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/group_internal.h"

/* Patches whose sums are kept before they are added up in order. */
enum { WAVE = 256, CHUNK = 4 };

/* Share of one patch and scrambling that arrived at a class; class ESCAPED: nowhere. */
typedef struct {
    uint32_t scramble, class;
    double   share;
} Arrival;

#define ESCAPED UINT32_MAX

/* What one patch sent. */
typedef struct {
    Arrival *arrival;
    size_t   count, capacity;
    double   seen[GROUP_SCRAMBLES]; /* visible area */
    uint64_t cast;
} Sent;

typedef struct {
    Grouping *g;
    uint32_t *patch;   /* [count]  of classes to be cast again */
    uint32_t  count, first; /* first of the wave */
    RowTile  *tile;    /* [threads] */
    double   *dense;   /* [threads * classes] */
    uint32_t  begin, rays; /* points of the nets to be cast; the tiles are made for `rays` */
    Sent      sent[WAVE];
    Error    *error;   /* [threads] */
} Wave;

static bool by_rays(const Grouping *g, uint32_t from, unsigned from_side, const RayEnd *end)
{
    if (g->kind == NULL)
        return true;
    const uint32_t to_side = g->room->patches->side[end->patch];
    const size_t i = g->side_of[2 * (size_t)from + from_side];
    const size_t j = g->side_of[2 * (size_t)end->surface + to_side];
    const size_t a = i < j ? i : j, b = i < j ? j : i;
    return g->kind[a * g->sides + b] == GROUP_RAYS;
}

static bool keep(Wave *w, Sent *sent, Arrival arrival, unsigned worker)
{
    if (!array_reserve((void **)&sent->arrival, &sent->capacity, sent->count + 1,
                       sizeof *sent->arrival, "rays between groups", &w->error[worker]))
        return false;
    sent->arrival[sent->count++] = arrival;
    return true;
}

/* Adds up where the rays of one scrambling went. */
static void count_row(Wave *w, const RowCast *row, uint32_t patch, uint32_t scramble, Sent *sent,
                      unsigned worker)
{
    const Grouping *g = w->g;
    const Patches *patches = g->room->patches;
    double *dense = &w->dense[(size_t)worker * g->options->count];
    double weights = 0, all = 0, escaped = 0;
    for (uint32_t p = 0; p < row->positions; p++) {
        all += row->position[p].weight;
        weights += row->position[p].good > 0 ? row->position[p].weight : 0;
    }
    const double seen = all > 0 ? patches->area[patch] * weights / all : 0;
    sent->seen[scramble] = seen;
    if (!(seen > 0))
        return;
    memset(dense, 0, g->options->count * sizeof *dense);
    for (uint32_t k = 0; k < row->rays; k++) {
        const CastPosition *p = &row->position[row->cell[k]];
        const RayEnd *end = &row->end[k];
        if (p->good == 0 || (end->patch == PATCH_NONE && !end->escaped))
            continue;
        const double share = seen * row->weight[k] / p->good_weight * p->weight / weights;
        if (end->escaped)
            escaped += share;
        else if (by_rays(g, row->start[k], patches->side[patch], end))
            dense[g->options->patch_class[end->patch]] += share;
    }
    for (uint32_t c = 0; c < g->options->count; c++)
        if (dense[c] > 0)
            keep(w, sent, (Arrival){ scramble, c, dense[c] }, worker);
    if (escaped > 0)
        keep(w, sent, (Arrival){ scramble, ESCAPED, escaped }, worker);
}

/* All scramblings of one patch, as many together as a tile takes. */
static void cast_patch(Wave *w, uint32_t patch, Sent *sent, unsigned worker)
{
    const Grouping *g = w->g;
    RowTile *tile = &w->tile[worker];
    sent->count = 0;
    for (uint32_t r = 0; r < GROUP_SCRAMBLES;) {
        const uint32_t left = GROUP_SCRAMBLES - r, n = left < tile->most ? left : tile->most;
        for (uint32_t k = 0; k < n; k++) {
            tile->row[k].begin = w->begin;
            row_cast_rays(&tile->row[k], g->room, patch,
                          sampling_seed(g->options->seed, SEED_GROUPS, r + k, 0));
        }
        bvh_nearest_many(g->room->bvh, tile->all.ray, tile->all.hit, (size_t)n * w->rays);
        for (uint32_t k = 0; k < n; k++) {
            row_cast_judge(&tile->row[k], g->room);
            count_row(w, &tile->row[k], patch, r + k, sent, worker);
        }
        r += n;
    }
    sent->cast = (uint64_t)w->rays * GROUP_SCRAMBLES;
}

static void cast_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Wave *w = context;
    for (uint32_t k = begin; k < end; k++)
        cast_patch(w, w->patch[w->first + k], &w->sent[k], worker);
}

static void add_wave(Wave *w, uint32_t count)
{
    Grouping *g = w->g;
    const size_t n = g->options->count;
    const double part = w->begin > 0 ? 0.5 : 1;
    for (uint32_t k = 0; k < count; k++) {
        const Sent *sent = &w->sent[k];
        const uint32_t class = g->options->patch_class[w->patch[w->first + k]];
        g->cast[class] += sent->cast;
        g->out->rays += sent->cast;
        for (size_t a = 0; a < sent->count; a++) {
            const Arrival *arrival = &sent->arrival[a];
            const size_t r = arrival->scramble;
            if (arrival->class == ESCAPED)
                g->away[r * n + class] += part * arrival->share;
            else
                g->sum[(r * n + class) * n + arrival->class] += part * arrival->share;
        }
        for (size_t r = 0; r < GROUP_SCRAMBLES; r++)
            g->seen[r * n + class] += part * sent->seen[r];
    }
}

/* What has been cast counts half from now on: the nets' points from n to 2 n - 1 are as many again,
 * spread as evenly, and both together are the nets' first 2 n. */
static void halve(Grouping *g, uint32_t class)
{
    const size_t n = g->options->count;
    for (size_t r = 0; r < GROUP_SCRAMBLES; r++) {
        for (size_t b = 0; b < n; b++)
            g->sum[(r * n + class) * n + b] /= 2;
        g->away[r * n + class] /= 2;
        g->seen[r * n + class] /= 2;
    }
}

/* Patches of classes that want `rays` in all, in order. */
static void list_patches(Wave *w, uint32_t rays)
{
    const Grouping *g = w->g;
    w->count = 0;
    for (uint32_t i = 0; i < g->room->patches->count; i++) {
        const uint32_t class = g->options->patch_class[i];
        if (g->again[class] != 0 && g->rays[class] == rays)
            w->patch[w->count++] = i;
    }
}

/* Casts all classes that want the same number of rays. */
static bool cast_like(Wave *w, uint32_t rays, Error *err)
{
    Grouping *g = w->g;
    list_patches(w, rays);
    w->begin = rays > GROUP_RAYS_FIRST ? rays / 2 : 0;
    w->rays = rays - w->begin;
    for (unsigned k = 0; k < g->threads; k++)
        row_tile_create(&w->tile[k], w->rays, 0, err);
    bool done = !error_is_set(err);
    for (w->first = 0; done && w->first < w->count; w->first += WAVE) {
        const uint32_t left = w->count - w->first, n = left < WAVE ? left : WAVE;
        if (!parallel_for(n, CHUNK, g->threads, cast_chunk, w, g->monitor, NULL))
            done = error_set(err, ERROR_STOPPED, "stopped while casting rays between groups");
        for (unsigned k = 0; done && k < g->threads; k++)
            if (error_is_set(&w->error[k])) {
                *err = w->error[k];
                done = false;
            }
        if (done)
            add_wave(w, n);
    }
    for (unsigned k = 0; k < g->threads; k++)
        row_tile_clear(&w->tile[k]);
    return done;
}

static uint32_t next_rays(const Grouping *g, uint32_t above)
{
    uint32_t least = UINT32_MAX;
    for (uint32_t c = 0; c < g->options->count; c++)
        if (g->again[c] != 0 && g->rays[c] > above && g->rays[c] < least)
            least = g->rays[c];
    return least;
}

bool group_rays_run(Grouping *g, Error *err)
{
    static const char what[] = "rays between groups";
    Wave *w = array_create(1, sizeof *w, what, err);
    if (w == NULL)
        return false;
    w->g = g;
    w->patch = array_create(g->room->patches->count, sizeof *w->patch, what, err);
    w->tile = array_create(g->threads, sizeof *w->tile, what, err);
    w->error = array_create(g->threads, sizeof *w->error, what, err);
    w->dense = array_create((size_t)g->threads * g->options->count, sizeof *w->dense, what, err);
    bool done = !error_is_set(err);
    for (uint32_t c = 0; done && c < g->options->count; c++)
        if (g->again[c] != 0)
            halve(g, c);
    for (uint32_t rays = next_rays(g, 0); done && rays != UINT32_MAX; rays = next_rays(g, rays)) {
        done = cast_like(w, rays, err);
    }
    for (int k = 0; k < WAVE; k++)
        array_free(w->sent[k].arrival);
    array_free(w->patch);
    array_free(w->tile);
    array_free(w->error);
    array_free(w->dense);
    array_free(w);
    return done;
}
