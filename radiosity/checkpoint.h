/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/checkpoint.h -- a run that is not finished, in a file: from it the run goes on to the
 * same bytes as if it had never stopped.
 *
 * It holds how patches were divided so far, links as cast, finished rows of the cast under way, a
 * solution, and parts that only the caller can read; whatever there is of these.
 * Format   the machine's own order of bytes: the magic "isoluxK1", the caller's key for what the
 *          run was made from, then the pieces, and a checksum over all of it.
 * Files    written beside and renamed: whoever is killed, and whatever disk is full, the file there
 *          is the old one or the new one, whole.
 */
#ifndef RADIOSITY_CHECKPOINT_H
#define RADIOSITY_CHECKPOINT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "radiosity/kept_rows.h"
#include "radiosity/links.h"
#include "radiosity/solve.h"

enum { CHECKPOINT_PASSES = 32, CHECKPOINT_PARTS = 2 };

typedef struct {
    uint64_t  key;
    uint32_t  passes;                     /* times that patches were divided, in order */
    uint32_t  count[CHECKPOINT_PASSES];   /* patches before each */
    uint8_t  *split[CHECKPOINT_PASSES];   /* [count[k]]  those that were to be divided */
    Links    *links;                      /* not packed; NULL: none */
    KeptRows *rows;                       /* NULL: none; read: NULL or rows that were loaded */
    Solution *solution;                   /* NULL: none */
    void     *part[CHECKPOINT_PARTS];     /* [size[k]]  the caller's; NULL: none */
    size_t    size[CHECKPOINT_PARTS];
} Checkpoint;

/* Writes what is there. With rows: only from within the cast's `progress` (kept_rows.h).
 * fails  false; ERROR_FAILED, the old file stays; ERROR_MEMORY. */
bool checkpoint_save(const Checkpoint *checkpoint, const char *path, Error *err);

/* Reads a file, all of it; what is inside is sound as far as one can tell without the scene.
 * owns   the caller frees with checkpoint_clear, also after a failure.
 * fails  false; ERROR_INPUT with one line when it is not there, no such file, cut or damaged;
 *        ERROR_MEMORY. */
bool checkpoint_load(Checkpoint *checkpoint, const char *path, Error *err);
/* The same from a stream that holds `bytes` bytes; the path is for messages. */
bool checkpoint_read(Checkpoint *checkpoint, FILE *stream, uint64_t bytes, const char *path,
                     Error *err);
/* Frees everything inside, leaves { 0 }. */
void checkpoint_clear(Checkpoint *checkpoint);

#endif
