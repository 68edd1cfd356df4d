/* SPDX-License-Identifier: BSD-3-Clause */
/* NumPy's archive: a zip file of arrays, each behind a header of text. */
#include "app/npz.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>

#include "base/array.h"
#include "base/file.h"

enum { ARRAYS_MOST = 16, HEADER_ALIGN = 64, WORD_MOST = 120 };

/* One date for all, so that the same numbers make the same bytes: 1980-01-01, the zip format's
 * first. */
enum { DOS_DATE = (1 << 5) | 1, DOS_TIME = 0 };

typedef struct {
    char   header[256];
    size_t header_size;
    const void *data; /* or NULL: */
    NpzRead read;
    void  *context;
    void  *owned;     /* data to be freed, or NULL */
    size_t size, at;  /* at: bytes handed out so far, header included */
} NpzArray;

struct Npz {
    OutFile *file;
    zip_t   *zip;
    NpzArray array[ARRAYS_MOST];
    int      count;
};

static void npz_free(Npz *npz)
{
    for (int i = 0; i < npz->count; i++)
        array_free(npz->array[i].owned);
    array_free(npz);
}

Npz *npz_open(const char *path, Error *err)
{
    assert(path != NULL && strcmp(path, "-") != 0);
    Npz *npz = array_create(1, sizeof *npz, "an archive", err);
    if (npz == NULL)
        return NULL;
    npz->file = outfile_open(path, err);
    int code = 0;
    if (npz->file != NULL)
        npz->zip = zip_open(outfile_path(npz->file), ZIP_CREATE | ZIP_TRUNCATE, &code);
    if (npz->zip != NULL)
        return npz;
    if (npz->file != NULL)
        error_set(err, ERROR_FAILED, "%s: no archive can be made there", path);
    outfile_discard(npz->file);
    npz_free(npz);
    return NULL;
}

/* The archive reads an array as a file: the header, then the data. */
static zip_int64_t array_read(void *state, void *buffer, zip_uint64_t length, zip_source_cmd_t what)
{
    NpzArray *a = state;
    const size_t all = a->header_size + a->size;
    switch (what) {
    case ZIP_SOURCE_OPEN:
        a->at = 0;
        return 0;
    case ZIP_SOURCE_READ: {
        size_t done = 0;
        while (done < length && a->at < all) {
            const bool head = a->at < a->header_size;
            const size_t from = head ? a->at : a->at - a->header_size;
            const size_t left = head ? a->header_size - from : a->size - from;
            const size_t take = left < length - done ? left : (size_t)(length - done);
            char *to = (char *)buffer + done;
            if (head || a->data != NULL)
                memcpy(to, (head ? a->header : (const char *)a->data) + from, take);
            else
                a->read(a->context, from, to, take);
            a->at += take;
            done += take;
        }
        return (zip_int64_t)done;
    }
    case ZIP_SOURCE_STAT: {
        zip_stat_t *stat = buffer;
        zip_stat_init(stat);
        stat->size = all;
        stat->valid = ZIP_STAT_SIZE;
        return sizeof *stat;
    }
    case ZIP_SOURCE_ERROR: {
        static const int none[2] = { ZIP_ER_OK, 0 };
        memcpy(buffer, none, sizeof none);
        return sizeof none;
    }
    case ZIP_SOURCE_CLOSE:
    case ZIP_SOURCE_FREE:
        return 0;
    case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE,
                                              -1);
    default:
        return -1;
    }
}

/* Magic, version 1.0, length, a Python dictionary, filled up with spaces to a line of 64 bytes. */
static void make_header(NpzArray *a, const char *type, size_t rows, size_t columns)
{
    char text[200], shape[64] = "";
    if (rows != SIZE_MAX && columns == 0)
        snprintf(shape, sizeof shape, "%zu,", rows);
    else if (rows != SIZE_MAX)
        snprintf(shape, sizeof shape, "%zu, %zu", rows, columns);
    const int length = snprintf(text, sizeof text, "{'descr': '%s', 'fortran_order': False, "
                                "'shape': (%s), }", type, shape);
    assert(length > 0 && (size_t)length < sizeof text);
    const size_t whole = (10 + (size_t)length + 1 + HEADER_ALIGN - 1) / HEADER_ALIGN * HEADER_ALIGN;
    assert(whole <= sizeof a->header);
    memset(a->header, ' ', whole);
    memcpy(a->header, "\x93NUMPY\x01\x00", 8);
    a->header[8] = (char)((whole - 10) & 0xff);
    a->header[9] = (char)((whole - 10) >> 8);
    memcpy(a->header + 10, text, (size_t)length);
    a->header[whole - 1] = '\n';
    a->header_size = whole;
}

/* Bytes of one element of a NumPy type: the number behind the order and the kind; a letter of
 * Unicode text has four. */
static size_t element_size(const char *type)
{
    return strtoul(type + 2, NULL, 10) * (type[1] == 'U' ? 4 : 1);
}

/* Hands the array that was filled in last to the archive. */
static bool add_entry(Npz *npz, const char *name, Error *err)
{
    char entry[64];
    NpzArray *a = &npz->array[npz->count++];
    snprintf(entry, sizeof entry, "%s.npy", name);
    zip_source_t *source = zip_source_function(npz->zip, array_read, a);
    const zip_int64_t at = source != NULL ? zip_file_add(npz->zip, entry, source, ZIP_FL_ENC_UTF_8)
                                          : -1;
    if (at < 0)
        zip_source_free(source);
    if (at < 0 || zip_set_file_compression(npz->zip, (zip_uint64_t)at, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(npz->zip, (zip_uint64_t)at, DOS_TIME, DOS_DATE, 0) != 0)
        return error_set(err, ERROR_FAILED, "the archive does not take %s: %s", entry,
                         zip_strerror(npz->zip));
    return true;
}

bool npz_add(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
             const void *data, Error *err)
{
    assert(npz != NULL && npz->count < ARRAYS_MOST && data != NULL);
    NpzArray *a = &npz->array[npz->count];
    *a = (NpzArray){ .data = data };
    make_header(a, type, rows, columns);
    a->size = element_size(type) * (rows == SIZE_MAX ? 1 : rows) * (columns > 0 ? columns : 1);
    return add_entry(npz, name, err);
}

bool npz_add_stream(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
                    NpzRead read, void *context, Error *err)
{
    assert(npz != NULL && npz->count < ARRAYS_MOST && read != NULL);
    NpzArray *a = &npz->array[npz->count];
    *a = (NpzArray){ .read = read, .context = context };
    make_header(a, type, rows, columns);
    a->size = element_size(type) * rows * (columns > 0 ? columns : 1);
    return add_entry(npz, name, err);
}

bool npz_give(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
              void *data, Error *err)
{
    if (data == NULL)
        return false;
    const bool added = npz_add(npz, name, type, rows, columns, data, err);
    npz->array[npz->count - 1].owned = data;
    return added;
}

/* The code point that begins at *text, which moves on; bytes that are no UTF-8 stand for
 * themselves. */
static uint32_t next_letter(const char **text)
{
    const unsigned char *t = (const unsigned char *)*text;
    const int more = t[0] >= 0xf0 ? 3 : t[0] >= 0xe0 ? 2 : t[0] >= 0xc0 ? 1 : 0;
    uint32_t letter = more == 3 ? t[0] & 7u : more == 2 ? t[0] & 15u
                      : more == 1 ? t[0] & 31u : t[0];
    for (int k = 1; k <= more; k++) {
        if ((t[k] & 0xc0) != 0x80) {
            *text += 1;
            return t[0];
        }
        letter = letter << 6 | (t[k] & 0x3fu);
    }
    *text += 1 + more;
    return letter;
}

bool npz_add_words(Npz *npz, const char *name, const char *const *word, size_t count, Error *err)
{
    char type[16];
    uint32_t *letters = array_create(count * WORD_MOST, sizeof *letters, "an archive", err);
    if (letters == NULL)
        return false;
    for (size_t i = 0; i < count; i++) {
        const char *text = word[i];
        for (size_t k = 0; k < WORD_MOST && *text != '\0'; k++)
            letters[i * WORD_MOST + k] = next_letter(&text);
    }
    snprintf(type, sizeof type, "<U%d", WORD_MOST);
    return npz_give(npz, name, type, count, 0, letters, err);
}

bool npz_commit(Npz *npz, Error *err)
{
    if (npz == NULL)
        return false;
    if (error_is_set(err)) {
        zip_discard(npz->zip);
    } else if (zip_close(npz->zip) != 0) {
        error_set(err, ERROR_FAILED, "the archive cannot be written: %s", zip_strerror(npz->zip));
        zip_discard(npz->zip);
    }
    OutFile *file = npz->file;
    npz_free(npz);
    if (error_is_set(err)) {
        outfile_discard(file);
        return false;
    }
    return outfile_commit(file, err);
}
