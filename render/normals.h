/* SPDX-License-Identifier: BSD-3-Clause */
/* render/normals.h -- smooth normals: the curved body that a mesh of triangles stands for.
 *
 * Reflections and refractions use them, and light that is received where the eye sees it, straight
 * or by way of mirrors and glass. All other light meets the triangles as they are, so that rooms
 * are solved and measured as they were modelled.
 * Method   where triangles bulge, light is received at the curved body, just off the triangle
 *          [hanika21]: rays from there tell what arrives, and none passes a triangle. Elsewhere
 *          none comes from below the triangle, and its share fades out towards there [chiang19].
 */
#ifndef RENDER_NORMALS_H
#define RENDER_NORMALS_H

#include "radiosity/room.h"
#include "render/lamps.h"

/* [9 * triangle_count] normals at the corners of the room's triangles: those the file gives, where
 * they are of any use (within 60 degrees of their triangle's, turned to its front); else means over
 * the triangles around the vertex that lie within the crease angle, weighted by their angle there.
 * owns   the caller frees with array_free. NULL: no normal differs from its triangle's.
 * fails  NULL and ERROR_MEMORY. */
float *normals_create(const Room *room, Error *err);

/* Unit normal at a hit, on its side, interpolated; the true one on exact shapes, for smooth NULL,
 * and where the smooth one would be seen from behind along `in`. */
Vec3 normals_at(const float *smooth, const Room *room, const RoomHit *hit, Vec3 in);

/* Where light is received that the eye sees at a hit; smooth NULL: there. One short ray at most. */
Receiver normals_receive(const float *smooth, const Room *room, const RoomHit *hit);

/* Share, 0..1, of light from `way` (unit) that a smooth normal keeps on a triangle's side `face`
 * (unit, both): 1 where it is as high over the triangle as over the smooth surface. 1 if the two
 * are the same. */
double normals_share(Vec3 way, Vec3 normal, Vec3 face);

#endif
