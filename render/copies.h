/* SPDX-License-Identifier: BSD-3-Clause */
/* render/copies.h -- a room and what stands in it by reference: meshes in many places.
 *
 * Each mesh has one set of surfaces and one tree, whatever its places; a place costs about 350
 * bytes. For renderers that need no patches: these have none.
 * Units    of the world, unless "local" is said.
 * Emission of a copy is from the front alone, or as its material says from both sides.
 * Threads  never changes once made.
 */
#ifndef RENDER_COPIES_H
#define RENDER_COPIES_H

#include "radiosity/room.h"
#include "raycast/instances.h"
#include "render/lamps.h"
#include "scenes/scene.h"

typedef struct RoomCopies RoomCopies;

/* room and scene are kept, not copied, and must live as long.
 * owns   the caller gets it; copies_destroy.
 * fails  NULL; ERROR_MEMORY; ERROR_INPUT when a mesh has no area, or a place reaches too far. */
RoomCopies *copies_create(const Room *room, const Scene *scene, const SurfaceOptions *repair,
                      unsigned threads, const Monitor *monitor, Error *err);
RoomCopies *copies_destroy(RoomCopies *copies);

/* The room itself is instance 0. */
const Instances *copies_instances(const RoomCopies *copies);

/* Where a ray along `direction` hit: `hit` in the world, but for surface and primitive, which count
 * in the room that is returned: the room itself, or a mesh with its one material. */
const Room *copies_hit(const RoomCopies *copies, const InstanceHit *found, Vec3 direction,
                       RoomHit *hit);

/* Normal for mirrors and gloss where copies_hit has been, met by a ray along `in`: shared across
 * edges that are not creases, in the mesh's own space. */
Vec3 copies_normal(const RoomCopies *copies, const InstanceHit *found, const RoomHit *hit, Vec3 in);

/* Where light is received that the eye sees there: normals_receive in the mesh's own space. */
Receiver copies_receive(const RoomCopies *copies, const InstanceHit *found, const RoomHit *hit);

/* How far rays start off surfaces of all rooms: rounded in the world and in a copy's own space. */
double copies_offset(const RoomCopies *copies);

#endif
