/* SPDX-License-Identifier: BSD-3-Clause */
/* Lights and cameras of a glTF, placed in the world by their nodes; both look along -z. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "scenes/gltf.h"

static const double degrees_per_radian = 57.295779513082320877;

/* --- lights (KHR_lights_punctual) ------------------------------------------------------------- */

static bool spot_read(const GltfContext *c, const Json *json, const char *where, Light *light)
{
    const Json *spot = gltf_object(c, json, where, "spot");
    const double inner = gltf_number(c, spot, where, "innerConeAngle", 0);
    const double outer = gltf_number(c, spot, where, "outerConeAngle", M_PI / 4);

    if (error_is_set(c->err))
        return false;
    if (!(inner >= 0 && inner < outer && outer <= M_PI / 2))
        return gltf_error(c, where, "cone angles must be 0 <= inner < outer <= pi/2");
    light->kind = LIGHT_SPOT;
    light->cos_inner = cos(inner);
    light->cos_outer = cos(outer);
    return true;
}

/* A light as defined, not placed yet; *known is false for kinds that cannot be used. */
static bool light_read(const GltfContext *c, const Json *json, const char *where, Light *light,
                       bool *known)
{
    const char *type = gltf_word(c, json, where, "type", "");
    const double intensity = gltf_number(c, json, where, "intensity", 1);
    double color[3] = { 1, 1, 1 };

    gltf_numbers(c, json, where, "color", color, 3);
    if (error_is_set(c->err))
        return false;
    if (!(intensity >= 0 && color[0] >= 0 && color[1] >= 0 && color[2] >= 0))
        return gltf_error(c, where, "its intensity or color is negative");
    light->intensity = rgb_scale(rgb(color[0], color[1], color[2]), intensity);
    light->kind = LIGHT_POINT;
    light->cos_inner = light->cos_outer = -1;
    *known = strcmp(type, "point") == 0 || strcmp(type, "spot") == 0;
    if (strcmp(type, "directional") == 0)
        monitor_warn(c->monitor, "light-ignored", where,
                     "directional lights (the sun) are not supported yet");
    else if (!*known)
        return gltf_error(c, where, "\"%.40s\" is no type of light", type);
    return strcmp(type, "spot") != 0 || spot_read(c, json, where, light);
}

bool gltf_read_lights(const GltfContext *c, const Json *root, Gltf *gltf)
{
    const Json *extension = gltf_object(c, gltf_object(c, root, "", "extensions"), "extensions",
                                        "KHR_lights_punctual");
    const Json *list = gltf_list(c, extension, "KHR_lights_punctual", "lights");

    gltf->light = array_create(gltf->node_count, sizeof *gltf->light, "lights", c->err);
    for (size_t i = 0; i < gltf->node_count && !error_is_set(c->err); i++) {
        const GltfNode *node = &gltf->node[i];
        Light light = { 0 };
        bool known = false;
        char where[48];
        if (!node->present || node->light == SIZE_MAX)
            continue;
        snprintf(where, sizeof where, "lights[%zu]", node->light);
        if (!light_read(c, gltf_item(list, node->light), where, &light, &known) || !known)
            continue;
        light.position = node->world.t;
        light.direction = vec3_unit(vec3_scale(node->world.z, -1));
        if (light.kind == LIGHT_SPOT && vec3_length(light.direction) == 0)
            return gltf_error(c, where, "its node is scaled to nothing");
        snprintf(light.name, sizeof light.name, "%.63s", node->name);
        gltf->light[gltf->light_count++] = light;
    }
    return !error_is_set(c->err);
}

/* --- cameras ---------------------------------------------------------------------------------- */

static bool camera_read(const GltfContext *c, const Json *json, const char *where, Camera *camera,
                        bool *known)
{
    const Json *lens = gltf_object(c, json, where, "perspective");
    const double yfov = gltf_number(c, lens, where, "yfov", 0);
    const double aspect = gltf_number(c, lens, where, "aspectRatio", 0);

    *known = false;
    if (error_is_set(c->err))
        return false;
    if (lens == NULL) {
        monitor_warn(c->monitor, "camera-ignored", where, "only perspective cameras can be used");
        return true;
    }
    if (!(yfov > 0 && yfov < M_PI) || !(aspect >= 0))
        return gltf_error(c, where, "its angle of view or aspect is out of range");
    camera->vertical_fov = yfov * degrees_per_radian;
    camera->aspect = aspect;
    *known = true;
    return true;
}

bool gltf_read_cameras(const GltfContext *c, const Json *root, Gltf *gltf)
{
    const Json *list = gltf_list(c, root, "", "cameras");

    gltf->camera = array_create(gltf->node_count, sizeof *gltf->camera, "cameras", c->err);
    for (size_t i = 0; i < gltf->node_count && !error_is_set(c->err); i++) {
        const GltfNode *node = &gltf->node[i];
        Camera camera = { .up = vec3_unit(node->world.y) };
        bool known = false;
        char where[48];
        if (!node->present || node->camera == SIZE_MAX)
            continue;
        snprintf(where, sizeof where, "cameras[%zu]", node->camera);
        if (!camera_read(c, gltf_item(list, node->camera), where, &camera, &known) || !known)
            continue;
        const Vec3 forward = vec3_unit(vec3_scale(node->world.z, -1));
        if (vec3_length(vec3_cross(forward, camera.up)) == 0)
            return gltf_error(c, where, "its node is scaled to nothing");
        camera.eye = node->world.t;
        camera.target = vec3_add(camera.eye, forward);
        snprintf(camera.name, sizeof camera.name, "%.63s", node->name);
        gltf->camera[gltf->camera_count++] = camera;
    }
    return !error_is_set(c->err);
}
