/* SPDX-License-Identifier: BSD-3-Clause */
/* Questions about a surface at (s, t). */
#include <assert.h>

#include "mesh/surfaces.h"

void surfaces_parameters(const Surfaces *surfaces, uint32_t primitive, double u, double v,
                         double *s, double *t)
{
    assert(primitive < surfaces_primitive_count(surfaces));
    const Surface *surface = &surfaces->surface[surfaces_of_primitive(surfaces, primitive)];
    const bool quad = surface->kind == SURFACE_QUAD;
    const bool second = primitive != surface->primitive;
    /* (a,b,c): b is (1,0), c is (1,1); (a,c,d): c is (1,1), d is (0,1) */
    *s = quad && !second ? u + v : u;
    *t = quad && second ? u + v : v;
}

static Vec3 triangle_cross(const Surfaces *surfaces, uint32_t triangle)
{
    const uint32_t *c = surfaces->corner + 3 * (size_t)triangle;
    const Vec3 a = surfaces->position[c[0]];
    return vec3_cross(vec3_sub(surfaces->position[c[1]], a), vec3_sub(surfaces->position[c[2]], a));
}

static void triangle_point(const Surfaces *surfaces, uint32_t triangle, double u, double v,
                           SurfacePoint *out)
{
    const uint32_t *c = surfaces->corner + 3 * (size_t)triangle;
    const Vec3 a = surfaces->position[c[0]];
    const Vec3 e1 = vec3_sub(surfaces->position[c[1]], a);
    const Vec3 e2 = vec3_sub(surfaces->position[c[2]], a);
    const Vec3 cross = vec3_cross(e1, e2);
    out->density = vec3_length(cross);
    out->point = vec3_mad(vec3_mad(a, u, e1), v, e2);
    out->normal = vec3_scale(cross, 1 / out->density);
    out->primitive = triangle;
}

void surfaces_point(const Surfaces *surfaces, uint32_t surface, double s, double t,
                    SurfacePoint *out)
{
    assert(surface < surfaces->count && out != NULL);
    const Surface *f = &surfaces->surface[surface];
    if (f->kind == SURFACE_SHAPE) {
        const Shape *shape = &surfaces->shape[f->primitive - surfaces->triangle_count];
        shape_all_at(shape, s, t, &out->point, &out->normal, &out->density);
        out->primitive = f->primitive;
    } else if (f->kind == SURFACE_TRIANGLE) {
        triangle_point(surfaces, f->primitive, s, t, out);
    } else if (t <= s) {
        triangle_point(surfaces, f->primitive, s - t, t, out);
    } else {
        triangle_point(surfaces, f->primitive + 1, s, t - s, out);
    }
}

void surfaces_place(const Surfaces *surfaces, uint32_t surface, double s, double t, Vec3 *point,
                    Vec3 *normal)
{
    assert(surface < surfaces->count && point != NULL && normal != NULL);
    const Surface *f = &surfaces->surface[surface];
    if (f->kind == SURFACE_SHAPE) {
        shape_place_at(&surfaces->shape[f->primitive - surfaces->triangle_count], s, t, point,
                       normal);
        return;
    }
    SurfacePoint at;
    surfaces_point(surfaces, surface, s, t, &at);
    *point = at.point;
    *normal = at.normal;
}

Vec3 surfaces_normal(const Surfaces *surfaces, uint32_t primitive, double u, double v)
{
    assert(primitive < surfaces_primitive_count(surfaces));
    if (primitive < surfaces->triangle_count)
        return vec3_unit(triangle_cross(surfaces, primitive));
    return shape_normal(&surfaces->shape[primitive - surfaces->triangle_count], u, v);
}
