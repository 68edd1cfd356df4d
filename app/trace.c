/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of a solver, a line each. */
#include "app/trace.h"

#include <assert.h>
#include <inttypes.h>
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

void trace_step(void *user, const SolveStep *step)
{
    const Trace *trace = user;
    assert(trace->file != NULL);
    fprintf(outfile_stream(trace->file), "%" PRIu32 ",%.6f,%" PRIu64 ",%.9g,%.9g,%.9g\n",
            step->step, step->seconds, trace->rays, step->residual, step->unshot,
            step->error_bound);
}

bool trace_finish(Trace *trace, Error *err)
{
    return trace->file == NULL || outfile_commit(trace->file, err);
}
