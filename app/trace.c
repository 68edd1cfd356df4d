/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of a solver, a line each. */
#include "app/trace.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

bool trace_begin(Trace *trace, const char *path, uint64_t rays, Error *err)
{
    *trace = (Trace){ .rays = rays };
    if (path == NULL)
        return true;
    trace->file = outfile_open(path, err);
    if (trace->file == NULL)
        return false;
    fputs("step,seconds,rays,residual,unshot,error_bound\n", outfile_stream(trace->file));
    return true;
}

void trace_watch(Trace *trace, void (*watch)(void *user, const SolveStep *step), void *user)
{
    assert(trace != NULL);
    trace->watch = watch;
    trace->watch_user = user;
}

bool trace_wanted(const Trace *trace) { return trace->file != NULL || trace->watch != NULL; }

void trace_step(void *user, const SolveStep *step)
{
    const Trace *trace = user;
    assert(trace_wanted(trace));
    if (trace->watch != NULL)
        trace->watch(trace->watch_user, step);
    if (trace->file == NULL)
        return;
    FILE *out = outfile_stream(trace->file);
    fprintf(out, "%" PRIu32 ",%.6f,%" PRIu64 ",%.9g,%.9g,", step->step, step->seconds,
            trace->rays + step->rays, step->residual, step->unshot);
    if (!isnan(step->error_bound)) /* else there is none */
        fprintf(out, "%.9g", step->error_bound);
    fputc('\n', out);
}

bool trace_finish(Trace *trace, Error *err)
{
    return trace->file == NULL || outfile_commit(trace->file, err);
}
