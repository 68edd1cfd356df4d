/* SPDX-License-Identifier: BSD-3-Clause */
/* Before assimp: what glTF says beside its triangles, and mended bytes. */
#include "scenes/import_prepare.h"

#include <assert.h>
#include <string.h>
#include <strings.h>

#include "scenes/import_quirks.h"

static Format format_of(const char *path)
{
    static const struct { const char *ending; Format format; } endings[] = {
        { ".gltf", FORMAT_GLTF }, { ".glb", FORMAT_GLTF }, { ".dae", FORMAT_COLLADA },
        { ".fbx", FORMAT_FBX }, { ".3ds", FORMAT_3DS }, { ".stl", FORMAT_STL },
        { ".off", FORMAT_OFF } };
    const char *dot = strrchr(path, '.');

    for (size_t i = 0; dot != NULL && i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(dot, endings[i].ending) == 0)
            return endings[i].format;
    return FORMAT_OTHER;
}

static void warning_pass(void *user, const char *code, const char *where, const char *text)
{
    pipe_put_warning(user, code, where, "%s", text);
}

static bool gltf_has_mesh(const Gltf *gltf)
{
    for (size_t i = 0; i < gltf->node_count; i++)
        if (gltf->node[i].present && gltf->node[i].mesh != SIZE_MAX)
            return true;
    return false;
}

/* Reads the JSON, sends what it says, and puts the reduced file in place of the true one. */
static bool gltf_prepare(Foreknown *known, const char *path, ImportFiles *files, size_t at,
                         PipeWriter *out, Error *err)
{
    const Monitor monitor = { .user = out, .warn = warning_pass };
    const ImportFile *file = &files->file[at];
    GltfParts parts;
    size_t size = 0;

    if (!gltf_split(path, (const uint8_t *)file->bytes, file->size, &parts, err))
        return false;
    known->gltf = gltf_read(path, parts.json, parts.json_size, &monitor, err);
    const Gltf *gltf = known->gltf;
    if (gltf == NULL)
        return false;
    for (size_t i = 0; i < gltf->material_count; i++)
        pipe_put_material(out, &gltf->material[i]);
    for (size_t i = 0; i < gltf->light_count; i++)
        pipe_put_light(out, &gltf->light[i]);
    for (size_t i = 0; i < gltf->camera_count; i++)
        pipe_put_camera(out, &gltf->camera[i]);
    known->nothing = !gltf_has_mesh(gltf);
    uint8_t *bytes = gltf_join(&parts, gltf->reduced, strlen(gltf->reduced), &size, err);
    if (bytes == NULL)
        return false;
    import_files_replace(files, at, (char *)bytes, size);
    return true;
}

bool import_prepare(Foreknown *known, const char *path, ImportFiles *files, size_t at,
                    PipeWriter *out, Error *err)
{
    assert(known != NULL && path != NULL && files != NULL && at < files->count);
    assert(out != NULL && err != NULL);
    const ImportFile *file = &files->file[at];

    known->format = format_of(path);
    switch (known->format) {
    case FORMAT_GLTF: return gltf_prepare(known, path, files, at, out, err);
    case FORMAT_COLLADA:
        collada_mend(file->bytes, file->size);
        known->cones = collada_has_cones(file->bytes, file->size);
        return true;
    case FORMAT_3DS:
        return discreet_names((const uint8_t *)file->bytes, file->size, &known->name,
                              &known->name_count, err);
    case FORMAT_STL:
        if (stl_is_cut(file->bytes, file->size))
            pipe_put_warning(out, "file-cut", path,
                             "the last solid has no endsolid: the file may be cut off");
        return true;
    case FORMAT_OFF: known->faces = off_faces(file->bytes); return true;
    default: return true;
    }
}
