/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/ceiling_light.h -- a lamp for a scene that has none. */
#ifndef SCENES_CEILING_LIGHT_H
#define SCENES_CEILING_LIGHT_H

#include "raycast/bvh.h"
#include "scenes/scene.h"

/* Hangs a flat square lamp just under the ceiling over the middle of the room: group and material
 * "ceiling-light", shining down, strong enough for about 500 lux on the floor. The ceiling is found
 * by rays upward; a scene without one gets the lamp at the top of its box.
 * hits come from `bvh`, built over the scene's geometry; lo, hi are its bounds.
 * fails  false and ERROR_MEMORY; ERROR_INPUT when the scene has no extent. */
bool ceiling_light_add(Scene *scene, const Bvh *bvh, Vec3 lo, Vec3 hi, Error *err);

#endif
