/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import_files.h -- the files that the importing library opens, read once and hashed; this
 * folder only, in the child. */
#ifndef SCENES_IMPORT_FILES_H
#define SCENES_IMPORT_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct {
    char   *path;
    char   *bytes;      /* NULL: cannot be read */
    size_t  size;
} ImportFile;

typedef struct {
    ImportFile *file;   /* [count] */
    size_t      count, capacity;
    uint64_t    hash;   /* of the bytes of all files, in the order they were first asked for */
    Error       err;    /* why the last file could not be read */
} ImportFiles;

/* The file's bytes, from memory the second time; *at is its number. A name with %20 and the like
 * is tried as it is and decoded. fails  false when it cannot be read. */
bool import_files_get(ImportFiles *files, const char *path, size_t *at);
/* Gives file `at` other bytes, which the caller hands over; the hash stays that of the original. */
void import_files_replace(ImportFiles *files, size_t at, char *bytes, size_t size);
void import_files_clear(ImportFiles *files);

#endif
