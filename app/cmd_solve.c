/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux solve: light on patches, as PLY and figures. */
#include <string.h>

#include "app/commands.h"
#include "app/compare_solvers.h"
#include "app/group_files.h"
#include "app/output.h"
#include "app/pipeline_accuracy.h"
#include "app/pipeline_check.h"
#include "app/summary.h"

/* --compare: figures and a plot instead of a mesh. */
static bool compare(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const char *output = session->options.output;
    char path[4096];
    bool converged;
    if (output == NULL &&
        !output_name(output_base(session->options.scene), "-solvers.csv", path, sizeof path, err))
        return false;
    if (!pipeline_light(pipeline, err) ||
        !compare_solvers(pipeline, output != NULL ? output : path, &converged, err))
        return false;
    *exit_code = converged ? 0 : 4;
    session->told = true;
    return true;
}

/* What -o may be called. */
static bool check_name(const Options *options, Error *err)
{
    const char *output = options->output;
    if (options->compare && output != NULL && !output_ends(output, ".csv") &&
        !output_ends(output, ".svg"))
        return error_set(err, ERROR_USAGE, "-o %s: --compare writes FILE.csv and FILE.svg",
                         output);
    if (!options->compare && output != NULL && strcmp(output, "-") != 0 &&
        !output_ends(output, ".ply"))
        return error_set(err, ERROR_USAGE, "-o %s: a solved mesh's name ends in .ply", output);
    return group_files_allowed(options, err);
}

static bool write_mesh(Pipeline *pipeline, Error *err)
{
    const char *output = pipeline->session->options.output;
    return output == NULL || (group_files_asked(output) ? group_files_write(pipeline, output, err)
                                                        : ply_write(pipeline, output, err));
}

bool cmd_solve(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const char *output = session->options.output;
    if (!check_name(&session->options, err) ||
        !pipeline_accuracy_allowed(&session->options, err) || !pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) ||
        (session->options.importance && !pipeline_camera(pipeline, err)) ||
        !pipeline_patches(pipeline, err) || !pipeline_check_allowed(pipeline, err))
        return false;
    if (session->options.compare)
        return pipeline_factors(pipeline, err) && compare(pipeline, exit_code, err);
    if (!pipeline_accurate(pipeline, err))
        return false;
    *exit_code = pipeline_exit_code(pipeline);
    if (!write_mesh(pipeline, err) || !pipeline_check(pipeline, exit_code, err))
        return false;
    session_say(session, "isolux: %s%s%s", session->options.scene, output != NULL ? " -> " : "",
                output != NULL ? output : "");
    summary_print(pipeline);
    return true;
}
