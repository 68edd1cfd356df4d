/* SPDX-License-Identifier: BSD-3-Clause */
/* Cameras: matrices and movements. */
#include "viewer/matrix.h"

#include <assert.h>
#include <float.h>
#include <math.h>

static const double PI = 3.14159265358979323846;
static const double STEEPEST = 0.999;   /* cosine between view and vertical: beyond, up is lost */
static const double WIDER = 1.01;       /* the depth's range, so that rounding cuts nothing off */
static const double NEAREST = 1e-4;     /* of the scene's size: what is nearer is cut off */

ViewFrame view_frame(const Camera *camera)
{
    ViewFrame f;
    Vec3 unused;
    f.forward = vec3_unit(vec3_sub(camera->target, camera->eye));
    if (!(vec3_length(f.forward) > 0))
        f.forward = vec3(0, 0, -1);
    f.right = vec3_cross(f.forward, camera->up);
    if (!(vec3_length(f.right) > DBL_EPSILON * vec3_length(camera->up)))
        vec3_frame(f.forward, &f.right, &unused);
    f.right = vec3_unit(f.right);
    f.up = vec3_cross(f.right, f.forward);
    return f;
}

static double half_tangent(const Camera *camera)
{
    return tan(fmin(camera->vertical_fov, 170) * PI / 360);
}

Vec3 view_direction(const Camera *camera, double x, double y, int width, int height)
{
    assert(width > 0 && height > 0);
    const ViewFrame f = view_frame(camera);
    const double t = half_tangent(camera), half = 0.5 * height;
    const Vec3 d = vec3_mad(f.forward, t * (x - 0.5 * width) / half, f.right);
    return vec3_unit(vec3_mad(d, t * (half - y) / half, f.up));
}

/* Distances along the view to the farthest and the nearest corner of a box. */
static void depth_range(const Camera *camera, Vec3 forward, Vec3 lo, Vec3 hi, double *nearest,
                        double *farthest)
{
    const double size = vec3_length(vec3_sub(hi, lo));
    *nearest = INFINITY;
    *farthest = 0;
    for (unsigned k = 0; k < 8; k++) {
        const Vec3 p = vec3(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z);
        const double d = vec3_dot(vec3_sub(p, camera->eye), forward);
        *nearest = fmin(*nearest, d);
        *farthest = fmax(*farthest, d);
    }
    *farthest = fmax(*farthest * WIDER, size * NEAREST);
    *nearest = fmax(*nearest / WIDER, fmax(*farthest, size) * NEAREST);
    if (*nearest >= *farthest)
        *nearest = *farthest * NEAREST;
}

void matrix_of_camera(const Camera *camera, double aspect, Vec3 middle, Vec3 lo, Vec3 hi,
                      float matrix[16])
{
    const ViewFrame f = view_frame(camera);
    const Vec3 eye = vec3_sub(camera->eye, middle);
    double n, far;
    assert(aspect > 0);
    depth_range(camera, f.forward, lo, hi, &n, &far);
    const double sy = 1 / half_tangent(camera), sx = sy / aspect;
    const double a = (far + n) / (far - n), b = -2 * far * n / (far - n);
    const Vec3 axis[3] = { f.right, f.up, f.forward };
    const double factor[3] = { sx, sy, a };
    for (int row = 0; row < 4; row++) {
        const Vec3 v = axis[row < 3 ? row : 2];
        const double s = row < 3 ? factor[row] : 1;
        matrix[row] = (float)(s * v.x);
        matrix[4 + row] = (float)(s * v.y);
        matrix[8 + row] = (float)(s * v.z);
        matrix[12 + row] = (float)(-s * vec3_dot(v, eye) + (row == 2 ? b : 0));
    }
}

/* v turned round a unit axis. */
static Vec3 turned(Vec3 v, Vec3 axis, double angle)
{
    const double c = cos(angle), s = sin(angle);
    const Vec3 along = vec3_scale(axis, vec3_dot(axis, v) * (1 - c));
    return vec3_add(vec3_mad(vec3_scale(v, c), s, vec3_cross(axis, v)), along);
}

/* A direction turned across and along, not past the vertical. */
static Vec3 swung(Vec3 way, Vec3 up, Vec3 right, double across, double along)
{
    const Vec3 tilted = turned(way, right, along);
    const double steep = vec3_dot(vec3_unit(tilted), up);
    if (fabs(steep) < STEEPEST || fabs(steep) < fabs(vec3_dot(vec3_unit(way), up)))
        way = tilted;
    return turned(way, up, -across);
}

static bool same_place(Vec3 a, Vec3 b)
{
    return !(a.x < b.x || a.x > b.x || a.y < b.y || a.y > b.y || a.z < b.z || a.z > b.z);
}

bool view_same(const Camera *a, const Camera *b)
{
    return same_place(a->eye, b->eye) && same_place(a->target, b->target) &&
           same_place(a->up, b->up) &&
           !(a->vertical_fov < b->vertical_fov || a->vertical_fov > b->vertical_fov);
}

void view_orbit(Camera *camera, Vec3 up, double across, double along)
{
    const ViewFrame f = view_frame(camera);
    const Vec3 way = vec3_sub(camera->target, camera->eye);
    camera->eye = vec3_sub(camera->target, swung(way, up, f.right, across, along));
    camera->up = up;
}

void view_look(Camera *camera, Vec3 up, double across, double along)
{
    const ViewFrame f = view_frame(camera);
    const Vec3 way = vec3_sub(camera->target, camera->eye);
    camera->target = vec3_add(camera->eye, swung(way, up, f.right, across, along));
    camera->up = up;
}

void view_move(Camera *camera, double right, double up, double forward)
{
    const ViewFrame f = view_frame(camera);
    const Vec3 by = vec3_mad(vec3_mad(vec3_scale(f.right, right), up, f.up), forward, f.forward);
    camera->eye = vec3_add(camera->eye, by);
    camera->target = vec3_add(camera->target, by);
}

void view_dolly(Camera *camera, double factor)
{
    const Vec3 way = vec3_sub(camera->target, camera->eye);
    assert(factor > 0);
    camera->eye = vec3_sub(camera->target, vec3_scale(way, factor));
}

void view_fit(Camera *camera, Vec3 centre, double radius, double aspect)
{
    assert(radius > 0 && aspect > 0);
    const ViewFrame f = view_frame(camera);
    const double narrow = half_tangent(camera) * fmin(1, aspect);
    camera->target = centre;
    camera->eye = vec3_mad(centre, -radius / sin(atan(narrow)), f.forward);
}

bool view_pixel(const Camera *camera, Vec3 place, int width, int height, double *x, double *y)
{
    const ViewFrame f = view_frame(camera);
    const Vec3 to = vec3_sub(place, camera->eye);
    const double depth = vec3_dot(to, f.forward), half = 0.5 * height;
    const double t = tan(camera->vertical_fov * M_PI / 360);
    assert(width > 0 && height > 0);
    if (!(depth > 0))
        return false;
    *x = 0.5 * width + half * vec3_dot(to, f.right) / (depth * t);
    *y = half - half * vec3_dot(to, f.up) / (depth * t);
    return true;
}
