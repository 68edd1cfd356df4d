/* SPDX-License-Identifier: BSD-3-Clause */
/* Panels: what the solver does, how it is shown, what was picked. */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "math/rgb.h"
#include "radiosity/solve.h"
#include "viewer/gathered.h"
#include "viewer/gui.h"
#include "viewer/internal.h"

static const double PI = 3.14159265358979323846;
static const double COLUMN = 13; /* letters before the second column */
static const double LEFT_WIDTH = 290, MEASURE_WIDTH = 250; /* of panels, at scale 1 */
/* Per cent, of solvers that estimate their error: what rays come to in seconds, and in hours. */
static const double ERROR_LEAST = 0.1, ERROR_MOST = 20;

__attribute__((format(printf, 2, 3)))
static void row(const char *name, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    gui_row(name, COLUMN, text);
}

/* 2.08 M */
static const char *count_text(double n, char *text, size_t size)
{
    static const char *const units[] = { "", " k", " M", " G", " T" };
    unsigned k = 0;
    for (; n >= 9999.5 && k < 4; k++)
        n /= 1000;
    snprintf(text, size, k == 0 ? "%.0f%s" : "%.4g%s", n, units[k]);
    return text;
}

static void ask_tolerance(Control *control, _Atomic double *which, double tolerance)
{
    atomic_store(which, tolerance);
    atomic_store(&control->knobs.settled, UINT_MAX); /* until it is solved for */
}

static void solver_choices(Viewer *viewer)
{
    const char *names[SOLVER_COUNT + 1];
    Control *control = viewer->control;
    int solver = atomic_load(&control->solver);
    const bool estimates = solver == SOLVER_COUNT || solver == SOLVER_HIERARCHICAL;
    double tolerance = log10(atomic_load(&control->tolerance));
    double error = 100 * atomic_load(&control->error);
    for (int k = 0; k < SOLVER_COUNT; k++)
        names[k] = solver_name((Solver)k);
    names[SOLVER_COUNT] = "stochastic";
    if (gui_choice("solver", &solver, names, SOLVER_COUNT + 1)) {
        atomic_store(&control->solver, solver);
        if (estimates || solver == SOLVER_COUNT || solver == SOLVER_HIERARCHICAL)
            viewer_say(viewer, "the solver is another from the next beginning on: Ctrl-R");
        else
            viewer_say(viewer, "goes on with %s", names[solver]);
    }
    if (estimates && gui_slider("tolerance", &error, ERROR_LEAST, ERROR_MOST, "%.2g %%", true))
        ask_tolerance(control, &control->error, 0.01 * fmax(ERROR_LEAST, error));
    if (!estimates && gui_slider("tolerance", &tolerance, -8, -1, "1e%.0f", false))
        ask_tolerance(control, &control->tolerance, pow(10, round(tolerance)));
}

static void solver_rows(const Report *r)
{
    char text[32];
    if (r->patches > 0)
        row("patches", "%u", r->patches);
    if (r->rays > 0 && r->rays_per_second > 0) {
        char speed[32];
        row("rays", "%s, %s/s", count_text((double)r->rays, text, sizeof text),
            count_text(r->rays_per_second, speed, sizeof speed));
    } else if (r->rays > 0) {
        row("rays", "%s", count_text((double)r->rays, text, sizeof text));
    }
    if (r->unshot >= 0)
        row("unshot", "%.3g %% of the power", 100 * r->unshot);
    if (r->residual >= 0 && r->estimated)
        row("off by", "%.2g %%, estimated", 100 * r->residual);
    else if (r->residual >= 0)
        row("residual", "%.2g after %u steps", r->residual, r->steps);
    row("memory", "%.0f MB", 1e-6 * (double)r->memory);
    if (r->left >= 1)
        row("time", "%.1f s, about %.0f s to go", r->seconds, r->left);
    else
        row("time", "%.1f s", r->seconds);
}

static void solver_panel(Viewer *viewer)
{
    const Report *r = &viewer->report;
    const bool paused = atomic_load(&viewer->control->paused);
    if (panel_begin(viewer, PANEL_SOLVER, viewer->options->solved ? "Solution" : "Solver")) {
        char text[96];
        const char *doing = paused ? "paused" : r->doing;
        const bool known = r->done >= 0 && r->done < 1;
        snprintf(text, sizeof text, known ? "%s  %.0f %%" : "%s", doing, 100 * r->done);
        gui_bar(r->done, text);
        if (viewer->options->solved) {
            solver_rows(r);
            panel_end(viewer, PANEL_SOLVER);
            return;
        }
        if (gui_button(paused ? "Go on" : "Pause"))
            viewer_act(viewer, ACTION_PAUSE, 0);
        gui_same_line();
        if (gui_button("Step"))
            viewer_act(viewer, ACTION_STEP, 0);
        gui_same_line();
        if (gui_button("Restart"))
            viewer_act(viewer, ACTION_RESTART, 0);
        solver_rows(r);
        solver_choices(viewer);
    }
    panel_end(viewer, PANEL_SOLVER);
}

static void choose_layer(Viewer *viewer)
{
    static const char *const names[] = { "radiosity", "irradiance", "direct light", "unshot",
                                         "error" };
    int layer = (int)viewer->view.layer;
    if (!gui_choice("layer", &layer, names, LAYER_COUNT))
        return;
    Error err = { 0 };
    if (viewer->shown == NULL || viewer->shown->layer[layer] == NULL) {
        viewer_say(viewer, "%s is not known at this stage", names[layer]);
    } else if (gl_take(viewer->gl, viewer->shown, (Layer)layer, &err)) {
        viewer->view.layer = (Layer)layer;
        viewer->exposure_due = viewer->automatic;
    }
}

static void view_panel(Viewer *viewer)
{
    static const char *const shadings[] = { "smooth", "patches", "wires" };
    static const char *const backs[] = { "hidden", "red", "grey" };
    static const char *const tones[] = { "shoulder", "linear", "reinhard", "filmic" };
    GlView *view = &viewer->view;
    if (panel_begin(viewer, PANEL_VIEW, "View")) {
        int shading = (int)view->shading, back = (int)view->backs, tone = (int)view->tone;
        char text[64];
        choose_layer(viewer);
        if (gui_choice("shading", &shading, shadings, SHADING_COUNT))
            view->shading = (Shading)shading;
        if (gui_choice("back faces", &back, backs, BACKS_COUNT))
            view->backs = (Backs)back;
        if (gui_choice("tone", &tone, tones, 4))
            view->tone = (ToneCurve)tone;
        if (gui_slider("exposure", &view->exposure, -20, 20, "%+.2f EV", false))
            viewer->automatic = viewer->exposure_due = false;
        if (gui_slider("field of view", &view->camera.vertical_fov, 5, 120, "%.0f deg", false)) {
            viewer->exposure_due = viewer->automatic;
            viewer->measuring.has_region = false;
        }
        if (gui_check("auto exposure", &viewer->automatic))
            viewer->exposure_due = viewer->automatic;
        gui_same_line();
        gui_check("outlines", &view->outlines);
        snprintf(text, sizeof text, "%.0f frames/s, F1 shows the keys",
                 viewer->frame_seconds > 0 ? 1 / viewer->frame_seconds : 0);
        gui_dim(text);
        gathered_row(viewer);
    }
    panel_end(viewer, PANEL_VIEW);
}

/* --- what was picked -------------------------------------------------------------------------- */

static double luminance_of(const float *value, uint32_t patch)
{
    const float *v = value + 3 * (size_t)patch;
    return rgb_luminance(rgb(v[0], v[1], v[2]));
}

static void light_rows(const Viewer *viewer, uint32_t i)
{
    assert(viewer->shown->layer[LAYER_RADIOSITY] != NULL);
    const Snapshot *s = viewer->shown;
    const bool lux = viewer->options->photometric;
    const float *b = s->layer[LAYER_RADIOSITY], *h = s->layer[LAYER_IRRADIANCE];
    if (h != NULL)
        row("irradiance", "%.4g %s", luminance_of(h, i), lux ? "lux" : "W/m2");
    if (s->layer[LAYER_DIRECT] != NULL)
        row("direct", "%.4g %s", luminance_of(s->layer[LAYER_DIRECT], i), lux ? "lux" : "W/m2");
    row("radiosity", "%.4g %s", luminance_of(b, i), lux ? "lm/m2" : "W/m2");
    row(lux ? "luminance" : "radiance", "%.4g %s", luminance_of(b, i) / PI,
        lux ? "cd/m2" : "W/m2/sr");
    const float *e = s->layer[LAYER_ERROR];
    if (e != NULL && luminance_of(e, i) > 0)
        row("error", "%.2g %s", luminance_of(e, i), lux ? "lux" : "W/m2");
    else if (e != NULL)
        row("error", "less than rays tell");
    if (s->row_sum != NULL)
        row("row sum", "%.7f", (double)s->row_sum[i]);
}

static void patch_panel(Viewer *viewer)
{
    assert(viewer->shown != NULL && viewer->view.picked < viewer->shown->mesh->patch_count);
    const ShownMesh *mesh = viewer->shown->mesh;
    const uint32_t i = viewer->view.picked;
    const ShownPatch *p = &mesh->patch[i];
    const Rgb rho = snapshot_reflectance(viewer->shown, i);
    const double unit = viewer->options->unit_m;
    if (panel_begin(viewer, PANEL_PATCH, "Patch")) {
        if (viewer->options->solved) /* how often is not in its file */
            row("patch", "%u, %s", i, p->side == 0 ? "front" : "back");
        else
            row("patch", "%u, %s, divided %u times", i, p->side == 0 ? "front" : "back", p->level);
        row("group", "%.32s", mesh->group_name[p->group]);
        row("material", "%.32s", mesh->material_name[p->material]);
        row("reflects", "%.3g %.3g %.3g", rho.r, rho.g, rho.b);
        row("area", "%.4g m2", p->area * unit * unit);
        row("at", "%.4g %.4g %.4g", viewer->picked_at.x, viewer->picked_at.y,
            viewer->picked_at.z);
        light_rows(viewer, i);
    }
    panel_end(viewer, PANEL_PATCH);
}

/* Two columns where there is room: all keys at one look. */
static void help_overlay(double scale, int width, int height)
{
    size_t count;
    const Binding *table = bindings_table(&count);
    const bool wide = width >= 920 * scale;
    const char *chapter = "";
    enum { HALF_LESS = 6 }; /* rows: a chapter that begins so near to the middle ends the column */
    if (gui_overlay("Keys and mouse", fmin(width - 24, (wide ? 960 : 500) * scale),
                    fmin(height - 24, (wide ? 620 : 960) * scale))) {
        bool second = !wide;
        gui_columns(wide ? 2 : 1);
        for (size_t i = 0; i < count; i++) {
            const bool begins = table[i].chapter != chapter;
            if (begins && !second && 2 * i >= count - HALF_LESS) {
                gui_next_column();
                second = true;
            }
            if (begins)
                gui_heading(table[i].chapter);
            chapter = table[i].chapter;
            gui_row(table[i].name, 26, table[i].text);
        }
        gui_columns(1);
    }
    gui_panel_end(NULL);
}

static void lay_out(Viewer *viewer, double scale)
{
    LaidPanel *panel = viewer->panel;
    const Snapshot *s = viewer->shown;
    const bool changing = viewer->changing && s != NULL;
    panel[PANEL_SOLVER].there = panel[PANEL_VIEW].there = true;
    panel[PANEL_PATCH].there = s != NULL && viewer->view.picked < s->mesh->patch_count;
    panel[PANEL_CHANGE].there = changing;
    panel[PANEL_MEASURE].there = !changing;
    const LayoutSize size = { viewer->view.width, viewer->view.height, gui_title_height(),
                              LEFT_WIDTH * scale,
                              (changing ? LEFT_WIDTH : MEASURE_WIDTH) * scale };
    layout_panels(&size, panel);
}

/* Folded or opened when its place changes: in between it is as hands have left it. */
bool panel_begin(Viewer *viewer, PanelId id, const char *title)
{
    const LaidPanel *p = &viewer->panel[id];
    assert(p->there);
    if (p->fold != viewer->folded[id])
        gui_fold(p->fold);
    viewer->folded[id] = p->fold;
    return gui_panel(title, p->x, p->y, p->width, p->room);
}

double panel_end(Viewer *viewer, PanelId id) { return gui_panel_end(&viewer->panel[id].need); }

void panels_draw(Viewer *viewer)
{
    const double scale = window_scale(viewer->window);
    lay_out(viewer, scale);
    if (viewer->panels) {
        solver_panel(viewer);
        view_panel(viewer);
        if (viewer->panel[PANEL_PATCH].there)
            patch_panel(viewer);
        if (viewer->panel[PANEL_CHANGE].there)
            panels_change(viewer);
        else
            measuring_panel(viewer);
    }
    marks_shot(viewer);
    measuring_marks(viewer, scale);
    if (viewer->help)
        help_overlay(scale, viewer->view.width, viewer->view.height);
    if (window_time() < viewer->notice_until)
        gui_notice(viewer->notice);
}
