/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_rows.c -- rows made by many threads, kept in chunks, put together in order. */
#include <assert.h>
#include <string.h>
#include <time.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"

static const uint32_t DEFAULT_RAYS = 256;
static const char what[] = "the casting of form factors";

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Goes on with what an earlier run had saved. */
static void take_kept(RowMaker *m, KeptRows *kept)
{
    assert(kept->maker == NULL);
    m->kept = kept;
    kept->maker = m;
    if (kept->count != m->count)
        return;
    for (uint32_t k = 0; k < m->chunks; k++) {
        m->taken_cast += kept->chunk[k].cast;
        m->taken_clamped += kept->chunk[k].clamped;
        m->chunk[k] = kept->chunk[k];
        kept->chunk[k] = (RowChunk){ 0 };
    }
    memcpy(m->length, kept->length, m->count * sizeof *m->length);
    memcpy(m->escape, kept->escape, m->count * sizeof *m->escape);
    memcpy(m->area, kept->area, m->count * sizeof *m->area);
    kept_rows_clear(kept);
}

bool row_maker_create(RowMaker *m, const Room *room, const LinksOptions *options, Error *err)
{
    const uint32_t rays = options->rays > 0 ? options->rays : DEFAULT_RAYS;
    const uint32_t lamp_rays = options->lamp_rays > 0 ? options->lamp_rays : (rays + 3) / 4;
    *m = (RowMaker){ .room = room, .seed = options->seed, .count = room->patches->count,
                     .threads = parallel_threads(options->threads), .begun = now() };
    m->chunks = (m->count + MAKER_CHUNK - 1) / MAKER_CHUNK;
    m->tile = array_create(m->threads, sizeof *m->tile, what, err);
    m->buffer = array_create(m->threads, sizeof *m->buffer, what, err);
    m->chunk = array_create(m->chunks, sizeof *m->chunk, what, err);
    m->length = array_create(m->count, sizeof *m->length, what, err);
    m->escape = array_create(m->count, sizeof *m->escape, what, err);
    m->area = array_create(m->count, sizeof *m->area, what, err);
    if (error_is_set(err) || !lamp_table_create(room, &m->lamps, err))
        return false;
    const uint32_t from_lamps = m->lamps.count > 0 ? lamp_rays : 0;
    for (unsigned k = 0; k < m->threads; k++)
        row_tile_create(&m->tile[k], rays, from_lamps, err);
    if (!error_is_set(err) && options->kept != NULL)
        take_kept(m, options->kept);
    return !error_is_set(err);
}

uint32_t row_maker_rays(const RowMaker *m)
{
    assert(m->threads > 0);
    return m->tile[0].all.rays + m->tile[0].all.lamp_rays;
}

void row_maker_clear(RowMaker *m)
{
    if (m->kept != NULL)
        m->kept->maker = NULL;
    for (unsigned k = 0; k < m->threads && m->tile != NULL; k++)
        row_tile_clear(&m->tile[k]);
    for (unsigned k = 0; k < m->threads && m->buffer != NULL; k++) {
        array_free(m->buffer[k].source);
        array_free(m->buffer[k].form_factor);
    }
    for (uint32_t k = 0; k < m->chunks && m->chunk != NULL; k++) {
        links_chunk_free(&m->chunk[k].source, &m->chunk[k].form_factor, &m->chunk[k].mapped);
    }
    array_free(m->tile);
    array_free(m->buffer);
    array_free(m->chunk);
    array_free(m->length);
    array_free(m->escape);
    array_free(m->area);
    lamp_table_clear(&m->lamps);
    *m = (RowMaker){ 0 };
}

void row_maker_add(RowMaker *m, unsigned worker, uint32_t source, float form_factor)
{
    RowBuffer *b = &m->buffer[worker];
    const size_t n = b->links + 1;
    if (!array_reserve((void **)&b->source, &b->source_capacity, n, sizeof *b->source, what,
                       &b->error) ||
        !array_reserve((void **)&b->form_factor, &b->factor_capacity, n, sizeof *b->form_factor,
                       what, &b->error))
        return;
    b->source[b->links] = source;
    b->form_factor[b->links++] = form_factor;
}

void row_maker_end(RowMaker *m, unsigned worker, uint32_t row, float escape, double area)
{
    RowBuffer *b = &m->buffer[worker];
    m->length[row] = (uint32_t)(b->links - b->row);
    m->escape[row] = escape;
    m->area[row] = area;
    b->row = b->links;
}

void row_maker_cast(RowMaker *m, const uint32_t *row, uint32_t count, unsigned worker)
{
    RowTile *tile = &m->tile[worker];
    for (uint32_t done = 0; done < count; done += tile->count) {
        const uint32_t left = count - done;
        row_tile_cast(tile, m->room, &m->lamps, &row[done], left < tile->most ? left : tile->most,
                      m->seed);
        for (uint32_t k = 0; k < tile->count; k++) {
            const RowCast *cast = row_tile_row(tile, m->room, &m->lamps, k);
            for (uint32_t i = 0; i < cast->links; i++)
                row_maker_add(m, worker, cast->source[i], cast->form_factor[i]);
            row_maker_end(m, worker, row[done + k], (float)cast->escape, cast->area);
        }
    }
}

void row_maker_keep(RowMaker *m, uint32_t begin, unsigned worker)
{
    RowBuffer *b = &m->buffer[worker];
    RowChunk *chunk = &m->chunk[begin / MAKER_CHUNK];
    assert(begin % MAKER_CHUNK == 0 && b->row == b->links);
    if (!error_is_set(&b->error) &&
        links_chunk_create(b->links, m->folder, &chunk->source, &chunk->form_factor,
                           &chunk->mapped, &b->error) && b->links > 0) {
        chunk->links = b->links;
        memcpy(chunk->source, b->source, b->links * sizeof *b->source);
        memcpy(chunk->form_factor, b->form_factor, b->links * sizeof *b->form_factor);
        links_chunk_leave(chunk->source, chunk->mapped);
    }
    chunk->cast = m->tile[worker].cast - b->cast;
    chunk->clamped = m->tile[worker].clamped - b->clamped;
    b->cast = m->tile[worker].cast;
    b->clamped = m->tile[worker].clamped;
    b->links = b->row = 0;
    atomic_store_explicit(&chunk->done, !error_is_set(&b->error), memory_order_release);
}

bool row_maker_has(const RowMaker *m, uint32_t begin)
{
    return atomic_load_explicit(&m->chunk[begin / MAKER_CHUNK].done, memory_order_acquire);
}

/* Copies the chunks' rows one after the other, giving back each chunk as soon as it is copied. */
static void join_chunks(RowMaker *m, Links *links)
{
    uint64_t at = 0;
    for (uint32_t k = 0; k < m->chunks; k++) {
        RowChunk *chunk = &m->chunk[k];
        if (chunk->links > 0) {
            memcpy(&links->source[at], chunk->source, chunk->links * sizeof *chunk->source);
            memcpy(&links->form_factor[at], chunk->form_factor,
                   chunk->links * sizeof *chunk->form_factor);
        }
        at += chunk->links;
        chunk->links = 0;
        chunk->done = false;
        links_chunk_free(&chunk->source, &chunk->form_factor, &chunk->mapped);
        for (uint32_t i = k * MAKER_CHUNK; i < m->count && i < (k + 1) * MAKER_CHUNK; i++)
            links->first[i + 1] = links->first[i] + m->length[i];
        links_pass(links, k * MAKER_CHUNK);
    }
    links_leave(links, 0, links->count);
}

Links *row_maker_gather(RowMaker *m, Error *err)
{
    uint64_t nonzeros = 0;
    if (m->kept != NULL)
        m->kept->maker = NULL; /* its chunks go */
    for (unsigned k = 0; k < m->threads; k++)
        if (error_is_set(&m->buffer[k].error)) {
            *err = m->buffer[k].error;
            return NULL;
        }
    for (uint32_t k = 0; k < m->chunks; k++)
        nonzeros += m->chunk[k].links;
    Links *links = links_allocate_in(m->count, nonzeros, m->folder, err);
    if (links == NULL)
        return NULL;
    join_chunks(m, links);
    for (uint32_t i = 0; i < m->count; i++) {
        links->escape[i] = m->escape[i];
        links->area[i] = m->area[i];
        links->lamp[i] = m->tile[0].all.lamp_rays > 0 && m->lamps.probability[i] > 0;
    }
    links->rays = m->taken_cast;
    links->clamped = m->taken_clamped;
    for (unsigned k = 0; k < m->threads; k++) {
        links->rays += m->tile[k].cast;
        links->clamped += m->tile[k].clamped;
    }
    assert(links->first[m->count] == nonzeros);
    links->seconds = now() - m->begun;
    return links;
}
