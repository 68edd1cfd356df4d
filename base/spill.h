/* SPDX-License-Identifier: BSD-3-Clause */
/* base/spill.h -- arrays that memory has no room for: in files without a name that are mapped.
 *
 * A file is unlinked as soon as it is open, so nothing is left behind, however the program ends.
 * All of its room is taken from the disk at once: a disk that is full is told before anything is
 * written, and never ends the program later.
 * Threads  all functions may be called from any thread.
 */
#ifndef BASE_SPILL_H
#define BASE_SPILL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

/* An array in a file of its own, zeroed, looked at like memory. 0 bytes give a valid pointer too.
 * fails  NULL; ERROR_MEMORY when disk or address space is short, ERROR_FAILED when no
 *        file can be made in the folder. */
void *spill_map(const char *folder, uint64_t bytes, const char *what, Error *err);
/* NULL is allowed. Always returns NULL. */
void *spill_unmap(void *array, uint64_t bytes);
/* Bytes begin..end of a mapped array are not needed for now: the pages they lie in leave
 * the process's memory. What is in them stays. Safe while others read or write them. */
void spill_leave(const void *array, uint64_t begin, uint64_t end);

/* Bytes free on the folder's disk for this user; UINT64_MAX when nobody can tell. */
uint64_t spill_free_bytes(const char *folder);

#endif
