/* SPDX-License-Identifier: BSD-3-Clause */
/* render/seen.h -- what of a picture each patch takes up. */
#ifndef RENDER_SEEN_H
#define RENDER_SEEN_H

#include "math/light.h"
#include "radiosity/room.h"
#include "scenes/scene.h"

/* Adds to seen [room->patches->count] the share of the picture that shows each patch, times
 * `weight`: by one ray through each cell of a grid of some 2^18 over the picture, which is width by
 * height pixels. What is seen in mirrors and behind glass counts for these.
 * fails  false; ERROR_MEMORY. */
bool seen_add(const Room *room, const Camera *camera, int width, int height, double weight,
              double *seen, Error *err);

#endif
