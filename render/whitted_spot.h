/* SPDX-License-Identifier: BSD-3-Clause */
/* render/whitted_spot.h -- a place that recursive ray tracing meets, with what it asks of it. */
#ifndef RENDER_WHITTED_SPOT_H
#define RENDER_WHITTED_SPOT_H

#include "radiosity/room.h"
#include "render/lamps.h"

/* What a material does to light. */
enum { SPOT_DIFFUSE = 1, SPOT_LOBE = 2, SPOT_MIRROR = 4, SPOT_CLEAR = 8 };

unsigned whitted_spot_kind(const Material *material);

typedef struct {
    const Material *material;
    unsigned kind;
    RoomHit  hit;
    Vec3     in;     /* unit, of the ray that came */
    Vec3     normal; /* for mirrors, glass and gloss: maybe smoothed */
    Receiver at;     /* of lights, if it is diffuse or glossy */
} WhittedSpot;

/* Where a ray along `in` met hit, which is none that missed. kind: [material_count], by
 * whitted_spot_kind. *made: what an image makes of the material is put there; it must live as long
 * as *spot. */
void whitted_spot_init(WhittedSpot *spot, const Room *room, const uint8_t *kind,
                       const float *smooth, const Hit *hit, Vec3 in, Material *made);

/* Diffuse and glossy scattering into a unit direction: f cos. */
Rgb whitted_spot_value(const WhittedSpot *spot, Vec3 out);

#endif
