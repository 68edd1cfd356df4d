/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux factors: the form-factor matrix by group, material or patch. */
#include <string.h>

#include "app/commands.h"
#include "app/output.h"
#include "app/summary.h"

/* A view factor as good as nothing: then the faces look away from each other. */
static const double NEARLY_ALL = 0.999;

static bool write_by_patch(Pipeline *pipeline, const char *output, Error *err)
{
    char matrix[4096], table[4096];
    if (!output_name(output, ".mtx", matrix, sizeof matrix, err) ||
        !output_name(output, ".csv", table, sizeof table, err))
        return false;
    if (!factors_write_patches(pipeline, matrix, table, err))
        return false;
    session_say(pipeline->session, "isolux: %s -> %s, %s", pipeline->session->options.scene,
                matrix, table);
    return true;
}

bool cmd_factors(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    const Options *options = &session->options;
    const char *output = options->output != NULL ? options->output : "-";
    if (options->by == BY_PATCH && strcmp(output, "-") == 0)
        return error_set(err, ERROR_USAGE, "--by patch writes two files; -o needs a name");
    if (options->output == NULL && options->json != NULL && strcmp(options->json, "-") == 0)
        return error_set(err, ERROR_USAGE, "--json - needs -o FILE for the matrix");
    if (!pipeline_read(pipeline, err) || !pipeline_mesh(pipeline, err) ||
        !pipeline_patches(pipeline, err) || !pipeline_factors(pipeline, err))
        return false;
    *exit_code = pipeline_exit_code(pipeline);
    if (pipeline->report.escaped > NEARLY_ALL)
        monitor_warn(&session->monitor, "all-escaped", options->scene,
                     "no side sees another; faces that look outwards need --sides both");
    const double begin = progress_now();
    if (options->by == BY_PATCH) {
        if (!write_by_patch(pipeline, output, err))
            return false;
    } else {
        if (!factors_write_csv(pipeline, (FactorsBy)options->by, output, err))
            return false;
        session_say(session, "isolux: %s -> %s", options->scene, output);
    }
    pipeline_note(pipeline, STAGE_WRITE, begin);
    summary_print(pipeline);
    return true;
}
