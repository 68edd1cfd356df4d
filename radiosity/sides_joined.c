/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether two places lie in one room: a way between them that nothing crosses is enough. */
#include <assert.h>

#include "radiosity/sides.h"

/* Heights of tents over the straight way, relative to it: side by side on a plane a low one does,
 * of leaves that hang in each other's way a high one may. */
static const double TENTS[] = { 0.1, 0.5, 1.5 };

static bool is_free(const Bvh *bvh, Vec3 from, Vec3 to)
{
    const Vec3 d = vec3_sub(to, from);
    const Ray ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z, .t_min = 0,
                      .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = 1 };
    return !bvh_blocked(bvh, &ray);
}

bool sides_joined(const void *context, const SurfacePoint *a, const SurfacePoint *b)
{
    const SidesJoined *j = context;
    assert(j != NULL && a != NULL && b != NULL);
    const Vec3 from = vec3_mad(a->point, j->offset, a->normal);
    const Vec3 to = vec3_mad(b->point, j->offset, b->normal);
    const double length = vec3_length(vec3_sub(to, from));
    const Vec3 up = vec3_add(a->normal, b->normal);
    if (!(vec3_length(up) > 0))
        return false;
    for (unsigned k = 0; k < sizeof TENTS / sizeof *TENTS; k++) {
        const Vec3 top = vec3_mad(vec3_lerp(from, to, 0.5), TENTS[k] * length, vec3_unit(up));
        if (is_free(j->bvh, from, top) && is_free(j->bvh, to, top))
            return true;
    }
    return false;
}
