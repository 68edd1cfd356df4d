/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/places.h -- what a place of a surface is made of: its material, or what an image makes
 * of it there; and means over patches.
 *
 * An image's colours multiply the material's reflectance. Where a material that is cut out has less
 * than half of its image opaque, nothing is there: light passes straight and unweakened.
 * Threads  any.
 */
#ifndef RADIOSITY_PLACES_H
#define RADIOSITY_PLACES_H

#include "radiosity/room.h"

/* The material of one side at a point of a primitive; *scratch is used where an image changes it,
 * and holds what is returned then. */
const Material *places_material(const Room *room, uint32_t primitive, unsigned side, Vec3 point,
                                Material *scratch);
static inline const Material *places_hit(const Room *room, const RoomHit *hit, Material *scratch)
{
    return places_material(room, hit->primitive, hit->side, hit->point, scratch);
}

/* Mean reflectance of a patch over what is opaque of it, and the share that is; opaque may be NULL.
 * Of an image's smaller copies, whose texels are as large as the samples lie apart: their mean is
 * the image's, up to the patch's rim. */
Rgb places_reflectance(const Room *room, uint32_t patch, double *opaque);

#endif
