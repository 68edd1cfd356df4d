/* SPDX-License-Identifier: BSD-3-Clause */
/* app/trace.h -- the steps of a solver as CSV (--trace), and for who looks on. */
#ifndef APP_TRACE_H
#define APP_TRACE_H

#include "base/file.h"
#include "radiosity/solve.h"

typedef struct {
    OutFile *file;   /* NULL: no trace was asked for */
    uint64_t rays;   /* cast for the links */
    void   (*watch)(void *user, const SolveStep *step); /* NULL: nobody */
    void    *watch_user;
} Trace;

/* Opens the file and writes the heading; path NULL: nothing.
 * fails  false. */
bool trace_begin(Trace *trace, const char *path, uint64_t rays, Error *err);
/* Hands each step to `watch` as well; NULL: not. */
void trace_watch(Trace *trace, void (*watch)(void *user, const SolveStep *step), void *user);
/* Whether steps are needed at all. */
bool trace_wanted(const Trace *trace);
/* SolveOptions.trace, with the Trace as its user. */
void trace_step(void *user, const SolveStep *step);
/* Puts the file in its place. */
bool trace_finish(Trace *trace, Error *err);

#endif
