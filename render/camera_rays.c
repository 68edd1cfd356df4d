/* SPDX-License-Identifier: BSD-3-Clause */
/* The pinhole camera: from a pixel to a direction. */
#include <assert.h>

#include "render/internal.h"

static const double PI = 3.14159265358979323846;

void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height)
{
    assert(width > 0 && height > 0);
    assert(camera->vertical_fov > 0 && camera->vertical_fov < 180);
    Vec3 forward = vec3_unit(vec3_sub(camera->target, camera->eye));
    if (!(vec3_length(forward) > 0))
        forward = vec3(0, 0, -1);
    Vec3 right = vec3_unit(vec3_cross(forward, camera->up));
    if (!(vec3_length(right) > 0)) { /* looks along its up: any horizon will do */
        Vec3 unused;
        vec3_frame(forward, &right, &unused);
    }
    const Vec3   up = vec3_cross(right, forward);
    const double half = tan(camera->vertical_fov * PI / 360);
    const double pixel = 2 * half / height;
    rays->eye = camera->eye;
    rays->right = vec3_scale(right, pixel);
    rays->down = vec3_scale(up, -pixel);
    rays->corner = vec3_mad(vec3_mad(forward, -0.5 * width, rays->right), -0.5 * height,
                            rays->down);
}

Vec3 camera_rays_direction(const CameraRays *rays, double x, double y)
{
    return vec3_unit(vec3_mad(vec3_mad(rays->corner, x, rays->right), y, rays->down));
}
