/* SPDX-License-Identifier: BSD-3-Clause */
/* MSD files that name other files, and the project's own scenes. */
#include "tests/msd_tools.h"

#include "base/array.h"

#define DATA "tests/data/msd/"
#define OURS "scenes/files/"

static Scene *file_read_warned(const char *path, Warnings *warnings, Error *err)
{
    const Monitor          monitor = { .user = warnings, .warn = warnings_take };
    const SceneReadOptions options = { .monitor = &monitor };
    return scene_read(path, &options, err);
}

/* Of a file that must be good and cause `expected` warnings. */
static Scene *good_file(const char *path, int expected)
{
    Warnings warnings = { 0 };
    Error    err = { 0 };
    Scene   *scene = file_read_warned(path, &warnings, &err);
    if (scene == NULL)
        fail_msg("%s", err.text);
    if (warnings.count != expected)
        fail_msg("%s: %d warnings, the last one: %s", path, warnings.count, warnings.text);
    assert_true(scene_check(scene));
    return scene;
}

/* parts/ball.msd makes a ball at 0 in its own green and one at 1 in surface 3. */
static void include_sees_outside_and_hides_inside(void **state)
{
    (void)state;
    Scene          *scene = good_file(DATA "include.msd", 6); /* SCREEN and light, three times */
    const Polygons *p = &scene->polygons;
    static const double x[] = { 0, 1, 10, 11, 20, 21, 30 };
    static const Rgb    rho[] = { { 0, 0.5, 0 }, { 0.2, 0.2, 0.2 }, { 0.25, 0.25, 0.25 },
                                  { 0.25, 0.25, 0.25 }, { 0, 0.5, 0 }, { 0.2, 0.2, 0.2 },
                                  { 0.5, 0.5, 0.5 } };
    static const char *const group[] = { "ball", "ball", "other", "other", "ball", "ball",
                                         "sphere-1" };
    assert_int_equal(p->shape_count, 7);
    for (size_t i = 0; i < 7; i++) {
        const Rgb found = p->materials[p->shape[i].material].reflectance;
        assert_near(p->shape[i].shape.to_world.t.x, x[i], 0, "x");
        assert_near(p->shape[i].shape.to_world.x.x, i == 6 ? 1 : 2 - (int)(i % 2), 1e-15, "radius");
        assert_near(found.r, rho[i].r, 1e-15, "red");
        assert_near(found.g, rho[i].g, 1e-15, "green");
        assert_string_equal(p->group_name[p->shape[i].group], group[i]);
    }
    assert_false(scene->has_screen);
    assert_int_equal(scene->light_count, 1);
    scene_destroy(scene);
    assert_int_equal(array_live(), 0);
}

typedef struct {
    const char *path, *message;
} Wrong;

static void wrong_files_are_told(void **state)
{
    (void)state;
    static const Wrong wrong[] = {
        { DATA "missing.msd", DATA "missing.msd:1:1: " DATA "nowhere.msd: cannot be read: " },
        { DATA "cycle.msd", DATA "cycle2.msd:2:3: file parts/../cycle.msd includes itself" },
        { DATA "nested_wrong.msd", DATA "parts/wrong.msd:3:9: found surface 77, which is not" },
        { DATA "brep_missing.msd", DATA "brep_missing.msd:1:53: " DATA "none.obj: " },
        { DATA "no_such_file.msd", DATA "no_such_file.msd: cannot be read: " },
        { "tests/data/msd", "" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        Warnings warnings = { 0 };
        Error    err = { 0 };
        assert_null(file_read_warned(wrong[i].path, &warnings, &err));
        assert_int_equal(err.code, ERROR_INPUT);
        if (strncmp(err.text, wrong[i].message, strlen(wrong[i].message)) != 0)
            fail_msg("told: %s\nexpected: %s", err.text, wrong[i].message);
        assert_int_equal(array_live(), 0);
    }
}

/* Sum of p . n / 3 over the polygons first..end-1: the volume when they close and look outward. */
static double volume_of(const Polygons *p, size_t begin, size_t end)
{
    double volume = 0;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *c = p->corner + p->first[i];
        for (uint32_t k = 1; k + 1 < p->first[i + 1] - p->first[i]; k++)
            volume += vec3_dot(p->position[c[0]],
                               vec3_cross(p->position[c[k]], p->position[c[k + 1]])) / 6;
    }
    return volume;
}

static void brepobj_brings_polygons(void **state)
{
    (void)state;
    Scene          *scene = good_file(DATA "brep.msd", 0);
    const Polygons *p = &scene->polygons;
    Vec3            lo, hi;

    assert_int_equal(p->polygon_count, 8);
    assert_int_equal(p->material_count, 1);
    assert_string_equal(p->group_name[p->group[0]], "wedge");
    assert_string_equal(p->group_name[p->group[4]], "mirrored");
    assert_near(volume_of(p, 0, 4), 1.0 / 6, 1e-15, "moved");
    assert_near(volume_of(p, 4, 8), 1.0 / 6, 1e-15, "mirrored, still outward");
    assert_true(polygons_bounds(p, &lo, &hi));
    assert_point(lo, 0, 0, -1, 0, "least");
    assert_point(hi, 1, 1, 3, 0, "greatest");
    scene_destroy(scene);
}

/* The same files give the same hash, others another. */
static void the_hash_is_of_all_files(void **state)
{
    (void)state;
    Scene *a = good_file(DATA "include.msd", 6), *b = good_file(DATA "include.msd", 6);
    Scene *c = good_file(DATA "brep.msd", 0);
    assert_true(a->hash == b->hash);
    assert_true(a->hash != c->hash);
    scene_destroy(a);
    scene_destroy(b);
    scene_destroy(c);
}

/* --- our own scenes -------------------------------------------------------------------------- */

static double total_area(const Polygons *p, const char *group)
{
    double area = 0;
    for (size_t i = 0; i < p->polygon_count; i++) {
        if (group != NULL && strcmp(p->group_name[p->group[i]], group) != 0)
            continue;
        const uint32_t *c = p->corner + p->first[i];
        for (uint32_t k = 1; k + 1 < p->first[i + 1] - p->first[i]; k++) {
            const Vec3 a = p->position[c[0]];
            area += vec3_length(vec3_cross(vec3_sub(p->position[c[k]], a),
                                           vec3_sub(p->position[c[k + 1]], a))) / 2;
        }
    }
    return area;
}

/* Measures of the published data: the lamp 1.3 x 1.05 m, shining down; the green wall 5.592 x
 * 5.488 m; lamp and ceiling fill 5.56 x 5.592 m. */
static void cornell_is_the_published_box(void **state)
{
    (void)state;
    Scene          *scene = good_file(OURS "cornell.msd", 0);
    const Polygons *p = &scene->polygons;

    assert_int_equal(p->polygon_count, 19);
    assert_near(total_area(p, "lamp"), 1.3 * 1.05, 1e-12, "lamp");
    assert_near(total_area(p, "green-wall"), 5.592 * 5.488, 1e-12, "green wall");
    assert_near(total_area(p, "lamp") + total_area(p, "ceiling"), 5.56 * 5.592, 1e-12, "ceiling");
    const Vec3 a = corner_of(scene, 0, 0);
    const Vec3 n = vec3_cross(vec3_sub(corner_of(scene, 0, 1), a),
                              vec3_sub(corner_of(scene, 0, 2), a));
    assert_true(n.y < 0);
    assert_near(p->materials[p->material[0]].emission.r, 17, 0, "emission");
    assert_near(scene->cameras[0].vertical_fov, 39.3077, 1e-12, "field of view");
    assert_int_equal(scene->width, 512);
    scene_destroy(scene);
}

/* Inward faces enclose minus the volume. */
static void furnace_is_a_closed_cube(void **state)
{
    (void)state;
    Scene          *scene = good_file(OURS "furnace.msd", 0);
    const Polygons *p = &scene->polygons;
    assert_near(total_area(p, NULL), 6, 1e-15, "area");
    assert_near(volume_of(p, 0, 6), -1, 1e-15, "volume");
    assert_near(p->materials[0].emission.g * 3.14159265358979324, 1, 1e-15, "E = pi L");
    assert_near(p->materials[0].reflectance.g, 0.5, 0, "rho");
    scene_destroy(scene);
}

static void our_other_scenes_are_good(void **state)
{
    (void)state;
    Scene *two = good_file(OURS "two-lights.msd", 0), *shapes = good_file(OURS "shapes.msd", 0);
    /* 4 x 4 x 3 m seen from inside, with a cube of 0.7 m. */
    assert_near(volume_of(&two->polygons, 0, two->polygons.polygon_count), -48 + 0.343, 1e-12,
                "volume");
    assert_int_equal(two->light_count, 2);
    assert_true(scene_has_light(two) && scene_has_light(shapes));
    assert_int_equal(shapes->camera_count, 2);
    bool seen[4] = { false };
    for (size_t i = 0; i < shapes->polygons.shape_count; i++)
        seen[shapes->polygons.shape[i].shape.kind] = true;
    assert_true(seen[SHAPE_SPHERE] && seen[SHAPE_DISC] && seen[SHAPE_FRUSTUM] && seen[SHAPE_TORUS]);
    scene_destroy(two);
    scene_destroy(shapes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(include_sees_outside_and_hides_inside),
        cmocka_unit_test(wrong_files_are_told),
        cmocka_unit_test(brepobj_brings_polygons),
        cmocka_unit_test(the_hash_is_of_all_files),
        cmocka_unit_test(cornell_is_the_published_box),
        cmocka_unit_test(furnace_is_a_closed_cube),
        cmocka_unit_test(our_other_scenes_are_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
