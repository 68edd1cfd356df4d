/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import_quirks.h -- what assimp 5.2 gets wrong or leaves out of single formats; this folder
 * and tests.
 *
 * Knows    bytes and numbers, not assimp.
 */
#ifndef SCENES_IMPORT_QUIRKS_H
#define SCENES_IMPORT_QUIRKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/light.h"
#include "math/vec3.h"

/* Makes cameras of a COLLADA text mean what they say, in place, without moving a byte: assimp does
 * not know a yfov alone, and takes a wrong ratio of sides from an xfov and a yfov. Afterwards such
 * a camera has an xfov of the vertical angle and no ratio: a square view. */
void collada_mend(char *text, size_t size);
/* Whether spots of a COLLADA text name an outer cone, beside the falloff_angle. Where none does,
 * assimp makes one up. */
bool collada_has_cones(const char *text, size_t size);

/* Names of the meshes of a 3DS file in their order, pointing into its bytes; assimp has them only
 * when there is a key frame for each.
 * owns   *name is freed by the caller with array_free. */
bool discreet_names(const uint8_t *bytes, size_t size, const char ***name, size_t *count,
                    Error *err);
/* Up in 3DS is z, but assimp turned y by the roll angle about `look` and gives that as up: the same
 * roll from z. All in the file's axes; look is a unit vector. */
Vec3 discreet_up(Vec3 look, Vec3 up);

/* Whether a text STL lacks its last endsolid: assimp takes what there is. */
bool stl_is_cut(const char *text, size_t size);
/* Faces that an OFF text promises, 0 when it is not known; assimp takes what there is. A 0 byte
 * ends the text. */
uint64_t off_faces(const char *text);

/* A spot's cones from assimp's angles, which are whole ones. added: the inner one is in the outer
 * (3DS); single: there is only the inner one, and assimp put another round it (COLLADA). */
void spot_cones(Light *light, bool added, bool single, double inner, double outer);

#endif
