/* SPDX-License-Identifier: BSD-3-Clause */
/* The gathered picture in the window. */
#include "viewer/gathered.h"

#include <assert.h>
#include <stdio.h>

#include "viewer/gui.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"

/* The window draws all cameras as pinholes, and so the picture is made. */
static Camera camera_of_view(const Viewer *viewer)
{
    Camera camera = viewer->view.camera;
    camera.projection = CAMERA_PERSPECTIVE;
    camera.aperture = 0;
    return camera;
}

static bool is_this_view(const Viewer *viewer, const EaselWish *wish)
{
    const GlView *view = &viewer->view;
    return view->width == wish->width && view->height == wish->height &&
           view_same(&view->camera, &wish->camera);
}

void gathered_ask(Viewer *viewer)
{
    Control *control = viewer->control;
    const Camera camera = camera_of_view(viewer);
    Error err = { 0 };
    if (viewer->shown == NULL) {
        viewer_say(viewer, "nothing is to be seen yet");
        return;
    }
    if (viewer->view.width < 1 || viewer->view.height < 1)
        return;
    viewer->picture_knobs = atomic_load(&control->knobs.version);
    if (!easel_ask(&control->easel, &camera, viewer->view.width, viewer->view.height, &err))
        viewer_say(viewer, "%s", err.text);
    viewer->dirty = true;
}

void gathered_drop(Viewer *viewer)
{
    if (easel_state(&viewer->control->easel, NULL, NULL) == EASEL_EMPTY)
        return;
    easel_drop(&viewer->control->easel);
    viewer->dirty = true;
}

bool gathered_awaited(const Viewer *viewer)
{
    const EaselState state = easel_state(&viewer->control->easel, NULL, NULL);
    return state == EASEL_WAITING || state == EASEL_PAINTING;
}

void gathered_work(Viewer *viewer)
{
    Easel *easel = &viewer->control->easel;
    GlView *view = &viewer->view;
    EaselWish wish;
    EaselState state = easel_state(easel, &wish, NULL);
    view->gathered = false;
    if (state == EASEL_EMPTY)
        return;
    if (state == EASEL_FAILED) {
        char why[200];
        easel_why(easel, why, sizeof why);
        viewer_say(viewer, "no picture: %s", why);
    }
    if (state == EASEL_FAILED || !is_this_view(viewer, &wish) ||
        viewer->picture_knobs != atomic_load(&viewer->control->knobs.version)) {
        easel_drop(easel);
        return;
    }
    const float *pixel = easel_open(easel, &viewer->picture_seen);
    if (pixel != NULL) {
        gl_take_picture(viewer->gl, pixel, wish.width, wish.height);
        easel_shut(easel);
    }
    view->gathered = view->map == NULL && view->layer == LAYER_RADIOSITY &&
                     view->shading != SHADING_WIRES;
}

void gathered_row(Viewer *viewer)
{
    double done;
    char text[64];
    switch (easel_state(&viewer->control->easel, NULL, &done)) {
    case EASEL_WAITING:
        gui_bar(-1, "picture: waits for light");
        break;
    case EASEL_PAINTING:
        snprintf(text, sizeof text, "picture  %.0f %%", 100 * done);
        gui_bar(done, text);
        break;
    case EASEL_DONE:
        gui_dim("the picture is finished: S saves it");
        break;
    case EASEL_EMPTY:
    case EASEL_FAILED:
        break;
    }
}
