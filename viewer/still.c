/* SPDX-License-Identifier: BSD-3-Clause */
/* The view by rays of our own: one through the middle of each pixel. */
#include "viewer/still.h"

#include <assert.h>
#include <math.h>

#include "base/parallel.h"
#include "viewer/matrix.h"
#include "viewer/seen.h"

static const double PI = 3.14159265358979323846;

typedef struct {
    const Snapshot *snapshot;
    const GlView   *view;
    Image          *image;
} Still;

static void store(float *out, const double value[3])
{
    for (unsigned k = 0; k < 3; k++)
        out[k] = (float)value[k];
}

/* Radiance at a place of a triangle, as it is drawn. */
static void radiance_at(const Still *still, const Hit *hit, uint32_t patch, double out[3])
{
    const Snapshot *s = still->snapshot;
    const uint32_t *corner = s->mesh->corner + 3 * (size_t)hit->primitive;
    const double u = (double)hit->u, v = (double)hit->v, share[3] = { 1 - u - v, u, v };
    for (unsigned k = 0; k < 3; k++) {
        double b = (double)s->layer[LAYER_RADIOSITY][3 * (size_t)patch + k];
        if (still->view->shading != SHADING_PATCHES) {
            b = 0;
            for (unsigned c = 0; c < 3; c++)
                b += share[c] * (double)s->vertex[3 * (size_t)corner[c] + k];
        }
        out[k] = b / PI;
    }
}

static void add_pixel(const Still *still, size_t at, const Hit *hit, uint32_t patch)
{
    const Snapshot *s = still->snapshot;
    Image *image = still->image;
    const ShownPatch *p = &s->mesh->patch[patch];
    const float *direct = s->layer[LAYER_DIRECT], *received = s->layer[LAYER_IRRADIANCE];
    const Rgb rho = snapshot_reflectance(s, patch);
    const double albedo[3] = { rho.r, rho.g, rho.b };
    double radiance[3], first[3] = { 0 }, later[3] = { 0 }, arriving[3] = { 0 };
    radiance_at(still, hit, patch, radiance);
    for (unsigned k = 0; k < 3; k++) {
        const size_t i = 3 * (size_t)patch + k;
        arriving[k] = received != NULL ? (double)received[i] : 0;
        /* A lamp's own light is neither. */
        const double back = p->lamp ? fmin(radiance[k], albedo[k] * arriving[k] / PI)
                                    : radiance[k];
        first[k] = direct != NULL ? fmin(back, albedo[k] * (double)direct[i] / PI) : 0;
        later[k] = back - first[k];
    }
    store(image->radiance + 3 * at, radiance);
    store(image->direct + 3 * at, first);
    store(image->indirect + 3 * at, later);
    store(image->albedo + 3 * at, albedo);
    store(image->irradiance + 3 * at, arriving);
    store(image->normal + 3 * at, (double[]){ p->normal.x, p->normal.y, p->normal.z });
    image->patch[at] = patch;
}

static void take_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Still *still = context;
    const GlView *view = still->view;
    (void)worker;
    for (uint32_t y = begin; y < end; y++)
        for (int x = 0; x < view->width; x++) {
            Hit hit;
            Vec3 place;
            const size_t at = (size_t)y * (size_t)view->width + (size_t)x;
            const Vec3 d = view_direction(&view->camera, x + 0.5, y + 0.5, view->width,
                                          view->height);
            const uint32_t patch = seen_along(still->snapshot->mesh, view->camera.eye, d, &hit,
                                              &place);
            if (patch == PATCH_NONE)
                continue;
            add_pixel(still, at, &hit, patch);
            still->image->depth[at] = (float)vec3_length(vec3_sub(place, view->camera.eye));
        }
}

Image *still_take(const Snapshot *snapshot, const GlView *view, Error *err)
{
    assert(snapshot->layer[LAYER_RADIOSITY] != NULL);
    Still still = { snapshot, view, image_create(view->width, view->height, err) };
    if (still.image != NULL)
        parallel_for((uint32_t)view->height, 4, 0, take_rows, &still, NULL, NULL);
    return still.image;
}
