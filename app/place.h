/* SPDX-License-Identifier: BSD-3-Clause */
/* app/place.h -- places as the user knows them: in the coordinates of the scene's file. */
#ifndef APP_PLACE_H
#define APP_PLACE_H

#include "scenes/scene.h"

/* Of a scene that was moved to the origin, coordinates need so many more digits: they are as long
 * as a map's, hundreds of kilometres in a room's millimetres. */
enum { PLACE_FAR_DIGITS = 6, PLACE_TEXT = 96 };

/* Whether the scene was moved: then floats are too coarse for its places. */
static inline bool place_is_far(const Scene *scene)
{
    return vec3_length(scene->origin) > 0;
}

/* "x,y,z" of a position in the scene, with that many digits at least. */
void place_text(const Scene *scene, Vec3 p, int digits, char out[PLACE_TEXT]);

#endif
