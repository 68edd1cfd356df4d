/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/visible.h -- places so near a seam that rounding decides on which side of it they are.
 *
 * Where a wall without thickness stands on a floor, a ray that comes down within rounding of its
 * foot may pass below it, and one that starts there may start on the other side. One such ray among
 * millions lights a dark room. So no ray starts that near to an edge where the surface does not go
 * on smoothly, and one that ends there does not count.
 */
#ifndef RADIOSITY_VISIBLE_H
#define RADIOSITY_VISIBLE_H

#include "radiosity/room.h"

/* Whether a place of a surface is that near to such an edge.
 * hot    checks nothing in release builds. */
bool visible_at_seam(const Room *room, uint32_t surface, double s, double t);

/* Whether what a ray along `direction` met is a side in use: where that has no patch nevertheless,
 * the place is too near to what parts it. */
bool visible_side_used(const Room *room, const Hit *hit, Vec3 direction);

/* Moves a point away from such edges, along its surface. */
void visible_move(const Room *room, PatchPoint *at);

#endif
