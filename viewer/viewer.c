/* SPDX-License-Identifier: BSD-3-Clause */
/* The window's loop: take what is new, handle events, draw when something has changed. */
#include "viewer/viewer.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "viewer/files.h"
#include "viewer/gathered.h"
#include "viewer/gui.h"
#include "viewer/internal.h"

/* Without anything new the picture is still drawn this often: figures change. */
static const double IDLE_SECONDS = 0.25;
/* Frames follow each other no faster; while the solver works, it is to have most of the machine. */
static const double LEAST_SECONDS = 1.0 / 60, WORKING_SECONDS = 1.0 / 20;
/* New light is looked for this often. */
static const double NEWS_SECONDS = 0.01;
/* Frame times are averaged over about ten. */
static const double FRAME_WEIGHT = 0.1;

/* --- begin and end ---------------------------------------------------------------------------- */

static bool open_viewer(Viewer *viewer, Error *err)
{
    const ViewerOptions *options = viewer->options;
    char title[512];
    snprintf(title, sizeof title, "%.400s - isolux", options->scene);
    if (options->script != NULL) {
        viewer->script = script_read(options->script, err);
        if (viewer->script == NULL)
            return false;
    }
    viewer->window = window_create(title, options->width, options->height, err);
    return viewer->window != NULL && renew_open(viewer, err);
}

static void close_viewer(Viewer *viewer)
{
    renew_leave(viewer);
    measuring_clear(&viewer->measuring);
    snapshot_destroy(viewer->shown);
    script_destroy(viewer->script);
    window_destroy(viewer->window);
}

/* --- a frame ---------------------------------------------------------------------------------- */

/* The same patch in other patches is the one at the same place: nothing else is kept of it. */
static void pick_again(Viewer *viewer, const ShownMesh *before)
{
    assert(viewer->shown != NULL);
    const ShownMesh *mesh = viewer->shown->mesh;
    if (viewer->view.picked == PATCH_NONE || before == mesh)
        return;
    const Vec3 at = viewer->picked_at;
    uint32_t nearest = PATCH_NONE;
    double least = INFINITY;
    const ShownPatch *old = before != NULL && viewer->view.picked < before->patch_count
                                ? &before->patch[viewer->view.picked] : NULL;
    for (uint32_t i = 0; old != NULL && i < mesh->patch_count; i++) {
        const ShownPatch *p = &mesh->patch[i];
        const double d = vec3_length(vec3_sub(p->centre, at));
        if (d < least && p->group == old->group && vec3_dot(p->normal, old->normal) > 0.5) {
            least = d;
            nearest = i;
        }
    }
    viewer->view.picked = nearest;
}

static bool take_new(Viewer *viewer, Error *err)
{
    Snapshot *snapshot = mailbox_take(viewer->mailbox);
    if (snapshot == NULL)
        return true;
    Snapshot *before = viewer->shown;
    viewer->shown = snapshot;
    /* Read again, the scene may be another one. */
    if (viewer->restarted && before != NULL && before->mesh != snapshot->mesh)
        viewer->measuring.plane_fits = false;
    viewer->measuring.sighted = viewer->measuring.sighted && before != NULL &&
                                before->mesh == snapshot->mesh;
    viewer->restarted = viewer->restarted && before != NULL && before->mesh == snapshot->mesh;
    pick_again(viewer, before != NULL ? before->mesh : NULL);
    snapshot_destroy(before);
    if (snapshot->layer[viewer->view.layer] == NULL)
        viewer->view.layer = LAYER_RADIOSITY;
    if (viewer->at_home)
        viewer->view.camera = snapshot->mesh->camera[0];
    viewer->at_home = false;
    /* A lamp that is dimmed is to look dimmed. */
    viewer->exposure_due = viewer->exposure_due || (viewer->automatic && !viewer->changing);
    viewer->dirty = true;
    if (!pace_snapshot(viewer->pace, snapshot, atomic_load(&viewer->control->finished),
                       window_time(), err))
        return false;
    measuring_renew(viewer);
    return gl_take(viewer->gl, snapshot, viewer->view.layer, err);
}

static void draw_frame(Viewer *viewer)
{
    const double now = window_time();
    assert(viewer->view.width > 0 && viewer->view.height > 0);
    if (viewer->exposure_due)
        viewer->view.exposure = pick_exposure(viewer);
    viewer->exposure_due = false;
    viewer->dirty = false;
    measuring_work(viewer);
    gathered_work(viewer);
    gl_draw(viewer->gl, &viewer->view);
    gui_begin(viewer->view.width, viewer->view.height, now - viewer->last_frame);
    panels_draw(viewer);
    gui_end();
    if (viewer->last_frame > 0)
        viewer->frame_seconds += (viewer->frame == 1 ? 1 : FRAME_WEIGHT) *
                                 (now - viewer->last_frame - viewer->frame_seconds);
    viewer->last_frame = now;
    viewer->frame++;
}

/* How long may pass before the next frame. */
static double patience(const Viewer *viewer)
{
    const double since = window_time() - viewer->last_frame;
    const bool working = !atomic_load(&viewer->control->finished) || gathered_awaited(viewer);
    const double rate = viewer->options->rate;
    /* Before first light there are but figures to be read. */
    if (viewer->shown == NULL && !viewer->dirty)
        return fmax(0, IDLE_SECONDS - since);
    /* Scripts wait for the solver, at the rate that a hand would have; then for nothing. */
    if (viewer->script != NULL && !working)
        return 0;
    if (rate > 0)
        return fmax(0, 1 / rate - since);
    const bool moves = viewer->script != NULL && script_moves(viewer->script);
    if (viewer->dirty || viewer->pointer.flying || moves)
        return fmax(0, LEAST_SECONDS - since);
    return fmax(0, (working ? WORKING_SECONDS : IDLE_SECONDS) - since);
}

static bool run_script(Viewer *viewer, Error *err)
{
    const char *screenshot = NULL;
    double tiles = 0;
    const EaselState picture = easel_state(&viewer->control->easel, NULL, &tiles);
    const ScriptState state = {
        .step = viewer->shown != NULL && !viewer->restarted ? viewer->shown->step : STEP_READING,
        .finished = atomic_load(&viewer->control->finished),
        .picture = picture,
        .tiles = tiles,
        .notice = viewer->notice,
        .seconds = window_time(),
        .settled = viewer->settled,
    };
    if (viewer->script == NULL)
        return true;
    if (!script_advance(viewer->script, &state, viewer->window, &screenshot, err))
        viewer->close = true;
    viewer->lose_context = script_loses_context(viewer->script);
    if (screenshot != NULL)
        snprintf(viewer->screenshot, sizeof viewer->screenshot, "%s", screenshot);
    return !error_is_set(err);
}

static void handle_events(Viewer *viewer)
{
    Event event;
    while (window_next(viewer->window, &event)) {
        pace_event(viewer->pace, window_time());
        input_event(viewer, &event);
    }
}

/* Once a frame; whether it went anywhere: then the next frame is soon. */
static bool fly(Viewer *viewer)
{
    viewer->dirty = false;
    input_fly(viewer, window_time() - viewer->last_frame);
    return viewer->dirty;
}

static bool one_frame(Viewer *viewer, Error *err)
{
    const ViewerOptions *options = viewer->options;
    window_wait(viewer->window, fmin(patience(viewer), NEWS_SECONDS));
    const Knobs *knobs = &viewer->control->knobs;
    viewer->settled = atomic_load(&knobs->settled) == atomic_load(&knobs->version);
    if (!take_new(viewer, err))
        return false;
    handle_events(viewer);
    if (!viewer->close && patience(viewer) > 0)
        return true; /* a moment's rest for the solver: nothing is due yet */
    if (!run_script(viewer, err))
        return false;
    handle_events(viewer);
    char line[256];
    control_read(viewer->control, &viewer->report);
    if (control_heard(viewer->control, &viewer->sayings, line, sizeof line))
        viewer_say(viewer, "%s", line);
    window_size(viewer->window, &viewer->view.width, &viewer->view.height);
    if (viewer->view.width < 1 || viewer->view.height < 1) {
        viewer->last_frame = window_time(); /* minimised: nothing to draw on */
        return true;
    }
    if (!renew_if_lost(viewer, err))
        return false;
    const bool   flew = fly(viewer);
    const double begin = window_time();
    draw_frame(viewer);
    viewer->dirty = viewer->dirty || flew;
    if (viewer->screenshot[0] != '\0')
        files_save_frame(viewer, viewer->screenshot, viewer->by_key);
    viewer->by_key = false;
    viewer->screenshot[0] = '\0';
    if (options->frames > 0 && viewer->frame >= options->frames)
        viewer->close = true;
    if (viewer->close && options->screenshot != NULL)
        files_save_frame(viewer, options->screenshot, false);
    window_show(viewer->window);
    pace_frame(viewer->pace, begin, window_time(), viewer->shown != NULL,
               atomic_load(&viewer->control->finished));
    return true;
}

bool viewer_run(const ViewerOptions *options, Mailbox *mailbox, Control *control, Pace *pace,
                Error *err)
{
    assert(options->width > 0 && options->height > 0);
    Viewer viewer = { .options = options, .mailbox = mailbox, .control = control,
                      .pace = pace,
                      .automatic = !options->exposure_set, .panels = !options->no_panels,
                      .at_home = true, .dirty = true };
    viewer.view = (GlView){ .exposure = options->exposure_set ? options->exposure : 0,
                            .tone = options->tone, .picked = PATCH_NONE,
                            .width = options->width, .height = options->height };
    measuring_init(&viewer.measuring);
    const bool opened = open_viewer(&viewer, err);
    while (opened && !viewer.close && !error_is_set(err) && !atomic_load(&control->failed))
        one_frame(&viewer, err);
    atomic_store(&control->quit, true);
    close_viewer(&viewer);
    return !error_is_set(err);
}
