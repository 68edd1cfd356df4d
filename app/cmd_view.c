/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux view: the window here, the solver in a thread; or a solution out of a file. */
#include <assert.h>
#include <math.h>

#include "app/commands.h"
#include "app/live.h"
#include "app/live_solved.h"
#include "app/picture_files.h"
#include "app/ply_read.h"
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
    };
}

/* The window on light that the session's scene is solved for meanwhile. */
static void view_scene(Pipeline *pipeline, const char *command, Mailbox *mailbox,
                       Control *control, Error *err)
{
    const ViewerOptions options = viewer_options(&pipeline->session->options, command);
    Live live;
    if (!live_start(&live, pipeline, mailbox, control, err))
        return;
    viewer_run(&options, mailbox, control, err);
    live_join(&live);
    /* What is wrong with the scene comes before what is wrong with the screen. */
    if (error_is_set(&live.err) && live.err.code != ERROR_STOPPED)
        *err = live.err;
}

/* The window on a solution that lies in a file. */
static void view_solved(Session *session, const char *command, Mailbox *mailbox, Control *control,
                        Error *err)
{
    LiveSolved live;
    if (!live_solved_allowed(&session->options, err) ||
        !live_solved_start(&live, session, mailbox, control, err))
        return;
    ViewerOptions options = viewer_options(&session->options, command);
    options.solved = true;
    viewer_run(&options, mailbox, control, err);
    live_solved_join(&live);
}

bool cmd_view(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    char command[1024];
    Control control;
    Mailbox mailbox = { NULL };
    assert(session->options.scene != NULL);
    session->told = true;
    picture_files_command(&session->options, command, sizeof command);
    control_init(&control);
    atomic_store(&control.solver, (int)session->settings.solver);
    atomic_store(&control.tolerance,
                 session->settings.tolerance > 0 ? session->settings.tolerance : TOLERANCE);
    if (solved_mesh_is(session->options.scene))
        view_solved(session, command, &mailbox, &control, err);
    else
        view_scene(pipeline, command, &mailbox, &control, err);
    *exit_code = session_stopped(session) ? ERROR_STOPPED : 0;
    snapshot_destroy(mailbox_take(&mailbox));
    control_clear(&control);
    return !error_is_set(err);
}
