/* SPDX-License-Identifier: BSD-3-Clause */
/* The importing library at work, in the child: files, materials, the whole.
 *
 * No post-processing is asked for: it would drop, join and triangulate. What glTF says beside its
 * triangles is sent by scenes/import_prepare.h.
 */
#include "scenes/import_assimp.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "scenes/import_quirks.h"

/* --- files for assimp ------------------------------------------------------------------------- */

typedef struct {
    ImportFiles *files;
    size_t       index, at;
} Stream;

static size_t stream_read(struct aiFile *file, char *to, size_t size, size_t count)
{
    Stream *s = (Stream *)(void *)file->UserData;
    const ImportFile *f = &s->files->file[s->index];
    const size_t left = f->size - s->at;
    const size_t take = size == 0 ? 0 : left / size < count ? left / size : count;

    memcpy(to, f->bytes + s->at, take * size);
    s->at += take * size;
    return take;
}

static size_t stream_write(struct aiFile *file, const char *from, size_t size, size_t count)
{
    return (void)file, (void)from, (void)size, (void)count, (size_t)0;
}

static size_t stream_tell(struct aiFile *file) { return ((Stream *)(void *)file->UserData)->at; }

static size_t stream_size(struct aiFile *file)
{
    const Stream *s = (Stream *)(void *)file->UserData;
    return s->files->file[s->index].size;
}

static enum aiReturn stream_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    Stream *s = (Stream *)(void *)file->UserData;
    const size_t size = stream_size(file);
    const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? s->at : size;
    if (offset > size - from)
        return aiReturn_FAILURE;
    s->at = from + offset;
    return aiReturn_SUCCESS;
}

static void stream_flush(struct aiFile *file) { (void)file; }
static struct aiFile *stream_open(struct aiFileIO *io, const char *path, const char *mode)
{
    ImportFiles *files = (ImportFiles *)(void *)io->UserData;
    Error ignored = { 0 };
    size_t index;

    if (mode[0] != 'r' || !import_files_get(files, path, &index))
        return NULL;
    Stream *stream = array_create(1, sizeof *stream, "stream", &ignored);
    struct aiFile *file = array_create(1, sizeof *file, "stream", &ignored);
    if (stream == NULL || file == NULL) {
        array_free(stream);
        return array_free(file);
    }
    *stream = (Stream){ .files = files, .index = index };
    *file = (struct aiFile){ .ReadProc = stream_read, .WriteProc = stream_write,
                             .TellProc = stream_tell, .FileSizeProc = stream_size,
                             .SeekProc = stream_seek, .FlushProc = stream_flush,
                             .UserData = (aiUserData)(void *)stream };
    return file;
}

static void stream_close(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    if (file != NULL)
        array_free(file->UserData);
    array_free(file);
}

/* --- materials -------------------------------------------------------------------------------- */

static Rgb color_get(const struct aiMaterial *m, const char *key, Rgb fallback)
{
    struct aiColor4D c;
    if (aiGetMaterialColor(m, key, 0, 0, &c) != aiReturn_SUCCESS)
        return fallback;
    return rgb((double)c.r, (double)c.g, (double)c.b);
}

static double value_get(const struct aiMaterial *m, const char *key, double fallback)
{
    ai_real value;
    unsigned count = 1;

    if (aiGetMaterialFloatArray(m, key, 0, 0, &value, &count) != aiReturn_SUCCESS ||
        !isfinite(value))
        return fallback;
    return (double)value;
}

/* assimp's COLLADA reader fills in 0.4 and 10 where the file says nothing of a highlight, and 0.6
 * where there is no diffuse part. */
static void collada_material(const struct aiMaterial *from, Material *m)
{
    static const float unsaid = 0.4F, unsaid_exponent = 10;
    int shading = aiShadingMode_Phong;
    unsigned count = 1;
    const Rgb s = m->specular;

    (void)aiGetMaterialIntegerArray(from, AI_MATKEY_SHADING_MODEL, &shading, &count);
    const bool glossy = shading == aiShadingMode_Phong || shading == aiShadingMode_Blinn;
    if (!glossy || ((float)s.r == unsaid && (float)s.g == unsaid && (float)s.b == unsaid &&
                    (float)m->exponent == unsaid_exponent)) {
        m->specular = rgb(0, 0, 0);
        m->exponent = 0;
    }
    if (shading == aiShadingMode_NoShading) /* <constant> has nothing but emission */
        m->reflectance = rgb(0, 0, 0);
}

static void material_send(Import *import, const struct aiMaterial *from)
{
    struct aiString name = { 0 };
    Material m = material_default();
    const double opacity = fmin(fmax(value_get(from, "$mat.opacity", 1), 0), 1);

    (void)aiGetMaterialString(from, AI_MATKEY_NAME, &name);
    m.name = name.data;
    m.reflectance = rgb_scale(color_get(from, "$clr.diffuse", m.reflectance), opacity);
    m.specular = color_get(from, "$clr.specular", m.specular);
    m.specular = rgb_scale(m.specular, value_get(from, "$mat.shinpercent", 1) * opacity);
    m.emission = color_get(from, "$clr.emissive", m.emission);
    m.exponent = fmax(value_get(from, "$mat.shininess", 0), 0);
    if (import->known.format == FORMAT_COLLADA)
        collada_material(from, &m);
    if (opacity < 1) {
        m.transmittance = rgb(1 - opacity, 1 - opacity, 1 - opacity);
        m.ior = fmax(value_get(from, "$mat.refracti", 1), 1);
    }
    pipe_put_material(import->out, &m);
}

/* An image in the file itself, "*0" or by its name; NULL: it is elsewhere. */
static const void *image_inside(const struct aiScene *scene, const char *name, size_t *size)
{
    for (unsigned i = 0; i < scene->mNumTextures; i++) {
        const struct aiTexture *t = scene->mTextures[i];
        *size = t->mWidth; /* with a height: pixels, which no format in use here has */
        if ((name[0] == '*' ? (unsigned)atoi(name + 1) == i
                            : strcmp(name, t->mFilename.data) == 0) && t->mHeight == 0)
            return t->pcData;
    }
    return NULL;
}

/* The image of a material's diffuse colour. */
static void texture_send(Import *import, unsigned i)
{
    const struct aiMaterial *m = import->scene->mMaterials[i];
    const enum aiTextureType type = aiGetMaterialTextureCount(m, aiTextureType_DIFFUSE) > 0
                                    ? aiTextureType_DIFFUSE : aiTextureType_BASE_COLOR;
    enum aiTextureMapMode mode[2] = { aiTextureMapMode_Wrap, aiTextureMapMode_Wrap };
    struct aiUVTransform map = { .mScaling = { 1, 1 } };
    struct aiString name;
    unsigned set = 0;
    size_t size = 0;

    if (import->material[i] == PIPE_NO_MATERIAL ||
        aiGetMaterialTexture(m, type, 0, &name, NULL, &set, NULL, NULL, mode, NULL) !=
            aiReturn_SUCCESS)
        return;
    const void *bytes = image_inside(import->scene, name.data, &size);
    const uint32_t image = child_image_send(&import->images, name.data, bytes, size);
    if (image == UINT32_MAX)
        return;
    (void)aiGetMaterialUVTransform(m, AI_MATKEY_UVTRANSFORM(type, 0), &map);
    import->place[i] = (ImagePlace){ set + 1, { (double)map.mScaling.x, (double)map.mScaling.y },
                                     { (double)map.mTranslation.x, (double)map.mTranslation.y },
                                     (double)map.mRotation };
    child_image_use(&import->images, import->material[i], image,
                    mode[0] == aiTextureMapMode_Clamp ? WRAP_CLAMP :
                    mode[0] == aiTextureMapMode_Mirror ? WRAP_MIRROR : WRAP_REPEAT,
                    import->known.gltf == NULL ||
                    import->known.gltf->material[import->material[i]].cut_out);
}

/* The image of a material's emission. */
static void glow_send(Import *import, unsigned i)
{
    const struct aiMaterial *m = import->scene->mMaterials[i];
    struct aiString name;
    size_t size = 0;

    if (import->material[i] == PIPE_NO_MATERIAL ||
        aiGetMaterialTexture(m, aiTextureType_EMISSIVE, 0, &name, NULL, NULL, NULL, NULL, NULL,
                             NULL) != aiReturn_SUCCESS)
        return;
    const void *bytes = image_inside(import->scene, name.data, &size);
    child_image_glow(&import->images, import->material[i], name.data, bytes, size);
}

/* The materials of the file; assimp's own stand-ins for none stay out. */
static bool materials_send(Import *import)
{
    const struct aiScene *scene = import->scene;
    uint32_t sent = 0;

    import->material = array_create(scene->mNumMaterials, sizeof *import->material, "materials",
                                    import->err);
    import->place = array_create(scene->mNumMaterials, sizeof *import->place, "images",
                                 import->err);
    import->images = (ChildImages){ .path = import->path, .out = import->out,
                                    .files = &import->files, .err = import->err };
    if (error_is_set(import->err))
        return false;
    for (unsigned i = 0; i < scene->mNumMaterials; i++) {
        const struct aiMaterial *m = scene->mMaterials[i];
        struct aiString name = { 0 };
        size_t index;
        (void)aiGetMaterialString(m, AI_MATKEY_NAME, &name);
        import->material[i] = PIPE_NO_MATERIAL;
        if (import->known.gltf != NULL) {
            if (sscanf(name.data, "m%zu", &index) == 1 &&
                index < import->known.gltf->material_count)
                import->material[i] = (uint32_t)index;
        } else if (name.length > 0 && strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) != 0) {
            material_send(import, m);
            import->material[i] = sent++;
        }
        texture_send(import, i);
        glow_send(import, i);
    }
    return true;
}

/* --- the whole -------------------------------------------------------------------------------- */

static double meta_number(const struct aiScene *scene, const char *key, double fallback)
{
    const struct aiMetadata *meta = scene->mMetaData;

    for (unsigned i = 0; meta != NULL && i < meta->mNumProperties; i++) {
        const struct aiMetadataEntry *entry = &meta->mValues[i];
        if (strcmp(meta->mKeys[i].data, key) != 0 || entry->mData == NULL)
            continue;
        switch (entry->mType) {
        case AI_INT32: return (double)*(const int32_t *)entry->mData;
        case AI_FLOAT: return (double)*(const float *)entry->mData;
        case AI_DOUBLE: return *(const double *)entry->mData;
        default: return fallback;
        }
    }
    return fallback;
}

/* FBX says which axis is up and how many centimetres a unit has; assimp does nothing about it. */
static void fbx_settings_send(Import *import)
{
    static const double centimetres = 100; /* in a metre */
    const double axis = meta_number(import->scene, "UpAxis", 1);
    const double sign = meta_number(import->scene, "UpAxisSign", 1) < 0 ? -1 : 1;
    const double unit = meta_number(import->scene, "UnitScaleFactor", 1);

    pipe_put_kind(import->out, RECORD_UP);
    pipe_put_vec3(import->out, vec3(axis == 0 ? sign : 0, axis != 0 && axis != 2 ? sign : 0,
                                    axis == 2 ? sign : 0));
    if (unit != centimetres)
        pipe_put_warning(import->out, "length-unit", import->path,
                         "this file says that its unit of length is %g m", unit / centimetres);
}

/* assimp's sentences may hold its own function names and several lines: the first line will do. */
static bool failure_tell(const Import *import)
{
    const char *why = aiGetErrorString();
    const int length = (int)strcspn(why, "\r\n");

    if (strstr(why, "No suitable reader found") != NULL)
        return error_at(import->err, ERROR_INPUT, import->path, 0,
                        "its content is not what its name says, or it is damaged");
    return error_at(import->err, ERROR_INPUT, import->path, 0, "cannot be read: %.*s",
                    length < 300 ? length : 300, why);
}

static bool scene_send(Import *import)
{
    const struct aiScene *scene = import->scene;
    const float unit = (float)import_root_scale(import);

    if (!materials_send(import))
        return false;
    if (import->known.format == FORMAT_FBX)
        fbx_settings_send(import);
    if (import->known.format == FORMAT_COLLADA && unit != 1)
        pipe_put_warning(import->out, "length-unit", import->path,
                         "lengths are turned into metres: this file's unit is %g m", (double)unit);
    for (unsigned i = 0; import->known.gltf == NULL && i < scene->mNumLights; i++)
        import_light_send(import, scene->mLights[i]);
    for (unsigned i = 0; import->known.gltf == NULL && i < scene->mNumCameras; i++)
        import_camera_send(import, scene->mCameras[i]);
    if (!import_meshes_send(import))
        return false;
    if (import->faces < import->known.faces)
        pipe_put_warning(import->out, "file-cut", import->path,
                         "has %llu of the %llu faces it promises: it may be cut off",
                         (unsigned long long)import->faces,
                         (unsigned long long)import->known.faces);
    return true;
}

static bool import_run(Import *import)
{
    struct aiFileIO io = { .OpenProc = stream_open, .CloseProc = stream_close,
                           .UserData = (aiUserData)(void *)&import->files };
    const char *slash = strrchr(import->path, '/');
    const char *dot = strrchr(slash != NULL ? slash : import->path, '.');
    size_t at;

    if (dot == NULL || aiIsExtensionSupported(dot) == AI_FALSE)
        return error_at(import->err, ERROR_INPUT, import->path, 0,
                        "no reader knows the ending \"%.20s\"; known are .msd .obj .gltf .glb "
                        ".ply .stl .3ds .dae .fbx and more", dot != NULL ? dot : "");
    if (!import_files_get(&import->files, import->path, &at))
        return error_set(import->err, import->files.err.code != ERROR_NONE
                         ? import->files.err.code : ERROR_MEMORY, "%s", import->files.err.text);
    if (!import_prepare(&import->known, import->path, &import->files, at, import->out,
                        import->err))
        return false;
    if (import->known.nothing)
        return true; /* the parent says that there are no faces */
    import->scene = aiImportFileEx(import->path, 0, &io);
    if (import->scene == NULL)
        return failure_tell(import);
    return scene_send(import);
}

bool import_assimp(const char *path, PipeWriter *out, Error *err)
{
    assert(path != NULL && out != NULL && err != NULL);
    Import import = { .path = path, .out = out, .err = err };

    if (!import_run(&import) || error_is_set(err))
        return false;
    pipe_put_kind(out, RECORD_LOOSE);
    pipe_put_u64(out, import.loose);
    pipe_put_kind(out, RECORD_END);
    pipe_put_u64(out, import.files.hash);
    return true; /* the process ends: nothing is given back */
}
