/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of lamps and paint: dimmers and colours. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "math/tolerance.h"
#include "viewer/gui.h"
#include "viewer/internal.h"

static const double DIM_MOST = 4, PAINT_MOST = 2;

/* sRGB of IEC 61966-2-1, for colours as a screen shows them, and back. */
static double to_screen(double v)
{
    const double x = fmin(1, fmax(0, v));
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

static double from_screen(double v)
{
    const double x = fmin(1, fmax(0, v));
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

/* Times the scene's own, by luminance. */
static double dimmed_to(const Knob *knob, Rgb value)
{
    const double base = rgb_luminance(knob->base);
    return base > 0 ? rgb_luminance(value) / base : 1;
}

static Rgb limited(const Knob *knob, Rgb v)
{
    const double most = knob_shines(knob) ? INFINITY : TOLERANCE_REFLECTANCE_MAX;
    return rgb(fmin(fmax(v.r, 0), most), fmin(fmax(v.g, 0), most), fmin(fmax(v.b, 0), most));
}

/* The same colour, brighter or darker; from black the scene's own. */
static Rgb dim_to(const Knob *knob, Rgb value, double dim)
{
    const double now = dimmed_to(knob, value);
    return limited(knob, now > 0 ? rgb_scale(value, dim / now) : rgb_scale(knob->base, dim));
}

/* Colour of a lamp: its brightest band is 1 on the screen; of paint: as it is. */
static Rgb shown_colour(const Knob *knob, Rgb value)
{
    const double most = rgb_max(value);
    if (!knob_shines(knob))
        return value;
    return most > 0 ? rgb_scale(value, 1 / most) : knob->base;
}

/* The picked colour; a lamp stays as bright as it was. */
static Rgb coloured(const Knob *knob, Rgb value, Rgb colour)
{
    const double luminance = rgb_luminance(colour);
    if (!knob_shines(knob))
        return limited(knob, colour);
    return luminance > 0 ? rgb_scale(colour, rgb_luminance(value) / luminance) : value;
}

/* Numbers behind the names keep apart what is called alike. */
static void knob_row(Viewer *viewer, const Knob *knob, uint32_t k)
{
    char name[80];
    Knobs *knobs = &viewer->control->knobs;
    Rgb value = knobs_value(knobs, knob, k);
    const Rgb c = shown_colour(knob, value);
    double dim = dimmed_to(knob, value);
    double screen[3] = { to_screen(c.r), to_screen(c.g), to_screen(c.b) };
    snprintf(name, sizeof name, "##colour%u", k);
    if (gui_colour(name, screen)) {
        value = coloured(knob, value, rgb(from_screen(screen[0]), from_screen(screen[1]),
                                          from_screen(screen[2])));
        knobs_turn(knobs, k, value);
    }
    gui_same_line();
    snprintf(name, sizeof name, "%.15s##%u", knob->name[0] != '\0' ? knob->name : "-", k);
    if (gui_slider(name, &dim, 0, knob_shines(knob) ? DIM_MOST : PAINT_MOST, "x %.2f", false))
        knobs_turn(knobs, k, dim_to(knob, value, fmax(0, dim)));
}

static void knob_rows(Viewer *viewer, bool shines, const char *heading)
{
    const ShownMesh *mesh = viewer->shown->mesh;
    bool any = false;
    for (uint32_t k = 0; k < mesh->knob_count; k++) {
        if (knob_shines(&mesh->knob[k]) != shines)
            continue;
        if (!any)
            gui_heading(heading);
        any = true;
        knob_row(viewer, &mesh->knob[k], k);
    }
}

void panels_change(Viewer *viewer)
{
    Knobs *knobs = &viewer->control->knobs;
    assert(viewer->shown != NULL);
    if (panel_begin(viewer, PANEL_CHANGE, "Lamps and paint")) {
        if (viewer->options->solved) {
            gui_dim("a solution cannot be changed");
            viewer->measuring.panel_bottom = panel_end(viewer, PANEL_CHANGE);
            return;
        }
        if (viewer->shown->step < STEP_SOLVED)
            gui_dim("light follows once it is solved for");
        knob_rows(viewer, true, "Light");
        knob_rows(viewer, false, "Reflectance");
        if (gui_button("As in the scene"))
            knobs_reset(knobs);
        gui_same_line();
        if (gui_button("Save changes")) {
            if (viewer->shown->step < STEP_SOLVED)
                viewer_say(viewer, "not saved: light is not solved for yet");
            else
                atomic_store(&knobs->save, true);
        }
    }
    viewer->measuring.panel_bottom = panel_end(viewer, PANEL_CHANGE);
}
