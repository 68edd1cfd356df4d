/* SPDX-License-Identifier: BSD-3-Clause */
/* On which side of other surfaces a place is. */
#include "mesh/slicers.h"

#include <assert.h>
#include <math.h>

#include "math/tolerance.h"

/* Rounding of where a ray starts and of where it hits is below one offset each; grazing hits are
 * off by more. */
static const double MARGIN = 4;

Slicer slicer_plane(Vec3 normal, double level, Vec3 lo, Vec3 hi)
{
    return (Slicer){ .kind = SLICER_PLANE, .shape = SURFACE_NONE, .normal = normal, .level = level,
                     .lo = lo, .hi = hi, .size = INFINITY };
}

/* The plane of the unit form where axis k is 0, or `at`. */
static Slicer split_plane(const Shape *shape, const Slicer *of, int k, double at)
{
    const Affine *m = &shape->to_local;
    const Vec3 row = vec3(vec3_axis(m->x, k), vec3_axis(m->y, k), vec3_axis(m->z, k));
    const double length = vec3_length(row);
    Slicer c = *of;
    c.kind = SLICER_SPLIT_PLANE;
    c.splits = 0;
    c.normal = vec3_scale(row, 1 / length);
    c.level = (at - vec3_axis(m->t, k)) / length;
    return c;
}

uint32_t slicer_shape(const Surfaces *surfaces, uint32_t index, Slicer *slicer)
{
    assert(index < surfaces->shape_count);
    const Shape *shape = &surfaces->shape[index];
    Slicer own = { .kind = SLICER_SHAPE, .shape = index,
                   .scale = 1 / affine_stretch(&shape->to_local) };
    uint32_t count = 1;
    shape_bounds(shape, &own.lo, &own.hi);
    own.size = own.scale * (shape->kind == SHAPE_TORUS ? 2 * shape->ratio
                            : shape->kind == SHAPE_FRUSTUM ? fmax(shape->ratio, 1) : 2);
    if (shape->kind == SHAPE_TORUS) {
        slicer[count] = own;
        slicer[count++].kind = SLICER_SPLIT_RING;
    }
    for (int k = 0; k < 3 && shape->kind != SHAPE_DISC; k++)
        if (k < 2 || shape->kind != SHAPE_FRUSTUM)
            slicer[count++] = split_plane(shape, &own, k, 0);
    own.splits = count - 1;
    assert(count <= 1 + SLICER_SPLITS);
    slicer[0] = own;
    return count;
}

double slicer_side(const Surfaces *surfaces, const Slicer *c, Vec3 p)
{
    if (c->kind == SLICER_PLANE || c->kind == SLICER_SPLIT_PLANE)
        return vec3_dot(c->normal, p) - c->level;
    const Shape *shape = &surfaces->shape[c->shape];
    if (c->kind == SLICER_SHAPE)
        return c->scale * shape_outside(shape, p);
    const Vec3 q = affine_point(&shape->to_local, p);
    return c->scale * (sqrt(q.x * q.x + q.y * q.y) - 1);
}

double slicer_margin(const Surfaces *surfaces, const Slicer *c)
{
    return c->kind == SLICER_PLANE || c->kind == SLICER_SHAPE
         ? MARGIN * ray_offset(surfaces->largest_coordinate) : 0;
}

bool slicer_signs(const Surfaces *surfaces, const uint32_t *slicer, uint32_t count, Vec3 p,
                  uint32_t *signs)
{
    assert(count <= 32);
    *signs = 0;
    for (uint32_t k = 0; k < count; k++) {
        const Slicer *c = &surfaces->slicer[slicer[k]];
        const double side = slicer_side(surfaces, c, p);
        if (fabs(side) < slicer_margin(surfaces, c))
            return false;
        *signs |= (uint32_t)(side > 0) << k;
    }
    return true;
}
