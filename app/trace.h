/* SPDX-License-Identifier: BSD-3-Clause */
/* app/trace.h -- the steps of a solver as CSV (--trace). */
#ifndef APP_TRACE_H
#define APP_TRACE_H

#include "base/file.h"
#include "radiosity/solve.h"

typedef struct {
    OutFile *file;   /* NULL: no trace was asked for */
    uint64_t rays;   /* cast for the links */
} Trace;

/* Opens the file and writes the heading; path NULL: nothing.
 * fails  false. */
bool trace_begin(Trace *trace, const char *path, uint64_t rays, Error *err);
/* SolveOptions.trace, with the Trace as its user. */
void trace_step(void *user, const SolveStep *step);
/* Puts the file in its place. */
bool trace_finish(Trace *trace, Error *err);

#endif
