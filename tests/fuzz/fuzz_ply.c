/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a PLY file: a sound scene or one line of error, nothing left over. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(bool condition)
{
    if (!condition)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const SceneReadOptions options = { 0 };
    Error err = { 0 };
    char path[32];
    const int file = memfd_create("fuzz", MFD_CLOEXEC);

    demand(file >= 0 && write(file, data, size) == (ssize_t)size);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    Scene *scene = scene_create(path, &err);
    demand(scene != NULL);
    ImportTarget target = { .soup = &scene->polygons, .scene = scene, .path = path,
                            .options = &options, .map = affine_identity(), .plain = UINT32_MAX };
    demand(import_ply(&target, &err) != error_is_set(&err));
    demand(scene_check(scene) && target.faces == scene->polygons.polygon_count);
    if (error_is_set(&err))
        demand(err.code == ERROR_INPUT && err.text[0] != 0 && strchr(err.text, '\n') == NULL);
    scene_destroy(scene);
    close(file);
    demand(array_live() == 0);
    return 0;
}
