/* SPDX-License-Identifier: BSD-3-Clause */
/* Scenes far from the origin come to it without losing a bit; others stay. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "scenes/scene.h"

/* Where a map has a building: UTM, in metres. */
static const Vec3 MAP = { 5e5, 5e6, 0 };

typedef struct {
    unsigned told;
    char     code[64];
} Told;

static void take(void *user, const char *code, const char *where, const char *text)
{
    Told *told = user;
    (void)where;
    (void)text;
    told->told++;
    strncpy(told->code, code, sizeof told->code - 1);
}

/* By way of memory: gcc 12 -O3 -fno-trapping-math drops the rounding of (double)(float)x. */
static double rounded(double x)
{
    const volatile float f = (float)x;
    return (double)f;
}

/* Faces are what counts: one over all corners, whatever it looks like. */
static void add_face(Scene *scene, Error *err)
{
    static const uint32_t corner[8] = { 0, 1, 3, 2, 6, 7, 5, 4 };
    const Material grey = material_default();
    uint32_t index;
    assert_true(polygons_add_material(&scene->polygons, &grey, &index, err));
    assert_true(polygons_add_group(&scene->polygons, "all", &index, err));
    assert_true(polygons_add_polygon(&scene->polygons, corner, 8, 0, 0, err));
}

/* Corners of a box of 4 x 3 x 2.7 with odd numbers, a ball, a lamp and a camera, all at `at`; with
 * corners as floats. */
static Scene *make_scene(Vec3 at, bool floats)
{
    Error err = { 0 };
    Scene *scene = scene_create("a scene", &err);
    const Affine map = { { 0.5, 0, 0 }, { 0, 0.5, 0 }, { 0, 0, 0.5 },
                         vec3_add(at, vec3(2, 1.5, 1)) };
    const Light light = { .kind = LIGHT_POINT, .position = vec3_add(at, vec3(1, 1, 2)) };
    const Camera camera = { .eye = vec3_add(at, vec3(1, 1, 1)), .target = vec3_add(at, map.t),
                            .up = { 0, 0, 1 }, .vertical_fov = 50 };
    Shape ball;
    uint32_t index;
    assert_true(shape_init(&ball, SHAPE_SPHERE, 1, &map, &err));
    for (int k = 0; k < 8; k++) {
        const Vec3 p = vec3_add(at, vec3(k & 1 ? 4.03 : 0.017, k & 2 ? 3.011 : 0.3,
                                         k & 4 ? 2.7 : 0));
        const Vec3 f = vec3(rounded(p.x), rounded(p.y), rounded(p.z));
        assert_true(polygons_add_vertex(&scene->polygons, floats ? f : p, &index, &err));
    }
    add_face(scene, &err);
    assert_true(polygons_add_shape(&scene->polygons, &ball, 0, 0, &err));
    assert_true(scene_add_light(scene, &light, &err) && scene_add_camera(scene, &camera, &err));
    return scene;
}

static bool same(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static void test_near_stays(void **state)
{
    (void)state;
    const Vec3 places[] = { { 0, 0, 0 }, { 100, -50, 3 }, { -250, 0, 0 } };
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        Error err = { 0 };
        Told told = { 0 };
        const Monitor monitor = { .user = &told, .warn = take };
        Scene *scene = make_scene(places[k], true);
        const Vec3 first = scene->polygons.position[0];
        assert_true(scene_recentre(scene, &monitor, &err));
        assert_true(same(scene->origin, vec3(0, 0, 0)));
        assert_true(same(scene->polygons.position[0], first));
        assert_int_equal(told.told, 0);
        scene_destroy(scene);
    }
}

static void test_far_comes(void **state)
{
    (void)state;
    Error err = { 0 };
    Told told = { 0 };
    const Monitor monitor = { .user = &told, .warn = take };
    Scene *scene = make_scene(MAP, false), *before = make_scene(MAP, false);
    assert_true(scene_recentre(scene, &monitor, &err));
    assert_int_equal(told.told, 0);
    assert_true(scene->polygons.grain == 0);
    /* z was near already; a grid of 8, the power of two above 4.013. */
    assert_true(scene->origin.z == 0);
    assert_true(fmod(scene->origin.x, 8) == 0 && fmod(scene->origin.y, 8) == 0);
    for (int k = 0; k < 8; k++) {
        const Vec3 p = scene->polygons.position[k];
        assert_true(fabs(p.x) <= 8 && fabs(p.y) <= 8);
        assert_true(same(scene_to_file(scene, p), before->polygons.position[k]));
        assert_true(same(p, scene_from_file(scene, before->polygons.position[k])));
    }
    const Shape *ball = &scene->polygons.shape[0].shape;
    const Vec3 way = vec3_sub(ball->to_world.t, scene->polygons.position[0]);
    assert_true(vec3_length(vec3_sub(way, vec3(2 - 0.017, 1.5 - 0.3, 1))) < 1e-8);
    ShapeHit hit;
    assert_true(shape_intersect(ball, vec3_sub(ball->to_world.t, vec3(2, 0, 0)), vec3(1, 0, 0), 0,
                                INFINITY, &hit));
    assert_true(fabs(hit.t - 1.5) < 1e-12);
    const Vec3 lamp = scene_to_file(scene, scene->lights[0].position);
    const Vec3 eye = scene_to_file(scene, scene->cameras[0].eye);
    assert_true(same(lamp, vec3_add(MAP, vec3(1, 1, 2))));
    assert_true(same(eye, vec3_add(MAP, vec3(1, 1, 1))));
    assert_true(scene_check(scene));
    /* Once there, it stays. */
    const Vec3 origin = scene->origin;
    assert_true(scene_recentre(scene, &monitor, &err) && same(scene->origin, origin));
    scene_destroy(scene);
    scene_destroy(before);
}

/* Floats at 5e6 go in steps of 0.5: the box has become a step or two wide. */
static void test_floats_are_coarse(void **state)
{
    (void)state;
    Error err = { 0 };
    Told told = { 0 };
    const Monitor monitor = { .user = &told, .warn = take };
    Scene *scene = make_scene(MAP, true);
    assert_true(scene_recentre(scene, &monitor, &err));
    assert_int_equal(told.told, 1);
    assert_string_equal(told.code, "coordinates-coarse");
    assert_true(scene->polygons.grain >= 0.25 && scene->polygons.grain <= 8);
    scene_destroy(scene);
}

/* Whole millimetres are floats as well, but none has been lost. */
static void test_whole_numbers_are_fine(void **state)
{
    (void)state;
    Error err = { 0 };
    Told told = { 0 };
    const Monitor monitor = { .user = &told, .warn = take };
    Scene *scene = scene_create("a scene", &err);
    uint32_t index;
    for (int k = 0; k < 8; k++)
        assert_true(polygons_add_vertex(&scene->polygons, vec3(5e6 + (k & 1 ? 4001 : 0),
                                                               k & 2 ? 3003 : 0, k & 4 ? 2700 : 0),
                                        &index, &err));
    add_face(scene, &err);
    assert_true(scene_recentre(scene, &monitor, &err));
    assert_int_equal(told.told, 0);
    assert_true(scene->origin.x != 0 && scene->origin.y == 0);
    scene_destroy(scene);
}

/* A turned box, written in nine digits: millimetres where x is 2e5, far less where z is 1. */
static void test_few_digits_are_coarse(void **state)
{
    (void)state;
    static const Vec3 corner[8] = {
        { 200002.426, 199999.424, -0.178126225 }, { 200001.258, 200002.064, 0.638450181 },
        { 200000.573, 200000.576, 0.178126225 },  { 200000.742, 199997.936, -0.638450181 },
        { 200002.427, 199999.837, 2.56646745 },   { 200001.259, 200001.325, 3.02679143 },
        { 200000.574, 199998.685, 2.21021512 },   { 200000.743, 199997.197, 1.74989104 },
    };
    for (int fine = 0; fine < 2; fine++) {
        Error err = { 0 };
        Told told = { 0 };
        const Monitor monitor = { .user = &told, .warn = take };
        Scene *scene = scene_create("a scene", &err);
        uint32_t index;
        /* On whole millimetres throughout nothing shows that any have been lost. */
        for (int k = 0; k < 8; k++) {
            Vec3 p = corner[k];
            p.z = fine ? nearbyint(p.z * 1000) / 1000 : p.z;
            assert_true(polygons_add_vertex(&scene->polygons, p, &index, &err));
        }
        add_face(scene, &err);
        assert_true(scene_recentre(scene, &monitor, &err));
        assert_int_equal(told.told, !fine);
        assert_true(fabs(scene->polygons.grain - (fine ? 0 : 0.004)) < 1e-12);
        scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_near_stays),
        cmocka_unit_test(test_far_comes),
        cmocka_unit_test(test_floats_are_coarse),
        cmocka_unit_test(test_whole_numbers_are_fine),
        cmocka_unit_test(test_few_digits_are_coarse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
