/* SPDX-License-Identifier: BSD-3-Clause */
/* Checkpoints: in. Nothing that a file says is believed before it is seen that it can be there. */
#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "base/array.h"
#include "base/file.h"
#include "radiosity/checkpoint.h"
#include "radiosity/checkpoint_format.h"
#include "radiosity/internal.h"

static const char what[] = "a checkpoint";

typedef struct {
    FILE       *stream;
    const char *path;
    uint64_t    hash, left;  /* left: bytes not read yet, the checksum included */
    Error      *err;
} Reader;

static bool refuse(const Reader *r)
{
    return error_at(r->err, ERROR_INPUT, r->path, 0, "is a damaged checkpoint");
}

static bool take(Reader *r, void *bytes, uint64_t size)
{
    if (error_is_set(r->err))
        return false;
    if (size == 0)
        return true;
    if (size > r->left || fread(bytes, (size_t)size, 1, r->stream) != 1)
        return refuse(r);
    r->left -= size;
    r->hash = file_hash(bytes, (size_t)size, r->hash);
    return true;
}

/* An array of the file, allocated only when that many bytes are left. */
static void *take_array(Reader *r, uint64_t count, size_t size)
{
    if (error_is_set(r->err))
        return NULL;
    if (count > r->left / size) {
        refuse(r);
        return NULL;
    }
    void *array = array_create((size_t)count, size, what, r->err);
    if (array != NULL && !take(r, array, count * size))
        array = array_free(array);
    return array;
}

/* --- links ------------------------------------------------------------------------------------ */

static bool rows_rise(const Links *links, uint64_t nonzeros)
{
    for (uint32_t i = 0; i < links->count; i++)
        if (links->first[i] > links->first[i + 1])
            return false;
    return links->first[0] == 0 && links->first[links->count] == nonzeros;
}

static Links *take_links(Reader *r)
{
    LinksHead head;
    if (!take(r, &head, sizeof head))
        return NULL;
    const uint64_t n = head.count;
    if (head.nonzeros > r->left / sizeof(uint64_t) || n > r->left / sizeof(uint64_t)) {
        refuse(r);
        return NULL;
    }
    Links *links = links_allocate(head.count, head.nonzeros, r->err);
    if (links == NULL)
        return NULL;
    take(r, links->first, (n + 1) * sizeof *links->first);
    take(r, links->source, head.nonzeros * sizeof *links->source);
    take(r, links->form_factor, head.nonzeros * sizeof *links->form_factor);
    take(r, links->escape, n * sizeof *links->escape);
    take(r, links->area, n * sizeof *links->area);
    if (head.lamps != 0)
        take(r, links->lamp, n);
    else
        links->lamp = array_free(links->lamp);
    links->rays = head.rays;
    links->clamped = head.clamped;
    links->seconds = head.seconds;
    if (!error_is_set(r->err) && (!rows_rise(links, head.nonzeros) || !links_check(links)))
        refuse(r);
    return error_is_set(r->err) ? links_destroy(links) : links;
}

/* --- rows under way --------------------------------------------------------------------------- */

/* Lengths add up, sources rise and are patches, factors are shares. */
static bool chunk_check(const KeptRows *rows, uint32_t begin, uint32_t end, const RowChunk *chunk)
{
    uint64_t at = 0;
    for (uint32_t i = begin; i < end; i++) {
        if (!(rows->area[i] >= 0 && rows->area[i] < INFINITY) ||
            !(rows->escape[i] >= 0 && rows->escape[i] <= 1) ||
            rows->length[i] > chunk->links - at)
            return false;
        for (const uint64_t after = at + rows->length[i], first = at; at < after; at++)
            if (chunk->source[at] >= rows->count ||
                (at > first && chunk->source[at] <= chunk->source[at - 1]) ||
                !(chunk->form_factor[at] >= 0 && chunk->form_factor[at] <= 1))
                return false;
    }
    return at == chunk->links;
}

static bool take_chunk(Reader *r, KeptRows *rows, uint32_t begin)
{
    ChunkHead head;
    if (!take(r, &head, sizeof head) || head.finished == 0)
        return !error_is_set(r->err);
    const uint32_t left = rows->count - begin;
    const size_t n = left < MAKER_CHUNK ? left : MAKER_CHUNK;
    RowChunk *chunk = &rows->chunk[begin / MAKER_CHUNK];
    take(r, &rows->length[begin], n * sizeof *rows->length);
    take(r, &rows->escape[begin], n * sizeof *rows->escape);
    take(r, &rows->area[begin], n * sizeof *rows->area);
    chunk->source = take_array(r, head.links, sizeof *chunk->source);
    chunk->form_factor = take_array(r, head.links, sizeof *chunk->form_factor);
    chunk->links = head.links;
    chunk->cast = head.cast;
    chunk->clamped = head.clamped;
    chunk->done = true;
    if (!error_is_set(r->err) && !chunk_check(rows, begin, begin + (uint32_t)n, chunk))
        refuse(r);
    return !error_is_set(r->err);
}

static KeptRows *take_rows(Reader *r, uint32_t count)
{
    KeptRows *rows = kept_rows_create(r->err);
    if (rows == NULL)
        return NULL;
    const size_t chunks = ((size_t)count + MAKER_CHUNK - 1) / MAKER_CHUNK;
    rows->count = count;
    if (chunks > r->left / sizeof(ChunkHead)) {
        refuse(r);
    } else {
        rows->chunk = array_create(chunks, sizeof *rows->chunk, what, r->err);
        rows->length = array_create(count, sizeof *rows->length, what, r->err);
        rows->escape = array_create(count, sizeof *rows->escape, what, r->err);
        rows->area = array_create(count, sizeof *rows->area, what, r->err);
    }
    for (size_t k = 0; k < chunks && !error_is_set(r->err); k++)
        take_chunk(r, rows, (uint32_t)k * MAKER_CHUNK);
    return rows;
}

/* --- the rest --------------------------------------------------------------------------------- */

static Solution *take_solution(Reader *r)
{
    SolutionHead head;
    if (!take(r, &head, sizeof head))
        return NULL;
    Solution *s = array_create(1, sizeof *s, what, r->err);
    if (s == NULL)
        return NULL;
    const uint64_t values = (uint64_t)head.count * head.bands;
    *s = (Solution){ .count = head.count, .bands = head.bands, .iterations = head.iterations,
                     .residual = head.residual, .unshot = head.unshot,
                     .error_bound = head.error_bound, .converged = head.converged != 0,
                     .seconds = head.seconds, .drift = INFINITY };
    s->radiosity = take_array(r, values, sizeof *s->radiosity);
    s->irradiance = take_array(r, values, sizeof *s->irradiance);
    for (uint64_t k = 0; !error_is_set(r->err) && k < values; k++)
        if (!(s->radiosity[k] >= 0 && isfinite(s->radiosity[k])) || !isfinite(s->irradiance[k]))
            refuse(r);
    return error_is_set(r->err) ? solution_destroy(s) : s;
}

static void take_passes(Reader *r, Checkpoint *c, uint32_t passes)
{
    for (uint32_t k = 0; k < passes && !error_is_set(r->err); k++) {
        take(r, &c->count[k], sizeof c->count[k]);
        c->split[k] = take_array(r, c->count[k], 1);
        c->passes = k + 1;
    }
}

static void take_pieces(Reader *r, Checkpoint *c, const CheckpointHead *head)
{
    c->key = head->key;
    take_passes(r, c, head->passes);
    if (head->links != 0)
        c->links = take_links(r);
    if (head->rows > 0 && !error_is_set(r->err))
        c->rows = take_rows(r, head->rows);
    if (head->solution != 0)
        c->solution = take_solution(r);
    for (int k = 0; k < CHECKPOINT_PARTS; k++) {
        if (head->part[k] > 0)
            c->part[k] = take_array(r, head->part[k], 1);
        c->size[k] = c->part[k] != NULL ? (size_t)head->part[k] : 0;
    }
}

bool checkpoint_read(Checkpoint *c, FILE *stream, uint64_t bytes, const char *path, Error *err)
{
    assert(c != NULL && stream != NULL && path != NULL);
    Reader r = { .stream = stream, .path = path, .left = bytes, .err = err };
    CheckpointHead head;
    uint64_t sum = 0;
    *c = (Checkpoint){ 0 };
    if (error_is_set(err))
        return false;
    if (bytes < sizeof head || !take(&r, &head, sizeof head) ||
        memcmp(head.magic, CHECKPOINT_MAGIC, sizeof head.magic) != 0) {
        *err = (Error){ 0 };
        return error_at(err, ERROR_INPUT, path, 0, "is no checkpoint");
    }
    if (head.passes > CHECKPOINT_PASSES)
        return refuse(&r);
    take_pieces(&r, c, &head);
    const uint64_t hash = r.hash;
    if (take(&r, &sum, sizeof sum) && (sum != hash || r.left > 0))
        error_at(err, ERROR_INPUT, path, 0,
                 "is a damaged checkpoint: its checksum does not fit");
    return !error_is_set(err);
}

bool checkpoint_load(Checkpoint *c, const char *path, Error *err)
{
    struct stat info;
    assert(path != NULL && err != NULL);
    *c = (Checkpoint){ 0 };
    if (error_is_set(err))
        return false;
    /* Asked before opening: a pipe would wait for a writer. */
    if (stat(path, &info) != 0)
        return error_at(err, ERROR_INPUT, path, 0, "cannot be read: %s", strerror(errno));
    FILE *stream = S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;
    if (stream == NULL)
        return error_at(err, ERROR_INPUT, path, 0, "is no checkpoint");
    const bool good = checkpoint_read(c, stream, (uint64_t)info.st_size, path, err);
    fclose(stream);
    return good;
}
