/* SPDX-License-Identifier: BSD-3-Clause */
/* The panel of measuring: false colours, work plane, region, probes. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "viewer/gui.h"
#include "viewer/internal.h"

static const double COLUMN = 11;        /* letters before the second column */
/* Metres: a table is 0.75 m high, a corridor is measured on its floor, a shelf at 2 m. */
static const double HEIGHT_LEAST = -1, HEIGHT_MOST = 5, MARGIN_MOST = 2;
enum { PROBES_LISTED = 6 };

__attribute__((format(printf, 2, 3)))
static void row(const char *name, const char *format, ...)
{
    char text[160];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    gui_row(name, COLUMN, text);
}

static bool lux(const Viewer *viewer) { return viewer->options->photometric; }

static void false_rows(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const char *names[SHOWN_COUNT];
    int layer = (int)m->layer;
    bool logarithmic = m->map.scale.logarithmic;
    const bool picked = viewer->shown != NULL &&
                        viewer->view.picked < viewer->shown->mesh->patch_count;
    for (int k = 0; k < SHOWN_COUNT; k++)
        names[k] = layer_name((ShownLayer)k);
    if (gui_check("false colours", &m->on))
        measuring_renew(viewer);
    if (!m->on || viewer->shown == NULL)
        return;
    if (gui_choice("of", &layer, names, SHOWN_COUNT)) {
        if (layer_known(viewer->shown, (ShownLayer)layer, picked)) {
            m->layer = (ShownLayer)layer;
            m->map.held = false;
            measuring_renew(viewer);
        } else {
            viewer_say(viewer, layer == SHOWN_FACTORS ? "%s: pick a patch first"
                                                      : "%s: not known now", names[layer]);
        }
    }
    if (gui_check("logarithmic", &logarithmic)) {
        false_map_set_log(&m->map, logarithmic);
        measuring_renew(viewer);
    }
    gui_same_line();
    gui_check("isolines", &m->map.scale.isolines);
    if (m->map.held && gui_button("Fit range")) {
        m->map.held = false;
        measuring_renew(viewer);
    }
}

static void plane_sliders(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const bool picked = viewer->view.picked < viewer->shown->mesh->patch_count;
    bool changed = gui_slider("height", &m->height, HEIGHT_LEAST, HEIGHT_MOST, "%.2f m", false);
    changed |= gui_slider("margin", &m->margin, 0, MARGIN_MOST, "%.2f m", false);
    if (picked || m->over_group)
        changed |= gui_check("over the picked group", &m->over_group);
    if (changed)
        m->plane_fits = false;
}

static void plane_rows(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const char *unit = lux(viewer) ? "lux" : "W/m2";
    if (gui_check("work plane", &m->plane_on))
        m->plane_fits = false;
    if (!m->plane_on || viewer->shown == NULL)
        return;
    plane_sliders(viewer);
    if (m->plane == NULL || m->plane->rays == 0)
        return;
    const PlaneReport *r = &m->report;
    const double unit_m = viewer->options->unit_m;
    row("area", "%.3g x %.3g m", m->plane->length * unit_m, m->plane->width * unit_m);
    row("grid", "%u x %u, p = %.3g m", m->plane->columns, m->plane->rows, m->plane->spacing);
    if (r->all.count < m->plane->count)
        row("in bodies", "%u not counted", m->plane->count - r->all.count);
    row("Eav", "%.4g %s", r->all.mean, unit);
    row("Emin", "%.4g %s", r->all.least, unit);
    row("Emax", "%.4g %s", r->all.greatest, unit);
    row("U0", "%.3f  Emin / Eav", r->uniformity);
    row("Ud", "%.3f  Emin / Emax", r->diversity);
    row("rays", "%u a point", m->plane->rays);
}

static void region_rows(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const Statistics *s = &m->in_region;
    if (gui_check("region of the picture", &m->marking))
        m->has_region = false;
    if (m->marking && m->grip != GRIP_REGION)
        gui_dim("drag over what is to be measured");
    if (!m->has_region || m->marking)
        return;
    const ShownLayer layer = measuring_layer(viewer);
    const char *unit = layer_unit(layer, lux(viewer));
    row("of", "%s", layer_name(layer));
    row("seen", "%.3g m2", m->region_area);
    row("min", "%.4g %s", s->least, unit);
    row("mean", "%.4g %s", s->mean, unit);
    row("median", "%.4g %s", s->median, unit);
    row("max", "%.4g %s", s->greatest, unit);
    row("deviation", "%.3g %s", s->deviation, unit);
}

static void probe_rows(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const char *unit = lux(viewer) ? "lux" : "W/m2";
    const size_t n = m->probes.count;
    if (n == 0)
        gui_dim("Shift-click keeps a probe");
    for (size_t i = n > PROBES_LISTED ? n - PROBES_LISTED : 0; i < n; i++) {
        const Probe *p = &m->probes.probe[i];
        char name[32];
        snprintf(name, sizeof name, "%zu", i + 1);
        if (isnan(p->reading.irradiance))
            row(name, "%.16s", p->group);
        else
            row(name, "%.4g %s  %.14s", p->reading.irradiance, unit, p->group);
    }
    if (n > 0 && gui_button("Forget last"))
        probes_remove(&m->probes, n - 1);
    if (n > 0)
        gui_same_line();
    if ((n > 0 || m->plane != NULL) && gui_button("Save CSV"))
        measuring_act(viewer, ACTION_SAVE_CSV);
}

void measuring_panel(Viewer *viewer)
{
    assert(viewer->panel[PANEL_MEASURE].there);
    if (panel_begin(viewer, PANEL_MEASURE, "Measure")) {
        false_rows(viewer);
        plane_rows(viewer);
        region_rows(viewer);
        probe_rows(viewer);
    }
    viewer->measuring.panel_bottom = panel_end(viewer, PANEL_MEASURE);
}
