/* SPDX-License-Identifier: BSD-3-Clause */
/* Marks over the picture: the legend, the work plane's points, probes, the region. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "base/array.h"
#include "base/parallel.h"
#include "viewer/gui.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"

static const GuiInk WHITE = { 255, 255, 255, 255 };
static const GuiInk SHADE = { 12, 13, 15, 255 }; /* figures of the plane lie below */
static const GuiInk LINE = { 255, 255, 255, 150 };
static const GuiInk AMBER = { 255, 190, 70, 255 };
static const double BAR = 20;           /* width of the legend's bar */
/* Points nearer to each other than this, in pixels, have no room for a figure. */
static const double FIGURE_ROOM = 44;
/* Points looked at together: fewer are not worth a thread. */
enum { SIGHT_CHUNK = 256 };

/* --- where things are ------------------------------------------------------------------------- */

/* Whether a place is in the picture and seen, and where. */
static bool place_seen(const Viewer *viewer, Vec3 place, double *x, double *y)
{
    const GlView *view = &viewer->view;
    const ShownMesh *mesh = viewer->shown->mesh;
    const Vec3 to = vec3_sub(place, view->camera.eye);
    if (!view_pixel(&view->camera, place, view->width, view->height, x, y))
        return false;
    if (*x < 0 || *y < 0 || *x > view->width || *y > view->height)
        return false;
    /* Up to just before it; a face seen from behind hides nothing. */
    static const double NEARLY = 0.999;
    Ray ray = { .ox = (float)view->camera.eye.x, .oy = (float)view->camera.eye.y,
                .oz = (float)view->camera.eye.z, .dx = (float)to.x, .dy = (float)to.y,
                .dz = (float)to.z, .t_max = (float)NEARLY };
    Hit hit;
    enum { PASSED_MOST = 64 };
    for (int k = 0; k < PASSED_MOST && bvh_nearest(mesh->bvh, &ray, &hit); k++) {
        if (vec3_dot(mesh->patch[mesh->triangle_patch[hit.primitive]].normal, to) < 0)
            return false;
        ray.t_min = nextafterf(hit.t, INFINITY);
    }
    return true;
}

/* --- the legend ------------------------------------------------------------------------------- */

static void legend_bar(const FalseMap *map, const Frame *bar)
{
    uint8_t rgb[3 * FALSE_TEXELS];
    false_map_texels(map, rgb);
    for (int k = 0; k < FALSE_TEXELS; k++) {
        const double height = (bar->y1 - bar->y0) / FALSE_TEXELS;
        const double y = bar->y1 - (k + 1) * height;
        const GuiInk ink = { rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2], 255 };
        gui_mark_box(bar->x0, floor(y), bar->x1, floor(y + height) + 1, ink, true);
    }
    gui_mark_box(bar->x0 - 1, bar->y0 - 1, bar->x1 + 1, bar->y1 + 1, LINE, false);
}

static void legend_ticks(const Viewer *viewer, const Frame *bar, double scale)
{
    const FalseColour *colours = &viewer->measuring.map.scale;
    double tick[FALSE_TICKS];
    const int n = false_colour_ticks(colours, FALSE_TICKS, tick);
    for (int k = 0; k < n; k++) {
        char text[32];
        const double y = bar->y1 - false_colour_place(colours, tick[k]) * (bar->y1 - bar->y0);
        snprintf(text, sizeof text, "%.4g", tick[k]);
        gui_mark_line(bar->x0 - 5 * scale, y, bar->x0, y, WHITE);
        gui_mark_text(bar->x0 - 8 * scale, y, GUI_RIGHT, text, WHITE);
    }
}

static void legend(Viewer *viewer, double scale)
{
    Measuring *m = &viewer->measuring;
    const GlView *view = &viewer->view;
    const bool changing = viewer->panel[PANEL_CHANGE].there;
    const LaidPanel *beside = &viewer->panel[changing ? PANEL_CHANGE : PANEL_MEASURE];
    const bool above = viewer->panels && beside->there && beside->x > view->width / 2.0;
    const double top = above ? m->panel_bottom : 0, least = 150 * scale;
    const bool below = view->height - top > least + 60 * scale;
    const double right = view->width - (below ? 14 * scale : 275 * scale);
    const double y0 = (below ? top : 0) + 42 * scale, y1 = view->height - 28 * scale;
    const Frame bar = { right - BAR * scale, y0, right, fmin(y1, y0 + 420 * scale) };
    char text[64];
    m->legend = (Frame){ 0, 0, -1, -1 }; /* what is not drawn is not dragged */
    if (bar.y1 - bar.y0 < 40 * scale)
        return;
    gui_mark_box(bar.x0 - 76 * scale, bar.y0 - 32 * scale, bar.x1 + 10 * scale,
                 bar.y1 + 16 * scale, SHADE, true);
    const char *unit = layer_unit(m->layer, viewer->options->photometric);
    snprintf(text, sizeof text, unit[0] != '\0' ? "%s, %s" : "%s", layer_name(m->layer), unit);
    gui_mark_text(bar.x1 + 6 * scale, bar.y0 - 19 * scale, GUI_RIGHT, text, WHITE);
    legend_bar(&m->map, &bar);
    legend_ticks(viewer, &bar, scale);
    m->legend = bar;
}

/* --- the plane, probes, the region ------------------------------------------------------------ */

static void plane_corners(const Viewer *viewer)
{
    const Plane *p = viewer->measuring.plane;
    double x[4], y[4];
    bool seen[4];
    for (unsigned k = 0; k < 4; k++) {
        const Vec3 a = vec3_mad(p->origin, k == 1 || k == 2 ? p->length : 0, p->along);
        seen[k] = place_seen(viewer, vec3_mad(a, k >= 2 ? p->width : 0, p->across), &x[k], &y[k]);
    }
    for (unsigned k = 0; k < 4; k++)
        if (seen[k] && seen[(k + 1) % 4])
            gui_mark_line(x[k], y[k], x[(k + 1) % 4], y[(k + 1) % 4], LINE);
}

static void sight_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Viewer *viewer = context;
    const Measuring *m = &viewer->measuring;
    (void)worker;
    for (uint32_t i = begin; i < end; i++) {
        double x, y;
        const bool seen = place_seen(viewer, m->plane->point[i], &x, &y);
        m->sight[2 * (size_t)i] = seen ? (float)x : NAN;
        m->sight[2 * (size_t)i + 1] = seen ? (float)y : NAN;
    }
}

/* Where points are in the picture; as long as nothing moves it is known. */
static bool find_sight(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const GlView *view = &viewer->view;
    Error err = { 0 };
    if (m->sighted && m->sight_width == view->width && m->sight_height == view->height &&
        view_same(&m->sight_camera, &view->camera))
        return true;
    array_free(m->sight);
    m->sight = array_create(2 * (size_t)m->plane->count, sizeof *m->sight, "work plane", &err);
    m->sighted = m->sight != NULL;
    if (!m->sighted)
        return false;
    m->sight_camera = view->camera;
    m->sight_width = view->width;
    m->sight_height = view->height;
    parallel_for(m->plane->count, SIGHT_CHUNK, viewer->options->threads, sight_chunk, viewer, NULL,
                 NULL);
    return true;
}

static void plane_points(const Viewer *viewer, double scale)
{
    const Measuring *m = &viewer->measuring;
    const Plane *p = m->plane;
    /* The legend's colours where it shows light; else the plane's own range. */
    const double most = m->report.all.greatest;
    FalseColour colours = { .low = 0, .high = most > 0 ? most : 1 };
    if (m->on && m->layer != SHOWN_REFLECTANCE && m->layer != SHOWN_FACTORS)
        colours = m->map.scale;
    double last_x = -INFINITY, last_y = -INFINITY;
    for (uint32_t i = 0; i < p->count; i++) {
        const double x = (double)m->sight[2 * (size_t)i], y = (double)m->sight[2 * (size_t)i + 1];
        uint8_t rgb[3];
        const double value = plane_value(p, i);
        if (isnan(value) || isnan(x))
            continue;
        false_colour_of(&colours, false_colour_place(&colours, value), rgb);
        gui_mark_dot(x, y, 5 * scale, (GuiInk){ 10, 10, 10, 255 });
        gui_mark_dot(x, y, 4 * scale, (GuiInk){ rgb[0], rgb[1], rgb[2], 255 });
        if (fabs(x - last_x) < FIGURE_ROOM * scale && fabs(y - last_y) < FIGURE_ROOM * scale)
            continue;
        char text[32];
        snprintf(text, sizeof text, "%.3g", value);
        gui_mark_text(x, y - 12 * scale, GUI_MIDDLE, text, WHITE);
        last_x = x;
        last_y = y;
    }
}

static void probe_marks(const Viewer *viewer, double scale)
{
    const Probes *probes = &viewer->measuring.probes;
    for (size_t i = 0; i < probes->count; i++) {
        char text[32];
        double x, y;
        if (!place_seen(viewer, probes->probe[i].reading.place, &x, &y))
            continue;
        snprintf(text, sizeof text, "%zu", i + 1);
        gui_mark_line(x - 6 * scale, y, x + 6 * scale, y, AMBER);
        gui_mark_line(x, y - 6 * scale, x, y + 6 * scale, AMBER);
        gui_mark_text(x + 8 * scale, y - 8 * scale, GUI_LEFT, text, AMBER);
    }
}

void measuring_marks(Viewer *viewer, double scale)
{
    const Measuring *m = &viewer->measuring;
    const Frame *r = &m->region;
    assert(scale > 0);
    if (viewer->shown == NULL)
        return;
    if (m->plane_on && m->plane != NULL && m->plane->rays > 0) {
        plane_corners(viewer);
        if (find_sight(viewer))
            plane_points(viewer, scale);
    }
    probe_marks(viewer, scale);
    if (m->has_region || m->grip == GRIP_REGION)
        gui_mark_box(r->x0, r->y0, r->x1, r->y1, AMBER, false);
    if (m->on)
        legend(viewer, scale);
}
