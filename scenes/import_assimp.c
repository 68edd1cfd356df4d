/* SPDX-License-Identifier: BSD-3-Clause */
/* The importing library at work, in the child. The only file that includes assimp.
 *
 * No post-processing is asked for: it would drop, join and triangulate. What glTF says beside its
 * triangles comes from scenes/gltf.h.
 */
#include <assert.h>
#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "scenes/gltf.h"
#include "scenes/import.h"
#include "scenes/import_files.h"

static const double degrees_per_radian = 57.295779513082320877;

typedef struct {
    const char           *path;
    PipeWriter           *out;
    Error                *err;
    ImportFiles           files;
    Gltf                 *gltf;          /* NULL: another format */
    const struct aiScene *scene;
    uint32_t             *material;      /* [mNumMaterials]  number in the pipe */
    uint64_t              loose;         /* points and lines */
} Import;

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
    (void)file, (void)from, (void)size, (void)count;
    return 0;
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

static void material_send(Import *import, const struct aiMaterial *from)
{
    struct aiString name = { 0 };
    Material m = material_default();
    const double opacity = fmin(fmax(value_get(from, "$mat.opacity", 1), 0), 1);

    (void)aiGetMaterialString(from, AI_MATKEY_NAME, &name);
    m.name = name.data;
    m.reflectance = rgb_scale(color_get(from, "$clr.diffuse", m.reflectance), opacity);
    m.specular = rgb_scale(color_get(from, "$clr.specular", m.specular), opacity);
    m.emission = color_get(from, "$clr.emissive", m.emission);
    m.exponent = fmax(value_get(from, "$mat.shininess", 0), 0);
    if (opacity < 1) {
        m.transmittance = rgb(1 - opacity, 1 - opacity, 1 - opacity);
        m.ior = fmax(value_get(from, "$mat.refracti", 1), 1);
    }
    pipe_put_material(import->out, &m);
}

/* The materials of the file; assimp's own stand-ins for none, unnamed in PLY, stay out. */
static bool materials_send(Import *import)
{
    const struct aiScene *scene = import->scene;
    uint32_t sent = 0;
    bool textured = false;

    import->material = array_create(scene->mNumMaterials, sizeof *import->material, "materials",
                                    import->err);
    if (import->material == NULL)
        return false;
    for (unsigned i = 0; i < scene->mNumMaterials; i++) {
        const struct aiMaterial *m = scene->mMaterials[i];
        struct aiString name = { 0 };
        size_t index;
        (void)aiGetMaterialString(m, AI_MATKEY_NAME, &name);
        import->material[i] = PIPE_NO_MATERIAL;
        if (import->gltf != NULL) {
            if (sscanf(name.data, "m%zu", &index) == 1 && index < import->gltf->material_count)
                import->material[i] = (uint32_t)index;
        } else if (name.length > 0 && strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) != 0) {
            material_send(import, m);
            import->material[i] = sent++;
            textured = textured || aiGetMaterialTextureCount(m, aiTextureType_DIFFUSE) > 0 ||
                       aiGetMaterialTextureCount(m, aiTextureType_EMISSIVE) > 0;
        }
    }
    if (textured)
        pipe_put_warning(import->out, "textures-ignored", import->path,
                         "images are not read: materials have one colour each");
    return true;
}

/* --- parts ------------------------------------------------------------------------------------ */

static Affine affine_get(const struct aiMatrix4x4 *m)
{
    return (Affine){ { (double)m->a1, (double)m->b1, (double)m->c1 },
                     { (double)m->a2, (double)m->b2, (double)m->c2 },
                     { (double)m->a3, (double)m->b3, (double)m->c3 },
                     { (double)m->a4, (double)m->b4, (double)m->c4 } };
}

static bool corners_check(const Import *import, const struct aiMesh *mesh, const char *group)
{
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        for (unsigned k = 0; k < mesh->mFaces[i].mNumIndices; k++)
            if (mesh->mFaces[i].mIndices[k] >= mesh->mNumVertices)
                return error_at(import->err, ERROR_INPUT, import->path, 0,
                                "face %u of object \"%.80s\" names vertex %u of %u", i, group,
                                mesh->mFaces[i].mIndices[k], mesh->mNumVertices);
    return true;
}

/* assimp leaves out faces with an index out of range and says nothing. */
static bool gltf_faces_check(const Import *import, const struct aiMesh *mesh, const char *group)
{
    size_t index, primitive = 0;
    const Gltf *gltf = import->gltf;

    if (sscanf(mesh->mName.data, "a%zu-%zu", &index, &primitive) < 1 || index >= gltf->mesh_count ||
        primitive >= gltf->first_primitive[index + 1] - gltf->first_primitive[index])
        return true;
    const uint64_t wanted = gltf->faces[gltf->first_primitive[index] + primitive];
    if (wanted > 0 && wanted != mesh->mNumFaces)
        return error_at(import->err, ERROR_INPUT, import->path, 0,
                        "object \"%.80s\" has indices out of range (%llu of %llu triangles are "
                        "good)", group, (unsigned long long)mesh->mNumFaces,
                        (unsigned long long)wanted);
    return true;
}

static void faces_send(const Import *import, const struct aiMesh *mesh, bool mirrored)
{
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        if (mesh->mFaces[i].mNumIndices >= 3)
            pipe_put_u32(import->out, mesh->mFaces[i].mNumIndices);
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        for (unsigned k = 0; k < face->mNumIndices && face->mNumIndices >= 3; k++)
            pipe_put_u32(import->out, face->mIndices[mirrored ? face->mNumIndices - 1 - k : k]);
    }
}

static bool mesh_send(Import *import, const struct aiMesh *mesh, const Affine *world,
                      const char *group)
{
    uint32_t faces = 0;

    if (!corners_check(import, mesh, group) ||
        (import->gltf != NULL && !gltf_faces_check(import, mesh, group)))
        return false;
    for (unsigned i = 0; i < mesh->mNumFaces; i++)
        faces += mesh->mFaces[i].mNumIndices >= 3;
    import->loose += mesh->mNumFaces - faces;
    if (faces == 0)
        return true;
    pipe_put_kind(import->out, RECORD_PART);
    pipe_put_text(import->out, group);
    pipe_put_u32(import->out, mesh->mMaterialIndex < import->scene->mNumMaterials
                              ? import->material[mesh->mMaterialIndex] : PIPE_NO_MATERIAL);
    pipe_put_u32(import->out, mesh->mNumVertices);
    pipe_put_u32(import->out, faces);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        const struct aiVector3D p = mesh->mVertices[i];
        pipe_put_vec3(import->out,
                      affine_point(world, vec3((double)p.x, (double)p.y, (double)p.z)));
    }
    faces_send(import, mesh, affine_determinant(world) < 0);
    return !import->out->broken;
}

/* --- nodes ------------------------------------------------------------------------------------ */

/* Names in angle brackets are assimp's own. */
static const char *group_name(const struct aiNode *node, const struct aiMesh *mesh)
{
    if (node->mName.length > 0 && node->mName.data[0] != '<')
        return node->mName.data;
    return mesh->mName.length > 0 && mesh->mName.data[0] != '<' ? mesh->mName.data : "";
}

static bool node_send(Import *import, const struct aiNode *node, const Affine *parent)
{
    const Affine local = affine_get(&node->mTransformation);
    Affine world = affine_then(&local, parent);
    const char *name = NULL;
    size_t index;

    if (import->gltf != NULL && sscanf(node->mName.data, "n%zu", &index) == 1 &&
        index < import->gltf->node_count) {
        world = import->gltf->node[index].world;
        name = import->gltf->node[index].name;
    }
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        if (node->mMeshes[i] >= import->scene->mNumMeshes)
            return error_at(import->err, ERROR_INPUT, import->path, 0, "a mesh is missing");
        const struct aiMesh *mesh = import->scene->mMeshes[node->mMeshes[i]];
        if (!mesh_send(import, mesh, &world, name != NULL ? name : group_name(node, mesh)))
            return false;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (!node_send(import, node->mChildren[i], &world))
            return false;
    return true;
}

/* Place of the node of that name in the world. */
static bool node_find(const struct aiNode *node, const char *name, const Affine *parent,
                      Affine *world)
{
    const Affine local = affine_get(&node->mTransformation);
    const Affine here = affine_then(&local, parent);

    if (strcmp(node->mName.data, name) == 0) {
        *world = here;
        return true;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        if (node_find(node->mChildren[i], name, &here, world))
            return true;
    return false;
}

/* --- lights and cameras of other formats ------------------------------------------------------ */

static void camera_send(Import *import, const struct aiCamera *from)
{
    const Affine still = affine_identity();
    Affine world = still;
    Camera camera = { .aspect = from->mAspect > 0 ? (double)from->mAspect : 0 };
    const double half = tan((double)from->mHorizontalFOV / 2);

    (void)node_find(import->scene->mRootNode, from->mName.data, &still, &world);
    camera.eye = affine_point(&world, vec3((double)from->mPosition.x, (double)from->mPosition.y,
                                           (double)from->mPosition.z));
    const Vec3 look = affine_vector(&world, vec3((double)from->mLookAt.x, (double)from->mLookAt.y,
                                                 (double)from->mLookAt.z));
    camera.target = vec3_add(camera.eye, vec3_unit(look));
    camera.up = vec3_unit(affine_vector(&world, vec3((double)from->mUp.x, (double)from->mUp.y,
                                                     (double)from->mUp.z)));
    /* assimp's angle is the whole horizontal one; without an aspect the view counts as square. */
    camera.vertical_fov = 2 * degrees_per_radian
                          * atan(half / (camera.aspect > 0 ? camera.aspect : 1));
    snprintf(camera.name, sizeof camera.name, "%.63s", from->mName.data);
    if (!(camera.vertical_fov > 0 && camera.vertical_fov < 180) || !vec3_finite(camera.eye) ||
        !(vec3_length(vec3_cross(look, camera.up)) > 0)) {
        pipe_put_warning(import->out, "camera-ignored", camera.name, "it does not look anywhere");
        return;
    }
    pipe_put_camera(import->out, &camera);
}

static void light_send(Import *import, const struct aiLight *from)
{
    const Affine still = affine_identity();
    Affine world = still;
    const double far = from->mAttenuationQuadratic > 0 ? (double)from->mAttenuationQuadratic : 1;
    Light light = { .kind = LIGHT_POINT, .cos_inner = -1, .cos_outer = -1 };

    snprintf(light.name, sizeof light.name, "%.63s", from->mName.data);
    if (from->mType != aiLightSource_POINT && from->mType != aiLightSource_SPOT) {
        pipe_put_warning(import->out, "light-ignored", light.name,
                         "only point and spot lights can be used");
        return;
    }
    (void)node_find(import->scene->mRootNode, from->mName.data, &still, &world);
    light.position = affine_point(&world, vec3((double)from->mPosition.x,
                                               (double)from->mPosition.y,
                                               (double)from->mPosition.z));
    light.direction = vec3_unit(affine_vector(&world, vec3((double)from->mDirection.x,
                                                           (double)from->mDirection.y,
                                                           (double)from->mDirection.z)));
    light.intensity = rgb((double)from->mColorDiffuse.r / far, (double)from->mColorDiffuse.g / far,
                          (double)from->mColorDiffuse.b / far);
    if (from->mType == aiLightSource_SPOT) {
        light.kind = LIGHT_SPOT;
        light.cos_outer = cos(fmin((double)from->mAngleOuterCone / 2, M_PI / 2));
        light.cos_inner = cos(fmin((double)from->mAngleInnerCone / 2, M_PI / 2));
        light.cos_inner = fmax(light.cos_inner, light.cos_outer);
    }
    pipe_put_warning(import->out, "light-units", light.name,
                     "this format gives lights no unit: the intensity is taken as candela");
    pipe_put_light(import->out, &light);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void warning_pass(void *user, const char *code, const char *where, const char *text)
{
    pipe_put_warning(user, code, where, "%s", text);
}

/* Reads the JSON, sends what it says, and puts the reduced file in place of the true one. */
static bool gltf_prepare(Import *import, size_t at)
{
    const Monitor monitor = { .user = import->out, .warn = warning_pass };
    const ImportFile *file = &import->files.file[at];
    GltfParts parts;
    size_t size = 0;

    if (!gltf_split(import->path, (const uint8_t *)file->bytes, file->size, &parts, import->err))
        return false;
    import->gltf = gltf_read(import->path, parts.json, parts.json_size, &monitor, import->err);
    const Gltf *gltf = import->gltf;
    if (gltf == NULL)
        return false;
    for (size_t i = 0; i < gltf->material_count; i++)
        pipe_put_material(import->out, &gltf->material[i]);
    for (size_t i = 0; i < gltf->light_count; i++)
        pipe_put_light(import->out, &gltf->light[i]);
    for (size_t i = 0; i < gltf->camera_count; i++)
        pipe_put_camera(import->out, &gltf->camera[i]);
    uint8_t *bytes = gltf_join(&parts, gltf->reduced, strlen(gltf->reduced), &size, import->err);
    if (bytes == NULL)
        return false;
    import_files_replace(&import->files, at, (char *)bytes, size);
    return true;
}

static bool gltf_has_mesh(const Gltf *gltf)
{
    for (size_t i = 0; i < gltf->node_count; i++)
        if (gltf->node[i].present && gltf->node[i].mesh != SIZE_MAX)
            return true;
    return false;
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
    const Affine still = affine_identity();
    const struct aiScene *scene = import->scene;

    if (!materials_send(import))
        return false;
    for (unsigned i = 0; import->gltf == NULL && i < scene->mNumLights; i++)
        light_send(import, scene->mLights[i]);
    for (unsigned i = 0; import->gltf == NULL && i < scene->mNumCameras; i++)
        camera_send(import, scene->mCameras[i]);
    return scene->mRootNode == NULL || node_send(import, scene->mRootNode, &still);
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
    if (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0) {
        if (!gltf_prepare(import, at))
            return false;
        if (!gltf_has_mesh(import->gltf))
            return true; /* the parent says that there are no faces */
    }
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
