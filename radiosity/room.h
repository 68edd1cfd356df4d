/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/room.h -- the geometry light travels in, gathered from the stages below.
 *
 * A Room owns nothing: it points to what the caller keeps alive, and never changes while used.
 */
#ifndef RADIOSITY_ROOM_H
#define RADIOSITY_ROOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "math/light.h"
#include "mesh/patches.h"
#include "mesh/polygons.h"
#include "mesh/surfaces.h"
#include "raycast/bvh.h"
#include "scenes/texture.h"

enum { ROOM_BANDS = 3 }; /* bands of materials; solvers take any number */

typedef struct {
    const Surfaces *surfaces;
    const Bvh      *bvh;            /* over the surfaces' primitives, in their order */
    const Patches  *patches;        /* NULL: renderers that need no solution */
    const Material *materials;      /* [material_count] */
    size_t          material_count;
    const Polygons *soup;           /* of the surfaces; its normals shade; NULL: none */
    const Textures *textures;       /* what Material.texture counts; NULL: none */
    const Light    *lights;         /* [light_count] */
    size_t          light_count;
    const uint8_t  *sides;          /* [surfaces->count]  bit 0/1: front/back in use */
    const uint8_t  *emitting;       /* [surfaces->count]  bit 0/1: front/back emits */
    bool            sides_given;    /* sides were chosen by hand, not found by sight: a ray that
                                       meets one that is not in use is lost, and tells nothing about
                                       where it came from */
    bool            mirrors;        /* rays go on at mirrors and clear glass (mirrors.h) */
    const uint8_t  *skin;           /* [surfaces->count]  of mirrors_skins, or NULL */
    double          offset;         /* ray_offset(surfaces->largest_coordinate) */
    double          pocket;         /* widest gap, in scene units, whose places neither send nor
                                       receive (links.h); 0: all places do */
} Room;

/* What a ray meets: the surface, where on it, and from which side. */
typedef struct {
    uint32_t surface, patch; /* patch: PATCH_NONE when that side is not in use (a wall's inside) */
    uint32_t primitive;
    unsigned side;
    double   s, t;
    Vec3     point;          /* on the surface, from (s, t): not from the ray's t */
    Vec3     normal;         /* unit, towards the side hit */
} RoomHit;

/* Resolves a BVH hit of a ray along `direction`. */
void room_hit(const Room *room, const Hit *hit, Vec3 direction, RoomHit *out);

/* Exitance pi L of a patch by itself, 0 when its side does not emit. */
Rgb room_emission(const Room *room, uint32_t patch);

#endif
