/* SPDX-License-Identifier: BSD-3-Clause */
/* View3D's files: both geometries, subsurfaces cut out of their base, masks, what is refused. */
#include "tests/import_tools.h"

#include <math.h>

#include "mesh/polygons.h"

#define CLOSE 1e-12

static double polygon_area_of(const Polygons *soup, size_t i, Vec3 *sum)
{
    const uint32_t *c = soup->corner + soup->first[i];
    *sum = vec3(0, 0, 0);
    for (uint32_t k = 1; k + 1 < soup->first[i + 1] - soup->first[i]; k++)
        *sum = vec3_add(*sum, vec3_cross(vec3_sub(soup->position[c[k]], soup->position[c[0]]),
                                         vec3_sub(soup->position[c[k + 1]],
                                                  soup->position[c[0]])));
    return vec3_length(*sum) / 2;
}

/* Area of a group, and the sum of its faces' normals times their areas. */
static double group_area(const Polygons *soup, const char *name, Vec3 *normal)
{
    double area = 0;
    *normal = vec3(0, 0, 0);
    for (size_t i = 0; i < soup->polygon_count; i++)
        if (strcmp(soup->group_name[soup->group[i]], name) == 0) {
            Vec3 sum;
            area += polygon_area_of(soup, i, &sum);
            *normal = vec3_mad(*normal, 0.5, sum);
        }
    return area;
}

static void rectangles_by_azimuth_and_tilt(void **state)
{
    Bench *bench = *state;
    static const struct {
        const char *place;
        Vec3 normal, centre;
    } cases[] = {
        { "3 0 0 0 90", { 0, 1, 0 }, { 2, 0, 0.5 } },
        { "0 0 0 90 90", { 1, 0, 0 }, { 0, 1, 0.5 } },
        { "0 0 0 180 90", { 0, -1, 0 }, { 1, 0, 0.5 } },
        { "0 5 0 270 90", { -1, 0, 0 }, { 0, 4, 0.5 } },
        { "0 0 0 180 0", { 0, 0, 1 }, { 1, 0.5, 0 } },
        { "3 0 3 0 180", { 0, 0, -1 }, { 2, 0.5, 3 } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[200];
        snprintf(text, sizeof text, "F 3a\nS 1 R 0 0 0.9 one\n%s 2 1\n", cases[i].place);
        bench_text(bench, "r.vs3", text);
        Scene *scene = bench_scene(bench, "r.vs3");
        Vec3 normal, centre = vec3(0, 0, 0);
        assert_float_equal(group_area(&scene->polygons, "one", &normal), 2, CLOSE);
        for (size_t k = 0; k < 4; k++)
            centre = vec3_mad(centre, 0.25, scene->polygons.position[k]);
        assert_float_equal(vec3_length(vec3_sub(vec3_scale(normal, 0.5), cases[i].normal)), 0,
                           CLOSE);
        assert_float_equal(vec3_length(vec3_sub(centre, cases[i].centre)), 0, CLOSE);
        scene_destroy(scene);
    }
}

/* A 4 x 3 wall with a window and a door that touches its rim. */
static const char wall[] =
    "C encl=1\nf 3\nV 1 0 0 0\nV 2 4 0 0\nV 3 4 0 3\nV 4 0 0 3\nV 5 1 0 1\nV 6 2 0 1\nV 7 2 0 2\n"
    "V 8 1 0 2\nV 9 3 0 0\nV 10 3.5 0 0\nV 11 3.5 0 2\nV 12 3 0 2\n"
    "S 1 1 2 3 4 0 0 0.9 wall\nS 2 5 6 7 8 1 0 0.5 window\ns 3 9 10 11 12 1 2 0.25 door\n"
    "%s 4 4 3 2 1 0 0 0.1 wall\nEnd\nnothing after it is read\n";

static void subsurfaces_are_cut_out(void **state)
{
    Bench *bench = *state;
    char text[800];
    Vec3 normal;
    snprintf(text, sizeof text, wall, "S");
    bench_text(bench, "w.vs3", text);
    Scene *scene = bench_scene(bench, "w.vs3");
    const Polygons *soup = &scene->polygons;
    assert_int_equal(soup->group_count, 3);
    assert_float_equal(group_area(soup, "wall", &normal), 10, CLOSE);
    assert_float_equal(normal.y, -10, CLOSE);
    assert_float_equal(group_area(soup, "window", &normal), 2, CLOSE); /* with the door */
    assert_float_equal(group_area(soup, "wall#4", &normal), 12, CLOSE);
    assert_float_equal(normal.y, 12, CLOSE);
    bool seen = false;
    for (size_t i = 0; i < soup->polygon_count; i++) {
        const Material *m = &soup->materials[soup->material[i]];
        seen = seen || (strcmp(m->name, "emissivity 0.25") == 0 && m->reflectance.g == 0.75);
    }
    assert_true(seen);
    scene_destroy(scene);
}

static void masks_and_nulls_cover(void **state)
{
    Bench *bench = *state;
    static const char *const kind[] = { "M", "N" };
    for (int i = 0; i < 2; i++) {
        char text[300];
        Vec3 normal;
        snprintf(text, sizeof text, "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n"
                 "V 5 .4 .4 0\nV 6 .6 .4 0\nV 7 .6 .6 0\nV 8 .4 .6 0\n"
                 "S 1 1 2 3 4 0 0 .9 base\n%s 2 8 7 6 5 1 0 .9 cover\n", kind[i]);
        bench_text(bench, "m.vs3", text);
        Scene *scene = bench_scene(bench, "m.vs3");
        assert_float_equal(group_area(&scene->polygons, "base", &normal), 0.96, CLOSE);
        assert_int_equal(scene->polygons.group_count, 1);
        assert_int_equal(bench->warnings > 0 && strcmp(bench->code, "mask") == 0, i == 0);
        bench->warnings = 0;
        bench->code[0] = 0;
        scene_destroy(scene);
    }
}

/* Obstructions as View3D reads them: corners alone. Transformations are passed over. */
static void obstructions_may_end_early(void **state)
{
    Bench *bench = *state;
    Vec3 normal;
    bench_text(bench, "o.vs3", "F 3\nX 1 2 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n"
               "S 1 1 2 3 4 0 0 .9 base\nO 2 1 2 3 0\nO 3 1 2 3 4 0 0 .5 plate\n");
    Scene *scene = bench_scene(bench, "o.vs3");
    const Polygons *soup = &scene->polygons;
    assert_int_equal(soup->group_count, 3);
    assert_float_equal(group_area(soup, "surface-2", &normal), 0.5, CLOSE);
    assert_float_equal(soup->materials[soup->material[1]].reflectance.g, 0, CLOSE);
    assert_float_equal(soup->materials[soup->material[2]].reflectance.g, 0.5, CLOSE);
    scene_destroy(scene);
    bench_text(bench, "p.vs3", "F 3a\nS 1 R 0 0 0.9 one\n0 0 0 0 0 2 1\nO 2 R\n0 0 1 0 0 2 3\n");
    scene = bench_scene(bench, "p.vs3");
    assert_float_equal(group_area(&scene->polygons, "surface-2", &normal), 6, CLOSE);
    scene_destroy(scene);
}

/* Combined surfaces share the first one's group, chains of them too; subsurfaces of different bases
 * stay with their own. */
static void combined_share_a_group(void **state)
{
    Bench *bench = *state;
    Vec3 normal;
    bench_text(bench, "c.vs3", "F 3a\nS 1 R 0 0 .9 a\n0 0 0 180 0 2 2\n"
               "S 2 R 0 1 .9 b\n3 0 0 180 0 3 3\nS 3 R 1 0 .9 c\n.5 .5 0 180 0 1 1\n"
               "S 4 R 2 3 .9 d\n3.5 .5 0 180 0 1 1\nS 5 R 0 2 .9 e\n9 0 0 180 0 1 1\n");
    Scene *scene = bench_scene(bench, "c.vs3");
    assert_int_equal(scene->polygons.group_count, 2);
    assert_float_equal(group_area(&scene->polygons, "a", &normal), 3 + 8 + 1, CLOSE);
    assert_float_equal(group_area(&scene->polygons, "c", &normal), 1 + 1, CLOSE);
    scene_destroy(scene);
}

static void what_makes_no_sense_is_refused(void **state)
{
    Bench *bench = *state;
#define V4 "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n"
    static const char *const text[] = {
        "F 2\n", "S 1 1 2 3 4 0 0 .9 a\n", V4, V4 "V 6 0 0 0\n", V4 "V 5 0 0\n",
        V4 "S 1 1 2 3 5 0 0 .9 a\n", V4 "S 1 1 2 0 4 0 0 .9 a\n", V4 "S 2 1 2 3 4 0 0 .9 a\n",
        V4 "S 1 1 2 3 4 1 0 .9 a\n", V4 "S 1 1 2 3 4 0 0 0 a\n", V4 "S 1 1 2 3 4 0 0 1.5 a\n",
        V4 "S 1 1 2 1 2 0 0 .9 a\n", V4 "N 1 1 2 3 4 0 0 .9 a\n", V4 "Q 1\n",
        V4 "V 5 2 0 0\nS 1 1 2 3 4 0 0 .9 a\nS 2 1 5 3 4 1 0 .9 b\n",
        V4 "S 1 1 2 3 4 0 0 .9 a\nM 2 1 2 3 0 1 1 .9 b\n",
        V4 "S 1 1 2 3 4 0 0 .9 a\nN 2 1 2 3 0 1 0 .9 b\nS 3 4 3 2 1 0 2 .9 c\n",
        V4 "S 1 1 2 3 4 0 0 .9 a\nO 2 1 2 3 0 1 0 .9 b\n", V4 "S 1 1 2 3 4\n",
        V4 "S 1 1 2 3 4 0 0 .9 a\nO 2 1 2 3\n", V4 "S 1 1 2 3 4 0 1 .9 a\n",
        V4 "V 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nS 1 1 2 3 4 0 0 .9 a\nS 2 5 6 7 0 1 0 .9 b\n",
        "F 3a\nS 1 X 0 0 .9 a\n0 0 0 0 0 1 1\n", "F 3a\nS 1 R 0 0 .9 a\n0 0 0 0\nS 2 R 0 0 .9 b\n",
        "F 3a\nS 1 R 0 0 .9 a\n0 0 0 0\nE\n", "F 3a\nS 1 R 0 0 .9 a\n0 0 0 0 0 1 x\n",
    };
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        bench_text(bench, "bad.vs3", text[i]);
        bench_refused(bench, "bad.vs3", "bad.vs3");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(rectangles_by_azimuth_and_tilt, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(subsurfaces_are_cut_out, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(masks_and_nulls_cover, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(obstructions_may_end_early, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(combined_share_a_group, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(what_makes_no_sense_is_refused, bench_open, bench_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
