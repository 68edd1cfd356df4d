/* SPDX-License-Identifier: BSD-3-Clause */
/* Cameras: from a place in the picture to a ray.
 *
 * Perspective   the plane at distance 1 in front of the eye, square pixels.
 * Orthographic  parallel rays from the plane through the eye.
 * Fisheye       equidistant: the angle from the axis grows with the distance from the picture's
 *               middle; the field of view spans its height.
 * Panorama      longitude and latitude, the axis in the middle; a picture twice as wide as high
 *               with a field of 180 degrees shows all directions.
 * Lens          a thin one [cook84]: rays through one pixel meet on the plane in focus. On a
 *               fisheye or panorama the sharp places lie on a sphere instead, and the lens stands
 *               perpendicular to each ray.
 */
#include <assert.h>

#include "math/sampling.h"
#include "render/internal.h"

static const double PI = 3.14159265358979323846;

static void init_frame(CameraRays *rays, const Camera *camera)
{
    Vec3 forward = vec3_unit(vec3_sub(camera->target, camera->eye));
    if (!(vec3_length(forward) > 0))
        forward = vec3(0, 0, -1);
    Vec3 right = vec3_unit(vec3_cross(forward, camera->up));
    if (!(vec3_length(right) > 0)) { /* looks along its up: any horizon will do */
        Vec3 unused;
        vec3_frame(forward, &right, &unused);
    }
    rays->eye = camera->eye;
    rays->forward = forward;
    rays->right = right;
    rays->up = vec3_cross(right, forward);
}

void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height)
{
    assert(width > 0 && height > 0);
    init_frame(rays, camera);
    rays->projection = camera->projection;
    rays->half_width = 0.5 * width;
    rays->half_height = 0.5 * height;
    rays->rim = fmin(PI, camera->vertical_fov * PI / 360);
    rays->lens = camera->aperture;
    rays->focus = camera->focus > 0 ? camera->focus
                                    : vec3_length(vec3_sub(camera->target, camera->eye));
    if (!(rays->focus > 0))
        rays->lens = 0;
    switch (camera->projection) {
    case CAMERA_PERSPECTIVE:
        assert(camera->vertical_fov > 0 && camera->vertical_fov < 180);
        rays->pixel = 2 * tan(camera->vertical_fov * PI / 360) / height;
        break;
    case CAMERA_ORTHOGRAPHIC:
        assert(camera->view_height > 0);
        rays->pixel = camera->view_height / height;
        break;
    case CAMERA_FISHEYE:
    case CAMERA_PANORAMA:
        assert(camera->vertical_fov > 0 && camera->vertical_fov <= 360);
        rays->pixel = camera->vertical_fov * PI / 180 / height;
        break;
    }
}

static Vec3 in_frame(const CameraRays *rays, double right, double up, double forward)
{
    return vec3_mad(vec3_mad(vec3_scale(rays->forward, forward), right, rays->right), up, rays->up);
}

/* Direction of a projection that sees around; false: outside its circle, or beyond a pole. */
static bool round_direction(const CameraRays *rays, double right, double up, Vec3 *direction)
{
    const double rim = 1e-6 * rays->pixel; /* what rounding takes off the rim is no pixel */
    if (rays->projection == CAMERA_FISHEYE) {
        const double angle = hypot(right, up);
        const double scale = angle > 0 ? sin(angle) / angle : 1;
        *direction = in_frame(rays, scale * right, scale * up, cos(angle));
        return angle <= rays->rim + rim;
    }
    *direction = in_frame(rays, cos(up) * sin(right), sin(up), cos(up) * cos(right));
    return fabs(up) <= PI / 2 + rim && fabs(right) <= PI + rim;
}

/* Moves the ray to another point of the lens, so that it still meets what is in focus. */
static void through_lens(const CameraRays *rays, const float *lens, Vec3 *origin, Vec3 *direction)
{
    const double radius = rays->lens * sqrt((double)lens[0]), angle = 2 * PI * (double)lens[1];
    Vec3   a = rays->right, b = rays->up;
    double distance = rays->focus;
    assert(rays->focus > 0);
    if (rays->projection == CAMERA_PERSPECTIVE)
        distance /= vec3_dot(*direction, rays->forward);
    else if (rays->projection != CAMERA_ORTHOGRAPHIC)
        vec3_frame(*direction, &a, &b);
    const Vec3 sharp = vec3_mad(*origin, distance, *direction);
    *origin = vec3_mad(vec3_mad(*origin, radius * cos(angle), a), radius * sin(angle), b);
    *direction = vec3_unit(vec3_sub(sharp, *origin));
}

bool camera_rays_at(const CameraRays *rays, double x, double y, const float *lens, Vec3 *origin,
                    Vec3 *direction)
{
    const double right = rays->pixel * (x - rays->half_width);
    const double up = rays->pixel * (rays->half_height - y);
    bool seen = true;
    *origin = rays->eye;
    if (rays->projection == CAMERA_PERSPECTIVE)
        *direction = vec3_unit(in_frame(rays, right, up, 1));
    else if (rays->projection == CAMERA_ORTHOGRAPHIC) {
        *origin = vec3_add(rays->eye, in_frame(rays, right, up, 0));
        *direction = rays->forward;
    } else
        seen = round_direction(rays, right, up, direction);
    if (lens != NULL && rays->lens > 0)
        through_lens(rays, lens, origin, direction);
    return seen;
}

void camera_rays_crop(CameraRays *rays, int x, int y)
{
    assert(x >= 0 && y >= 0);
    rays->half_width -= x;
    rays->half_height -= y;
}

double camera_rays_footprint(const CameraRays *rays, double distance)
{
    return rays->projection == CAMERA_ORTHOGRAPHIC ? rays->pixel : rays->pixel * distance;
}
