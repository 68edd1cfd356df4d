/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays against curved shapes: in the space of the unit form, where they are quadrics or a torus.
 *
 * The ray's own parameter survives the affine map. Its origin is first moved to the point nearest
 * to the form's centre: the equations then have small coefficients however far the eye is, and
 * only the last addition rounds at the size of t. */
#include <assert.h>
#include <stddef.h>

#include "math/internal.h"
#include "math/shape.h"

/* Each returns whether there is a hit, and its s. */
static bool sphere_first(const LocalRay *ray, double *s)
{
    const double c = 1 - vec3_dot(ray->origin, ray->origin);

    if (!(c >= 0))
        return false;
    const double half = sqrt(c / ray->square); /* half the chord: origin is its middle */
    *s = local_ray_allows(ray, -half) ? -half : half;
    return local_ray_allows(ray, *s);
}

static bool disc_first(const LocalRay *ray, double *s)
{
    *s = -ray->origin.z / ray->direction.z; /* a ray in the plane: infinite or NaN, no hit */
    if (!local_ray_allows(ray, *s))
        return false;
    const Vec3 p = vec3_mad(ray->origin, *s, ray->direction);
    return p.x * p.x + p.y * p.y <= 1;
}

static bool frustum_valid(const LocalRay *ray, double s)
{
    const double z = ray->origin.z + s * ray->direction.z;
    return local_ray_allows(ray, s) && z >= 0 && z <= 1;
}

static bool frustum_first(const LocalRay *ray, double ratio, double *s)
{
    const double k = ratio - 1;
    const Vec3 o = ray->origin, d = ray->direction;
    const double radius = 1 + k * o.z, growth = k * d.z;
    const double a = d.x * d.x + d.y * d.y - growth * growth;
    const double b = o.x * d.x + o.y * d.y - growth * radius;
    const double c = o.x * o.x + o.y * o.y - radius * radius;
    const double root = b * b - a * c;

    if (!(root >= 0))
        return false;
    /* The two solutions without cancellation; a ray along a generator has a = 0 and its first
     * one at infinity. 0 / 0 fails each comparison. */
    const double q = -(b + copysign(sqrt(root), b));
    const double s1 = fmin(q / a, c / q), s2 = fmax(q / a, c / q);
    if (frustum_valid(ray, s1))
        *s = s1;
    else if (frustum_valid(ray, s2))
        *s = s2;
    else
        return false;
    return true;
}

static bool local_first(const Shape *shape, const LocalRay *ray, double *s)
{
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return sphere_first(ray, s);
    case SHAPE_DISC:
        return disc_first(ray, s);
    case SHAPE_FRUSTUM:
        return frustum_first(ray, shape->ratio, s);
    case SHAPE_TORUS:
        break;
    }
    return torus_first(ray, shape->ratio, s);
}

/* Whether a ray that meets the unit form at p comes from outside. Normals map so that their product
 * with a direction keeps its sign (shape.c); lengths do not count. */
static bool from_outside(const Shape *shape, Vec3 p, Vec3 d)
{
    if (shape->kind == SHAPE_SPHERE)
        return vec3_dot(p, d) < 0;
    if (shape->kind == SHAPE_DISC)
        return d.z < 0;
    const double r = sqrt(p.x * p.x + p.y * p.y);
    if (shape->kind == SHAPE_FRUSTUM) /* at a cone's tip the normal with u = 0 */
        return (r > 0 ? p.x * d.x + p.y * d.y : d.x) +
               (r > 0 ? r : 1) * (1 - shape->ratio) * d.z < 0;
    const double off = 1 - 1 / r; /* from the ring: r >= 1 - ratio > 0 */
    return off * (p.x * d.x + p.y * d.y) + p.z * d.z < 0;
}

bool shape_meet(const Shape *shape, Vec3 origin, Vec3 direction, double t_min, double t_max,
                ShapeMeeting *meeting)
{
    assert(shape != NULL && meeting != NULL);
    LocalRay ray = { .origin = affine_point(&shape->to_local, origin),
                     .direction = affine_vector(&shape->to_local, direction),
                     .t_min = t_min,
                     .t_max = t_max };
    const Vec3 centre = vec3(0, 0, shape->kind == SHAPE_FRUSTUM ? 0.5 : 0);
    double s;

    ray.square = vec3_dot(ray.direction, ray.direction);
    if (!(ray.square > 0))
        return false;
    ray.shift = vec3_dot(vec3_sub(centre, ray.origin), ray.direction) / ray.square;
    ray.origin = vec3_mad(ray.origin, ray.shift, ray.direction);
    if (!local_first(shape, &ray, &s))
        return false;
    meeting->t = ray.shift + s;
    meeting->local = vec3_mad(ray.origin, s, ray.direction);
    meeting->front = from_outside(shape, meeting->local, ray.direction);
    return true;
}

void shape_meeting_parameters(const Shape *shape, const ShapeMeeting *meeting, double *u, double *v)
{
    shape_local_parameters(shape, meeting->local, u, v);
}

bool shape_intersect(const Shape *shape, Vec3 origin, Vec3 direction, double t_min, double t_max,
                     ShapeHit *hit)
{
    ShapeMeeting meeting;
    assert(shape != NULL && hit != NULL);
    if (!shape_meet(shape, origin, direction, t_min, t_max, &meeting))
        return false;
    *hit = (ShapeHit){ .t = meeting.t, .front = meeting.front };
    shape_meeting_parameters(shape, &meeting, &hit->u, &hit->v);
    return true;
}
