/* SPDX-License-Identifier: BSD-3-Clause */
/* Checkpoints: out. */
#include "radiosity/checkpoint.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "radiosity/checkpoint_format.h"
#include "radiosity/internal.h"

typedef struct {
    FILE    *stream;
    uint64_t hash;
} Writer;

/* A write that fails is remembered by the stream, and told when it is put in place. */
static void put(Writer *w, const void *bytes, size_t size)
{
    if (size == 0)
        return;
    w->hash = file_hash(bytes, size, w->hash);
    fwrite(bytes, size, 1, w->stream);
}

static void put_links(Writer *w, const Links *links)
{
    assert(links->packed == NULL);
    const size_t n = links->count;
    const LinksHead head = { .nonzeros = links->first[n], .rays = links->rays,
                             .clamped = links->clamped, .seconds = links->seconds,
                             .count = links->count, .lamps = links->lamp != NULL };
    put(w, &head, sizeof head);
    put(w, links->first, (n + 1) * sizeof *links->first);
    put(w, links->source, head.nonzeros * sizeof *links->source);
    put(w, links->form_factor, head.nonzeros * sizeof *links->form_factor);
    put(w, links->escape, n * sizeof *links->escape);
    put(w, links->area, n * sizeof *links->area);
    if (links->lamp != NULL)
        put(w, links->lamp, n);
}

static void put_chunk(Writer *w, const RowMaker *m, uint32_t k, bool finished)
{
    const RowChunk *chunk = &m->chunk[k];
    const uint32_t begin = k * MAKER_CHUNK, left = m->count - begin;
    const size_t rows = left < MAKER_CHUNK ? left : MAKER_CHUNK;
    const ChunkHead head = { .finished = finished, .links = finished ? chunk->links : 0,
                             .cast = finished ? chunk->cast : 0,
                             .clamped = finished ? chunk->clamped : 0 };
    put(w, &head, sizeof head);
    if (!finished)
        return;
    put(w, &m->length[begin], rows * sizeof *m->length);
    put(w, &m->escape[begin], rows * sizeof *m->escape);
    put(w, &m->area[begin], rows * sizeof *m->area);
    put(w, chunk->source, chunk->links * sizeof *chunk->source);
    put(w, chunk->form_factor, chunk->links * sizeof *chunk->form_factor);
}

/* Which chunks are finished now; those that others finish meanwhile are left for the next time. */
static bool *finished_chunks(const RowMaker *m, Error *err)
{
    bool *finished = array_create(m->chunks, sizeof *finished, "a checkpoint", err);
    for (uint32_t k = 0; finished != NULL && k < m->chunks; k++)
        finished[k] = row_maker_has(m, k * MAKER_CHUNK);
    return finished;
}

static void put_solution(Writer *w, const Solution *s)
{
    const SolutionHead head = { .count = s->count, .bands = s->bands, .iterations = s->iterations,
                                .converged = s->converged, .residual = s->residual,
                                .unshot = s->unshot, .error_bound = s->error_bound,
                                .seconds = s->seconds };
    const size_t values = (size_t)s->count * s->bands;
    put(w, &head, sizeof head);
    put(w, s->radiosity, values * sizeof *s->radiosity);
    put(w, s->irradiance, values * sizeof *s->irradiance);
}

static void put_all(Writer *w, const Checkpoint *c, const bool *finished)
{
    const RowMaker *m = finished != NULL ? c->rows->maker : NULL;
    CheckpointHead head = { .key = c->key, .passes = c->passes, .links = c->links != NULL,
                            .rows = m != NULL ? m->count : 0,
                            .solution = c->solution != NULL };
    memcpy(head.magic, CHECKPOINT_MAGIC, sizeof head.magic);
    for (int k = 0; k < CHECKPOINT_PARTS; k++)
        head.part[k] = c->part[k] != NULL ? c->size[k] : 0;
    put(w, &head, sizeof head);
    for (uint32_t k = 0; k < c->passes; k++) {
        put(w, &c->count[k], sizeof c->count[k]);
        put(w, c->split[k], c->count[k]);
    }
    if (c->links != NULL)
        put_links(w, c->links);
    for (uint32_t k = 0; m != NULL && k < m->chunks; k++)
        put_chunk(w, m, k, finished[k]);
    if (c->solution != NULL)
        put_solution(w, c->solution);
    for (int k = 0; k < CHECKPOINT_PARTS; k++)
        put(w, c->part[k], (size_t)head.part[k]);
    put(w, &(uint64_t){ w->hash }, sizeof(uint64_t));
}

bool checkpoint_save(const Checkpoint *c, const char *path, Error *err)
{
    assert(c != NULL && path != NULL && c->passes <= CHECKPOINT_PASSES);
    bool *finished = NULL;
    if (c->rows != NULL && c->rows->maker != NULL) {
        finished = finished_chunks(c->rows->maker, err);
        if (finished == NULL)
            return false;
    }
    OutFile *file = outfile_open(path, err);
    if (file != NULL) {
        Writer w = { .stream = outfile_stream(file) };
        put_all(&w, c, finished);
    }
    array_free(finished);
    return file != NULL && outfile_commit(file, err);
}

void checkpoint_clear(Checkpoint *c)
{
    for (uint32_t k = 0; k < CHECKPOINT_PASSES; k++)
        array_free(c->split[k]);
    for (int k = 0; k < CHECKPOINT_PARTS; k++)
        array_free(c->part[k]);
    links_destroy(c->links);
    kept_rows_destroy(c->rows);
    solution_destroy(c->solution);
    *c = (Checkpoint){ 0 };
}
