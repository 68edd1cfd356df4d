/* SPDX-License-Identifier: BSD-3-Clause */
/* app/commands.h -- the commands: each takes an empty Pipeline of a session and does its job.
 *
 * *exit_code gets 0, 4 or 5; anything else is told through *err. The caller writes the summary
 * unless session->told is set, and frees the pipeline.
 */
#ifndef APP_COMMANDS_H
#define APP_COMMANDS_H

#include "app/pipeline.h"

bool cmd_render(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_solve(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_factors(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_measure(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_check(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_validate(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_bench(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_compare(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_view(Pipeline *pipeline, int *exit_code, Error *err);
bool cmd_develop(Pipeline *pipeline, int *exit_code, Error *err);

/* --- parts ------------------------------------------------------------------------------------ */

/* Sets the picture's width and height; the camera is chosen already. */
void view_size(Pipeline *pipeline);

/* The solved mesh as PLY. `path` "-": standard output. */
bool ply_write(Pipeline *pipeline, const char *path, Error *err);

#endif
