/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/ceiling_light.h -- a lamp for a scene that has none. */
#ifndef SCENES_CEILING_LIGHT_H
#define SCENES_CEILING_LIGHT_H

#include "mesh/surfaces.h"
#include "raycast/bvh.h"
#include "scenes/scene.h"

/* Hangs a flat square lamp just under the ceiling, in the middle of the room that the scene's first
 * camera stands in, else of the room that view_of_surfaces shows: group and material
 * "ceiling-light", shining down, strong enough for about 500 lux on the floor. A scene without a
 * ceiling gets the lamp at the top of its box.
 * hits come from `bvh`, built over `surfaces`, which were made from the scene.
 * fails  false and ERROR_MEMORY; ERROR_INPUT when the scene has no extent. */
bool ceiling_light_hang(Scene *scene, const Surfaces *surfaces, const Bvh *bvh, Error *err);

#endif
