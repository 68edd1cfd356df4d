/* SPDX-License-Identifier: BSD-3-Clause */
/* A scene as a whole: made, filled, checked, freed; which reader a file gets. */
#include "scenes/scene.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "scenes/internal.h"

Scene *scene_create(const char *file, Error *err)
{
    assert(file != NULL && err != NULL);
    Scene *scene = array_create(1, sizeof *scene, "scene", err);

    if (scene == NULL)
        return NULL;
    scene->up = vec3(0, 0, 1);
    scene->file = array_string(file, err);
    return scene->file != NULL ? scene : scene_destroy(scene);
}

Scene *scene_destroy(Scene *scene)
{
    if (scene == NULL)
        return NULL;
    polygons_clear(&scene->polygons);
    for (size_t i = 0; i < scene->prototype_count; i++)
        polygons_clear(&scene->prototypes[i]);
    array_free(scene->prototypes);
    array_free(scene->placements);
    textures_clear(&scene->textures);
    array_free(scene->file);
    array_free(scene->lights);
    array_free(scene->cameras);
    return array_free(scene);
}

/* The lists are short; they carry no capacity of their own and double at powers of two. */
static bool list_room(void **list, size_t count, size_t size, const char *what, Error *err)
{
    size_t capacity = count; /* full exactly at 0 and at powers of two */

    if (count > 0 && (count & (count - 1)) != 0)
        return !error_is_set(err);
    if (*list == NULL)
        capacity = 0;
    return array_reserve(list, &capacity, count > 0 ? 2 * count : 1, size, what, err);
}

bool scene_add_light(Scene *scene, const Light *light, Error *err)
{
    assert(scene != NULL && light != NULL && err != NULL);
    if (!list_room((void **)&scene->lights, scene->light_count, sizeof *light, "lights", err))
        return false;
    scene->lights[scene->light_count++] = *light;
    return true;
}

bool scene_add_camera(Scene *scene, const Camera *camera, Error *err)
{
    assert(scene != NULL && camera != NULL && err != NULL);
    if (!list_room((void **)&scene->cameras, scene->camera_count, sizeof *camera, "cameras", err))
        return false;
    scene->cameras[scene->camera_count++] = *camera;
    return true;
}

bool scene_add_prototype(Scene *scene, Polygons *polygons, uint32_t *index, Error *err)
{
    assert(scene != NULL && polygons != NULL && index != NULL && err != NULL);
    if (!list_room((void **)&scene->prototypes, scene->prototype_count, sizeof *polygons,
                   "prototypes", err)) {
        polygons_clear(polygons);
        return false;
    }
    *index = (uint32_t)scene->prototype_count;
    scene->prototypes[scene->prototype_count++] = *polygons;
    *polygons = (Polygons){ 0 };
    return true;
}

bool scene_add_placement(Scene *scene, const Placement *placement, Error *err)
{
    assert(scene != NULL && placement != NULL && err != NULL);
    assert(placement->prototype < scene->prototype_count);
    if (scene->placement_count >= UINT32_MAX - 1)
        return error_set(err, ERROR_INPUT, "more than %u placed objects", UINT32_MAX - 1);
    if (!list_room((void **)&scene->placements, scene->placement_count, sizeof *placement,
                   "placed objects", err))
        return false;
    scene->placements[scene->placement_count++] = *placement;
    return true;
}

static uint64_t soup_triangles(const Polygons *soup)
{
    return soup->polygon_count == 0
               ? 0 : (uint64_t)soup->first[soup->polygon_count] - 2 * soup->polygon_count;
}

uint64_t scene_triangles(const Scene *scene)
{
    assert(scene != NULL);
    uint64_t count = soup_triangles(&scene->polygons);
    for (size_t i = 0; i < scene->placement_count; i++)
        count += soup_triangles(&scene->prototypes[scene->placements[i].prototype]);
    return count;
}

/* --- values that cannot be ------------------------------------------------------------------- */

/* Brings a band into [0, top]; a value that is no number becomes 0. True when it had to. */
static bool band_limit(double *band, double top)
{
    const double before = *band;

    *band = !(before > 0) ? 0 : before > top ? top : before;
    return *band != before;
}

static bool colour_limit(Rgb *colour, double top)
{
    const bool r = band_limit(&colour->r, top), g = band_limit(&colour->g, top);
    return band_limit(&colour->b, top) || r || g;
}

void scene_limit_material(Material *material, const char *file, const SceneReadOptions *options)
{
    assert(material != NULL && file != NULL);
    const Monitor *monitor = options != NULL ? options->monitor : NULL;
    const char    *name = material->name != NULL ? material->name : "";
    const Rgb      rho = material->reflectance;

    if (!(rgb_max(rho) <= TOLERANCE_REFLECTANCE_MAX) || !(rho.r >= 0 && rho.g >= 0 && rho.b >= 0))
        if (colour_limit(&material->reflectance, TOLERANCE_REFLECTANCE_MAX))
            monitor_warn(monitor, "reflectance-limited", file,
                         "reflectance %g %g %g of material \"%s\" is limited to 0..%g", rho.r,
                         rho.g, rho.b, name, TOLERANCE_REFLECTANCE_MAX);
    const Rgb le = material->emission;
    if (colour_limit(&material->emission, HUGE_VAL) || !isfinite(rgb_max(le))) {
        if (!isfinite(rgb_max(material->emission)))
            material->emission = rgb(0, 0, 0);
        monitor_warn(monitor, "emission-limited", file,
                     "emission %g %g %g of material \"%s\" is not a finite amount of light; "
                     "what is wrong with it counts as 0", le.r, le.g, le.b, name);
    }
    const bool specular = colour_limit(&material->specular, 1);
    if (colour_limit(&material->transmittance, 1) || specular)
        monitor_warn(monitor, "specular-limited", file,
                     "specular reflectance or transmittance of material \"%s\" is limited to 0..1",
                     name);
    colour_limit(&material->scattered, 1);
    if (!(material->exponent >= 0))
        material->exponent = 0;
    material->roughness = material->roughness >= 0 ? fmin(material->roughness, 1) : 0;
}

/* --- checks ---------------------------------------------------------------------------------- */

static bool camera_good(const Camera *c)
{
    return memchr(c->name, 0, sizeof c->name) != NULL && vec3_finite(c->eye) &&
           vec3_finite(c->target) && vec3_finite(c->up) && c->vertical_fov > 0 &&
           c->vertical_fov < 180 && c->aspect >= 0 && isfinite(c->aspect);
}

static bool light_good(const Light *l)
{
    const Rgb i = l->intensity;
    return memchr(l->name, 0, sizeof l->name) != NULL && vec3_finite(l->position) &&
           i.r >= 0 && i.g >= 0 && i.b >= 0 && isfinite(i.r + i.g + i.b) &&
           (l->kind == LIGHT_POINT || vec3_finite(l->direction)) &&
           (l->kind != LIGHT_SPOT || l->cos_outer <= l->cos_inner);
}

bool scene_check(const Scene *scene)
{
    assert(scene != NULL);
    for (size_t i = 0; i < scene->camera_count; i++)
        if (!camera_good(&scene->cameras[i]))
            return false;
    for (size_t i = 0; i < scene->light_count; i++)
        if (!light_good(&scene->lights[i]))
            return false;
    for (size_t i = 0; i < scene->polygons.material_count; i++)
        if (scene->polygons.materials[i].texture > scene->textures.count)
            return false;
    for (size_t i = 0; i < scene->prototype_count; i++)
        if (!polygons_check(&scene->prototypes[i]))
            return false;
    for (size_t i = 0; i < scene->placement_count; i++)
        if (scene->placements[i].prototype >= scene->prototype_count ||
            scene->placements[i].material >= scene->polygons.material_count)
            return false;
    return scene->file != NULL && scene->width >= 0 && scene->height >= 0 &&
           vec3_finite(scene->up) && vec3_length(scene->up) > 0 &&
           polygons_check(&scene->polygons);
}

bool scene_has_light(const Scene *scene)
{
    assert(scene != NULL);
    const Polygons *soup = &scene->polygons;

    for (size_t i = 0; i < soup->polygon_count; i++)
        if (rgb_max(soup->materials[soup->material[i]].emission) > 0)
            return true;
    for (size_t i = 0; i < soup->shape_count; i++)
        if (rgb_max(soup->materials[soup->shape[i].material].emission) > 0)
            return true;
    for (size_t i = 0; i < scene->placement_count; i++)
        if (rgb_max(soup->materials[scene->placements[i].material].emission) > 0)
            return true;
    for (size_t i = 0; i < scene->light_count; i++)
        if (rgb_max(scene->lights[i].intensity) > 0)
            return true;
    return false;
}

/* --- reading --------------------------------------------------------------------------------- */

Scene *scene_read(const char *path, const SceneReadOptions *options, Error *err)
{
    assert(path != NULL && err != NULL);
    static const SceneReadOptions usual = { 0 };
    if (error_is_set(err))
        return NULL;
    const char *dot = strrchr(path, '.');
    const bool  msd = dot != NULL && strcasecmp(dot, ".msd") == 0;
    if (options == NULL)
        options = &usual;
    Scene *scene = msd ? scene_read_msd(path, options, err) : scene_read_import(path, options, err);
    if (scene != NULL && !scene_recentre(scene, options->monitor, err))
        scene = scene_destroy(scene);
    assert(scene == NULL || scene_check(scene));
    return scene;
}
