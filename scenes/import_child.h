/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import_child.h -- a child process that reads a file; this folder only.
 *
 * fork alone, no other program, so that the library works wherever it is linked. The child has no
 * open files but the pipe, no core dump, and limits on processor time and address space.
 */
#ifndef SCENES_IMPORT_CHILD_H
#define SCENES_IMPORT_CHILD_H

#include <sys/types.h>

#include "scenes/import.h"

typedef struct {
    double   seconds;   /* > 0 */
    uint64_t memory;    /* bytes beyond what the parent has */
    PipeWish wish;      /* handed on */
} ChildLimits;

typedef struct {
    ChildLimits limits;
    pid_t       pid;
    int         fd;     /* to read its records from */
} ImportChild;

bool child_start(ImportChild *child, const ChildLimits *limits, ImportWork work, const char *path,
                 Error *err);
void child_kill(ImportChild *child);
/* Waits for its end; a bad end is ERROR_INPUT unless an error is set already. Returns whether all
 * is well. */
bool child_finish(ImportChild *child, const char *path, Error *err);

#endif
