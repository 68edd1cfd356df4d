/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links.c -- all rows of form factors: cast in parallel, gathered in order. */
#include "radiosity/links.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"

static const uint32_t DEFAULT_RAYS = 256;

/* Patches a thread takes at a time: some 10^4 rays, a few milliseconds. */
enum { PATCH_CHUNK = 64 };

/* Rows cast beforehand to learn how many links a row has, when memory is limited; spread evenly,
 * and the tenth that is added to what they say covers their chance. */
enum { PILOT_ROWS = 256 };
static const double PILOT_MARGIN = 1.1;

/* Rows of one chunk, packed one after the other. */
typedef struct {
    uint32_t *source;
    float    *form_factor;
    uint64_t  links;
} RowChunk;

typedef struct {
    const Room *room;
    LampTable   lamps;
    uint32_t    seed;
    unsigned    threads;
    RowCast    *row;       /* [threads] */
    Error      *error;     /* [threads] */
    uint32_t  **source;    /* [threads]  room for the links of a chunk */
    float     **form_factor;
    RowChunk   *chunk;     /* [chunks] */
    uint32_t    chunks, count;
    uint32_t   *length;    /* [count]  links in the row */
    float      *escape;    /* [count] */
    double     *area;      /* [count] */
} Casting;

static void cast_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Casting *c = context;
    RowCast *row = &c->row[worker];
    RowChunk *chunk = &c->chunk[begin / PATCH_CHUNK];
    uint64_t links = 0;
    for (uint32_t i = begin; i < end; i++) {
        row_cast_run(row, c->room, &c->lamps, i, c->seed);
        memcpy(&c->source[worker][links], row->source, row->links * sizeof *row->source);
        memcpy(&c->form_factor[worker][links], row->form_factor,
               row->links * sizeof *row->form_factor);
        links += row->links;
        c->length[i] = row->links;
        c->escape[i] = (float)row->escape;
        c->area[i] = row->area;
    }
    Error *err = &c->error[worker];
    chunk->source = array_create(links, sizeof *chunk->source, "form factors", err);
    chunk->form_factor = array_create(links, sizeof *chunk->form_factor, "form factors", err);
    if (error_is_set(err))
        return;
    chunk->links = links;
    memcpy(chunk->source, c->source[worker], links * sizeof *chunk->source);
    memcpy(chunk->form_factor, c->form_factor[worker], links * sizeof *chunk->form_factor);
}

static bool casting_init(Casting *c, const Room *room, const LinksOptions *options, Error *err)
{
    static const char what[] = "the casting of form factors";
    const uint32_t rays = options->rays > 0 ? options->rays : DEFAULT_RAYS;
    const uint32_t lamp_rays = options->lamp_rays > 0 ? options->lamp_rays : (rays + 3) / 4;
    *c = (Casting){ .room = room, .seed = options->seed, .count = room->patches->count,
                    .threads = parallel_threads(options->threads) };
    c->chunks = (c->count + PATCH_CHUNK - 1) / PATCH_CHUNK;
    c->row = array_create(c->threads, sizeof *c->row, what, err);
    c->error = array_create(c->threads, sizeof *c->error, what, err);
    c->source = array_create(c->threads, sizeof *c->source, what, err);
    c->form_factor = array_create(c->threads, sizeof *c->form_factor, what, err);
    c->chunk = array_create(c->chunks, sizeof *c->chunk, what, err);
    c->length = array_create(c->count, sizeof *c->length, what, err);
    c->escape = array_create(c->count, sizeof *c->escape, what, err);
    c->area = array_create(c->count, sizeof *c->area, what, err);
    if (error_is_set(err) || !lamp_table_create(room, &c->lamps, err))
        return false;
    const uint32_t from_lamps = c->lamps.count > 0 ? lamp_rays : 0;
    const size_t most = (size_t)PATCH_CHUNK * ((size_t)rays + from_lamps);
    for (unsigned k = 0; k < c->threads; k++) {
        row_cast_create(&c->row[k], rays, from_lamps, err);
        c->source[k] = array_create(most, sizeof **c->source, what, err);
        c->form_factor[k] = array_create(most, sizeof **c->form_factor, what, err);
    }
    return !error_is_set(err);
}

static void casting_clear(Casting *c)
{
    for (unsigned k = 0; k < c->threads; k++) {
        if (c->row != NULL)
            row_cast_clear(&c->row[k]);
        if (c->source != NULL)
            array_free(c->source[k]);
        if (c->form_factor != NULL)
            array_free(c->form_factor[k]);
    }
    for (uint32_t k = 0; k < c->chunks && c->chunk != NULL; k++) {
        array_free(c->chunk[k].source);
        array_free(c->chunk[k].form_factor);
    }
    array_free(c->row);
    array_free(c->error);
    array_free(c->source);
    array_free(c->form_factor);
    array_free(c->chunk);
    array_free(c->length);
    array_free(c->escape);
    array_free(c->area);
    lamp_table_clear(&c->lamps);
}

/* Links are held twice while the chunks are gathered. */
static double bytes_needed(const Casting *c, double links_per_row)
{
    const double per_link = 2.0 * (sizeof(uint32_t) + sizeof(float));
    const double per_row = sizeof(uint64_t) + 2 * (sizeof(float) + sizeof(double)) +
                           sizeof(uint32_t) + sizeof(uint8_t);
    return c->count * (links_per_row * per_link + per_row);
}

static bool check_memory(Casting *c, uint64_t max_bytes, Error *err)
{
    RowCast *row = &c->row[0];
    if (max_bytes == 0 || c->count == 0)
        return true;
    if (bytes_needed(c, (double)row->rays + row->lamp_rays) <= (double)max_bytes)
        return true; /* even if no two rays met the same patch */
    const uint32_t pilots = c->count < PILOT_ROWS ? c->count : PILOT_ROWS;
    uint64_t links = 0;
    for (uint32_t k = 0; k < pilots; k++) {
        row_cast_run(row, c->room, &c->lamps, (uint32_t)((uint64_t)k * c->count / pilots),
                     c->seed);
        links += row->links;
    }
    const double needed = PILOT_MARGIN * bytes_needed(c, (double)links / pilots);
    row->cast = row->clamped = 0;
    if (needed <= (double)max_bytes)
        return true;
    return error_set(err, ERROR_MEMORY,
                     "form factors of %u patches with %u rays each need about %.0f MiB, %.0f MiB "
                     "are allowed: use fewer rays or larger patches", c->count, row->rays,
                     ceil(needed / 0x1p20), (double)max_bytes / 0x1p20);
}

/* Puts the chunks' rows together, giving back each chunk as soon as it is copied. */
static Links *gather_chunks(Casting *c, Error *err)
{
    uint64_t nonzeros = 0;
    for (unsigned k = 0; k < c->threads; k++)
        if (error_is_set(&c->error[k])) {
            *err = c->error[k];
            return NULL;
        }
    for (uint32_t k = 0; k < c->chunks; k++)
        nonzeros += c->chunk[k].links;
    Links *links = links_allocate(c->count, nonzeros, err);
    if (links == NULL)
        return NULL;
    uint64_t at = 0;
    for (uint32_t k = 0; k < c->chunks; k++) {
        RowChunk *chunk = &c->chunk[k];
        memcpy(&links->source[at], chunk->source, chunk->links * sizeof *chunk->source);
        memcpy(&links->form_factor[at], chunk->form_factor,
               chunk->links * sizeof *chunk->form_factor);
        at += chunk->links;
        chunk->source = array_free(chunk->source);
        chunk->form_factor = array_free(chunk->form_factor);
    }
    for (uint32_t i = 0; i < c->count; i++) {
        links->first[i + 1] = links->first[i] + c->length[i];
        links->escape[i] = c->escape[i];
        links->area[i] = c->area[i];
        links->lamp[i] = c->row[0].lamp_rays > 0 && c->lamps.probability[i] > 0;
    }
    for (unsigned k = 0; k < c->threads; k++) {
        links->rays += c->row[k].cast;
        links->clamped += c->row[k].clamped;
    }
    assert(links->first[c->count] == nonzeros);
    return links;
}

Links *links_create(const Room *room, const LinksOptions *options, const Monitor *monitor,
                    Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(room != NULL && options != NULL && room->bvh != NULL && room->patches != NULL);
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    Casting casting;
    Links *links = NULL;
    const Progress progress = { .stage = "factors", .done = 1, .energy_left = -1 };
    if (casting_init(&casting, room, options, err) &&
        check_memory(&casting, options->max_bytes, err)) {
        if (parallel_for(casting.count, PATCH_CHUNK, casting.threads, cast_chunk, &casting,
                         monitor, &progress))
            links = gather_chunks(&casting, err);
        else
            error_set(err, ERROR_STOPPED, "stopped while casting form factors");
    }
    casting_clear(&casting);
    if (links == NULL)
        return NULL;
    clock_gettime(CLOCK_MONOTONIC, &end);
    links->seconds = (double)(end.tv_sec - start.tv_sec) +
                     1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    return links;
}
