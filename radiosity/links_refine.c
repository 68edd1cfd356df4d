/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_refine.c -- links after some patches were divided: only the parts' rows are cast.
 *
 * A row of an undivided patch i knows what it sends to a patch that was divided, and has to share
 * it among the parts. The parts' own rows say how much each sees of i: by reciprocity F_ic is in
 * proportion to A_c F_ci. Where their rays all missed i, rays between i and each of the parts tell,
 * and where none of these gets through either, row i is cast anew: light never goes to a part that
 * was not seen from i.
 */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/internal.h"

/* Rays from an undivided patch to each part that its rays have to be shared among. */
enum { PART_RAYS = 4 };

typedef struct {
    RowMaker        maker;
    const Links    *old;
    const Links    *fresh;   /* rows of parts; all others are empty */
    const uint32_t *parent;
    uint32_t       *first;   /* [old->count + 1]  first part of an old patch */
} Refining;

static bool is_divided(const Refining *r, uint32_t old)
{
    return r->first[old + 1] - r->first[old] > 1;
}

static void cast_parts(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Refining *r = context;
    uint32_t row[MAKER_CHUNK], rows = 0;
    if (row_maker_has(&r->maker, begin) || error_is_set(&r->maker.buffer[worker].error))
        return;
    for (uint32_t i = begin; i < end; i++)
        if (is_divided(r, r->parent[i]))
            row[rows++] = i;
        else
            row_maker_end(&r->maker, worker, i, 0, 0); /* empty, so its place does not matter */
    row_maker_cast(&r->maker, row, rows, worker);
    row_maker_keep(&r->maker, begin, worker);
}

static double factor_between(const Links *links, uint32_t from, uint32_t to)
{
    uint64_t low = links->first[from], high = links->first[from + 1];
    const uint64_t end = high;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (links->source[middle] < to)
            low = middle + 1;
        else
            high = middle;
    }
    return low < end && links->source[low] == to ? links->form_factor[low] : 0;
}

/* cos cos / (pi d^2) between points of two patches by a few rays, times the weights of the points;
 * 0 when none gets through. */
static double sight(Refining *r, uint32_t from, uint32_t to, unsigned worker)
{
    const Room *room = r->maker.room;
    const uint32_t seed = sampling_seed(r->maker.seed, room_patch_key(room, from),
                                        room_patch_key(room, to), SEED_PARTS);
    double sum = 0;
    for (uint32_t k = 0; k < PART_RAYS; k++) {
        PatchPoint p, q;
        float x[4];
        sampling_sobol4(k, seed, x);
        patches_point(room->patches, room->surfaces, from, x[0], x[1], &p);
        patches_point(room->patches, room->surfaces, to, x[2], x[3], &q);
        const Vec3 way = vec3_sub(q.point.point, p.point.point);
        const double square = vec3_dot(way, way);
        const double here = vec3_dot(way, p.point.normal), there = -vec3_dot(way, q.point.normal);
        if (!(here > 0 && there > 0 && sqrt(square) > 2 * room->offset))
            continue;
        const Ray ray = ray_between(p.point.point, p.point.normal, q.point.point, q.point.normal,
                                    room->offset);
        r->maker.tile[worker].cast++;
        if (!bvh_blocked(room->bvh, &ray))
            sum += here * there / (M_PI * square * square) * p.weight * q.weight;
    }
    return sum / PART_RAYS;
}

/* Weights of the parts of old patch p as seen from new patch i, into the thread's row; returns
 * their sum. */
static double add_parts(Refining *r, uint32_t i, uint32_t p, bool by_sight, unsigned worker)
{
    double sum = 0;
    for (uint32_t c = r->first[p]; c < r->first[p + 1]; c++) {
        const double seen = by_sight ? sight(r, i, c, worker) : factor_between(r->fresh, c, i);
        const float weight = (float)(r->fresh->area[c] * seen);
        row_maker_add(&r->maker, worker, c, weight);
        sum += (double)weight;
    }
    return sum;
}

/* Adds the links to the parts of p, which share `factor`; false when nothing tells how. */
static bool share_factor(Refining *r, uint32_t i, uint32_t p, float factor, unsigned worker)
{
    RowBuffer *b = &r->maker.buffer[worker];
    const uint64_t begin = b->links;
    double sum = add_parts(r, i, p, false, worker);
    if (!(sum > 0)) {
        b->links = begin;
        sum = add_parts(r, i, p, true, worker);
    }
    uint64_t kept = begin;
    for (uint64_t k = begin; k < b->links; k++) {
        const float part = (float)(factor * (b->form_factor[k] / sum));
        if (!(part > 0))
            continue;
        b->source[kept] = b->source[k];
        b->form_factor[kept++] = fminf(part, 1);
    }
    b->links = kept;
    return sum > 0;
}

static void share_row(Refining *r, uint32_t i, unsigned worker)
{
    const Links *old = r->old;
    const uint32_t o = r->parent[i];
    RowBuffer *b = &r->maker.buffer[worker];
    for (uint64_t k = old->first[o]; k < old->first[o + 1]; k++) {
        const uint32_t p = old->source[k];
        if (!is_divided(r, p)) {
            row_maker_add(&r->maker, worker, r->first[p], old->form_factor[k]);
        } else if (!share_factor(r, i, p, old->form_factor[k], worker)) {
            b->links = b->row;
            row_maker_cast(&r->maker, &i, 1, worker);
            return;
        }
    }
    row_maker_end(&r->maker, worker, i, old->escape[o], old->area[o]);
}

static void refine_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Refining *r = context;
    const Links *fresh = r->fresh;
    for (uint32_t i = begin; i < end; i++) {
        if (!is_divided(r, r->parent[i])) {
            share_row(r, i, worker);
            continue;
        }
        for (uint64_t k = fresh->first[i]; k < fresh->first[i + 1]; k++)
            row_maker_add(&r->maker, worker, fresh->source[k], fresh->form_factor[k]);
        row_maker_end(&r->maker, worker, i, fresh->escape[i], fresh->area[i]);
    }
    row_maker_keep(&r->maker, begin, worker);
    /* Rows from anywhere were looked into. */
    links_leave(fresh, 0, fresh->count);
    links_leave(r->old, 0, r->old->count);
}

/* First part of each old patch, and how many are new. */
static uint32_t find_parts(Refining *r, uint32_t count)
{
    uint32_t parts = 0;
    for (uint32_t i = 0; i < count; i++) {
        assert(r->parent[i] < r->old->count && (i == 0 || r->parent[i - 1] <= r->parent[i]));
        r->first[r->parent[i] + 1] = i + 1;
    }
    for (uint32_t p = 0; p < r->old->count; p++) {
        const uint32_t n = r->first[p + 1] - r->first[p];
        assert(r->first[p + 1] > r->first[p]);
        parts += n > 1 ? n : 0;
    }
    return parts;
}

/* The rows cast, those kept and what both make, each link in eight bytes; of a row that is kept,
 * each link to a divided patch may become as many as it has parts. */
static bool fits(Refining *r, uint32_t parts, const LinksOptions *options, Error *err)
{
    const Links *old = r->old;
    const double per_link = sizeof *old->source + sizeof *old->form_factor;
    const double per_row = old->count > 0 ? (double)old->first[old->count] / old->count : 0;
    double links = 3.0 * parts * per_row;
    if (options->max_bytes == 0)
        return true;
    for (uint32_t o = 0; o < old->count; o++)
        for (uint64_t k = old->first[o]; !is_divided(r, o) && k < old->first[o + 1]; k++)
            links += 2.0 * (r->first[old->source[k] + 1] - r->first[old->source[k]]);
    return links_choose_folder(links * per_link, r->maker.count, options, &r->maker.folder, err);
}

/* Both steps on all threads; *fresh is the caller's. */
static Links *run(Refining *r, Links **fresh, const Monitor *monitor, Error *err)
{
    RowMaker *m = &r->maker;
    uint64_t rows = 0;
    for (uint32_t i = 0; i < m->count; i++)
        rows += is_divided(r, r->parent[i]);
    const Progress cast = { .stage = "factors", .done = 1, .energy_left = -1,
                            .rays = rows * row_maker_rays(m) };
    if (!parallel_for(m->count, MAKER_CHUNK, m->threads, cast_parts, r, monitor, &cast)) {
        error_set(err, ERROR_STOPPED, "stopped while casting form factors");
        return NULL;
    }
    r->fresh = *fresh = row_maker_gather(m, err);
    if (*fresh == NULL)
        return NULL;
    if (!parallel_for(m->count, MAKER_CHUNK, m->threads, refine_chunk, r, monitor, NULL)) {
        error_set(err, ERROR_STOPPED, "stopped while sharing form factors among parts");
        return NULL;
    }
    Links *links = row_maker_gather(m, err);
    if (links != NULL) {
        links->rays += r->old->rays;
        links->clamped += r->old->clamped;
        links->seconds += r->old->seconds;
    }
    return links;
}

Links *links_refine(const Links *old, const Room *room, const uint32_t *parent,
                    const LinksOptions *options, const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(old != NULL && room != NULL && parent != NULL && options != NULL);
    Refining r = { .old = old, .parent = parent };
    Links *links = NULL, *fresh = NULL;
    r.first = array_create((size_t)old->count + 1, sizeof *r.first, "parts of patches", err);
    if (r.first != NULL) {
        const uint32_t parts = find_parts(&r, room->patches->count);
        if (row_maker_create(&r.maker, room, options, err) && fits(&r, parts, options, err))
            links = run(&r, &fresh, monitor, err);
        row_maker_clear(&r.maker);
    }
    links_destroy(fresh);
    array_free(r.first);
    return links;
}
