/* SPDX-License-Identifier: BSD-3-Clause */
/* One box, 1 x 2 x 3, in the formats that assimp reads: geometry, names, colours, axes, views and
 * lamps.
 *
 * Expected values are worked out from the files in tests/data/formats by hand. */
#include "tests/import_tools.h"

#include "mesh/polygons.h"
#include "scenes/import_quirks.h"

/* Positions and angles pass through assimp as floats: 6e-8 of a number up to 40, some steps. */
static const double float_noise = 1e-5;

/* Vertical angle, degrees, of a view 90 degrees wide at 2 : 1: 2 atan(1 / 2). */
static const double half_as_high = 53.130102354155978703;

static Scene *sample(Bench *bench, const char *name)
{
    static const char folder[] = "tests/data/formats/";
    const Monitor monitor = { .user = bench, .warn = bench_warn };
    const SceneReadOptions options = { .monitor = &monitor, .import_seconds = 30 };
    char path[300];
    Error err = { 0 };

    snprintf(path, sizeof path, "%s%s", folder, name);
    bench->warnings = 0;
    Scene *scene = scene_read(path, &options, &err);
    if (scene == NULL)
        fail_msg("%s", err.text);
    assert_true(scene_check(scene));
    return scene;
}

/* Area in all and volume inside (positive when faces look out), of planar polygons. */
static void box_check(const Scene *scene, Vec3 lo, Vec3 hi, const char *name)
{
    const Polygons *soup = &scene->polygons;
    const Vec3 size = vec3_sub(hi, lo);
    double area = 0, volume = 0;
    Vec3 low, high;

    assert_true(polygons_bounds(soup, &low, &high));
    assert_vec3(low, lo.x, lo.y, lo.z, float_noise, name);
    assert_vec3(high, hi.x, hi.y, hi.z, float_noise, name);
    for (size_t i = 0; i < soup->polygon_count; i++) {
        const Vec3 normal = bench_normal(scene, i);
        area += vec3_length(normal) / 2;
        volume += vec3_dot(normal, vec3_sub(bench_corner(scene, i, 0), lo)) / 6;
    }
    assert_close(area, 2 * (size.x * size.y + size.y * size.z + size.z * size.x), float_noise,
                 name);
    assert_close(volume, size.x * size.y * size.z, float_noise, name);
}

static const Material *material_named(const Scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->polygons.material_count; i++)
        if (strcmp(scene->polygons.materials[i].name, name) == 0)
            return &scene->polygons.materials[i];
    fail_msg("no material \"%s\"", name);
    return NULL;
}

static const Camera *camera_named(const Scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->camera_count; i++)
        if (strcmp(scene->cameras[i].name, name) == 0)
            return &scene->cameras[i];
    fail_msg("no camera \"%s\"", name);
    return NULL;
}

static const Light *light_named(const Scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->light_count; i++)
        if (strcmp(scene->lights[i].name, name) == 0)
            return &scene->lights[i];
    fail_msg("no light \"%s\"", name);
    return NULL;
}

static void view_check(const Camera *camera, Vec3 eye, Vec3 ahead, Vec3 up, double fov)
{
    const Vec3 look = vec3_unit(vec3_sub(camera->target, camera->eye));

    assert_vec3(camera->eye, eye.x, eye.y, eye.z, float_noise, "eye");
    assert_vec3(look, ahead.x, ahead.y, ahead.z, float_noise, "look");
    assert_vec3(vec3_unit(camera->up), up.x, up.y, up.z, float_noise, "up");
    assert_close(camera->vertical_fov, fov, float_noise, "field of view");
}

static double cos_degrees(double angle)
{
    return cos(angle * (acos(-1) / 180));
}

static void lamp_check(const Light *light, Vec3 place, Rgb intensity)
{
    assert_vec3(light->position, place.x, place.y, place.z, float_noise, "place of a lamp");
    assert_rgb(light->intensity, intensity.r, intensity.g, intensity.b, float_noise, "intensity");
}

/* Half angles in degrees. */
static void spot_check(const Light *light, Vec3 direction, double inner, double outer)
{
    assert_int_equal(light->kind, LIGHT_SPOT);
    assert_vec3(light->direction, direction.x, direction.y, direction.z, float_noise, "spot");
    assert_close(light->cos_inner, cos_degrees(inner), float_noise, "inner cone");
    assert_close(light->cos_outer, cos_degrees(outer), float_noise, "outer cone");
}

/* --- formats without materials ---------------------------------------------------------------- */

static void plain_formats_hold_the_box(void **state)
{
    static const struct { const char *name; size_t faces, groups; double up_y; } files[] = {
        { "box_ascii.ply", 6, 1, 1 },  { "box_little.ply", 6, 1, 1 }, { "box_big.ply", 6, 1, 1 },
        { "box_ascii.stl", 12, 2, 0 }, { "box_binary.stl", 12, 1, 0 }, { "box.off", 6, 1, 1 } };

    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        Scene *scene = sample(*state, files[i].name);
        box_check(scene, vec3(0, 0, 0), vec3(1, 2, 3), files[i].name);
        assert_int_equal(scene->polygons.polygon_count, files[i].faces);
        assert_int_equal(scene->polygons.group_count, files[i].groups);
        assert_int_equal(scene->polygons.material_count, 1);
        assert_rgb(scene->polygons.materials[0].reflectance, 0.5, 0.5, 0.5, 0, files[i].name);
        assert_vec3(scene->up, 0, files[i].up_y, 1 - files[i].up_y, 0, files[i].name);
        assert_int_equal(scene->camera_count + scene->light_count, 0);
        scene_destroy(scene);
    }
}

static void solids_of_stl_are_groups(void **state)
{
    Scene *scene = sample(*state, "box_ascii.stl");
    assert_string_equal(bench_group(scene, 0), "walls");
    assert_string_equal(bench_group(scene, 9), "walls");
    assert_string_equal(bench_group(scene, 10), "lid");
    scene_destroy(scene);
}

/* --- COLLADA: z up, centimetres; what comes is y up, metres ----------------------------------- */

static void collada_is_turned_and_measured(void **state)
{
    Scene *scene = sample(*state, "box.dae");
    /* The box turned by 90 degrees about z, moved by (10, 20, 30), then (x, y, z) to (x, z, -y). */
    box_check(scene, vec3(0.08, 0.30, -0.21), vec3(0.10, 0.33, -0.20), "box.dae");
    assert_int_equal(scene->polygons.polygon_count, 6);
    assert_int_equal(scene->polygons.group_count, 1);
    assert_string_equal(scene->polygons.group_name[0], "box-node");
    assert_vec3(scene->up, 0, 1, 0, 0, "up");
    const Material *wall = material_named(scene, "wall"), *lid = material_named(scene, "lid");
    assert_rgb(wall->reflectance, 0.5, 0.25, 0.75, float_noise, "wall");
    assert_rgb(wall->specular, 0, 0, 0, 0, "a Lambert surface has no highlight");
    assert_rgb(wall->transmittance, 0, 0, 0, 0, "wall");
    assert_rgb(lid->reflectance, 0.1, 0.1, 0.1, float_noise, "lid");
    assert_rgb(lid->emission, 3, 2, 1, float_noise, "lid");
    assert_rgb(lid->specular, 0.2, 0.3, 0.4, float_noise, "lid");
    assert_close(lid->exponent, 25, float_noise, "lid");
    assert_string_equal(bench_material(scene, 5)->name, "lid");
    scene_destroy(scene);
}

static void collada_has_views_and_lamps(void **state)
{
    Scene *scene = sample(*state, "box.dae");
    assert_int_equal(scene->camera_count, 2);
    const Camera *wide = camera_named(scene, "second-node");
    view_check(camera_named(scene, "camera-node"), vec3(0.005, 0.015, 0.04), vec3(0, 0, -1),
               vec3(0, 1, 0), 40);
    view_check(wide, vec3(0, 0.05, 0), vec3(0, -1, 0), vec3(0, 0, -1), half_as_high);
    assert_close(wide->aspect, 2, 0, "aspect");
    assert_int_equal(scene->light_count, 3);
    lamp_check(light_named(scene, "lamp-node"), vec3(0.01, 0.03, -0.02), rgb(8, 4, 2));
    assert_int_equal(light_named(scene, "lamp-node")->kind, LIGHT_POINT);
    /* Divided by 0.01 d^2 with d in centimetres: 1 / (0.01 * 100^2) at a metre. */
    lamp_check(light_named(scene, "far-node"), vec3(0.04, 0.06, -0.05), rgb(0.01, 0.02, 0.03));
    spot_check(light_named(scene, "spot-node"), vec3(0, -1, 0), 30, 30);
    scene_destroy(scene);
}

static void collada_angles_are_mended(void **state)
{
    (void)state;
    static const struct { const char *given, *mended; } texts[] = {
        { "<perspective><yfov>40</yfov></perspective>",
          "<perspective><xfov>40</xfov></perspective>" },
        { "<perspective><xfov>1</xfov><yfov sid=\"a\">2</yfov></perspective>",
          "<perspective><none>1</none><xfov sid=\"a\">2</xfov></perspective>" },
        { "<perspective><yfov>2</yfov><aspect_ratio>1</aspect_ratio></perspective>", NULL },
        { "<perspective><xfov>2</xfov></perspective>", NULL },
        { "<perspective><yfov>2</yfov>", NULL },
        { "<perspective", NULL },
        { "<p>yfov</p><perspective>yfov <yfov>1</yfov></perspective><yfov>",
          "<p>yfov</p><perspective>yfov <xfov>1</xfov></perspective><yfov>" } };
    char text[200];

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        snprintf(text, sizeof text, "%s", texts[i].given);
        collada_mend(text, strlen(text));
        assert_string_equal(text, texts[i].mended != NULL ? texts[i].mended : texts[i].given);
    }
    assert_false(collada_has_cones("<falloff_angle>3</falloff_angle>", 32));
    assert_true(collada_has_cones("<outer_cone>3</outer_cone>", 26));
}

/* --- FBX: says its up axis, keeps its unit ---------------------------------------------------- */

static void fbx_keeps_its_unit_and_says_its_up(void **state)
{
    Bench *bench = *state;
    Scene *scene = sample(bench, "box.fbx");
    box_check(scene, vec3(8, 20, 30), vec3(10, 21, 33), "box.fbx");
    assert_int_equal(scene->polygons.polygon_count, 6);
    assert_int_equal(scene->polygons.group_count, 1);
    assert_string_equal(scene->polygons.group_name[0], "box");
    assert_vec3(scene->up, 0, 0, 1, 0, "up");
    assert_int_equal(bench->warnings, 3); /* the unit of length, that of each lamp */
    const Material *wall = material_named(scene, "wall"), *lid = material_named(scene, "lid");
    assert_rgb(wall->reflectance, 0.25, 0.125, 0.375, float_noise, "colour times factor");
    assert_rgb(wall->specular, 0, 0, 0, 0, "wall");
    assert_rgb(lid->emission, 6, 4, 2, float_noise, "emission times factor");
    assert_rgb(lid->specular, 0.1, 0.15, 0.2, float_noise, "specular times factor");
    assert_close(lid->exponent, 25, float_noise, "lid");
    assert_string_equal(bench_material(scene, 5)->name, "lid");
    scene_destroy(scene);
}

static void fbx_has_views_and_lamps(void **state)
{
    Scene *scene = sample(*state, "box.fbx");
    assert_int_equal(scene->camera_count, 1);
    const Camera *front = camera_named(scene, "front");
    view_check(front, vec3(0.5, -4, 1.5), vec3(0, 1, 0), vec3(0, 0, 1), half_as_high);
    assert_close(front->aspect, 2, 0, "aspect");
    assert_int_equal(scene->light_count, 2);
    /* 800 %; no made-up fall with the distance. */
    lamp_check(light_named(scene, "lamp"), vec3(1, 2, 3), rgb(8, 4, 2));
    lamp_check(light_named(scene, "spot"), vec3(4, 5, 6), rgb(1, 1, 1));
    spot_check(light_named(scene, "spot"), vec3(0, 0, -1), 15, 30);
    scene_destroy(scene);
}

/* --- 3DS: z up; what comes is y up ----------------------------------------------------------- */

static void discreet_is_turned(void **state)
{
    Scene *scene = sample(*state, "box.3ds");
    box_check(scene, vec3(0, 0, -2), vec3(1, 3, 0), "box.3ds");
    assert_int_equal(scene->polygons.polygon_count, 12);
    assert_int_equal(scene->polygons.group_count, 1);
    assert_string_equal(scene->polygons.group_name[0], "box");
    assert_vec3(scene->up, 0, 1, 0, 0, "up");
    assert_rgb(material_named(scene, "wall")->reflectance, 0.5, 0.25, 0.75, float_noise, "wall");
    assert_rgb(material_named(scene, "lid")->reflectance, 0.125, 0.5, 0.5, float_noise, "lid");
    assert_string_equal(bench_material(scene, 9)->name, "wall");
    assert_string_equal(bench_material(scene, 11)->name, "lid");
    assert_int_equal(scene->camera_count, 1);
    /* A lens of 40: 2400 / 40 degrees. */
    view_check(camera_named(scene, "camera"), vec3(0.5, 1.5, 4), vec3(0, 0, -1), vec3(0, 1, 0), 60);
    assert_int_equal(scene->light_count, 2);
    lamp_check(light_named(scene, "lamp"), vec3(0.5, 2, -1), rgb(8, 4, 2));
    lamp_check(light_named(scene, "spot"), vec3(0.5, 2.5, -1), rgb(1, 1, 1));
    spot_check(light_named(scene, "spot"), vec3(0, -1, 0), 15, 25);
    scene_destroy(scene);
}

static void discreet_rolls_about_the_view(void **state)
{
    (void)state;
    const double half = sqrt(0.5);
    const Vec3 x = vec3(1, 0, 0), y = vec3(0, 1, 0), z = vec3(0, 0, 1);
    /* Looking along x, y turned by 45 degrees towards z: z turned by 45 degrees towards -y. */
    const Vec3 rolled = discreet_up(x, vec3(0, half, half));

    assert_vec3(discreet_up(x, y), 0, 0, 1, float_noise, "no roll");
    assert_vec3(rolled, 0, -half, half, float_noise, "roll");
    assert_vec3(discreet_up(y, y), 0, 0, 1, 0, "along y");
    assert_vec3(discreet_up(z, y), 0, 1, 0, 0, "straight up");
    assert_vec3(discreet_up(x, vec3(0, 0, 0)), 0, 0, 1, 0, "no up");
}

static void discreet_names_are_found_in_any_bytes(void **state)
{
    Bench *bench = *state;
    uint8_t bytes[4096];
    FILE *file = fopen("tests/data/formats/box.3ds", "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    /* Cut anywhere, or with a byte changed: never past the end (the sanitizers look). */
    for (size_t i = 0; i <= size; i++) {
        Error err = { 0 };
        const char **name;
        size_t count;
        uint8_t *copy = malloc(size + 1);
        memcpy(copy, bytes, size);
        if (i < size)
            copy[i] = (uint8_t)~copy[i];
        assert_true(discreet_names(copy, size, &name, &count, &err));
        if (i == size) {
            assert_int_equal(count, 1);
            assert_string_equal(name[0], "box");
        }
        array_free(name);
        free(copy);
        copy = malloc(i + 1);
        memcpy(copy, bytes, i);
        assert_true(discreet_names(copy, i, &name, &count, &err));
        array_free(name);
        free(copy);
    }
    bench->warnings = 0;
}

static void cut_files_are_told(void **state)
{
    Bench *bench = *state;
    static const char off[] = "OFF # a square\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    static const char stl[] = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                              "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nEndSolid a\n \n";

    bench_text(bench, "whole.off", off);
    scene_destroy(bench_scene(bench, "whole.off"));
    bench_bytes(bench, "cut.off", off, (size_t)(strstr(off, "4 0 1") - off));
    bench_refused(bench, "cut.off", "cut.off: ");
    bench_text(bench, "more.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    scene_destroy(bench_scene(bench, "more.off"));
    assert_non_null(strstr(bench->text, "1 of the 3 faces"));
    bench_text(bench, "whole.stl", stl);
    scene_destroy(bench_scene(bench, "whole.stl"));
    assert_int_equal(bench->warnings, 0);
    bench_bytes(bench, "cut.stl", stl, (size_t)(strstr(stl, "EndSolid") - stl));
    scene_destroy(bench_scene(bench, "cut.stl"));
    assert_string_equal(bench->code, "file-cut");
    assert_int_equal(off_faces("OFF 8 6 12"), 6);
    assert_int_equal(off_faces("#x\nCOFF\n8\n#7\n6"), 6);
    assert_int_equal(off_faces("OFF BINARY"), 0);
    assert_int_equal(off_faces("OFF 8 -1"), 0);
    assert_int_equal(off_faces("#"), 0);
    assert_int_equal(off_faces(""), 0);
    assert_false(stl_is_cut("solid\0binary", 12));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(plain_formats_hold_the_box, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(solids_of_stl_are_groups, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(collada_is_turned_and_measured, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(collada_has_views_and_lamps, bench_open, bench_close),
        cmocka_unit_test(collada_angles_are_mended),
        cmocka_unit_test_setup_teardown(fbx_keeps_its_unit_and_says_its_up, bench_open,
                                        bench_close),
        cmocka_unit_test_setup_teardown(fbx_has_views_and_lamps, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(discreet_is_turned, bench_open, bench_close),
        cmocka_unit_test(discreet_rolls_about_the_view),
        cmocka_unit_test_setup_teardown(cut_files_are_told, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(discreet_names_are_found_in_any_bytes, bench_open,
                                        bench_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
