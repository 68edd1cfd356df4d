/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux check: what is in a file, what is wrong with it, what was repaired. */
#include <string.h>

#include "app/check.h"
#include "app/commands.h"
#include "app/marked.h"
#include "app/output.h"
#include "app/summary.h"

static uint64_t count_warnings(const Session *session, const char *code)
{
    uint64_t count = 0;
    for (size_t i = 0; i < session->warning_count; i++)
        count += strcmp(session->warnings[i].code, code) == 0;
    return count;
}

static bool output_named(const Session *session, Error *err)
{
    const char *path = session->options.output;
    if (path == NULL || strcmp(path, "-") == 0 || output_ends(path, ".ply"))
        return true;
    return error_set(err, ERROR_USAGE, "-o '%s': the marked mesh is a PLY file; its name ends in "
                     ".ply", path);
}

static bool look(Check *check, Pipeline *pipeline, Error *err)
{
    Session             *session = pipeline->session;
    const InspectOptions options = { .sides = pipeline->sides,
                                     .threads = session->settings.threads };
    const double         begin = progress_now();
    check->pipeline = pipeline;
    if (!inspect(pipeline->surfaces, &options, &pipeline->defects, &check->inspection,
                 &session->monitor, err) ||
        !check_account(pipeline, &check->faces, err))
        return false;
    check_units(pipeline, &check->units);
    check->missing = count_warnings(session, "material-missing");
    pipeline_note(pipeline, STAGE_MESH, begin);
    return true;
}

static bool write_json(const Check *check, Error *err)
{
    Summary     summary;
    const Error none = { 0 };
    Session    *session = check->pipeline->session;
    if (!summary_begin(&summary, session, 0, &none, err))
        return false;
    if (summary.file != NULL) {
        summary_pipeline(&summary.json, check->pipeline);
        check_json(&summary.json, check);
    }
    session->told = summary_finish(&summary, session, err);
    return session->told;
}

bool cmd_check(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    Check    check = { 0 };
    *exit_code = 0;
    if (!output_named(session, err) || !pipeline_read(pipeline, err) ||
        !pipeline_mesh(pipeline, err) || !pipeline_sides(pipeline, err))
        return false;
    if (!scene_has_light(pipeline->scene))
        monitor_warn(&session->monitor, "no-emitter", pipeline->scene->file,
                     "nothing in the scene gives light");
    bool ok = look(&check, pipeline, err);
    if (ok)
        check_print(&check);
    if (ok && session->options.output != NULL)
        ok = marked_write(&check, session->options.output, err);
    ok = ok && write_json(&check, err);
    inspection_clear(&check.inspection);
    return ok;
}
