/* SPDX-License-Identifier: BSD-3-Clause */
/* Events become movements and actions. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "viewer/files.h"
#include "viewer/gathered.h"
#include "viewer/gui.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"

static const double PI = 3.14159265358979323846;
static const double CLICK_PIXELS = 4;     /* a press that moves no further is a click */
static const double DOUBLE_SECONDS = 0.4;
static const double STOP_THIRD = 1.0 / 3; /* EV */
static const double FOV_STEP = 1.1, FOV_LEAST = 5, FOV_MOST = 120; /* degrees */
static const double WHEEL_STEP = 0.88;
static const double FLY_SHARE = 0.25;     /* of the scene's size, a second */
static const double FLY_FAST = 4;

static double scene_size(const Viewer *viewer)
{
    const ShownMesh *mesh = viewer->shown->mesh;
    return vec3_length(vec3_sub(mesh->hi, mesh->lo));
}

void viewer_say(Viewer *viewer, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(viewer->notice, sizeof viewer->notice, format, arguments);
    va_end(arguments);
    viewer->notice_until = window_time() + 3;
    viewer->dirty = true;
}

/* --- actions ---------------------------------------------------------------------------------- */

static void moved(Viewer *viewer)
{
    viewer->dirty = true;
    viewer->exposure_due = viewer->automatic;
    viewer->view.gathered = false;
    viewer->measuring.has_region = false; /* it was one of the picture before */
}

static void frame(Viewer *viewer, Action action)
{
    assert(viewer->shown != NULL);
    const GlView *v = &viewer->view;
    const ShownMesh *mesh = viewer->shown->mesh;
    const double aspect = v->height > 0 ? (double)v->width / v->height : 1;
    if (action == ACTION_FRAME_ALL) {
        view_fit(&viewer->view.camera, vec3_lerp(mesh->lo, mesh->hi, 0.5),
                 0.5 * scene_size(viewer), aspect);
    } else if (v->picked < mesh->patch_count) {
        const ShownPatch *p = &mesh->patch[v->picked];
        view_fit(&viewer->view.camera, p->centre, 3 * sqrt(p->area), aspect);
    }
    moved(viewer);
}

static void stored_view(Viewer *viewer, int key, bool store)
{
    const int i = key - '1';
    assert(i >= 0 && i < STORED_VIEWS);
    if (store) {
        viewer->stored[i] = viewer->view.camera;
        viewer->is_stored[i] = true;
        viewer_say(viewer, "view %d stored", i + 1);
    } else if (viewer->is_stored[i]) {
        viewer->view.camera = viewer->stored[i];
        moved(viewer);
    } else {
        viewer_say(viewer, "no view %d is stored; Shift-%d stores one", i + 1, i + 1);
    }
}

static void next_camera(Viewer *viewer, uint32_t by)
{
    const ShownMesh *mesh = viewer->shown->mesh;
    assert(mesh->camera_count > 0);
    viewer->camera_number = (viewer->camera_number + by) % mesh->camera_count;
    viewer->view.camera = mesh->camera[viewer->camera_number];
    viewer_say(viewer, "camera %u of %u %s", viewer->camera_number + 1, mesh->camera_count,
               viewer->view.camera.name);
    moved(viewer);
}

static void widen(Viewer *viewer, double factor)
{
    Camera *camera = &viewer->view.camera;
    camera->vertical_fov = fmin(FOV_MOST, fmax(FOV_LEAST, camera->vertical_fov * factor));
    moved(viewer);
}

static void expose(Viewer *viewer, double by)
{
    viewer->automatic = viewer->exposure_due = false;
    viewer->view.exposure += by;
}

static void act_on_scene(Viewer *viewer, Action action, int key)
{
    switch (action) {
    case ACTION_FRAME_ALL:
    case ACTION_FRAME_PICKED:
        frame(viewer, action);
        break;
    case ACTION_VIEW:
    case ACTION_STORE_VIEW:
        stored_view(viewer, key, action == ACTION_STORE_VIEW);
        break;
    case ACTION_CAMERA_BEFORE:
        next_camera(viewer, viewer->shown->mesh->camera_count - 1);
        break;
    case ACTION_CAMERA_NEXT:
        next_camera(viewer, 1);
        break;
    case ACTION_WIDER:
    case ACTION_NARROWER:
        widen(viewer, action == ACTION_WIDER ? FOV_STEP : 1 / FOV_STEP);
        break;
    default:
        break;
    }
}

static void act_on_solver(Viewer *viewer, Action action)
{
    Control *control = viewer->control;
    switch (action) {
    case ACTION_PAUSE:
        atomic_store(&control->paused, !atomic_load(&control->paused));
        viewer_say(viewer, atomic_load(&control->paused) ? "paused" : "going on");
        break;
    case ACTION_STEP:
        atomic_store(&control->paused, true);
        atomic_fetch_add(&control->steps, 1);
        viewer->view.rays = true;
        break;
    case ACTION_RESTART:
    case ACTION_RELOAD:
        viewer_say(viewer, action == ACTION_RELOAD ? "reading again" : "from the beginning");
        gathered_drop(viewer);
        knobs_reset(&control->knobs);
        viewer->restarted = viewer->shown != NULL;
        atomic_store(&control->finished, false);
        atomic_store(&control->paused, false);
        atomic_store(&control->restart, true);
        break;
    default:
        break;
    }
}

static void act_on_picture(Viewer *viewer, Action action)
{
    GlView *view = &viewer->view;
    switch (action) {
    case ACTION_BRIGHTER:
        expose(viewer, STOP_THIRD);
        break;
    case ACTION_DARKER:
        expose(viewer, -STOP_THIRD);
        break;
    case ACTION_AUTO_EXPOSURE:
        viewer->automatic = viewer->exposure_due = !viewer->automatic;
        break;
    case ACTION_TONE:
        view->tone = (ToneCurve)((view->tone + 1) % (TONE_FILMIC + 1));
        break;
    case ACTION_SHADING:
        view->shading = (Shading)((view->shading + 1) % SHADING_COUNT);
        break;
    case ACTION_OUTLINES:
        view->outlines = !view->outlines;
        break;
    case ACTION_BACKS:
        view->backs = (Backs)((view->backs + 1) % BACKS_COUNT);
        break;
    default:
        break;
    }
}

static void next_layer(Viewer *viewer)
{
    assert(viewer->shown != NULL && viewer->shown->layer[LAYER_RADIOSITY] != NULL);
    const Snapshot *s = viewer->shown;
    Error err = { 0 };
    unsigned k = viewer->view.layer;
    do {
        k = (k + 1) % LAYER_COUNT;
    } while (s->layer[k] == NULL);
    viewer->view.layer = (Layer)k;
    viewer->exposure_due = viewer->automatic;
    if (!gl_take(viewer->gl, s, viewer->view.layer, &err))
        viewer_say(viewer, "%s", err.text);
}

static void leave(Viewer *viewer)
{
    viewer->help = viewer->pointer.flying = viewer->view.rays = false;
    gathered_drop(viewer);
    viewer->view.picked = PATCH_NONE;
    viewer->measuring.marking = viewer->measuring.has_region = false;
}

void viewer_act(Viewer *viewer, Action action, int key)
{
    viewer->dirty = true;
    if (action >= ACTION_FRAME_ALL && action <= ACTION_NARROWER && viewer->shown != NULL)
        act_on_scene(viewer, action, key);
    else if (action >= ACTION_PAUSE && action <= ACTION_RELOAD)
        act_on_solver(viewer, action);
    else if (action == ACTION_LAYER && viewer->shown != NULL)
        next_layer(viewer);
    else if (action >= ACTION_BRIGHTER && action <= ACTION_BACKS)
        act_on_picture(viewer, action);
    else if (action >= ACTION_FALSE_COLOUR && action <= ACTION_SAVE_CSV)
        measuring_act(viewer, (int)action);
    else if (action == ACTION_FLY)
        viewer->pointer.flying = !viewer->pointer.flying;
    else if (action == ACTION_SAVE_PNG)
        files_save_png(viewer);
    else if (action == ACTION_SAVE_EXR)
        files_save_exr(viewer);
    else if (action == ACTION_GATHER)
        gathered_ask(viewer);
    else if (action == ACTION_CHANGE)
        viewer->changing = !viewer->changing;
    else if (action == ACTION_PANELS)
        viewer->panels = !viewer->panels;
    else if (action == ACTION_HELP)
        viewer->help = !viewer->help;
    else if (action == ACTION_LEAVE)
        leave(viewer);
    else if (action == ACTION_QUIT)
        viewer->close = true;
}

/* --- mouse ------------------------------------------------------------------------------------ */

static void click(Viewer *viewer, bool twice, bool keep)
{
    Vec3 at;
    Hit hit;
    const Pointer *p = &viewer->pointer;
    const uint32_t patch = pick_hit(viewer, p->x, p->y, &hit, &at);
    viewer->view.picked = patch;
    viewer->picked_at = at;
    if (patch != PATCH_NONE)
        measuring_pick(viewer, hit.primitive, (double)hit.u, (double)hit.v, keep);
    if (twice && patch != PATCH_NONE) {
        viewer->view.camera.target = at;
        moved(viewer);
    }
}

static void button(Viewer *viewer, const Event *event)
{
    Pointer *p = &viewer->pointer;
    const double now = window_time();
    p->down[event->code] = event->down;
    p->x = event->x;
    p->y = event->y;
    if (event->down) {
        p->over_panel = gui_has_mouse();
        p->press_x = event->x;
        p->press_y = event->y;
        if (event->code == BUTTON_LEFT && !p->over_panel)
            measuring_button(viewer, true, p->x, p->y);
        return;
    }
    if (event->code == BUTTON_LEFT && measuring_button(viewer, false, p->x, p->y))
        return;
    const bool still = hypot(event->x - p->press_x, event->y - p->press_y) < CLICK_PIXELS;
    if (!still || p->over_panel || event->code != BUTTON_LEFT || viewer->shown == NULL)
        return;
    const bool there = hypot(event->x - p->click_x, event->y - p->click_y) < CLICK_PIXELS;
    const bool keep = p->key[KEY_SHIFT] || (event->mods & MOD_SHIFT) != 0;
    click(viewer, there && !keep && now - p->click_time < DOUBLE_SECONDS, keep);
    p->click_time = now;
    p->click_x = event->x;
    p->click_y = event->y;
}

static void drag(Viewer *viewer, double dx, double dy)
{
    const Pointer *p = &viewer->pointer;
    assert(viewer->shown != NULL);
    Camera *camera = &viewer->view.camera;
    const Vec3 up = viewer->shown->mesh->up;
    const double pixel = PI / fmax(viewer->view.height, 1);
    const double distance = vec3_length(vec3_sub(camera->target, camera->eye));
    const double there = 2 * distance * tan(camera->vertical_fov * PI / 360) /
                         fmax(viewer->view.height, 1);
    if (p->down[BUTTON_MIDDLE] || (p->down[BUTTON_LEFT] && p->key[KEY_SHIFT]))
        view_move(camera, -dx * there, dy * there, 0);
    else if (p->down[BUTTON_LEFT])
        view_orbit(camera, up, dx * pixel, -dy * pixel);
    else if (p->down[BUTTON_RIGHT] || p->flying)
        view_look(camera, up, 0.5 * dx * pixel, -0.5 * dy * pixel);
    else
        return;
    moved(viewer);
}

static void pointer_moved(Viewer *viewer, const Event *event)
{
    Pointer *p = &viewer->pointer;
    const double dx = event->x - p->x, dy = event->y - p->y;
    p->x = event->x;
    p->y = event->y;
    if (viewer->shown != NULL && !p->over_panel &&
        !measuring_move(viewer, event->x, event->y, dx, dy))
        drag(viewer, dx, dy);
}

/* --- all of it -------------------------------------------------------------------------------- */

static bool is_flying(const Viewer *viewer)
{
    const Pointer *p = &viewer->pointer;
    return viewer->shown != NULL && (p->flying || (p->down[BUTTON_RIGHT] && !p->over_panel));
}

static void key_event(Viewer *viewer, const Event *event)
{
    static const char flown[] = "WASDQE";
    if (event->code > 0 && event->code < KEY_MOST)
        viewer->pointer.key[event->code] = event->down;
    const bool flies = is_flying(viewer) && event->code < 128 && event->code > 0 &&
                       strchr(flown, event->code) != NULL && (event->mods & MOD_CONTROL) == 0;
    if (event->down && !flies && !gui_has_keys())
        viewer_act(viewer, bindings_find(event->code, event->mods), event->code);
}

void input_event(Viewer *viewer, const Event *event)
{
    viewer->dirty = true;
    gui_event(event);
    switch (event->kind) {
    case EVENT_KEY:
        key_event(viewer, event);
        break;
    case EVENT_BUTTON:
        button(viewer, event);
        break;
    case EVENT_MOVE:
        pointer_moved(viewer, event);
        break;
    case EVENT_WHEEL:
        if (!gui_has_mouse() && viewer->shown != NULL) {
            view_dolly(&viewer->view.camera, pow(WHEEL_STEP, event->y));
            moved(viewer);
        }
        break;
    case EVENT_CLOSE:
        viewer->close = true;
        break;
    case EVENT_SCALE:
        viewer->rescaled = true;
        break;
    case EVENT_CHARACTER:
        break;
    }
}

void input_fly(Viewer *viewer, double seconds)
{
    const bool *key = viewer->pointer.key;
    if (!is_flying(viewer))
        return;
    const double speed = FLY_SHARE * scene_size(viewer) * (key[KEY_SHIFT] ? FLY_FAST : 1);
    const double step = speed * fmin(seconds, 0.1);
    const double right = key['D'] - key['A'], up = key['E'] - key['Q'];
    const double forward = key['W'] - key['S'];
    if (right != 0 || up != 0 || forward != 0) {
        view_move(&viewer->view.camera, step * right, step * up, step * forward);
        moved(viewer);
    }
}
