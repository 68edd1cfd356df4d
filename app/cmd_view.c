/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux view: the window here, the solver in a thread; or a solution out of a file. */
#include <assert.h>
#include <math.h>

#include "app/commands.h"
#include "app/live.h"
#include "app/live_solved.h"
#include "app/picture_files.h"
#include "app/pipeline_stochastic.h"
#include "app/ply_read.h"
#include "app/summary.h"
#include "viewer/viewer.h"

/* Of the solver, where none is given: its own default. */
static const double TOLERANCE = 1e-6;

enum { WIDTH = 1024, HEIGHT = 768 };

static ViewerOptions viewer_options(const Options *options, const char *command)
{
    const bool sized = options->size[0] > 0;
    return (ViewerOptions){
        .scene = options->scene,
        .command = command,
        .width = sized ? options->size[0] : WIDTH,
        .height = sized ? options->size[1] : HEIGHT,
        .script = options->script,
        .screenshot = options->screenshot,
        .frames = options->frames,
        .rate = options->rate,
        .no_panels = options->no_panels,
        .exposure_set = options->exposure_set,
        .exposure = options->exposure,
        .tone = (ToneCurve)options->tone,
        .photometric = options->units == UNITS_PHOTOMETRIC,
        .unit_m = options->unit_m,
        .threads = (unsigned)options->threads,
    };
}

/* The window on light that the session's scene is solved for meanwhile. */
static void view_scene(Pipeline *pipeline, const char *command, Mailbox *mailbox,
                       Control *control, Pace *pace, Error *err)
{
    const ViewerOptions options = viewer_options(&pipeline->session->options, command);
    Live live;
    if (!live_start(&live, pipeline, mailbox, control, err))
        return;
    viewer_run(&options, mailbox, control, pace, err);
    live_join(&live);
    /* What is wrong with the scene comes before what is wrong with the screen. */
    if (error_is_set(&live.err) && live.err.code != ERROR_STOPPED)
        *err = live.err;
}

/* The window on a solution that lies in a file. */
static void view_solved(Session *session, const char *command, Mailbox *mailbox, Control *control,
                        Pace *pace, Error *err)
{
    LiveSolved live;
    if (!live_solved_allowed(&session->options, err) ||
        !live_solved_start(&live, session, mailbox, control, err))
        return;
    ViewerOptions options = viewer_options(&session->options, command);
    options.solved = true;
    viewer_run(&options, mailbox, control, pace, err);
    live_solved_join(&live);
}

/* --- figures ---------------------------------------------------------------------------------- */

static void put_times(Json *json, const char *key, const PaceTimes *times)
{
    json_open(json, key, '{');
    json_count(json, "count", times->count);
    json_number(json, "median", 1e3 * pace_quantile(times, 0.5));
    json_number(json, "p95", 1e3 * pace_quantile(times, 0.95));
    json_number(json, "most", 1e3 * times->most);
    json_close(json, '}');
}

static bool write_json(const Pipeline *pipeline, const Pace *pace, int exit_code, Error *err)
{
    Summary summary;
    Json   *json = &summary.json;
    if (!summary_begin(&summary, pipeline->session, exit_code, err, err))
        return false;
    if (summary.file == NULL)
        return true;
    summary_pipeline(json, pipeline);
    json_open(json, "view", '{');
    json_number(json, "first_frame_s", pace->first_frame);
    json_number(json, "first_lit_s", pace->first_lit);
    json_number(json, "light_50_s", pace_light_at(pace, 0.5));
    json_number(json, "light_90_s", pace_light_at(pace, 0.9));
    json_number(json, "working_s", pace->working_seconds);
    json_number(json, "working_frames_per_s",
                (double)pace->working.count / pace->working_seconds);
    put_times(json, "working_frame_ms", &pace->working);
    put_times(json, "resting_frame_ms", &pace->resting);
    put_times(json, "latency_ms", &pace->latency);
    put_times(json, "update_ms", &pace->updates);
    json_close(json, '}');
    return summary_finish(&summary, pipeline->session, err);
}

bool cmd_view(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    char command[1024];
    Control control;
    Mailbox mailbox = { NULL };
    Pace    pace;
    assert(session->options.scene != NULL);
    session->told = true;
    pace_init(&pace, progress_now() - session->printer.start);
    picture_files_command(&session->options, command, sizeof command);
    control_init(&control);
    atomic_store(&control.solver, session->options.solver);
    /* What is given is for the solver that is. */
    const double tolerance = session->settings.tolerance;
    const bool estimates = session->settings.stochastic;
    const bool given = options_given(&session->options, OPTION_TOLERANCE);
    atomic_store(&control.tolerance, tolerance > 0 && !estimates ? tolerance : TOLERANCE);
    atomic_store(&control.error, given && estimates ? tolerance : STOCHASTIC_TOLERANCE);
    if (solved_mesh_is(session->options.scene))
        view_solved(session, command, &mailbox, &control, &pace, err);
    else
        view_scene(pipeline, command, &mailbox, &control, &pace, err);
    *exit_code = session_stopped(session) ? ERROR_STOPPED : 0;
    snapshot_destroy(mailbox_take(&mailbox));
    control_clear(&control);
    if (!error_is_set(err))
        write_json(pipeline, &pace, *exit_code, err);
    session->told = !error_is_set(err);
    pace_clear(&pace);
    return !error_is_set(err);
}
