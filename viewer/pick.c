/* SPDX-License-Identifier: BSD-3-Clause */
/* What lies under a pixel, by rays of our own: no reading back from the card. */
#include <assert.h>
#include <math.h>

#include "math/rgb.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"
#include "viewer/seen.h"

static const double PI = 3.14159265358979323846;

/* Faces seen from behind are passed; more of them than this in a row is a wall of them. */
enum { PASSED_MOST = 64 };

uint32_t seen_along(const ShownMesh *mesh, Vec3 eye, Vec3 d, Hit *hit, Vec3 *at)
{
    Ray ray = { .ox = (float)eye.x, .oy = (float)eye.y, .oz = (float)eye.z, .dx = (float)d.x,
                .dy = (float)d.y, .dz = (float)d.z, .t_max = INFINITY };
    for (int k = 0; k < PASSED_MOST; k++) {
        if (!bvh_nearest(mesh->bvh, &ray, hit))
            return PATCH_NONE;
        const uint32_t *c = mesh->corner + 3 * (size_t)hit->primitive;
        const Vec3 a = mesh->position[c[0]];
        const Vec3 n = vec3_cross(vec3_sub(mesh->position[c[1]], a),
                                  vec3_sub(mesh->position[c[2]], a));
        *at = vec3_mad(eye, (double)hit->t, d);
        if (vec3_dot(n, d) < 0)
            return mesh->triangle_patch[hit->primitive];
        ray.t_min = nextafterf(hit->t, INFINITY);
    }
    return PATCH_NONE;
}

uint32_t pick_hit(const Viewer *viewer, double x, double y, Hit *hit, Vec3 *at)
{
    const GlView *view = &viewer->view;
    assert(view->width > 0 && view->height > 0);
    if (viewer->shown == NULL)
        return PATCH_NONE;
    return seen_along(viewer->shown->mesh, view->camera.eye,
                      view_direction(&view->camera, x, y, view->width, view->height), hit, at);
}

uint32_t pick(const Viewer *viewer, double x, double y, Vec3 *at)
{
    Hit hit;
    return pick_hit(viewer, x, y, &hit, at);
}

double pick_exposure(const Viewer *viewer)
{
    enum { ACROSS = 40, DOWN = 30 };
    static const double MID_GREY = 0.18;
    const GlView *view = &viewer->view;
    const Snapshot *s = viewer->shown;
    double sum = 0;
    unsigned count = 0;
    if (s == NULL || s->layer[view->layer] == NULL)
        return view->exposure;
    for (int j = 0; j < DOWN; j++)
        for (int i = 0; i < ACROSS; i++) {
            Vec3 at;
            const uint32_t p = pick(viewer, (i + 0.5) * view->width / ACROSS,
                                    (j + 0.5) * view->height / DOWN, &at);
            if (p == PATCH_NONE || s->mesh->patch[p].lamp)
                continue;
            const float *b = s->layer[view->layer] + 3 * (size_t)p;
            const double y = rgb_luminance(rgb(b[0], b[1], b[2])) / PI;
            if (y > 0 && isfinite(y)) {
                sum += log(y);
                count++;
            }
        }
    return count > 0 ? log2(MID_GREY) - sum / count / log(2) : view->exposure;
}
