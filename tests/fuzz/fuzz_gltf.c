/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a .gltf or .glb: what its JSON says, or one line of error; nothing left over. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

static void demand(bool condition)
{
    if (!condition)
        abort();
}

static void gltf_demand(const Gltf *gltf)
{
    for (size_t i = 0; i < gltf->node_count; i++)
        demand(!gltf->node[i].present || vec3_finite(gltf->node[i].world.t));
    for (size_t i = 0; i < gltf->light_count; i++)
        demand(gltf->light[i].cos_outer <= gltf->light[i].cos_inner);
    for (size_t i = 0; i < gltf->camera_count; i++)
        demand(gltf->camera[i].vertical_fov > 0 && gltf->camera[i].vertical_fov < 180);
    for (size_t i = 0; i < gltf->material_count; i++)
        demand(!isnan(gltf->material[i].exponent));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Error err = { 0 };
    GltfParts parts;
    Gltf *gltf = NULL;

    if (gltf_split("fuzz.gltf", data, size, &parts, &err))
        gltf = gltf_read("fuzz.gltf", parts.json, parts.json_size, NULL, &err);
    demand((gltf != NULL) != error_is_set(&err));
    if (gltf != NULL) {
        size_t joined;
        gltf_demand(gltf);
        uint8_t *bytes = gltf_join(&parts, gltf->reduced, strlen(gltf->reduced), &joined, &err);
        demand(bytes != NULL);
        /* What assimp gets is itself good. */
        demand(gltf_split("fuzz.gltf", bytes, joined, &parts, &err));
        Gltf *again = gltf_read("fuzz.gltf", parts.json, parts.json_size, NULL, &err);
        demand(again != NULL);
        gltf_destroy(again);
        array_free(bytes);
    } else {
        demand(err.text[0] != 0 && strchr(err.text, '\n') == NULL);
    }
    gltf_destroy(gltf);
    demand(array_live() == 0);
    return 0;
}
