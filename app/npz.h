/* SPDX-License-Identifier: BSD-3-Clause */
/* app/npz.h -- arrays in a file that NumPy reads: numpy.load, and scipy.sparse.load_npz.
 *
 * Stored as they are: form factors hardly get smaller, and packing them took longer than all else.
 */
#ifndef APP_NPZ_H
#define APP_NPZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct Npz Npz;

/* fails  NULL; ERROR_FAILED, ERROR_MEMORY. */
Npz *npz_open(const char *path, Error *err);
/* An array of `rows` by `columns` (columns 0: of one dimension; rows SIZE_MAX: a single value), in
 * C order. type: NumPy's, as "<f8". The data are not copied: they must stay until npz_commit. */
bool npz_add(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
             const void *data, Error *err);
/* The same from a stream: `read` is asked for the bytes of the data in order, from `at` = 0 on
 * (more than once, maybe); `context` must stay until npz_commit. */
typedef void (*NpzRead)(void *context, uint64_t at, void *buffer, size_t size);
bool npz_add_stream(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
                    NpzRead read, void *context, Error *err);
/* npz_add, and frees the data (of array_create) in the end, also when it fails; NULL is allowed:
 * false. */
bool npz_give(Npz *npz, const char *name, const char *type, size_t rows, size_t columns,
              void *data, Error *err);
/* Words as an array of Unicode text, each cut to 120 letters. Copied. */
bool npz_add_words(Npz *npz, const char *name, const char *const *word, size_t count, Error *err);
/* Writes all and puts the file in its place; frees npz in any case. NULL is allowed: false. */
bool npz_commit(Npz *npz, Error *err);

#endif
