/* SPDX-License-Identifier: BSD-3-Clause */
/* Questions about a surface at (s, t), and the check of a whole Surfaces. */
#include <assert.h>
#include <math.h>

#include "math/tolerance.h"
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
        out->point = shape_point(shape, s, t);
        out->normal = shape_normal(shape, s, t);
        out->density = shape_density(shape, s, t);
        out->primitive = f->primitive;
    } else if (f->kind == SURFACE_TRIANGLE) {
        triangle_point(surfaces, f->primitive, s, t, out);
    } else if (t <= s) {
        triangle_point(surfaces, f->primitive, s - t, t, out);
    } else {
        triangle_point(surfaces, f->primitive + 1, s, t - s, out);
    }
}

Vec3 surfaces_normal(const Surfaces *surfaces, uint32_t primitive, double u, double v)
{
    assert(primitive < surfaces_primitive_count(surfaces));
    if (primitive < surfaces->triangle_count)
        return vec3_unit(triangle_cross(surfaces, primitive));
    return shape_normal(&surfaces->shape[primitive - surfaces->triangle_count], u, v);
}

static uint32_t surface_primitives(const Surface *f) { return f->kind == SURFACE_QUAD ? 2 : 1; }

static bool check_primitives(const Surfaces *s)
{
    uint32_t next_triangle = 0, next_shape = s->triangle_count;
    for (uint32_t i = 0; i < s->count; i++) {
        const Surface *f = &s->surface[i];
        uint32_t *next = f->kind == SURFACE_SHAPE ? &next_shape : &next_triangle;
        if (f->primitive != *next)
            return false;
        *next += surface_primitives(f);
        if (*next > surfaces_primitive_count(s))
            return false;
        for (uint32_t k = 0; k < surface_primitives(f); k++)
            if (surfaces_of_primitive(s, f->primitive + k) != i)
                return false;
    }
    for (size_t i = 0; i < 3 * (size_t)s->triangle_count; i++)
        if (s->corner[i] >= s->vertex_count)
            return false;
    return next_triangle == s->triangle_count && next_shape == surfaces_primitive_count(s);
}

static bool check_areas(const Surfaces *s)
{
    /* Area is a sum of two lengths of cross products, here formed once more in the same way. */
    const double slack = rounding_bound(64);
    for (uint32_t i = 0; i < s->count; i++) {
        const Surface *f = &s->surface[i];
        double area = 0;
        if (!(f->area > 0) || !isfinite(f->area))
            return false;
        if (f->kind == SURFACE_SHAPE)
            continue;
        for (uint32_t k = 0; k < surface_primitives(f); k++)
            area += vec3_length(triangle_cross(s, f->primitive + k)) / 2;
        if (!(fabs(area - f->area) <= slack * area))
            return false;
        const uint32_t *c = s->corner + 3 * (size_t)f->primitive;
        if (f->kind == SURFACE_QUAD && (c[0] != c[3] || c[2] != c[4]))
            return false;
    }
    return true;
}

static bool check_neighbours(const Surfaces *s)
{
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 4; k++) {
            const uint32_t j = s->surface[i].neighbour[k];
            if (j == SURFACE_NONE)
                continue;
            if (j >= s->count)
                return false;
            const uint32_t *back = s->surface[j].neighbour;
            if (back[0] != i && back[1] != i && back[2] != i && back[3] != i)
                return false;
        }
    return true;
}

bool surfaces_check(const Surfaces *surfaces)
{
    assert(surfaces != NULL);
    return check_primitives(surfaces) && check_areas(surfaces) && check_neighbours(surfaces);
}
