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
#include "radiosity/mirrors.h"

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

/* Bytes of mapped links that are in memory at a time. */
enum { PIECE = 1 << 24 };

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

/* The links of a row after the other, so that mapped ones stay out of memory. */
static void put_links(Stream *s, const Links *links, const void *array, size_t size)
{
    const uint64_t nonzeros = links->first[links->count];
    for (uint64_t at = 0; at < nonzeros; at += PIECE) {
        const uint64_t n = nonzeros - at < PIECE ? nonzeros - at : PIECE;
        put(s, (const char *)array + at * size, n * size);
        links_leave(links, 0, links->count);
    }
}

static void take_piecewise(Stream *s, const Links *links, void *array, size_t size)
{
    const uint64_t nonzeros = links->first[links->count];
    for (uint64_t at = 0; at < nonzeros && s->good; at += PIECE) {
        const uint64_t n = nonzeros - at < PIECE ? nonzeros - at : PIECE;
        take(s, (char *)array + at * size, n * size);
        links_leave(links, 0, links->count);
    }
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
    assert(links != NULL && links->packed == NULL && path != NULL && err != NULL);
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    const LinksHeader h = header_of(links, key);
    const size_t n = links->count;
    Stream s = { .stream = outfile_stream(file), .good = true };
    put(&s, &h, sizeof h);
    put(&s, links->first, (n + 1) * sizeof *links->first);
    put_links(&s, links, links->source, sizeof *links->source);
    put_links(&s, links, links->form_factor, sizeof *links->form_factor);
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
    return links->first[0] == 0 && links->first[links->count] == nonzeros;
}

static Links *take_links(Stream *s, const LinksHeader *h, const char *path,
                         const LinksOptions *options, Error *err)
{
    const size_t n = h->count;
    const char *folder = NULL;
    uint64_t sum = 0;
    if (!links_choose_folder((double)file_bytes(h), h->count, options, &folder, err))
        return NULL;
    Links *links = links_allocate_in(h->count, h->nonzeros, folder, err);
    if (links == NULL)
        return NULL;
    take(s, links->first, (n + 1) * sizeof *links->first);
    if (!s->good || !rows_rise(links, h->nonzeros)) {
        refuse(path, "is damaged: its rows are not in order", err);
        return links_destroy(links);
    }
    take_piecewise(s, links, links->source, sizeof *links->source);
    take_piecewise(s, links, links->form_factor, sizeof *links->form_factor);
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
    else if (!links_check(links))
        refuse(path, "holds factors that cannot be", err);
    return error_is_set(err) ? links_destroy(links) : links;
}

/* --- the key ---------------------------------------------------------------------------------- */

static uint64_t hash_shape(const Shape *shape, uint64_t hash)
{
    const uint32_t kind = (uint32_t)shape->kind;
    hash = file_hash(&kind, sizeof kind, hash);
    hash = file_hash(&shape->ratio, sizeof shape->ratio, hash);
    return file_hash(&shape->to_world, sizeof shape->to_world, hash);
}

static uint64_t hash_patches(const Room *room, uint64_t hash)
{
    const Patches *p = room->patches;
    const size_t n = p->count;
    hash = file_hash(p->surface, n * sizeof *p->surface, hash);
    hash = file_hash(p->side, n * sizeof *p->side, hash);
    hash = file_hash(p->area, n * sizeof *p->area, hash);
    hash = file_hash(p->centre, n * sizeof *p->centre, hash);
    hash = file_hash(p->normal, n * sizeof *p->normal, hash);
    hash = file_hash(p->first_piece, (n + 1) * sizeof *p->first_piece, hash);
    hash = file_hash(p->piece, p->first_piece[n] * sizeof *p->piece, hash);
    for (uint32_t i = 0; i < p->count; i++) {
        /* Field by field: there are gaps between them. */
        const uint32_t cell[] = { p->cell[i].i, p->cell[i].j, p->cell[i].upper, p->cell[i].level,
                                  rgb_luminance(room_emission(room, i)) > 0 };
        hash = file_hash(cell, sizeof cell, hash);
    }
    return hash;
}

/* Mirrors and glass decide where rays go on; without them the key is that of the geometry. */
static uint64_t hash_mirrors(const Room *room, uint64_t hash)
{
    for (size_t i = 0; room->mirrors && i < room->material_count; i++) {
        const Material *m = &room->materials[i];
        const bool      is = mirrors_is(m);
        const double    v[] = { is, is ? rgb_luminance(m->specular) : 0,
                                is ? rgb_luminance(m->transmittance) : 0, is ? m->ior : 0 };
        hash = file_hash(v, sizeof v, hash);
    }
    return hash;
}

uint64_t links_key(const Room *room, const LinksOptions *options)
{
    const Surfaces *s = room->surfaces;
    const uint32_t numbers[] = { options->rays, options->lamp_rays, options->seed,
                                 room->sides_given, s->count, s->triangle_count, s->shape_count,
                                 room->patches->count };
    uint64_t hash = file_hash(numbers, sizeof numbers, 0);
    hash = file_hash(&room->offset, sizeof room->offset, hash);
    hash = file_hash(s->position, s->vertex_count * sizeof *s->position, hash);
    hash = file_hash(s->corner, 3 * (size_t)s->triangle_count * sizeof *s->corner, hash);
    hash = file_hash(s->triangle_surface, s->triangle_count * sizeof *s->triangle_surface, hash);
    for (uint32_t i = 0; i < s->shape_count; i++)
        hash = hash_shape(&s->shape[i], hash);
    return hash_mirrors(room, hash_patches(room, hash));
}

/* --- loading ---------------------------------------------------------------------------------- */

Links *links_load(const char *path, uint64_t key, const LinksOptions *options, bool *other,
                  Error *err)
{
    assert(path != NULL && options != NULL && err != NULL);
    if (error_is_set(err))
        return NULL;
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
            links = take_links(&s, &h, path, options, err);
        else
            refuse(path, "was made from another scene or with other options", err);
        if (other != NULL)
            *other = h.key != key;
    }
    fclose(s.stream);
    return links;
}
