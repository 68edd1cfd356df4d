/* SPDX-License-Identifier: BSD-3-Clause */
/* Light so far, put where the window takes it. */
#include <assert.h>
#include <string.h>

#include "app/live.h"
#include "base/array.h"

/* More pictures a second are no use while they change, and each takes time from the solver. */
static const double BETWEEN = 0.12;

bool live_due(const Live *live)
{
    return progress_now() - live->published >= BETWEEN ||
           atomic_load(&live->control->paused);
}

static bool take_mesh(Live *live, Error *err)
{
    const Pipeline *p = live->pipeline;
    if (live->mesh != NULL && live->patches == p->patches)
        return true;
    live->mesh = shown_mesh_leave(live->mesh);
    live->carry = vertex_carry_destroy(live->carry);
    live->mesh = shown_mesh_create(p->scene, p->patches, p->emitting, &p->camera,
                                   p->session->settings.threads, err);
    live->patches = p->patches;
    live->report.patches = p->patches->count;
    return live->mesh != NULL;
}

/* What carries values to vertices, as long as patches and what is seen of them stay. */
static bool take_carry(Live *live, const double *visible_area, Error *err)
{
    if (vertex_carry_fits(live->carry, live->patches, visible_area))
        return true;
    vertex_carry_destroy(live->carry);
    live->carry = vertex_carry_create(live->patches, visible_area, err);
    return live->carry != NULL;
}

static Rgb *lamps_emission(const Live *live, Error *err)
{
    const uint32_t count = live->patches->count;
    Rgb *emission = array_create(count, sizeof *emission, "direct light", err);
    for (uint32_t i = 0; emission != NULL && i < count; i++)
        emission[i] = room_emission(&live->pipeline->room, i);
    return emission;
}

/* What comes straight from lamps by links, and what the solver got from outside: point lights;
 * these are not known while patches are still divided. */
static bool add_direct(const Live *live, Snapshot *s, const LiveLight *light, Error *err)
{
    const uint32_t count = s->mesh->patch_count;
    const double *outside = live->pipeline->direct.irradiance;
    LinksScratch scratch;
    if (outside == NULL && live->pipeline->room.light_count > 0)
        return true;
    Rgb   *emission = lamps_emission(live, err);
    float *out = array_create(3 * (size_t)count, sizeof *out, "direct light", err);
    s->layer[LAYER_DIRECT] = out;
    if (out == NULL || !links_scratch_create(light->links, &scratch, err)) {
        array_free(emission);
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        const LinksRow row = links_row(light->links, i, &scratch);
        Rgb sum = rgb(0, 0, 0);
        for (uint64_t k = 0; k < row.count; k++)
            sum = rgb_mad(sum, (double)row.form_factor[k], emission[row.source[k]]);
        const double band[3] = { sum.r, sum.g, sum.b };
        for (size_t k = 0; k < 3; k++)
            out[3 * (size_t)i + k] =
                (float)(band[k] + (outside != NULL ? outside[3 * (size_t)i + k] : 0));
    }
    links_scratch_clear(&scratch);
    array_free(emission);
    return true;
}

static bool add_rows(Snapshot *s, const Links *links, Error *err)
{
    LinksScratch scratch;
    const uint32_t count = s->mesh->patch_count;
    s->row_sum = array_create(count, sizeof *s->row_sum, "row sums", err);
    if (s->row_sum == NULL || !links_scratch_create(links, &scratch, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const LinksRow row = links_row(links, i, &scratch);
        double sum = (double)links->escape[i];
        for (uint64_t k = 0; k < row.count; k++)
            sum += (double)row.form_factor[k];
        s->row_sum[i] = (float)sum;
    }
    links_scratch_clear(&scratch);
    return true;
}

/* The error of a patch's irradiance is one number: the same in all bands. */
static bool add_error(Snapshot *s, const double *error, Error *err)
{
    const uint32_t count = s->mesh->patch_count;
    float *out = array_create(3 * (size_t)count, sizeof *out, "errors", err);
    for (size_t i = 0; out != NULL && i < 3 * (size_t)count; i++)
        out[i] = (float)error[i / 3];
    s->layer[LAYER_ERROR] = out;
    return out != NULL;
}

static bool add_rays(Snapshot *s, const LiveLight *light, Error *err)
{
    s->shooter = light->shooter;
    s->ray = array_create(2 * (size_t)light->ray_count, sizeof *s->ray, "rays", err);
    if (s->ray == NULL)
        return false;
    memcpy(s->ray, light->ray, 2 * (size_t)light->ray_count * sizeof *s->ray);
    s->ray_count = light->ray_count;
    return true;
}

/* Lights and paint as they are now. */
static bool add_changes(const Live *live, Snapshot *s, Error *err)
{
    const Scene *scene = live->pipeline->scene;
    const uint32_t count = s->mesh->patch_count;
    assert(s->mesh->light_count == scene->light_count);
    s->reflectance = array_create(3 * (size_t)count, sizeof *s->reflectance, "paint", err);
    s->light = array_create(scene->light_count, sizeof *s->light, "lights", err);
    if (error_is_set(err))
        return false;
    if (scene->light_count > 0)
        memcpy(s->light, scene->lights, scene->light_count * sizeof *s->light);
    for (uint32_t i = 0; i < count; i++) {
        const Rgb rho = scene->polygons.materials[live->patches->material[i]].reflectance;
        s->reflectance[3 * (size_t)i] = (float)rho.r;
        s->reflectance[3 * (size_t)i + 1] = (float)rho.g;
        s->reflectance[3 * (size_t)i + 2] = (float)rho.b;
    }
    return true;
}

const Links *live_links(const Live *live)
{
    const Pipeline *p = live->pipeline;
    return p->session->settings.stochastic ? live->few : p->links;
}

void live_forget(Live *live)
{
    live->lit = NULL;
    live->lit_radiosity = array_free(live->lit_radiosity);
    live->lit_area = array_free(live->lit_area);
}

/* Pictures may be wished for when what it was published from has gone. */
static bool keep_light(Live *live, const LiveLight *light, Error *err)
{
    const size_t n = live->patches->count;
    assert(live->patches == live->pipeline->patches);
    if (live->lit != live->patches) {
        live_forget(live);
        live->lit_radiosity = array_create(3 * n, sizeof(double), "light", err);
        live->lit_area = array_create(n, sizeof(double), "light", err);
        if (error_is_set(err))
            return false;
    }
    memcpy(live->lit_radiosity, light->radiosity, 3 * n * sizeof(double));
    memcpy(live->lit_area, light->visible_area, n * sizeof(double));
    live->lit = live->patches;
    live->lit_wholly = light->error != NULL;
    return true;
}

bool live_publish(Live *live, const LiveLight *light, Error *err)
{
    assert(light->radiosity != NULL && light->visible_area != NULL);
    if (!take_mesh(live, err) || !take_carry(live, light->visible_area, err))
        return false;
    Snapshot *s = snapshot_create(live->mesh, live->patches, live->carry, light->radiosity, err);
    if (s == NULL)
        return false;
    s->step = live->step;
    if ((light->irradiance != NULL && !snapshot_layer(s, LAYER_IRRADIANCE, light->irradiance,
                                                      err)) ||
        (light->direct != NULL && !snapshot_layer(s, LAYER_DIRECT, light->direct, err)) ||
        (light->direct == NULL && light->links != NULL && !add_direct(live, s, light, err)) ||
        (light->unshot != NULL && !snapshot_layer(s, LAYER_UNSHOT, light->unshot, err)) ||
        (light->error != NULL && !add_error(s, light->error, err)) ||
        (light->changed && !add_changes(live, s, err)) ||
        (light->links != NULL && light->links != live->few && !add_rows(s, light->links, err)) ||
        (light->ray_count > 0 && !add_rays(s, light, err)) || !keep_light(live, light, err)) {
        snapshot_destroy(s);
        return false;
    }
    mailbox_put(live->mailbox, s);
    live->published = progress_now();
    return true;
}
