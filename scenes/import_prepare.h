/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/import_prepare.h -- what is read of a foreign file, or mended in it, before assimp sees
 * it; this folder only.
 */
#ifndef SCENES_IMPORT_PREPARE_H
#define SCENES_IMPORT_PREPARE_H

#include "scenes/gltf.h"
#include "scenes/import_files.h"
#include "scenes/pipe.h"

/* Formats that need care of their own. */
typedef enum {
    FORMAT_OTHER, FORMAT_GLTF, FORMAT_COLLADA, FORMAT_FBX, FORMAT_3DS, FORMAT_STL, FORMAT_OFF
} Format;

typedef struct {
    Format       format;
    Gltf        *gltf;       /* NULL: another format */
    bool         nothing;    /* there is no mesh: assimp need not look */
    bool         cones;      /* COLLADA: spots name their outer cone */
    const char **name;       /* [name_count]  3DS: of the meshes, into the file's bytes */
    size_t       name_count;
    uint64_t     faces;      /* OFF: as many are promised; 0: not known */
} Foreknown;

/* Looks at file number `at` and, for glTF, sends its materials, lights and cameras. */
bool import_prepare(Foreknown *known, const char *path, ImportFiles *files, size_t at,
                    PipeWriter *out, Error *err);

#endif
