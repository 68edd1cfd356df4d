/* SPDX-License-Identifier: BSD-3-Clause */
/* Measuring by keys and mouse: layers, the legend's ends, a region of the picture. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "viewer/files.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"

/* How near to an end of the legend's bar the pointer takes that end, as a share of its length. */
static const double GRIP_SHARE = 0.2;
/* Places looked at in a region, at most, each way. */
enum { REGION_MOST = 96 };

/* --- keys ------------------------------------------------------------------------------------- */

static bool name_file(const Viewer *viewer, const char *word, char *path, size_t size, Error *err)
{
    return files_free_name(viewer, word, ".csv", path, size) ||
           error_set(err, ERROR_FAILED, "there is no free name like ...-%s.csv", word);
}

static void save(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const bool lux = viewer->options->photometric;
    char path[512];
    Error err = { 0 };
    if (m->probes.count == 0 && m->plane == NULL)
        viewer_say(viewer, "no probes yet: Shift-click keeps one; K lays a work plane");
    if (m->probes.count > 0 && name_file(viewer, "probes", path, sizeof path, &err) &&
        probes_write(&m->probes, lux, path, &err))
        viewer_say(viewer, "saved %s", path);
    if (m->plane != NULL && !error_is_set(&err) &&
        name_file(viewer, "plane", path, sizeof path, &err) &&
        plane_write(m->plane, lux, path, &err))
        viewer_say(viewer, "saved %s", path);
    if (error_is_set(&err))
        viewer_say(viewer, "%s", err.text);
}

static void next_layer(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    if (viewer->shown == NULL)
        return;
    const bool picked = viewer->view.picked < viewer->shown->mesh->patch_count;
    do {
        m->layer = (ShownLayer)((m->layer + 1) % SHOWN_COUNT);
    } while (!layer_known(viewer->shown, m->layer, picked));
    m->map.held = false;
    measuring_renew(viewer);
    viewer_say(viewer, "%s", layer_name(m->layer));
}

void measuring_act(Viewer *viewer, int action)
{
    Measuring *m = &viewer->measuring;
    switch (action) {
    case ACTION_FALSE_COLOUR:
        m->on = !m->on;
        measuring_renew(viewer);
        break;
    case ACTION_FALSE_LAYER:
        m->on = true;
        next_layer(viewer);
        break;
    case ACTION_FALSE_LOG:
        false_map_set_log(&m->map, !m->map.scale.logarithmic);
        measuring_renew(viewer);
        break;
    case ACTION_ISOLINES:
        m->map.scale.isolines = !m->map.scale.isolines;
        break;
    case ACTION_REGION:
        m->marking = !m->marking;
        m->has_region = false;
        if (m->marking)
            viewer_say(viewer, "drag over what is to be measured");
        break;
    case ACTION_PLANE:
        m->plane_on = !m->plane_on;
        m->plane_fits = false;
        m->plane = plane_destroy(m->plane);
        break;
    case ACTION_SAVE_CSV:
        save(viewer);
        break;
    default:
        break;
    }
    viewer->dirty = true;
}

/* --- mouse ------------------------------------------------------------------------------------ */

static Grip grip_at(const Measuring *m, double x, double y)
{
    const Frame *l = &m->legend;
    const double length = l->y1 - l->y0;
    if (!m->on || x < l->x0 || x > l->x1 || y < l->y0 || y > l->y1)
        return GRIP_NONE;
    return y - l->y0 < GRIP_SHARE * length ? GRIP_HIGH
           : l->y1 - y < GRIP_SHARE * length ? GRIP_LOW : GRIP_BOTH;
}

bool measuring_button(Viewer *viewer, bool down, double x, double y)
{
    Measuring *m = &viewer->measuring;
    const Grip before = m->grip;
    if (viewer->shown == NULL)
        return false;
    if (!down) {
        m->grip = GRIP_NONE;
        if (before == GRIP_REGION) {
            m->marking = false;
            measuring_region(viewer);
        }
        return before != GRIP_NONE;
    }
    m->grip = m->marking ? GRIP_REGION : grip_at(m, x, y);
    if (m->grip == GRIP_REGION) {
        m->region = (Frame){ x, y, x, y };
        m->has_region = false;
    }
    return m->grip != GRIP_NONE;
}

bool measuring_move(Viewer *viewer, double x, double y, double dx, double dy)
{
    Measuring *m = &viewer->measuring;
    const double share = -dy / fmax(1, m->legend.y1 - m->legend.y0);
    (void)dx;
    switch (m->grip) {
    case GRIP_NONE:
        return false;
    case GRIP_REGION:
        m->region.x1 = x;
        m->region.y1 = y;
        break;
    case GRIP_BOTH:
        false_map_shift(&m->map, -share);
        break;
    default:
        /* An end that is pulled outwards widens the range. */
        false_map_drag(&m->map, m->grip == GRIP_HIGH, share);
        break;
    }
    viewer->dirty = true;
    return true;
}

/* --- a region --------------------------------------------------------------------------------- */

/* What one sample of `pixels` pixels stands for: the area seen through it, and its value. */
static double area_seen(const Viewer *viewer, double x, double y, double pixels, uint32_t *patch)
{
    const GlView *view = &viewer->view;
    const Camera *camera = &view->camera;
    Vec3 at;
    *patch = pick(viewer, x, y, &at);
    if (*patch == PATCH_NONE)
        return 0;
    const Vec3 d = view_direction(camera, x, y, view->width, view->height);
    const double forward = vec3_dot(d, view_frame(camera).forward);
    const double side = 2 * tan(camera->vertical_fov * M_PI / 360) / view->height;
    const double far = vec3_length(vec3_sub(at, camera->eye));
    const double facing = -vec3_dot(d, viewer->shown->mesh->patch[*patch].normal);
    return facing > 0 ? pixels * side * side * far * far * pow(forward, 3) / facing : 0;
}

ShownLayer measuring_layer(const Viewer *viewer)
{
    if (viewer->measuring.on)
        return viewer->measuring.layer;
    return layer_known(viewer->shown, SHOWN_IRRADIANCE, false) ? SHOWN_IRRADIANCE
                                                               : SHOWN_RADIOSITY;
}

static double value_of(const Viewer *viewer, uint32_t patch)
{
    const Measuring *m = &viewer->measuring;
    return m->on ? (double)m->value[patch]
                 : layer_value(viewer->shown, measuring_layer(viewer), patch);
}

void measuring_region(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const Frame r = { fmin(m->region.x0, m->region.x1), fmin(m->region.y0, m->region.y1),
                      fmax(m->region.x0, m->region.x1), fmax(m->region.y0, m->region.y1) };
    const int across = (int)fmin(REGION_MOST, floor(r.x1 - r.x0));
    const int down = (int)fmin(REGION_MOST, floor(r.y1 - r.y0));
    Error err = { 0 };
    m->has_region = across >= 1 && down >= 1;
    if (!m->has_region)
        return;
    const uint32_t count = (uint32_t)(across * down);
    double *value = array_create(count, sizeof *value, "region", &err);
    double *weight = array_create(count, sizeof *weight, "region", &err);
    const double pixels = (r.x1 - r.x0) * (r.y1 - r.y0) / count;
    for (uint32_t k = 0; !error_is_set(&err) && k < count; k++) {
        uint32_t patch;
        const double x = r.x0 + (k % (uint32_t)across + 0.5) * (r.x1 - r.x0) / across;
        const double y = r.y0 + (k / (uint32_t)across + 0.5) * (r.y1 - r.y0) / down;
        weight[k] = area_seen(viewer, x, y, pixels, &patch);
        value[k] = patch != PATCH_NONE ? value_of(viewer, patch) : NAN;
    }
    if (!error_is_set(&err))
        statistics_find(value, weight, count, &m->in_region, &err);
    m->region_area = m->in_region.weight * viewer->options->unit_m * viewer->options->unit_m;
    array_free(value);
    array_free(weight);
    if (error_is_set(&err)) {
        m->has_region = false;
        viewer_say(viewer, "%s", err.text);
    }
}
