/* SPDX-License-Identifier: BSD-3-Clause */
/* Straight rays through panes. */
#include "render/clear.h"

#include "math/fresnel.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"

/* Crossings after which a ray is taken for lost: a window of three panes, four times over. */
enum { CROSSINGS = 24 };

/* What one crossing lets through, straight; 0: opaque, or the skin of a body, which bends light. */
static Rgb crossing(const Room *room, const RoomHit *hit, Vec3 way)
{
    Material        scratch;
    const Material *m = places_hit(room, hit, &scratch);
    const double    ior = m->ior > 0 ? m->ior : 1;
    if (!(rgb_max(m->transmittance) > 0) ||
        (ior != 1 && mirrors_is_skin(room, hit->surface)))
        return rgb(0, 0, 0);
    const double cosine = fmin(fmax(-vec3_dot(way, hit->normal), 0), 1);
    return rgb_scale(m->transmittance, 1 - fresnel_pane(cosine, ior));
}

/* Follows a ray with its nearest hit through what is clear: *hit becomes the first opaque one, its
 * t still counted from the ray's start, or RAY_MISS. Returns the share of light that passes. */
static Rgb clear_nearest(const Room *room, const Ray *ray, Hit *hit)
{
    const Vec3   d = vec3(ray->dx, ray->dy, ray->dz), way = vec3_unit(d);
    const double length = vec3_length(d);
    Rgb          passed = { 1, 1, 1 };
    double       start = 0, end = ray->t_max;
    for (int i = 0; i < CROSSINGS && hit->primitive != RAY_MISS; i++) {
        RoomHit at;
        room_hit(room, hit, d, &at);
        const Rgb share = crossing(room, &at, way);
        if (!(rgb_max(share) > 0)) {
            hit->t += (float)start;
            return passed;
        }
        passed = rgb_mul(passed, share);
        start += hit->t;
        /* The new start is off the old line by up to the offset: a ray that was to end that far
         * before a surface must still do so. */
        end -= 2 * room->offset / length;
        const Ray on = ray_leaving(at.point, at.normal, -room->offset, d, (float)(end - start));
        bvh_nearest(room->bvh, &on, hit);
    }
    hit->primitive = RAY_MISS;
    return passed;
}

Rgb clear_between(const Room *room, const Ray *ray)
{
    Hit hit;
    bvh_nearest(room->bvh, ray, &hit);
    const Rgb passed = clear_nearest(room, ray, &hit);
    return hit.primitive == RAY_MISS ? passed : rgb(0, 0, 0);
}
