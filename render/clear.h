/* SPDX-License-Identifier: BSD-3-Clause */
/* render/clear.h -- light that passes through panes, straight on: for rays to lamps and lights.
 *
 * The skin of a body of glass bends light, and so stops these rays: what it throws on is found by
 * rays of the hemisphere, which are bent as the eye's are (specular.h).
 */
#ifndef RENDER_CLEAR_H
#define RENDER_CLEAR_H

#include "radiosity/room.h"

/* Share of light that a blocked ray's way lets pass from end to end: 0 when opaque. */
Rgb clear_between(const Room *room, const Ray *ray);

#endif
