/* SPDX-License-Identifier: BSD-3-Clause */
/* The JSON that assimp gets: nodes with a mesh, side by side, and what their triangles need. */
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

typedef struct {
    char  *text;
    size_t used, capacity;
    Error *err;
} TextOut;

static void text_add(TextOut *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void bytes_add(TextOut *out, const char *bytes, size_t size)
{
    if (!array_reserve((void **)&out->text, &out->capacity, out->used + size + 1, 1,
                       "reduced glTF", out->err))
        return;
    memcpy(out->text + out->used, bytes, size);
    out->used += size;
    out->text[out->used] = 0;
}

/* Short pieces only. */
static void text_add(TextOut *out, const char *format, ...)
{
    char piece[256];
    va_list list;

    va_start(list, format);
    const int length = vsnprintf(piece, sizeof piece, format, list);
    va_end(list);
    assert(length >= 0 && (size_t)length < sizeof piece);
    bytes_add(out, piece, (size_t)length);
}

/* Copies a member as it is, when it is there. */
static void member_copy(TextOut *out, const Json *object, const char *key)
{
    const Json *member = gltf_member(object, key);

    if (member == NULL || error_is_set(out->err))
        return;
    char *text = gltf_text(member);
    if (text == NULL) {
        error_set(out->err, ERROR_MEMORY, "no memory for the JSON of \"%s\"", key);
        return;
    }
    text_add(out, ",\"%s\":", key);
    bytes_add(out, text, strlen(text));
    gltf_text_free(text);
}

static void nodes_add(TextOut *out, const Gltf *gltf)
{
    size_t count = 0;

    text_add(out, ",\"nodes\":[");
    for (size_t i = 0; i < gltf->node_count; i++)
        if (gltf->node[i].present && gltf->node[i].mesh != SIZE_MAX)
            text_add(out, "%s{\"name\":\"n%zu\",\"mesh\":%zu}", count++ > 0 ? "," : "", i,
                     gltf->node[i].mesh);
    text_add(out, "],\"scene\":0,\"scenes\":[{\"nodes\":[");
    for (size_t i = 0; i < count; i++)
        text_add(out, "%s%zu", i > 0 ? "," : "", i);
    text_add(out, "]}]");
}

static void primitive_add(const GltfContext *c, TextOut *out, const Json *root, const Gltf *gltf,
                          const Json *primitive, const char *where)
{
    const size_t many = SIZE_MAX / 2;
    const size_t material = gltf_index(c, primitive, where, "material", gltf->material_count);
    const size_t indices = gltf_index(c, primitive, where, "indices", many);
    const size_t mode = gltf_index(c, primitive, where, "mode", many);
    const size_t position = gltf_index(c, gltf_member(primitive, "attributes"), where, "POSITION",
                                       many);
    const size_t normals = gltf_normals(c, root, primitive, where);

    text_add(out, "{\"attributes\":{\"POSITION\":%zu", position);
    if (normals != SIZE_MAX)
        text_add(out, ",\"NORMAL\":%zu", normals);
    static const char *const sets[] = { "TEXCOORD_0", "TEXCOORD_1" };
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
        const size_t at = gltf_index(c, gltf_member(primitive, "attributes"), where, sets[k],
                                     many);
        if (at != SIZE_MAX && material != SIZE_MAX && gltf->image[material])
            text_add(out, ",\"%s\":%zu", sets[k], at);
    }
    text_add(out, "}");
    if (indices != SIZE_MAX)
        text_add(out, ",\"indices\":%zu", indices);
    if (mode != SIZE_MAX)
        text_add(out, ",\"mode\":%zu", mode);
    if (material != SIZE_MAX)
        text_add(out, ",\"material\":%zu", material);
    text_add(out, "}");
}

/* Its name, and the images of its colour and emission: assimp finds and unpacks them. */
static void material_add(TextOut *out, const Json *root, const Gltf *gltf, size_t i)
{
    const Json *json = gltf_item(gltf_member(root, "materials"), i);
    const Json *old = gltf_member(gltf_member(json, "extensions"),
                                  "KHR_materials_pbrSpecularGlossiness");
    const Json *texture = old != NULL ? gltf_member(old, "diffuseTexture")
                                      : gltf_member(gltf_member(json, "pbrMetallicRoughness"),
                                                    "baseColorTexture");

    text_add(out, "%s{\"name\":\"m%zu\"", i > 0 ? "," : "", i);
    char *text = gltf->image[i] && !error_is_set(out->err) ? gltf_text(texture) : NULL;
    if (text != NULL) {
        text_add(out, ",\"pbrMetallicRoughness\":{\"baseColorTexture\":");
        bytes_add(out, text, strlen(text));
        text_add(out, "}");
        gltf_text_free(text);
    }
    if (gltf->glow[i])
        member_copy(out, json, "emissiveTexture");
    text_add(out, "}");
}

static void meshes_add(const GltfContext *c, TextOut *out, const Json *root, const Gltf *gltf)
{
    const Json *meshes = gltf_member(root, "meshes");

    text_add(out, ",\"meshes\":[");
    for (size_t i = 0; i < gltf->mesh_count; i++) {
        const Json *list = gltf_member(gltf_item(meshes, i), "primitives");
        char where[48];
        snprintf(where, sizeof where, "meshes[%zu]", i);
        text_add(out, "%s{\"name\":\"a%zu\",\"primitives\":[", i > 0 ? "," : "", i);
        for (size_t k = 0; k < gltf_count(list); k++) {
            if (k > 0)
                text_add(out, ",");
            primitive_add(c, out, root, gltf, gltf_item(list, k), where);
        }
        text_add(out, "]}");
    }
    text_add(out, "],\"materials\":[");
    for (size_t i = 0; i < gltf->material_count; i++)
        material_add(out, root, gltf, i);
    text_add(out, "]");
}

bool gltf_reduce(const GltfContext *c, const Json *root, Gltf *gltf)
{
    assert(c != NULL && root != NULL && gltf != NULL);
    TextOut out = { .err = c->err };

    text_add(&out, "{\"asset\":{\"version\":\"2.0\"},"
              "\"extensionsUsed\":[\"KHR_texture_transform\"]");
    nodes_add(&out, gltf);
    meshes_add(c, &out, root, gltf);
    member_copy(&out, root, "textures");
    member_copy(&out, root, "images");
    member_copy(&out, root, "samplers");
    member_copy(&out, root, "accessors");
    member_copy(&out, root, "bufferViews");
    member_copy(&out, root, "buffers");
    text_add(&out, "}");
    gltf->reduced = out.text;
    return !error_is_set(c->err);
}
