/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as an OBJ file, and as its material library: a sound scene or one line of error.
 *
 * What follows a line "#mtl" is the library, which the OBJ part calls "100". */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define LIBRARY_FILE 100
#define OBJ_FILE     101

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

static void obj_read(Error *err)
{
    size_t warnings = 0;
    const Monitor monitor = { .user = &warnings, .warn = warning_take };
    const SceneReadOptions options = { .monitor = &monitor };
    char path[32];

    snprintf(path, sizeof path, "/proc/self/fd/%d", OBJ_FILE);
    Scene *scene = scene_create(path, err);
    demand(scene != NULL);
    ImportTarget target = { .soup = &scene->polygons, .scene = scene, .path = path,
                            .options = &options, .map = affine_identity(), .plain = UINT32_MAX };
    const bool good = import_obj(&target, err);
    demand(good != error_is_set(err));
    demand(scene_check(scene));
    demand(target.faces == scene->polygons.polygon_count);
    scene_destroy(scene);
}

static void mtl_read(Error *err)
{
    MaterialLibrary library = { 0 };
    uint64_t hash = 0;
    char path[32];

    snprintf(path, sizeof path, "/proc/self/fd/%d", LIBRARY_FILE);
    demand(import_mtl(&library, path, &hash, err) != error_is_set(err));
    for (size_t i = 0; i < library.count; i++)
        demand(library_find(&library, library.material[i].name) == i);
    library_clear(&library);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Error obj = { 0 }, mtl = { 0 };
    const uint8_t *cut = size > 0 ? memmem(data, size, "#mtl\n", 5) : NULL;
    const size_t first = cut != NULL ? (size_t)(cut - data) : size;

    file_offer(data, first, OBJ_FILE);
    file_offer(data + first, size - first, LIBRARY_FILE);
    obj_read(&obj);
    mtl_read(&mtl);
    if (error_is_set(&obj))
        error_demand(&obj);
    if (error_is_set(&mtl))
        error_demand(&mtl);
    close(OBJ_FILE);
    close(LIBRARY_FILE);
    demand(array_live() == 0);
    return 0;
}
