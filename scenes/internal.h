/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/internal.h -- what the readers share; this folder only. */
#ifndef SCENES_INTERNAL_H
#define SCENES_INTERNAL_H

#include "scenes/scene.h"

/* Each fills a new Scene or fails as scene_read does. */
Scene *scene_read_msd(const char *path, const SceneReadOptions *options, Error *err);
Scene *scene_read_import(const char *path, const SceneReadOptions *options, Error *err);

/* MSD text that is in memory already; `file` is what messages call it. INCLUDE and BREPOBJ, which
 * would read files, are refused, and what REF may repeat is limited tightly: for fuzzing. */
Scene *scene_parse_msd(const char *file, const char *text, size_t size,
                       const SceneReadOptions *options, Error *err);

/* Limits a reflectance to what light can die in and says so once per material. */
void scene_limit_material(Material *material, const char *file, const SceneReadOptions *options);

/* Reads a foreign file's polygons into an existing soup (BREPOBJ): every polygon gets `material`
 * unless it is UINT32_MAX, then the file's own materials are added. `map` moves positions. */
bool scene_import_into(Polygons *soup, const char *path, uint32_t material, const Affine *map,
                       const SceneReadOptions *options, uint64_t *hash, Error *err);

#endif
