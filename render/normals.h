/* SPDX-License-Identifier: BSD-3-Clause */
/* render/normals.h -- smooth normals for mirrors: what a mesh of triangles approximates.
 *
 * Only reflections and refractions use them; light that is received meets the triangles as they
 * are, so that what is measured and what is seen agree.
 */
#ifndef RENDER_NORMALS_H
#define RENDER_NORMALS_H

#include "radiosity/room.h"

/* [9 * triangle_count] normals at the triangles' corners: means over the triangles around the
 * vertex that lie within the crease angle, weighted by their angle there.
 * owns   the caller frees with array_free.
 * fails  NULL and ERROR_MEMORY. */
float *normals_create(const Surfaces *surfaces, Error *err);

/* Unit normal at a hit, on its side, interpolated; the true one on exact shapes, for smooth NULL,
 * and where the smooth one would be seen from behind along `in`. */
Vec3 normals_at(const float *smooth, const Room *room, const RoomHit *hit, Vec3 in);

#endif
