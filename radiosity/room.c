/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/room.c -- what a ray met: surface, side, place and patch. */
#include "radiosity/room.h"

#include <assert.h>

#include "math/sampling.h"
#include "radiosity/internal.h"

/* The side that a ray along `direction` runs into, given the front normal. */
static unsigned side_hit(Vec3 front, Vec3 direction)
{
    return vec3_dot(front, direction) > 0 ? 1 : 0;
}

uint32_t room_patch(const Room *room, const Hit *hit, Vec3 direction, uint32_t *surface, double *s,
                    double *t)
{
    *surface = surfaces_of_primitive(room->surfaces, hit->primitive);
    const Vec3 front = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
    surfaces_parameters(room->surfaces, hit->primitive, hit->u, hit->v, s, t);
    return patches_at(room->patches, room->surfaces, *surface, side_hit(front, direction), *s, *t);
}

void room_hit(const Room *room, const Hit *hit, Vec3 direction, RoomHit *out)
{
    assert(room != NULL && hit != NULL && out != NULL);
    assert(hit->primitive < surfaces_primitive_count(room->surfaces));
    const Surfaces *surfaces = room->surfaces;
    SurfacePoint at;
    out->primitive = hit->primitive;
    out->surface = surfaces_of_primitive(surfaces, hit->primitive);
    surfaces_parameters(surfaces, hit->primitive, hit->u, hit->v, &out->s, &out->t);
    surfaces_point(surfaces, out->surface, out->s, out->t, &at);
    out->point = at.point;
    out->side = side_hit(at.normal, direction);
    out->normal = out->side == 0 ? at.normal : vec3_scale(at.normal, -1);
    out->patch = room->patches == NULL ? PATCH_NONE
                                       : patches_at(room->patches, surfaces, out->surface,
                                                    out->side, out->s, out->t);
}

Rgb room_emission(const Room *room, uint32_t patch)
{
    assert(patch < room->patches->count);
    const uint32_t surface = room->patches->surface[patch];
    if (((room->emitting[surface] >> room->patches->side[patch]) & 1) == 0)
        return rgb(0, 0, 0);
    return rgb_scale(room->materials[room->patches->material[patch]].emission, M_PI);
}

uint32_t room_patch_key(const Room *room, uint32_t patch)
{
    const Patches *patches = room->patches;
    const PatchCell cell = patches->cell[patch];
    const uint32_t which = (uint32_t)cell.level << 2 | (uint32_t)cell.upper << 1 |
                           patches->side[patch];
    return sampling_seed(patches->surface[patch], cell.i, cell.j, which);
}
