/* SPDX-License-Identifier: BSD-3-Clause */
/* app/compare_solvers.h -- all solvers on the same links: how fast each comes how near. */
#ifndef APP_COMPARE_SOLVERS_H
#define APP_COMPARE_SOLVERS_H

#include "app/pipeline.h"

/* Runs every solver on the pipeline's links and problem, with a bound on the error at each step and
 * the error itself, against a solution that is as near as rounding allows. Writes path's stem with
 * .csv and .svg, and --json. *converged: whether all reached the tolerance.
 * fails  false; ERROR_FAILED when a file cannot be written; ERROR_STOPPED; ERROR_MEMORY. */
bool compare_solvers(Pipeline *pipeline, const char *path, bool *converged, Error *err);

#endif
