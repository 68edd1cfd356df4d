/* SPDX-License-Identifier: BSD-3-Clause */
/* base/file.h -- whole files in, whole files out: a reader never sees half of one.
 *
 * Writing goes to a temporary file beside the target, is flushed to disk, and is renamed over it.
 */
#ifndef BASE_FILE_H
#define BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/error.h"

/* The whole file, with one 0 byte after the last that *size does not count.
 * owns   the caller frees with array_free.
 * fails  NULL; ERROR_INPUT when it cannot be read (the text says why) or is larger than `limit`
 *        bytes; a directory, a device without end and the like are refused. */
char *file_read(const char *path, size_t limit, size_t *size, Error *err);

/* A file being written. `path` "-" is standard output, without temporary file. */
typedef struct OutFile OutFile;

/* Nothing stands at `path` itself, and what stood there stays, until outfile_commit. A symbolic
 * link is followed; a device or pipe is written in place.
 * fails  NULL and ERROR_FAILED, the text says why. */
OutFile *outfile_open(const char *path, Error *err);
/* Where to write. It is closed by commit and discard alone. */
FILE *outfile_stream(OutFile *out);
/* The path that libraries may open and write themselves until outfile_commit. NULL for "-". */
const char *outfile_path(const OutFile *out);
/* Flushes, closes and puts the file in place; on any write error removes it and sets *err.
 * Frees `out` in each case. NULL is allowed. */
bool outfile_commit(OutFile *out, Error *err);
/* Throws away what was written. Frees `out`; NULL is allowed. */
void outfile_discard(OutFile *out);

/* "dir/of/path" + "/" + name into buffer, or name alone when it is absolute or path has no folder.
 * Returns false when it does not fit. */
bool file_beside(const char *path, const char *name, char *buffer, size_t size);

/* 64-bit xxHash of bytes, chained: pass the last result as seed. */
uint64_t file_hash(const void *bytes, size_t size, uint64_t seed);

#endif
