/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/view.h -- a camera for a scene without one: in the room, or before its open side. */
#ifndef SCENES_VIEW_H
#define SCENES_VIEW_H

#include "mesh/surfaces.h"
#include "raycast/bvh.h"
#include "scenes/scene.h"

/* Makes a camera that shows the room. When the scene's bounds are open towards one level side (most
 * rays sent in from there, all over that face of the box, reach deep) the eye stands before it and
 * sees the whole opening; otherwise it stands inside in free air at eye height, where it sees far
 * and much. What is no room at all is seen from outside. `up` as the scene's. Places that see
 * fronts are preferred to hollows behind walls and under floors, which see backs.
 * hits come from `bvh`, built over `surfaces`, which were made from the scene. */
void view_of_surfaces(const Scene *scene, const Surfaces *surfaces, const Bvh *bvh,
                      Camera *camera);
/* The same for triangles of which no more is known; `up` as a scene's. */
void view_of_triangles(const Bvh *bvh, Vec3 lo, Vec3 hi, Vec3 up, Camera *camera);

#endif
