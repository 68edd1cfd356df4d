/* SPDX-License-Identifier: BSD-3-Clause */
/* The container of binary glTF: a header, a JSON chunk, perhaps a BIN chunk; all sizes checked. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

#define GLB_MAGIC 0x46546C67u  /* "glTF" */
#define GLB_JSON 0x4E4F534Au   /* "JSON" */
#define GLB_BIN 0x004E4942u    /* "BIN" */
#define GLB_HEADER 12u
#define GLB_CHUNK 8u

static uint32_t u32_get(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void u32_put(uint8_t *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> 8 * i);
}

static bool chunks_find(const char *path, const uint8_t *bytes, size_t size, GltfParts *parts,
                        Error *err)
{
    for (size_t at = GLB_HEADER; size - at >= GLB_CHUNK;) {
        const size_t length = u32_get(bytes + at);
        const uint32_t kind = u32_get(bytes + at + 4);
        at += GLB_CHUNK;
        if (length > size - at)
            return error_at(err, ERROR_INPUT, path, 0,
                            "a chunk of %zu bytes ends after the file's %zu", length, size);
        if (at == GLB_HEADER + GLB_CHUNK && kind != GLB_JSON)
            return error_at(err, ERROR_INPUT, path, 0, "its first chunk is not JSON");
        if (kind == GLB_JSON && parts->json == NULL) {
            parts->json = (const char *)bytes + at;
            parts->json_size = length;
        } else if (kind == GLB_BIN && parts->binary == NULL) {
            parts->binary = bytes + at;
            parts->binary_size = length;
        }
        at += length;
    }
    if (parts->json == NULL)
        return error_at(err, ERROR_INPUT, path, 0, "has no JSON chunk");
    return true;
}

bool gltf_split(const char *path, const uint8_t *bytes, size_t size, GltfParts *parts, Error *err)
{
    assert(path != NULL && bytes != NULL && parts != NULL && err != NULL);
    *parts = (GltfParts){ .is_glb = size >= 4 && u32_get(bytes) == GLB_MAGIC };
    if (!parts->is_glb) {
        const bool marked = size >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0;
        parts->json = (const char *)bytes + (marked ? 3 : 0);
        parts->json_size = size - (marked ? 3 : 0);
        return true;
    }
    if (size < GLB_HEADER)
        return error_at(err, ERROR_INPUT, path, 0, "ends within its header");
    const uint32_t version = u32_get(bytes + 4), length = u32_get(bytes + 8);
    if (version != 2)
        return error_at(err, ERROR_INPUT, path, 0, "is binary glTF of version %u; 2 is supported",
                        version);
    if (length > size || length < GLB_HEADER)
        return error_at(err, ERROR_INPUT, path, 0,
                        "says it has %u bytes, but has %zu: it is cut off or damaged", length,
                        size);
    return chunks_find(path, bytes, length, parts, err);
}

uint8_t *gltf_join(const GltfParts *parts, const char *json, size_t json_size, size_t *size,
                   Error *err)
{
    assert(parts != NULL && json != NULL && size != NULL && err != NULL);
    const size_t json_room = (json_size + 3) & ~(size_t)3;
    const size_t binary_room = (parts->binary_size + 3) & ~(size_t)3;
    const size_t total = !parts->is_glb ? json_size
                       : GLB_HEADER + GLB_CHUNK + json_room
                         + (parts->binary != NULL ? GLB_CHUNK + binary_room : 0);

    if (total > UINT32_MAX && parts->is_glb) {
        error_set(err, ERROR_INPUT, "a binary glTF of more than 4 GiB");
        return NULL;
    }
    uint8_t *bytes = array_create(total + 1, 1, "glTF", err);
    if (bytes == NULL)
        return NULL;
    *size = total;
    if (!parts->is_glb) {
        memcpy(bytes, json, json_size);
        return bytes;
    }
    u32_put(bytes, GLB_MAGIC);
    u32_put(bytes + 4, 2);
    u32_put(bytes + 8, (uint32_t)total);
    uint8_t *at = bytes + GLB_HEADER;
    u32_put(at, (uint32_t)json_room);
    u32_put(at + 4, GLB_JSON);
    memset(at + GLB_CHUNK, ' ', json_room);
    memcpy(at + GLB_CHUNK, json, json_size);
    at += GLB_CHUNK + json_room;
    if (parts->binary != NULL) {
        u32_put(at, (uint32_t)binary_room);
        u32_put(at + 4, GLB_BIN);
        memcpy(at + GLB_CHUNK, parts->binary, parts->binary_size);
    }
    return bytes;
}
