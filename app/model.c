/* SPDX-License-Identifier: BSD-3-Clause */
/* Scenes made by code. */
#include "app/model.h"

#include <assert.h>
#include <stdio.h>

static const double PI = 3.14159265358979323846;

static uint32_t add_material(Scene *scene, const char *name, Rgb reflectance, Rgb exitance,
                             Error *err)
{
    Material material = material_default();
    char copy[64];
    uint32_t index = 0;
    if (error_is_set(err))
        return 0;
    snprintf(copy, sizeof copy, "%s", name);
    material.name = copy;
    material.reflectance = reflectance;
    material.emission = rgb_scale(exitance, 1 / PI);
    polygons_add_material(&scene->polygons, &material, &index, err);
    return index;
}

uint32_t model_grey(Scene *scene, const char *name, double reflectance, double exitance,
                    Error *err)
{
    assert(reflectance >= 0 && reflectance < 1 && exitance >= 0);
    return add_material(scene, name, rgb(reflectance, reflectance, reflectance),
                        rgb(exitance, exitance, exitance), err);
}

void model_polygon(Scene *scene, const Vec3 *corner, int corners, uint32_t material,
                   const char *group, Error *err)
{
    uint32_t index[MODEL_CORNERS], number = 0;
    assert(corners >= 3 && corners <= MODEL_CORNERS);
    if (error_is_set(err))
        return;
    for (int i = 0; i < corners; i++)
        if (!polygons_add_vertex(&scene->polygons, corner[i], &index[i], err))
            return;
    if (polygons_add_group(&scene->polygons, group, &number, err))
        polygons_add_polygon(&scene->polygons, index, (size_t)corners, material, number, err);
}

void model_rectangle(Scene *scene, Vec3 o, Vec3 u, Vec3 v, uint32_t material, const char *group,
                     Error *err)
{
    const Vec3 corner[4] = { o, vec3_add(o, u), vec3_add(vec3_add(o, u), v), vec3_add(o, v) };
    model_polygon(scene, corner, 4, material, group, err);
}

void model_box(Scene *scene, Vec3 s, const uint32_t material[6], Error *err)
{
    const Vec3 zero = vec3(0, 0, 0), x = vec3(s.x, 0, 0), y = vec3(0, s.y, 0), z = vec3(0, 0, s.z);
    assert(s.x > 0 && s.y > 0 && s.z > 0);
    model_rectangle(scene, zero, y, z, material[0], "x0", err);
    model_rectangle(scene, x, z, y, material[1], "x1", err);
    model_rectangle(scene, zero, z, x, material[2], "y0", err);
    model_rectangle(scene, y, x, z, material[3], "y1", err);
    model_rectangle(scene, zero, x, y, material[4], "z0", err);
    model_rectangle(scene, z, y, x, material[5], "z1", err);
}

void model_shape(Scene *scene, ShapeKind kind, double ratio, Vec3 at, Vec3 scale,
                 uint32_t material, const char *group, Error *err)
{
    const Affine map = { { scale.x, 0, 0 }, { 0, scale.y, 0 }, { 0, 0, scale.z }, at };
    Shape shape;
    uint32_t number = 0;
    if (error_is_set(err) || !shape_init(&shape, kind, ratio, &map, err))
        return;
    if (polygons_add_group(&scene->polygons, group, &number, err))
        polygons_add_shape(&scene->polygons, &shape, material, number, err);
}

void model_point_light(Scene *scene, LightKind kind, Vec3 at, double intensity, Error *err)
{
    const Light light = { .kind = kind, .position = at, .direction = { 0, 0, -1 },
                          .intensity = rgb(intensity, intensity, intensity), .name = "lamp" };
    if (!error_is_set(err))
        scene_add_light(scene, &light, err);
}

/* --- Cornell box ------------------------------------------------------------------------------ */

typedef struct {
    int    material; /* 0 white, 1 red, 2 green, 3 lamp */
    double corner[4][3];
} CornellFace;

/* x to the left, y up, z away, as measured by the box's makers. */
static const CornellFace cornell_faces[] = {
    { 0, { { 552.8, 0, 0 }, { 0, 0, 0 }, { 0, 0, 559.2 }, { 549.6, 0, 559.2 } } },
    { 0, { { 556, 548.8, 0 }, { 556, 548.8, 559.2 }, { 0, 548.8, 559.2 }, { 0, 548.8, 0 } } },
    { 0, { { 549.6, 0, 559.2 }, { 0, 0, 559.2 }, { 0, 548.8, 559.2 }, { 556, 548.8, 559.2 } } },
    { 2, { { 0, 0, 559.2 }, { 0, 0, 0 }, { 0, 548.8, 0 }, { 0, 548.8, 559.2 } } },
    { 1, { { 552.8, 0, 0 }, { 549.6, 0, 559.2 }, { 556, 548.8, 559.2 }, { 556, 548.8, 0 } } },
    { 3, { { 343, 548.7, 227 }, { 343, 548.7, 332 }, { 213, 548.7, 332 }, { 213, 548.7, 227 } } },
    { 0, { { 130, 165, 65 }, { 82, 165, 225 }, { 240, 165, 272 }, { 290, 165, 114 } } },
    { 0, { { 290, 0, 114 }, { 290, 165, 114 }, { 240, 165, 272 }, { 240, 0, 272 } } },
    { 0, { { 130, 0, 65 }, { 130, 165, 65 }, { 290, 165, 114 }, { 290, 0, 114 } } },
    { 0, { { 82, 0, 225 }, { 82, 165, 225 }, { 130, 165, 65 }, { 130, 0, 65 } } },
    { 0, { { 240, 0, 272 }, { 240, 165, 272 }, { 82, 165, 225 }, { 82, 0, 225 } } },
    { 0, { { 423, 330, 247 }, { 265, 330, 296 }, { 314, 330, 456 }, { 472, 330, 406 } } },
    { 0, { { 423, 0, 247 }, { 423, 330, 247 }, { 472, 330, 406 }, { 472, 0, 406 } } },
    { 0, { { 472, 0, 406 }, { 472, 330, 406 }, { 314, 330, 456 }, { 314, 0, 456 } } },
    { 0, { { 314, 0, 456 }, { 314, 330, 456 }, { 265, 330, 296 }, { 265, 0, 296 } } },
    { 0, { { 265, 0, 296 }, { 265, 330, 296 }, { 423, 330, 247 }, { 423, 0, 247 } } },
};

Scene *model_cornell(Error *err)
{
    static const char *const groups[] = { "white", "red", "green", "lamp" };
    const Rgb white = rgb(0.73, 0.73, 0.73), red = rgb(0.61, 0.06, 0.06);
    const Rgb green = rgb(0.12, 0.43, 0.11), lamp = rgb(57, 42, 16), none = rgb(0, 0, 0);
    const Camera camera = { .name = "front", .eye = { 278, 273, -800 }, .target = { 278, 273, 0 },
                            .up = { 0, 1, 0 }, .vertical_fov = 39.3, .aspect = 1 };
    Scene *scene = scene_create("Cornell box", err);
    if (scene == NULL)
        return NULL;
    add_material(scene, "white", white, none, err);
    add_material(scene, "red", red, none, err);
    add_material(scene, "green", green, none, err);
    add_material(scene, "lamp", white, lamp, err);
    for (size_t i = 0; i < sizeof cornell_faces / sizeof *cornell_faces; i++) {
        const CornellFace *face = &cornell_faces[i];
        Vec3 corner[4];
        for (int k = 0; k < 4; k++)
            corner[k] = vec3(face->corner[k][0], face->corner[k][1], face->corner[k][2]);
        model_polygon(scene, corner, 4, (uint32_t)face->material, groups[face->material], err);
    }
    if (!error_is_set(err))
        scene_add_camera(scene, &camera, err);
    return error_is_set(err) ? scene_destroy(scene) : scene;
}
