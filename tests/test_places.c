/* SPDX-License-Identifier: BSD-3-Clause */
/* What images make of places and patches: colours where they lie, means over patches, holes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "scenes/scene.h"
#include "tests/room_maker.h"

/* A box of side 4 whose floor, z0, shows an image 4 x 1: red, green, blue, clear white. */
static void make(TestRoom *r, Textures *textures, bool cut_out)
{
    static const uint8_t bytes[16] = { 255, 0, 0,   255, 0,   255, 0,   255,
                                       0,   0, 255, 255, 255, 255, 255, 0 };
    Error    err = { 0 };
    Texture  texture;
    uint32_t index;
    double   misfit;
    FaceMap  map;
    const Vec3   corner[3] = { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 4, 0 } };
    const double uv[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
    uint8_t *copy = array_create(16, 1, "texture", &err);
    *r = (TestRoom){ 0 };
    *textures = (Textures){ 0 };
    memcpy(copy, bytes, 16);
    const uint32_t wall = room_material(r, 0.5, 0), floor = room_material(r, 0.8, 0);
    room_box(r, vec3(0, 0, 0), vec3(4, 4, 4), BOX_Z0, true, floor, "");
    room_box(r, vec3(0, 0, 0), vec3(4, 4, 4), BOX_ALL & ~BOX_Z0, true, wall, "");
    assert_true(texture_make(&texture, "four", 4, 1, copy, NULL, &err));
    assert_true(textures_add(textures, &texture, &index, &err));
    assert_true(face_map_fit(&map, corner, uv, 3, &misfit));
    assert_true(textures_set_map(textures, 0, &map, &err));
    r->soup.materials[floor].texture = index + 1;
    r->soup.materials[floor].cut_out = cut_out;
    room_finish(r, 0.5, &(SidesOptions){ 0 }, NULL, 0, NULL);
    r->room.textures = textures;
    r->room.mirrors = mirrors_exist(r->soup.materials, r->soup.material_count);
}

static uint32_t patch_at(const TestRoom *r, Vec3 p)
{
    for (uint32_t i = 0; i < r->patches->count; i++)
        if (vec3_length(vec3_sub(r->patches->centre[i], p)) < 1e-9)
            return i;
    fail();
    return 0;
}

/* Middles of texels show their colours; an image does not reach other faces. */
static void places_show_their_colours(void **state)
{
    (void)state;
    TestRoom r;
    Textures textures;
    make(&r, &textures, false);
    for (int k = 0; k < 3; k++) {
        const Ray ray = { .ox = (float)k + 0.5F, .oy = 2, .oz = 2, .dz = -1, .t_max = INFINITY };
        Hit      hit;
        RoomHit  at;
        Material scratch;
        assert_true(bvh_nearest(r.bvh, &ray, &hit));
        room_hit(&r.room, &hit, vec3(0, 0, -1), &at);
        const Rgb c = places_hit(&r.room, &at, &scratch)->reflectance;
        const double band[3] = { c.r, c.g, c.b };
        for (int b = 0; b < 3; b++)
            assert_true(fabs(band[b] - (b == k ? 0.8 : 0)) < 1e-6);
    }
    assert_true(places_reflectance(&r.room, patch_at(&r, vec3(2.25, 2.25, 4)), NULL).g == 0.5);
    room_clear(&r);
    textures_clear(&textures);
}

/* Patches of half a texel; the image is linear between texels' middles, so that the patch from 0.5
 * to 1 shows red from 1 to 1/2: its mean is 3/4. */
static void means_over_patches_are_exact(void **state)
{
    (void)state;
    TestRoom r;
    Textures textures;
    make(&r, &textures, false);
    const Rgb c = places_reflectance(&r.room, patch_at(&r, vec3(0.75, 1.25, 0)), NULL);
    assert_true(fabs(c.r - 0.8 * 0.75) < 1e-6 && fabs(c.g - 0.8 * 0.25) < 1e-6);
    assert_true(mirrors_kept(&r.room, patch_at(&r, vec3(0.75, 1.25, 0))) == 1);
    room_clear(&r);
    textures_clear(&textures);
}

/* Where the image is clear there is a hole: a ray goes on straight, the patch keeps no light. */
static void holes_let_light_through(void **state)
{
    (void)state;
    TestRoom r;
    Textures textures;
    make(&r, &textures, true);
    const Ray up = { .ox = 3.5F, .oy = 2, .oz = -1, .dz = 1, .t_max = 1.5F };
    const Ray red = { .ox = 0.5F, .oy = 2, .oz = -1, .dz = 1, .t_max = 1.5F };
    assert_true(mirrors_between(&r.room, up) == 1);
    assert_true(mirrors_between(&r.room, red) == 0);
    Ray  ray = { .ox = 3.5F, .oy = 2, .oz = 1, .dz = -1, .t_max = INFINITY };
    Hit  hit;
    bool straight = true;
    assert_true(bvh_nearest(r.bvh, &ray, &hit));
    assert_true(mirrors_step(&r.room, &hit, 0.999, &ray, &straight) && straight);
    assert_true(ray.dz == -1 && ray.oz < 0);
    /* Where something is, a cut-out plate is as dull as any other: gathering rays end there. */
    const RoomHit there = { .primitive = 0, .point = vec3(0.5, 2, 0) };
    Material scratch;
    assert_false(mirrors_is(places_hit(&r.room, &there, &scratch)));
    assert_true(rgb_max(scratch.reflectance) > 0);
    /* From 3 to 3.5 the alpha falls from 1/2 to 0: a quarter is there, all of it white and blue. */
    double opaque;
    const uint32_t patch = patch_at(&r, vec3(3.25, 1.25, 0));
    const Rgb c = places_reflectance(&r.room, patch, &opaque);
    assert_true(fabs(opaque - 0.25) < 1e-6 && fabs(mirrors_kept(&r.room, patch) - 0.25) < 1e-6);
    assert_true(fabs(c.b - 0.8) < 1e-6 && c.r < 1e-6);
    room_clear(&r);
    textures_clear(&textures);
}

/* The file's image, its upper left quarter red, lies the right way up on the wall from 0 to 4. */
static void gltf_brings_its_image(void **state)
{
    (void)state;
    static const struct { Vec3 at; double r, g, b; } places[] = {
        { { 1, 3, 0 }, 220, 30, 30 }, { { 3, 3, 0 }, 30, 200, 30 }, { { 1, 1, 0 }, 30, 30, 220 },
        { { 3, 1, 0 }, 230, 230, 230 },
    };
    Error  err = { 0 };
    Scene *scene = scene_read("tests/data/formats/image.gltf", NULL, &err);
    assert_non_null(scene);
    assert_int_equal(scene->textures.count, 1);
    const FaceMap *map = textures_map(&scene->textures, 0);
    assert_non_null(map);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const Rgb c = texture_at(&scene->textures.texture[0], face_map_u(map, places[i].at),
                                 face_map_v(map, places[i].at), NULL);
        assert_true(fabs(c.r - pow((places[i].r / 255 + 0.055) / 1.055, 2.4)) < 1e-6);
        assert_true(fabs(c.b - pow((places[i].b / 255 + 0.055) / 1.055, 2.4)) < 1e-6);
    }
    scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_show_their_colours),
        cmocka_unit_test(means_over_patches_are_exact),
        cmocka_unit_test(holes_let_light_through),
        cmocka_unit_test(gltf_brings_its_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
