/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a View3D file: a sound scene or one line of error. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define VS3_FILE 101

static void demand(bool condition)
{
    if (!condition)
        abort();
}

/* Makes the bytes readable as /proc/self/fd/NUMBER. */
static void file_offer(const uint8_t *bytes, size_t size, int number)
{
    const int file = memfd_create("fuzz", MFD_CLOEXEC);

    demand(file >= 0 && write(file, bytes, size) == (ssize_t)size);
    demand(dup3(file, number, O_CLOEXEC) == number);
    close(file);
}

static void warning_take(void *user, const char *code, const char *where, const char *text)
{
    demand(code[0] != 0 && strchr(where, '\n') == NULL && strchr(text, '\n') == NULL);
    ++*(size_t *)user;
}

static void error_demand(const Error *err)
{
    demand(err->code == ERROR_INPUT && err->text[0] != 0 && strchr(err->text, '\n') == NULL);
}

static void vs3_read(Error *err)
{
    size_t warnings = 0;
    const Monitor monitor = { .user = &warnings, .warn = warning_take };
    const SceneReadOptions options = { .monitor = &monitor };
    char path[32];

    snprintf(path, sizeof path, "/proc/self/fd/%d", VS3_FILE);
    Scene *scene = scene_create(path, err);
    demand(scene != NULL);
    ImportTarget target = { .soup = &scene->polygons, .scene = scene, .path = path,
                            .options = &options, .map = affine_identity(), .plain = UINT32_MAX };
    const bool good = import_vs3(&target, err);
    demand(good != error_is_set(err));
    demand(scene_check(scene));
    demand(target.faces == scene->polygons.polygon_count);
    scene_destroy(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Error err = { 0 };

    file_offer(data, size, VS3_FILE);
    vs3_read(&err);
    if (error_is_set(&err))
        error_demand(&err);
    close(VS3_FILE);
    demand(array_live() == 0);
    return 0;
}
