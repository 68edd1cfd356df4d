/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_sides.c -- sides of surfaces in use as convex polygons. */
#include <assert.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "radiosity/group_internal.h"

/* Sides whose pairs are gone through one by one: half a million, some seconds. More are left to
 * rays, whose cost grows with the area only. */
enum { SIDES_MOST = 1024 };

bool group_polygon(const Surfaces *surfaces, uint32_t surface, double slack, ConvexPolygon *out)
{
    const Surface *f = &surfaces->surface[surface];
    const uint32_t *c = surfaces->corner + 3 * (size_t)f->primitive;
    if (f->kind == SURFACE_SHAPE)
        return false;
    out->count = f->kind == SURFACE_TRIANGLE ? 3 : 4;
    for (int k = 0; k < 3; k++)
        out->corner[k] = surfaces->position[c[k]];
    if (f->kind == SURFACE_TRIANGLE)
        return true;
    out->corner[3] = surfaces->position[c[5]];
    const Vec3 n = surfaces_normal(surfaces, f->primitive, 0, 0);
    if (fabs(vec3_dot(n, vec3_sub(out->corner[3], out->corner[0]))) > slack)
        return false;
    for (int k = 0; k < 4; k++) {
        const Vec3 a = out->corner[k], b = out->corner[(k + 1) & 3], d = out->corner[(k + 2) & 3];
        if (!(vec3_dot(n, vec3_cross(vec3_sub(b, a), vec3_sub(d, b))) > 0))
            return false;
    }
    return true;
}

static void fill_side(Grouping *g, uint32_t surface, unsigned side, uint32_t patch)
{
    const Surfaces *surfaces = g->room->surfaces;
    GroupSide *s = &g->side[g->sides];
    *s = (GroupSide){ .surface = surface, .class = g->options->patch_class[patch],
                      .area = surfaces->surface[surface].area };
    s->flat = group_polygon(surfaces, surface, g->slack, &s->polygon);
    if (s->flat) {
        const Vec3 n = surfaces_normal(surfaces, surfaces->surface[surface].primitive, 0, 0);
        s->normal = side == 0 ? n : vec3_scale(n, -1);
        s->offset = vec3_dot(s->normal, s->polygon.corner[0]);
        for (size_t a = 0, b = s->polygon.count - 1; side != 0 && a < b; a++, b--) {
            const Vec3 swap = s->polygon.corner[a];
            s->polygon.corner[a] = s->polygon.corner[b];
            s->polygon.corner[b] = swap;
        }
    }
    g->side_of[2 * (size_t)surface + side] = g->sides++;
}

bool group_sides_create(Grouping *g, Error *err)
{
    const Surfaces *surfaces = g->room->surfaces;
    const Patches *patches = g->room->patches;
    uint32_t sides = 0;
    g->slack = position_tolerance(surfaces->largest_coordinate);
    for (uint32_t i = 0; i < surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++)
            sides += patches->first[side][i] != PATCH_NONE;
    if (sides > SIDES_MOST)
        return true;
    static const char what[] = "sides of surfaces";
    g->side = array_create(sides, sizeof *g->side, what, err);
    g->side_of = array_create(2 * (size_t)surfaces->count, sizeof *g->side_of, what, err);
    g->kind = array_create((size_t)sides * sides, 1, what, err);
    g->value = array_create((size_t)sides * sides, sizeof *g->value, what, err);
    g->between = array_create((size_t)sides * sides, 1, what, err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < surfaces->count; i++)
        for (unsigned side = 0; side < 2; side++) {
            const uint32_t patch = patches->first[side][i];
            g->side_of[2 * (size_t)i + side] = SIDE_NONE;
            if (patch != PATCH_NONE)
                fill_side(g, i, side, patch);
        }
    assert(g->sides == sides);
    return true;
}
