/* SPDX-License-Identifier: BSD-3-Clause */
/* render/clear.h -- light that passes through glass, straight on.
 *
 * Rays that gather light are weakened by what they cross, not bent: caustics are left out, but what
 * stands behind a pane or under water is lit. The eye's own rays are bent (specular.h).
 */
#ifndef RENDER_CLEAR_H
#define RENDER_CLEAR_H

#include "radiosity/room.h"

/* Whether any material lets light through: if not, all below need not be called. */
bool clear_exists(const Room *room);

/* Share of light that a blocked ray's way lets pass from end to end: 0 when opaque. */
Rgb clear_between(const Room *room, const Ray *ray);

/* Follows a ray with its nearest hit through what is clear: *hit becomes the first opaque one, its
 * t still counted from the ray's start, or RAY_MISS. Returns the share of light that passes. */
Rgb clear_nearest(const Room *room, const Ray *ray, Hit *hit);

#endif
