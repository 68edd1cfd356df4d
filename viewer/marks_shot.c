/* SPDX-License-Identifier: BSD-3-Clause */
/* The patch that shot last, outlined while its rays are shown. */
#include <assert.h>

#include "viewer/gui.h"
#include "viewer/internal.h"
#include "viewer/matrix.h"

static const GuiInk SHOOTER = { 255, 240, 60, 255 };

/* Triangles of a patch to be outlined; more are not worth the time of a frame. */
enum { MOST = 64 };

static void mark_edge(const Viewer *viewer, uint32_t a, uint32_t b)
{
    const GlView *view = &viewer->view;
    const Vec3 *position = viewer->shown->mesh->position;
    double x[2], y[2];
    if (!view_pixel(&view->camera, position[a], view->width, view->height, &x[0], &y[0]) ||
        !view_pixel(&view->camera, position[b], view->width, view->height, &x[1], &y[1]))
        return;
    for (double d = -1; d <= 1; d++) { /* three pixels wide */
        gui_mark_line(x[0] + d, y[0], x[1] + d, y[1], SHOOTER);
        gui_mark_line(x[0], y[0] + d, x[1], y[1] + d, SHOOTER);
    }
}

/* Whether another triangle of them has the edge the other way round: then it lies inside. */
static bool is_inside(const ShownMesh *mesh, const uint32_t *triangle, unsigned count, uint32_t a,
                      uint32_t b)
{
    for (unsigned t = 0; t < count; t++) {
        const uint32_t *c = mesh->corner + 3 * (size_t)triangle[t];
        for (unsigned k = 0; k < 3; k++)
            if (c[k] == b && c[(k + 1) % 3] == a)
                return true;
    }
    return false;
}

void marks_shot(const Viewer *viewer)
{
    const Snapshot *s = viewer->shown;
    uint32_t triangle[MOST];
    unsigned count = 0;
    if (s == NULL || !viewer->view.rays || s->shooter >= s->mesh->patch_count)
        return;
    const ShownMesh *mesh = s->mesh;
    assert(mesh->triangle_count > 0);
    for (uint32_t t = 0; t < mesh->triangle_count && count < MOST; t++)
        if (mesh->triangle_patch[t] == s->shooter)
            triangle[count++] = t;
    for (unsigned t = 0; t < count; t++) {
        const uint32_t *c = mesh->corner + 3 * (size_t)triangle[t];
        for (unsigned k = 0; k < 3; k++)
            if (!is_inside(mesh, triangle, count, c[k], c[(k + 1) % 3]))
                mark_edge(viewer, c[k], c[(k + 1) % 3]);
    }
}
