/* SPDX-License-Identifier: BSD-3-Clause */
/* Light at one moment, handed from the solver to the window. */
#include "viewer/snapshot.h"

#include <assert.h>

#include "base/array.h"
#include "radiosity/solve.h"

enum { BANDS = 3 };

/* The vertices' own values, then those inside faces as means of them. */
static void fill_vertices(const ShownMesh *mesh, const double *value, float *out)
{
    for (uint32_t i = 0; i < BANDS * mesh->plain_count; i++)
        out[i] = (float)value[i];
    for (uint32_t i = mesh->plain_count; i < mesh->vertex_count; i++) {
        const uint32_t *of = mesh->mean_of + 4 * (size_t)(i - mesh->plain_count);
        for (unsigned k = 0; k < BANDS; k++)
            out[BANDS * (size_t)i + k] = 0.25f * (out[BANDS * (size_t)of[0] + k] +
                                                  out[BANDS * (size_t)of[1] + k] +
                                                  out[BANDS * (size_t)of[2] + k] +
                                                  out[BANDS * (size_t)of[3] + k]);
    }
}

bool snapshot_layer(Snapshot *snapshot, Layer layer, const double *value, Error *err)
{
    const size_t n = (size_t)BANDS * snapshot->mesh->patch_count;
    assert((unsigned)layer < LAYER_COUNT && snapshot->layer[layer] == NULL);
    float *out = array_create(n, sizeof *out, "layer", err);
    if (out == NULL)
        return false;
    for (size_t i = 0; i < n; i++)
        out[i] = (float)value[i];
    snapshot->layer[layer] = out;
    return true;
}

Snapshot *snapshot_create(ShownMesh *mesh, const Patches *patches, const VertexCarry *carry,
                          const double *radiosity, Error *err)
{
    assert(mesh->patch_count == patches->count && mesh->plain_count == patches->vertex_count);
    Snapshot *s = array_create(1, sizeof *s, "snapshot", err);
    if (s == NULL)
        return NULL;
    s->mesh = shown_mesh_share(mesh);
    s->shooter = PATCH_NONE;
    double *at_vertex = array_create((size_t)BANDS * patches->vertex_count, sizeof *at_vertex,
                                     "vertices", err);
    s->vertex = array_create((size_t)BANDS * mesh->vertex_count, sizeof *s->vertex, "vertices",
                             err);
    if (s->vertex != NULL && snapshot_layer(s, LAYER_RADIOSITY, radiosity, err) &&
        vertex_carry_values(carry, BANDS, radiosity, at_vertex, err))
        fill_vertices(mesh, at_vertex, s->vertex);
    array_free(at_vertex);
    return error_is_set(err) ? snapshot_destroy(s) : s;
}

Rgb snapshot_reflectance(const Snapshot *snapshot, uint32_t patch)
{
    assert(patch < snapshot->mesh->patch_count);
    if (snapshot->reflectance == NULL)
        return snapshot->mesh->patch[patch].reflectance;
    const float *v = snapshot->reflectance + BANDS * (size_t)patch;
    return rgb((double)v[0], (double)v[1], (double)v[2]);
}

const Light *snapshot_lights(const Snapshot *snapshot)
{
    return snapshot->light != NULL ? snapshot->light : snapshot->mesh->light;
}

Snapshot *snapshot_destroy(Snapshot *snapshot)
{
    if (snapshot == NULL)
        return NULL;
    shown_mesh_leave(snapshot->mesh);
    array_free(snapshot->vertex);
    for (unsigned k = 0; k < LAYER_COUNT; k++)
        array_free(snapshot->layer[k]);
    array_free(snapshot->row_sum);
    array_free(snapshot->reflectance);
    array_free(snapshot->light);
    array_free(snapshot->ray);
    return array_free(snapshot);
}

void mailbox_put(Mailbox *mailbox, Snapshot *snapshot)
{
    snapshot_destroy(atomic_exchange(&mailbox->waiting, snapshot));
}

Snapshot *mailbox_take(Mailbox *mailbox)
{
    assert(mailbox != NULL);
    return atomic_exchange(&mailbox->waiting, NULL);
}
