/* SPDX-License-Identifier: BSD-3-Clause */
/* Turned knobs as JSON. */
#include "app/live_changes.h"

#include <assert.h>
#include <string.h>
#include <unistd.h>

#include "app/json.h"
#include "app/output.h"
#include "base/file.h"

static bool free_path(const char *scene_path, char *path, size_t size, Error *err)
{
    for (int n = 1; n < 10000; n++) {
        char ending[32] = "-changes.json";
        if (n > 1)
            snprintf(ending, sizeof ending, "-changes-%d.json", n);
        if (!output_name(output_base(scene_path), ending, path, size, err))
            return false;
        if (access(path, F_OK) != 0)
            return true;
    }
    return error_set(err, ERROR_FAILED, "there is no free name like ...-changes.json");
}

static uint32_t group_of_name(const Polygons *soup, const char *name)
{
    uint32_t g = 0;
    while (g < soup->group_count && strcmp(soup->group_name[g], name) != 0)
        g++;
    return g;
}

static uint32_t material_of_name(const Polygons *soup, const char *name)
{
    uint32_t m = 0;
    while (m < soup->material_count && strcmp(soup->materials[m].name, name) != 0)
        m++;
    return m;
}

/* Whether a group's faces and a material's are the same. */
static bool same_faces(const Polygons *soup, uint32_t group, uint32_t material)
{
    bool same = true;
    for (size_t i = 0; same && i < soup->polygon_count; i++)
        same = (soup->group[i] == group) == (soup->material[i] == material);
    for (size_t i = 0; same && i < soup->shape_count; i++)
        same = (soup->shape[i].group == group) == (soup->shape[i].material == material);
    return same;
}

/* Whether the knob's name means in a file what the knob means: else why not. */
static const char *misnamed(const Scene *scene, const Knob *knob)
{
    const Polygons *soup = &scene->polygons;
    if (knob->kind == KNOB_GROUP)
        return NULL;
    if (knob->name[0] == '\0')
        return "has no name";
    const uint32_t g = group_of_name(soup, knob->name), m = material_of_name(soup, knob->name);
    const bool light = knob->kind == KNOB_LIGHT;
    if (g < soup->group_count && (light || !same_faces(soup, g, knob->index)))
        return "is a group's name too";
    if (m < soup->material_count && (light || m != knob->index))
        return "is a material's name too";
    return NULL;
}

static bool can_save(const Scene *scene, const Knob *knob, Error *err)
{
    if (knob->kind == KNOB_LIGHTS) {
        for (size_t i = 0; i < scene->light_count; i++) {
            Knob one = { .kind = KNOB_LIGHT, .index = (uint32_t)i, .name = scene->lights[i].name };
            const char *why = misnamed(scene, &one);
            if (why != NULL)
                return error_set(err, ERROR_FAILED, "not saved: the light '%s' %s", one.name, why);
        }
        return true;
    }
    const char *why = misnamed(scene, knob);
    return why == NULL ||
           error_set(err, ERROR_FAILED, "not saved: '%.80s' %s", knob->name, why);
}

static double share(double value, double base) { return base > 0 ? value / base : 1; }

static void put_value(Json *json, const Knob *knob, Rgb value)
{
    char text[120];
    const bool factor = knob_is_factor(knob, value);
    const Rgb v = factor ? rgb(share(value.r, knob->base.r), share(value.g, knob->base.g),
                               share(value.b, knob->base.b))
                         : value;
    snprintf(text, sizeof text, "%s%.9g,%.9g,%.9g", factor ? "*" : "", v.r, v.g, v.b);
    json_text(json, knob_shines(knob) ? "emission" : "reflectance", text);
}

/* All that was turned under the name of knob k, unless an earlier one had it. */
static void put_name(Json *json, const Knob *knob, uint32_t count, const KnobSetting *setting,
                     uint32_t k)
{
    for (uint32_t i = 0; i < k; i++)
        if (setting->turned[i] && strcmp(knob[i].name, knob[k].name) == 0)
            return;
    json_open(json, knob[k].name, '{');
    for (uint32_t i = k; i < count; i++)
        if (setting->turned[i] && strcmp(knob[i].name, knob[k].name) == 0)
            put_value(json, &knob[i], setting->value[i]);
    json_close(json, '}');
}

static void put_lights(Json *json, const Scene *scene, const Knob *knob, Rgb value)
{
    for (size_t i = 0; i < scene->light_count; i++) {
        bool first = true;
        for (size_t k = 0; first && k < i; k++)
            first = strcmp(scene->lights[k].name, scene->lights[i].name) != 0;
        if (!first)
            continue;
        json_open(json, scene->lights[i].name, '{');
        put_value(json, knob, value);
        json_close(json, '}');
    }
}

/* Paint first: a group that is changed takes copies of its materials as they are then. */
static void put_all(Json *json, const Scene *scene, const Knob *knob, uint32_t count,
                    const KnobSetting *setting)
{
    json_open(json, NULL, '{');
    for (uint32_t k = count; k-- > 0;) {
        if (!setting->turned[k])
            continue;
        if (knob[k].kind == KNOB_LIGHTS)
            put_lights(json, scene, &knob[k], setting->value[k]);
        else
            put_name(json, knob, count, setting, k);
    }
    json_close(json, '}');
}

bool live_changes_save(const Scene *scene, const char *scene_path, const Knob *knob,
                       uint32_t count, const KnobSetting *setting, char *path, size_t size,
                       Error *err)
{
    uint32_t turned = 0;
    assert(scene != NULL && knob != NULL && count <= KNOBS_MOST);
    for (uint32_t k = 0; k < count; k++) {
        turned += setting->turned[k];
        if (setting->turned[k] && !can_save(scene, &knob[k], err))
            return false;
    }
    if (turned == 0)
        return error_set(err, ERROR_FAILED, "nothing was changed");
    if (!free_path(scene_path, path, size, err))
        return false;
    OutFile *file = outfile_open(path, err);
    if (file == NULL)
        return false;
    Json json = { .out = outfile_stream(file) };
    put_all(&json, scene, knob, count, setting);
    if (json.failed) {
        outfile_discard(file);
        return error_set(err, ERROR_FAILED, "%s: cannot be written", path);
    }
    return outfile_commit(file, err);
}
