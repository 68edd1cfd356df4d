/* SPDX-License-Identifier: BSD-3-Clause */
/* base/array.h -- checked allocation.
 *
 * Every allocation of the library passes here, so that a test can make each one fail in turn and
 * count what is still alive. Memory is given back with array_free.
 *
 * Threads  all functions may be called from any thread.
 */
#ifndef BASE_ARRAY_H
#define BASE_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* Zeroed room for count elements of size bytes; count 0 gives a valid pointer too.
 * fails  NULL and ERROR_MEMORY naming `what`, also when count * size overflows; NULL when *err is
 *        set already. */
void *array_create(size_t count, size_t size, const char *what, Error *err);

/* Grows *array (NULL allowed) to hold at least `needed` elements; *capacity is in elements and at
 * least doubles. New room is not cleared.
 * fails  false and ERROR_MEMORY; the old array stays valid and owned by the caller. */
bool array_reserve(void **array, size_t *capacity, size_t needed, size_t size, const char *what,
                   Error *err);

/* A copy of a string, owned by the caller; NULL gives "". */
char *array_string(const char *text, Error *err);

/* Frees; NULL is allowed. Always returns NULL. */
void *array_free(void *array);

/* --- for tests ------------------------------------------------------------------------------- */

/* Lets n more allocations succeed, then makes all fail; n < 0: none fails any more. */
void array_fail_after(long n);
/* Allocations not freed yet. */
long array_live(void);

#endif
