/* SPDX-License-Identifier: BSD-3-Clause */
/* isolux view: the window here, the solver in a thread. */
#include <assert.h>
#include <math.h>

#include "app/commands.h"
#include "app/live.h"
#include "app/picture_files.h"
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

bool cmd_view(Pipeline *pipeline, int *exit_code, Error *err)
{
    Session *session = pipeline->session;
    char command[1024];
    picture_files_command(&session->options, command, sizeof command);
    const ViewerOptions options = viewer_options(&session->options, command);
    Control control;
    Mailbox mailbox = { NULL };
    Live live;
    assert(session->options.scene != NULL);
    session->told = true;
    control_init(&control);
    atomic_store(&control.solver, (int)session->settings.solver);
    atomic_store(&control.tolerance,
                 session->settings.tolerance > 0 ? session->settings.tolerance : TOLERANCE);
    if (live_start(&live, pipeline, &mailbox, &control, err)) {
        viewer_run(&options, &mailbox, &control, err);
        live_join(&live);
        /* What is wrong with the scene comes before what is wrong with the screen. */
        if (error_is_set(&live.err) && live.err.code != ERROR_STOPPED)
            *err = live.err;
        *exit_code = session_stopped(session) ? ERROR_STOPPED : 0;
    }
    snapshot_destroy(mailbox_take(&mailbox));
    control_clear(&control);
    return !error_is_set(err);
}
