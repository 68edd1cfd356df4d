/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux solve: light on patches, as PLY and figures. */
#include <string.h>

#include "app/commands.h"
#include "app/output.h"
#include "app/summary.h"

bool cmd_solve(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const char *output = session->options.output;
    if (output != NULL && strcmp(output, "-") != 0 && !output_ends(output, ".ply"))
        return error_set(err, ERROR_USAGE, "-o %s: a solved mesh's name ends in .ply", output);
    if (!pipeline_read(pipeline, err) || !pipeline_mesh(pipeline, err) ||
        !pipeline_patches(pipeline, err) || !pipeline_factors(pipeline, err) ||
        !pipeline_solve(pipeline, err))
        return false;
    *exit_code = pipeline_exit_code(pipeline);
    if (output != NULL && !ply_write(pipeline, output, err))
        return false;
    session_say(session, "isolux: %s%s%s", session->options.scene, output != NULL ? " -> " : "",
                output != NULL ? output : "");
    summary_print(pipeline);
    return true;
}
