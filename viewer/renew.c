/* SPDX-License-Identifier: BSD-3-Clause */
/* What lives on the graphics card, made and made again from what lies in memory. */
#include <assert.h>

#include "viewer/gui.h"
#include "viewer/internal.h"

bool renew_open(Viewer *viewer, Error *err)
{
    assert(viewer->gl == NULL && !viewer->has_gui);
    viewer->gl = gl_create(err);
    if (viewer->gl == NULL)
        return false;
    viewer->has_gui = gui_create(window_scale(viewer->window));
    return viewer->has_gui ||
           error_set(err, ERROR_FAILED, "no window: OpenGL does not do for the panels");
}

void renew_leave(Viewer *viewer)
{
    if (viewer->has_gui)
        gui_destroy();
    viewer->has_gui = false;
    viewer->gl = gl_destroy(viewer->gl);
}

/* Light, false colours and the gathered picture go to the new card as they went to the old one. */
static bool renew_all(Viewer *viewer, Error *err)
{
    renew_leave(viewer);
    if (!window_renew(viewer->window, err) || !renew_open(viewer, err))
        return false;
    viewer->picture_seen--;
    viewer->measuring.stale = viewer->measuring.value != NULL;
    window_size(viewer->window, &viewer->view.width, &viewer->view.height);
    return viewer->shown == NULL ||
           gl_take(viewer->gl, viewer->shown, viewer->view.layer, err);
}

bool renew_if_lost(Viewer *viewer, Error *err)
{
    const bool lost = viewer->lose_context || gl_is_lost(viewer->gl);
    const bool rescaled = viewer->rescaled;
    viewer->lose_context = viewer->rescaled = false;
    if (lost)
        return renew_all(viewer, err);
    if (!rescaled)
        return true;
    gui_destroy();
    viewer->has_gui = gui_create(window_scale(viewer->window));
    return viewer->has_gui ||
           error_set(err, ERROR_FAILED, "no window: OpenGL does not do for the panels");
}
