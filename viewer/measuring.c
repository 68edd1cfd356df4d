/* SPDX-License-Identifier: BSD-3-Clause */
/* Values for false colours, the work plane and the readings, kept up with the light. */
#include "viewer/measuring.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "viewer/internal.h"

/* Rays of a picked patch for its factors: a few hundredths of a second. */
enum { FACTOR_RAYS = 1 << 15 };
/* Places, evenly by area, whose values set the range of colours. */
enum { RANGE_VALUES = 1 << 13 };
/* Rays for the work plane: so many a frame, so many for each point in the end. */
enum { PLANE_RAYS_FRAME = 1 << 16, PLANE_RAYS_MOST = 1 << 12, PLANE_RAYS_STEP = 1 << 5 };

void measuring_init(Measuring *m)
{
    *m = (Measuring){ .height = 0.75, .margin = 0.5, .factors_of = PATCH_NONE };
    false_map_init(&m->map);
}

void measuring_clear(Measuring *m)
{
    array_free(m->value);
    array_free(m->vertex);
    array_free(m->factors);
    plane_destroy(m->plane);
    array_free(m->sight);
    probes_clear(&m->probes);
}

/* --- values ----------------------------------------------------------------------------------- */

static void find_factors(Viewer *viewer, Error *err)
{
    Measuring *m = &viewer->measuring;
    const ShownMesh *mesh = viewer->shown->mesh;
    const uint32_t picked = viewer->view.picked;
    m->factors = array_free(m->factors);
    m->factors_of = PATCH_NONE;
    if (picked >= mesh->patch_count || m->layer != SHOWN_FACTORS)
        return;
    m->factors = array_create(mesh->patch_count, sizeof *m->factors, "factors", err);
    if (m->factors != NULL && layer_factors(mesh, picked, FACTOR_RAYS, m->factors, err))
        m->factors_of = picked;
}

/* Carried to vertices: means of the patches around, by area. Radiosity has its own. */
static void fill_vertices(const Snapshot *s, const Measuring *m, float *weight)
{
    const ShownMesh *mesh = s->mesh;
    memset(m->vertex, 0, mesh->vertex_count * sizeof *m->vertex);
    for (uint32_t i = 0; m->layer == SHOWN_RADIOSITY && i < mesh->vertex_count; i++) {
        const float *b = s->vertex + 3 * (size_t)i;
        m->vertex[i] = (float)rgb_luminance(rgb((double)b[0], (double)b[1], (double)b[2]));
    }
    if (m->layer == SHOWN_RADIOSITY)
        return;
    for (uint32_t k = 0; k < 3 * mesh->triangle_count; k++) {
        const uint32_t patch = mesh->triangle_patch[k / 3], vertex = mesh->corner[k];
        const float area = (float)mesh->patch[patch].area;
        if (!isnan(m->value[patch])) {
            m->vertex[vertex] += area * m->value[patch];
            weight[vertex] += area;
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        m->vertex[i] = weight[i] > 0 ? m->vertex[i] / weight[i] : NAN;
}

/* Lamps shine far beyond what they light: the range is that of all else, by area, or a crowd of
 * small patches in one bright corner would set it. */
static bool fit_range(Measuring *m, const ShownMesh *mesh, Error *err)
{
    const bool lamps_too = m->layer == SHOWN_FACTORS;
    float *value = array_create(RANGE_VALUES, sizeof *value, "range", err);
    double whole = 0, passed = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < mesh->patch_count; i++)
        whole += lamps_too || !mesh->patch[i].lamp ? mesh->patch[i].area : 0;
    for (uint32_t i = 0; value != NULL && i < mesh->patch_count; i++) {
        passed += lamps_too || !mesh->patch[i].lamp ? mesh->patch[i].area : 0;
        while (n < RANGE_VALUES && (n + 0.5) * whole < passed * RANGE_VALUES)
            value[n++] = m->value[i];
    }
    if (value != NULL)
        false_map_fit(&m->map, value, n);
    array_free(value);
    return !error_is_set(err);
}

static bool find_values(Viewer *viewer, Error *err)
{
    Measuring *m = &viewer->measuring;
    const Snapshot *s = viewer->shown;
    const ShownMesh *mesh = s->mesh;
    assert(m->on && layer_known(s, m->layer, m->factors != NULL));
    array_free(m->value);
    array_free(m->vertex);
    m->value = array_create(mesh->patch_count, sizeof *m->value, "values", err);
    m->vertex = array_create(mesh->vertex_count, sizeof *m->vertex, "values", err);
    float *weight = array_create(mesh->vertex_count, sizeof *weight, "values", err);
    if (!error_is_set(err)) {
        layer_fill(s, m->layer, m->factors, m->value);
        fill_vertices(s, m, weight);
        fit_range(m, mesh, err);
    }
    array_free(weight);
    return !error_is_set(err);
}

/* --- the work plane --------------------------------------------------------------------------- */

static void renew_plane(Viewer *viewer, Error *err)
{
    Measuring *m = &viewer->measuring;
    const ShownMesh *mesh = viewer->shown->mesh;
    const uint32_t picked = viewer->view.picked;
    const bool grouped = m->over_group && picked < mesh->patch_count;
    const PlaneWish wish = { grouped ? mesh->patch[picked].group : PLANE_ALL, m->height,
                             m->margin, viewer->options->unit_m };
    if (m->plane_fits && m->plane != NULL) {
        plane_restart(m->plane);
        return;
    }
    plane_destroy(m->plane);
    m->sighted = false;
    m->plane = m->plane_on ? plane_create(mesh, &wish, viewer->options->threads, err) : NULL;
    m->plane_fits = m->plane != NULL;
}

static void gather_plane(Viewer *viewer, Error *err)
{
    Measuring *m = &viewer->measuring;
    if (m->plane_on && !m->plane_fits)
        renew_plane(viewer, err);
    if (!m->plane_on || m->plane == NULL || m->plane->rays >= PLANE_RAYS_MOST)
        return;
    for (uint32_t cast = 0; cast < PLANE_RAYS_FRAME && m->plane->rays < PLANE_RAYS_MOST;
         cast += PLANE_RAYS_STEP * m->plane->count)
        if (!plane_gather(m->plane, viewer->shown, PLANE_RAYS_STEP, viewer->options->threads, err))
            return;
    plane_report(m->plane, &m->report, err);
    viewer->dirty = true;
}

/* --- keeping up ------------------------------------------------------------------------------- */

void measuring_renew(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    const Snapshot *s = viewer->shown;
    Error err = { 0 };
    if (s == NULL)
        return;
    if (m->on)
        find_factors(viewer, &err);
    if (m->on && !layer_known(s, m->layer, m->factors != NULL))
        m->layer = SHOWN_RADIOSITY;
    if (m->on && !error_is_set(&err))
        m->stale = find_values(viewer, &err);
    if (m->plane != NULL && m->plane_on)
        renew_plane(viewer, &err);
    if (m->has_region)
        measuring_region(viewer);
    if (error_is_set(&err))
        viewer_say(viewer, "%s", err.text);
    viewer->dirty = true;
}

void measuring_work(Viewer *viewer)
{
    Measuring *m = &viewer->measuring;
    Error err = { 0 };
    if (viewer->shown == NULL)
        return;
    viewer->view.map = m->on ? &m->map : NULL;
    if (m->on && m->stale)
        m->stale = !gl_take_values(viewer->gl, m->value, m->vertex, &err);
    gather_plane(viewer, &err);
    if (error_is_set(&err)) {
        m->plane_on = m->plane_on && m->plane != NULL;
        viewer_say(viewer, "%s", err.text);
    }
}

void measuring_pick(Viewer *viewer, uint32_t triangle, double u, double v, bool probe)
{
    Measuring *m = &viewer->measuring;
    Error err = { 0 };
    Reading reading;
    reading_take(viewer->shown, triangle, u, v, &reading);
    if (probe && probes_add(&m->probes, viewer->shown->mesh, &reading, &err))
        viewer_say(viewer, "probe %zu kept", m->probes.count);
    if (m->over_group)
        m->plane_fits = false;
    if (m->layer == SHOWN_FACTORS)
        measuring_renew(viewer);
    if (error_is_set(&err))
        viewer_say(viewer, "%s", err.text);
}
