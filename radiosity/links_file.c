/* SPDX-License-Identifier: BSD-3-Clause */
/* Links to a file and back. */
#include "radiosity/links_file.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/array.h"
#include "base/file.h"
#include "radiosity/internal.h"

typedef struct {
    char     magic[8];
    uint64_t key, nonzeros, rays, clamped;
    double   seconds;
    uint32_t count;
    uint32_t lamps;      /* 1: lamp[] follows */
} LinksHeader;

static const char MAGIC[8] = "isoluxF1";

typedef struct {
    FILE    *stream;
    uint64_t hash;
    bool     good;
} Stream;

static void put(Stream *s, const void *bytes, size_t size)
{
    s->hash = file_hash(bytes, size, s->hash);
    s->good = s->good && (size == 0 || fwrite(bytes, size, 1, s->stream) == 1);
}

/* The checksum runs over what was read, so that a damaged file is told by it alone. */
static void take(Stream *s, void *bytes, size_t size)
{
    s->good = s->good && (size == 0 || fread(bytes, size, 1, s->stream) == 1);
    if (s->good)
        s->hash = file_hash(bytes, size, s->hash);
}

/* Of the whole file. The counts are below 2^32 and 2^58: the sum does not overflow. */
static uint64_t file_bytes(const LinksHeader *h)
{
    const uint64_t n = h->count;
    return sizeof *h + (n + 1) * sizeof(uint64_t) + h->nonzeros * (sizeof(uint32_t) + sizeof(float))
           + n * (sizeof(float) + sizeof(double)) + (h->lamps ? n : 0) + sizeof(uint64_t);
}

static LinksHeader header_of(const Links *links, uint64_t key)
{
    LinksHeader h = { .key = key, .nonzeros = links->first[links->count], .rays = links->rays,
                      .clamped = links->clamped, .seconds = links->seconds, .count = links->count,
                      .lamps = links->lamp != NULL };
    memcpy(h.magic, MAGIC, sizeof h.magic);
    return h;
}

uint64_t links_file_bytes(const Links *links)
{
    const LinksHeader h = header_of(links, 0);
    return file_bytes(&h);
}

bool links_save(const Links *links, uint64_t key, const char *path, Error *err)
{
    assert(links != NULL && path != NULL && err != NULL);
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    const LinksHeader h = header_of(links, key);
    const size_t n = links->count;
    Stream s = { .stream = outfile_stream(file), .good = true };
    put(&s, &h, sizeof h);
    put(&s, links->first, (n + 1) * sizeof *links->first);
    put(&s, links->source, h.nonzeros * sizeof *links->source);
    put(&s, links->form_factor, h.nonzeros * sizeof *links->form_factor);
    put(&s, links->escape, n * sizeof *links->escape);
    put(&s, links->area, n * sizeof *links->area);
    if (links->lamp != NULL)
        put(&s, links->lamp, n);
    put(&s, &(uint64_t){ s.hash }, sizeof(uint64_t));
    return outfile_commit(file, err);
}

static bool refuse(const char *path, const char *what, Error *err)
{
    return error_at(err, ERROR_INPUT, path, 0, "%s", what);
}

static bool take_header(Stream *s, const char *path, LinksHeader *h, Error *err)
{
    struct stat info;
    take(s, h, sizeof *h);
    if (!s->good || memcmp(h->magic, MAGIC, sizeof h->magic) != 0)
        return refuse(path, "is no file of form factors", err);
    if (h->nonzeros > UINT64_MAX >> 6 || h->lamps > 1 ||
        fstat(fileno(s->stream), &info) != 0 || (uint64_t)info.st_size != file_bytes(h))
        return refuse(path, "has another size than it says: cut or damaged", err);
    return true;
}

/* Before anything is looked up by them. */
static bool rows_rise(const Links *links, uint64_t nonzeros)
{
    for (uint32_t i = 0; i < links->count; i++)
        if (links->first[i] > links->first[i + 1])
            return false;
    return links->first[links->count] == nonzeros;
}

static Links *take_links(Stream *s, const LinksHeader *h, const char *path, Error *err)
{
    Links *links = links_allocate(h->count, h->nonzeros, err);
    if (links == NULL)
        return NULL;
    const size_t n = h->count;
    uint64_t sum = 0;
    take(s, links->first, (n + 1) * sizeof *links->first);
    take(s, links->source, h->nonzeros * sizeof *links->source);
    take(s, links->form_factor, h->nonzeros * sizeof *links->form_factor);
    take(s, links->escape, n * sizeof *links->escape);
    take(s, links->area, n * sizeof *links->area);
    if (h->lamps)
        take(s, links->lamp, n);
    else
        links->lamp = array_free(links->lamp);
    const uint64_t hash = s->hash;
    take(s, &sum, sizeof sum);
    links->rays = h->rays;
    links->clamped = h->clamped;
    links->seconds = h->seconds;
    if (!s->good || sum != hash)
        refuse(path, "is damaged: its checksum does not fit", err);
    else if (!rows_rise(links, h->nonzeros) || !links_check(links))
        refuse(path, "holds factors that cannot be", err);
    return error_is_set(err) ? links_destroy(links) : links;
}

Links *links_load(const char *path, uint64_t key, bool *other, Error *err)
{
    assert(path != NULL && err != NULL);
    LinksHeader h;
    Links *links = NULL;
    struct stat info;
    if (other != NULL)
        *other = false;
    /* Asked before opening: a pipe would wait for a writer. */
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) {
        refuse(path, "there is no such file", err);
        return NULL;
    }
    Stream s = { .stream = fopen(path, "rb"), .good = true };
    if (s.stream == NULL) {
        refuse(path, "cannot be read", err);
        return NULL;
    }
    if (take_header(&s, path, &h, err)) {
        if (h.key == key)
            links = take_links(&s, &h, path, err);
        else
            refuse(path, "was made from another scene or with other options", err);
        if (other != NULL)
            *other = h.key != key;
    }
    fclose(s.stream);
    return links;
}
