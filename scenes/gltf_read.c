/* SPDX-License-Identifier: BSD-3-Clause */
/* A glTF's JSON as a whole: what it demands, its meshes' sizes, its nodes, materials and lights. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

/* Kinds of primitives. */
enum { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6, MODE_COUNT = 7 };

#define COMPONENT_FLOAT 5126

/* --- what the file demands -------------------------------------------------------------------- */

/* Extensions without which a file may be read all the same: they change no triangle. */
static bool extension_known(const char *name)
{
    static const char *const known[] = { "KHR_lights_punctual", "KHR_texture_transform",
                                         "KHR_texture_basisu", "EXT_texture_webp",
                                         "KHR_animation_pointer", "KHR_xmp_json_ld" };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(name, known[i]) == 0)
            return true;
    return strncmp(name, "KHR_materials_", 14) == 0;
}

static bool demands_check(const GltfContext *c, const Json *root)
{
    const Json *asset = gltf_object(c, root, "", "asset");
    const char *version = gltf_word(c, asset, "asset", "version", "");
    const Json *list = gltf_list(c, root, "", "extensionsRequired");

    if (error_is_set(c->err))
        return false;
    if (asset == NULL || version[0] == 0)
        return gltf_error(c, "asset", "there is no \"version\": this is not glTF 2.0");
    if (version[0] != '2' || (version[1] != '.' && version[1] != 0))
        return gltf_error(c, "asset", "glTF of version \"%.20s\"; 2.0 is supported", version);
    for (size_t i = 0; i < gltf_count(list); i++) {
        const char *name = gltf_string_item(c, list, "extensionsRequired", i);
        if (name == NULL)
            return false;
        if (!extension_known(name))
            return gltf_error(c, "extensionsRequired", "%.80s is not supported", name);
    }
    return true;
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Entries of the accessor that `key` names; 0 when there is none. */
static uint64_t accessor_count(const GltfContext *c, const Json *accessors, const Json *object,
                               const char *where, const char *key, bool positions)
{
    const size_t at = gltf_index(c, object, where, key, gltf_count(accessors));

    if (at == SIZE_MAX)
        return 0;
    const Json *accessor = gltf_item(accessors, at);
    char place[48];
    snprintf(place, sizeof place, "accessors[%zu]", at);
    const char *type = gltf_word(c, accessor, place, "type", "");
    const size_t component = gltf_index(c, accessor, place, "componentType", 1 << 16);
    const size_t count = gltf_index(c, accessor, place, "count", UINT32_MAX);
    if (error_is_set(c->err))
        return 0;
    if (positions && (strcmp(type, "VEC3") != 0 || component != COMPONENT_FLOAT))
        gltf_error(c, place, "positions must be three floats each");
    if (!positions && (strcmp(type, "SCALAR") != 0 || component == COMPONENT_FLOAT))
        gltf_error(c, place, "indices must be single whole numbers");
    if (count == SIZE_MAX || count == 0)
        gltf_error(c, place, "has no \"count\"");
    return error_is_set(c->err) ? 0 : count;
}

/* Triangles of one primitive; 0 for points and lines. */
static uint64_t primitive_faces(const GltfContext *c, const Json *root, const Json *primitive,
                                const char *where)
{
    const Json *accessors = gltf_list(c, root, "", "accessors");
    const Json *attributes = gltf_object(c, primitive, where, "attributes");
    const size_t given = gltf_index(c, primitive, where, "mode", MODE_COUNT);
    const size_t mode = given == SIZE_MAX ? MODE_TRIANGLES : given;
    const uint64_t positions = accessor_count(c, accessors, attributes, where, "POSITION", true);
    const uint64_t indices = accessor_count(c, accessors, primitive, where, "indices", false);
    const uint64_t count = gltf_member(primitive, "indices") != NULL ? indices : positions;

    if (!error_is_set(c->err) && positions == 0)
        gltf_error(c, where, "has no POSITION");
    if (mode == MODE_TRIANGLES)
        return count / 3;
    return (mode == MODE_STRIP || mode == MODE_FAN) && count > 2 ? count - 2 : 0;
}

bool gltf_read_meshes(const GltfContext *c, const Json *root, Gltf *gltf)
{
    const Json *meshes = gltf_list(c, root, "", "meshes");
    size_t total = 0, at = 0;

    gltf->mesh_count = gltf_count(meshes);
    for (size_t i = 0; i < gltf->mesh_count; i++)
        total += gltf_count(gltf_list(c, gltf_item(meshes, i), "meshes", "primitives"));
    gltf->first_primitive = array_create(gltf->mesh_count + 1, sizeof *gltf->first_primitive,
                                         "meshes", c->err);
    gltf->faces = array_create(total, sizeof *gltf->faces, "meshes", c->err);
    for (size_t i = 0; i < gltf->mesh_count && !error_is_set(c->err); i++) {
        const Json *list = gltf_member(gltf_item(meshes, i), "primitives");
        for (size_t k = 0; k < gltf_count(list) && !error_is_set(c->err); k++) {
            char where[80];
            snprintf(where, sizeof where, "meshes[%zu].primitives[%zu]", i, k);
            gltf->faces[at++] = primitive_faces(c, root, gltf_item(list, k), where);
        }
        gltf->first_primitive[i + 1] = at;
    }
    return !error_is_set(c->err);
}

/* --- normals ---------------------------------------------------------------------------------- */

/* Whether accessor `at` holds as many normals as accessor `positions` does positions: three floats
 * each, all of them within their view. The importing library gives up on a file that does not. */
static bool normals_fit(const GltfContext *c, const Json *root, size_t at, size_t positions)
{
    const Json *accessors = gltf_list(c, root, "", "accessors");
    const Json *views = gltf_list(c, root, "", "bufferViews");
    const Json *accessor = gltf_item(accessors, at);
    const char *where = "accessors of normals";
    const size_t vector = 3 * sizeof(float), most = UINT32_MAX;
    const size_t view = gltf_index(c, accessor, where, "bufferView", gltf_count(views));
    const size_t count = gltf_index(c, accessor, where, "count", most);
    const size_t offset = gltf_index(c, accessor, where, "byteOffset", most);
    if (error_is_set(c->err) || view == SIZE_MAX || count == SIZE_MAX || count == 0 ||
        gltf_member(accessor, "sparse") != NULL ||
        strcmp(gltf_word(c, accessor, where, "type", ""), "VEC3") != 0 ||
        gltf_index(c, accessor, where, "componentType", 1 << 16) != COMPONENT_FLOAT ||
        gltf_index(c, gltf_item(accessors, positions), where, "count", most) != count)
        return false;
    const Json *of = gltf_item(views, view);
    const size_t length = gltf_index(c, of, "bufferViews", "byteLength", most);
    const size_t given = gltf_index(c, of, "bufferViews", "byteStride", most);
    const size_t stride = given == SIZE_MAX || given == 0 ? vector : given;
    return length != SIZE_MAX && stride >= vector &&
           (offset == SIZE_MAX ? 0 : offset) + (count - 1) * stride + vector <= length;
}

size_t gltf_normals(const GltfContext *c, const Json *root, const Json *primitive,
                    const char *where)
{
    const size_t count = gltf_count(gltf_list(c, root, "", "accessors"));
    const Json *attributes = gltf_member(primitive, "attributes");
    const size_t at = gltf_index(c, attributes, where, "NORMAL", count);
    const size_t positions = gltf_index(c, attributes, where, "POSITION", count);
    if (error_is_set(c->err) || at == SIZE_MAX || positions == SIZE_MAX)
        return SIZE_MAX;
    if (normals_fit(c, root, at, positions))
        return at;
    if (!error_is_set(c->err))
        monitor_warn(c->monitor, "normals-ignored", c->path, "the normals of %s are not three "
                     "floats for each vertex: its faces are shaded by their shape", where);
    return SIZE_MAX;
}

/* --- the whole -------------------------------------------------------------------------------- */

Gltf *gltf_read(const char *path, const char *json, size_t size, const Monitor *monitor,
                Error *err)
{
    assert(path != NULL && json != NULL && err != NULL);
    const GltfContext c = { path, monitor, err };
    Gltf *gltf = array_create(1, sizeof *gltf, "glTF", err);
    Json *root = gltf != NULL ? gltf_parse(&c, json, size) : NULL;
    const bool good = root != NULL && demands_check(&c, root) && gltf_read_meshes(&c, root, gltf) &&
                      gltf_read_nodes(&c, root, gltf) && gltf_read_materials(&c, root, gltf) &&
                      gltf_read_lights(&c, root, gltf) && gltf_read_cameras(&c, root, gltf) &&
                      gltf_reduce(&c, root, gltf);
    if (root != NULL)
        gltf_free(root);
    return good ? gltf : gltf_destroy(gltf);
}

Gltf *gltf_destroy(Gltf *gltf)
{
    if (gltf == NULL)
        return NULL;
    for (size_t i = 0; i < gltf->material_count; i++)
        array_free(gltf->material[i].name);
    array_free(gltf->material);
    array_free(gltf->image);
    array_free(gltf->glow);
    array_free(gltf->node);
    array_free(gltf->light);
    array_free(gltf->camera);
    array_free(gltf->first_primitive);
    array_free(gltf->faces);
    array_free(gltf->reduced);
    return array_free(gltf);
}
