/* SPDX-License-Identifier: BSD-3-Clause */
/* OBJ and MTL: line ends, encodings, indices, groups, materials, and what is refused. */
#include "tests/import_tools.h"

#include <locale.h>
#include <sys/stat.h>

#include "scenes/import.h"

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/* Replaces each \n of text by `end`. */
static size_t with_ends(const char *text, const char *end, char *out)
{
    size_t used = 0;
    for (; *text != 0; text++)
        if (*text == '\n')
            used += (size_t)sprintf(out + used, "%s", end);
        else
            out[used++] = *text;
    return used;
}

static size_t as_utf16(const char *text, int big, char *out)
{
    size_t used = 0;
    out[used++] = big ? '\xFE' : '\xFF';
    out[used++] = big ? '\xFF' : '\xFE';
    for (; *text != 0; text++) {
        out[used++] = big ? 0 : *text;
        out[used++] = big ? *text : 0;
    }
    return used;
}

static void square_check(Bench *bench, const char *name)
{
    Scene *scene = bench_scene(bench, name);
    assert_int_equal(scene->polygons.polygon_count, 1);
    assert_int_equal(scene->polygons.vertex_count, 4);
    assert_vec3(bench_normal(scene, 0), 0, 0, 2, 0, name);
    assert_vec3(scene->up, 0, 1, 0, 0, "up");
    assert_int_equal(bench->warnings, 0);
    scene_destroy(scene);
}

static void lines_end_as_they_like(void **state)
{
    Bench *bench = *state;
    char bytes[400];
    static const char *const ends[] = { "\n", "\r\n", "\r", "\n\n", "  \t\n", " # note\n" };

    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        bench_bytes(bench, "ends.obj", bytes, with_ends(square, ends[i], bytes));
        square_check(bench, "ends.obj");
    }
    bench_bytes(bench, "big.obj", bytes, as_utf16(square, 1, bytes));
    square_check(bench, "big.obj");
    bench_bytes(bench, "little.obj", bytes, as_utf16(square, 0, bytes));
    square_check(bench, "little.obj");
    bench_text(bench, "mark.obj", "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4");
    square_check(bench, "mark.obj");
    bench_text(bench, "joined.obj", "v 0 0 0\nv 1 0 \\\n0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\r\n 3 4");
    square_check(bench, "joined.obj");
}

static void indices_count_from_both_ends(void **state)
{
    Bench *bench = *state;
    static const char *const faces[] = {
        "f -4 -3 -2 -1", "f 1/1 2/2 3/3 4/4", "f 1//1 2//1 3//1 4//1",
                                         "f 1/1/1 -3/1/1 3 4", "f  +1 2 3 4 # all" };
    char text[200];

    for (size_t i = 0; i < sizeof faces / sizeof *faces; i++) {
        snprintf(text, sizeof text, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n%s\n",
                 faces[i]);
        bench_text(bench, "indices.obj", text);
        square_check(bench, "indices.obj");
    }
    /* A face before its vertices. */
    bench_text(bench, "before.obj", "f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n");
    square_check(bench, "before.obj");
}

/* By number from both ends, of any length; what is missing or no number is none. */
static void normals_belong_to_corners(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "normals.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 5\nvn 3 0 4\nvn 1 nan 0\n"
               "f 1//1 2//2 3/1/-3 4\nvn 0 3 4\nf 1//3 2//5 3//-1 4//0\nf 1 2 3\nvn 1 0\n");
    Scene *scene = bench_scene(bench, "normals.obj");
    static const Vec3 expected[2][4] = {
        { { 0, 0, 1 }, { 0.6, 0, 0.8 }, { 0, 0, 1 }, { 0, 0, 0 } },
        { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0.6, 0.8 }, { 0, 0, 0 } } };
    for (size_t i = 0; i < 2; i++)
        for (size_t k = 0; k < 4; k++)
            assert_vec3(bench_shading(scene, i, k), expected[i][k].x, expected[i][k].y,
                        expected[i][k].z, 1e-6, "normal");
    assert_vec3(bench_shading(scene, 2, 0), 0, 0, 0, 0, "none");
    scene_destroy(scene);
}

/* An L of six corners stays one polygon; its area by Newell is 3. */
static void polygons_stay_whole(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "ell.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                 "f 1 2 3 4 5 6\n");
    Scene *scene = bench_scene(bench, "ell.obj");
    assert_int_equal(scene->polygons.polygon_count, 1);
    assert_int_equal(bench_corners(scene, 0), 6);
    assert_vec3(bench_normal(scene, 0), 0, 0, 6, 0, "twice the area");
    assert_vec3(bench_corner(scene, 0, 3), 1, 1, 0, 0, "the inner corner");
    scene_destroy(scene);
}

static void positions_keep_double_precision(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "digits.obj", "v .1 -.7e+02 559.2\nv .8e-001 1e2 1.E1\nv 0 0 0\nf 1 2 3\n");
    Scene *scene = bench_scene(bench, "digits.obj");
    assert_vec3(bench_corner(scene, 0, 0), 0.1, -70, 559.2, 0, "first");
    assert_vec3(bench_corner(scene, 0, 1), 0.08, 100, 10, 0, "second");
    scene_destroy(scene);
}

/* A program that uses commas reads the same numbers. */
static void numbers_know_no_locale(void **state)
{
    if (setlocale(LC_NUMERIC, "de_DE.UTF-8") == NULL && setlocale(LC_NUMERIC, "de_DE") == NULL)
        skip();
    positions_keep_double_precision(state);
    setlocale(LC_NUMERIC, "C");
}

static void groups_are_the_last_o_or_g(void **state)
{
    Bench *bench = *state;
    static const char *const expected[] = { "default", "box", "left side", "box", "default" };

    bench_text(bench, "groups.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no box\nf 1 2 3\n"
               "g left side \nf 1 2 3\ng box\nf 1 2 3\ng\nf 1 2 3\no nothing\n");
    Scene *scene = bench_scene(bench, "groups.obj");
    assert_int_equal(scene->polygons.polygon_count, 5);
    assert_int_equal(scene->polygons.group_count, 3);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(bench_group(scene, i), expected[i]);
    scene_destroy(scene);
    bench_text(bench, "bytes.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\xFF\x01z\xC3\xA9\nf 1 2 3\n");
    scene = bench_scene(bench, "bytes.obj");
    assert_string_equal(bench_group(scene, 0), "a??z\xC3\xA9");
    scene_destroy(scene);
}

/* --- materials ------------------------------------------------------------------------------- */

static const char library[] =
    "# comment\nnewmtl lamp\n\tKd 0.78 0.5 0.25\n  Ke 17 12 4 # bright\nillum 2\nd 1.0\nTr 0.0\n"
    "newmtl mirror\nKd 0.01 0.01 0.01\nKs .95 .9 .85\nNs 1000\nillum 5\n"
    "newmtl glossy\nKd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\nNs 30\nillum 2\n"
    "newmtl dull\nKd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\nNs 30\nillum 1\n"
    "newmtl water\nKd 0.01 0.01 0.01\nKs 0.3 0.3 0.3\nTf 0.1 0.2 0.3\nNs 200\nNi 1.33\nillum 7\n"
    "newmtl pane\nKd 0.8 0.4 0.2\nd 0.25\nNi 1.5\n"
    "newmtl with spaces\nKd .3\nPr 0.2\naniso 0.7\nmap_Kd wood.png\n"
    "newmtl bare\nKs 0.9 0.9 0.9\nillum 3\nNs 500\n"
    "newmtl rough\nKd 0.2 0.2 0.2\nKs 0.4 0.4 0.4\nPr 0.5\n"
    "newmtl sharp\nKd 0.2 0.2 0.2\nKs 0.4 0.4 0.4\nPr 0\n"
    "newmtl chalk\nKd 0.2 0.2 0.2\nKs 0.4 0.4 0.4\nPr 1\n";

static void materials_scene(Bench *bench, char *text, size_t size)
{
    static const char *const names[] = { "lamp", "mirror", "glossy", "dull", "water", "pane",
                                         "with spaces", "bare", "rough", "sharp", "chalk" };
    size_t used = (size_t)snprintf(text, size, "mtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        used += (size_t)snprintf(text + used, size - used, "usemtl %s\nf 1 2 3\n", names[i]);
    bench_text(bench, "a b.mtl", library);
    bench_text(bench, "materials.obj", text);
}

static void materials_mean_light(void **state)
{
    Bench *bench = *state;
    char text[2000];

    materials_scene(bench, text, sizeof text);
    Scene *scene = bench_scene(bench, "materials.obj");
    assert_int_equal(scene->polygons.material_count, 11);
    assert_rgb(bench_material(scene, 0)->emission, 17, 12, 4, 0, "Ke is radiance");
    assert_rgb(bench_material(scene, 0)->reflectance, 0.78, 0.5, 0.25, 0, "Kd");
    assert_rgb(bench_material(scene, 0)->transmittance, 0, 0, 0, 0, "opaque");
    assert_rgb(bench_material(scene, 1)->specular, 0.95, 0.9, 0.85, 0, "Ks");
    assert_true(isinf(bench_material(scene, 1)->exponent));
    assert_close(bench_material(scene, 2)->exponent, 30, 0, "Ns");
    assert_rgb(bench_material(scene, 3)->specular, 0, 0, 0, 0, "illum 1 has no highlight");
    assert_rgb(bench_material(scene, 4)->transmittance, 0.1, 0.2, 0.3, 0, "Tf");
    assert_close(bench_material(scene, 4)->ior, 1.33, 0, "Ni");
    assert_rgb(bench_material(scene, 5)->transmittance, 0.75, 0.75, 0.75, 0, "1 - d");
    assert_rgb(bench_material(scene, 5)->reflectance, 0.2, 0.1, 0.05, 1e-16, "d Kd");
    assert_string_equal(bench_material(scene, 6)->name, "with spaces");
    assert_rgb(bench_material(scene, 6)->reflectance, 0.3, 0.3, 0.3, 0, "one number for three");
    assert_rgb(bench_material(scene, 7)->reflectance, 0, 0, 0, 0, "a mirror without Kd");
    assert_close(bench_material(scene, 7)->roughness, 0, 0, "no Pr");
    assert_close(bench_material(scene, 8)->roughness, 0.5, 0, "Pr");
    assert_true(isfinite(bench_material(scene, 8)->exponent));
    assert_true(isinf(bench_material(scene, 9)->exponent));
    assert_rgb(bench_material(scene, 10)->reflectance, 0.6, 0.6, 0.6, 1e-15, "as good as diffuse");
    assert_rgb(bench_material(scene, 10)->specular, 0, 0, 0, 0, "and that alone");
    assert_int_equal(bench->named[1], 1);
    assert_int_equal(bench->warnings, 1);
    scene_destroy(scene);
}

static void hash_covers_the_library(void **state)
{
    Bench *bench = *state;
    uint64_t hash[3];
    char text[2000];

    for (int i = 0; i < 3; i++) {
        materials_scene(bench, text, sizeof text);
        if (i == 2)
            bench_text(bench, "a b.mtl", strcat(strcpy(text, library), "\n"));
        Scene *scene = bench_scene(bench, "materials.obj");
        hash[i] = scene->hash;
        scene_destroy(scene);
    }
    assert_int_equal(hash[0], hash[1]);
    assert_int_not_equal(hash[0], hash[2]);
}

static void missing_materials_are_told(void **state)
{
    Bench *bench = *state;

    bench_text(bench, "here.mtl", "newmtl known\nKd 0.1 0.1 0.1\n");
    bench_text(bench, "missing.obj", "mtllib nowhere.mtl\nmtllib C:\\other\\here.mtl\nv 0 0 0\n"
               "v 1 0 0\nv 0 1 0\nusemtl unknown\nf 1 2 3\nusemtl known\nf 1 2 3\n"
               "usemtl unknown\nf 1 2 3\n");
    Scene *scene = bench_scene(bench, "missing.obj");
    assert_int_equal(bench->named[0], 2); /* the library, and "unknown" once */
    assert_non_null(strstr(bench->text, "\"unknown\""));
    assert_non_null(strstr(bench->where, "missing.obj:6"));
    assert_string_equal(bench_material(scene, 0)->name, "unknown");
    assert_rgb(bench_material(scene, 0)->reflectance, 0.5, 0.5, 0.5, 0, "grey");
    assert_rgb(bench_material(scene, 1)->reflectance, 0.1, 0.1, 0.1, 0, "by its bare name");
    assert_int_equal(scene->polygons.material[0], scene->polygons.material[2]);
    scene_destroy(scene);
}

static void what_is_missing_is_told_shortly(void **state)
{
    Bench *bench = *state;
    char text[4000] = "mtllib pipe.mtl\nmtllib folder.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";

    /* Neither is a file; the first must not be waited for. */
    assert_int_equal(mkfifo(bench_path(bench, "pipe.mtl"), 0600), 0);
    assert_int_equal(mkdir(bench_path(bench, "folder.mtl"), 0700), 0);
    for (int i = 0; i < 100; i++)
        sprintf(text + strlen(text), "usemtl m%d\nf 1 2 3\n", i);
    bench_text(bench, "many.obj", text);
    Scene *scene = bench_scene(bench, "many.obj");
    assert_int_equal(scene->polygons.material_count, 100);
    assert_string_equal(bench_material(scene, 99)->name, "m99");
    assert_int_equal(bench->named[0], 21); /* 20 one by one */
    assert_non_null(strstr(bench->text, "82 more"));
    scene_destroy(scene);
}

static void a_library_is_read_once(void **state)
{
    Bench *bench = *state;
    Error err = { 0 };
    MaterialLibrary table = { 0 };
    uint64_t hash = 0;
    char text[20000] = "";

    for (int i = 0; i < 500; i++)
        sprintf(text + strlen(text), "newmtl m%d\nKd 0.%03d 0 0\n", i, i);
    bench_text(bench, "many.mtl", text);
    assert_true(import_mtl(&table, bench_path(bench, "many.mtl"), &hash, &err));
    assert_int_equal(table.count, 500);
    for (size_t i = 0; i < 500; i++) {
        snprintf(text, sizeof text, "m%zu", i);
        assert_int_equal(library_find(&table, text), i);
        assert_close(table.material[i].reflectance.r, (double)i / 1000, 1e-15, text);
    }
    assert_true(library_find(&table, "m500") == SIZE_MAX);
    library_clear(&table);
    bench_text(bench, "twice.obj", "mtllib many.mtl\nmtllib many.mtl\nv 0 0 0\nv 1 0 0\n"
               "v 0 1 0\nusemtl m499\nf 1 2 3\n");
    Scene *scene = bench_scene(bench, "twice.obj");
    assert_close(bench_material(scene, 0)->reflectance.r, 0.499, 1e-15, "m499");
    scene_destroy(scene);
}

/* --- what is refused ------------------------------------------------------------------------- */

static void bad_lines_are_named(void **state)
{
    Bench *bench = *state;
    static const struct { const char *text, *part; } cases[] = {
        { "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "bad.obj:4: a face names vertex 4" },
        { "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "bad.obj:4: a face names vertex 0" },
        { "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n", "bad.obj:3: a face names vertex -3" },
        { "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 x\r\n", "bad.obj:4: 'x' is not a corner" },
        { "v 0 0 0\nv 1 \\\n0 0\nv 0 1\nf 1 2 3\n", "bad.obj:4: a vertex needs three numbers" },
        { "v 0 0 0\nv 3.1+e2 0 0\n", "found '3.1+e2'" },
        { "o wall\nv 0 nan 0\n", "bad.obj:2: vertex 1 of object \"wall\" is not finite" },
        { "v 0 1e999 0\n", "is not finite" },
        { "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 99999999999999999999 1 2\n", "a face names vertex" },
        { "v 0 0 0\nv 1 0 0\nl 1 2\np 1\n", "has no faces, only points or lines" },
        { "v 0 0 0\nv 1 0 0\nf 1 2\n", "has no faces" },
        { "# nothing\n", "has no faces" },
        { "", "the file is empty" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bench_text(bench, "bad.obj", cases[i].text);
        bench_refused(bench, "bad.obj", cases[i].part);
    }
    bench_text(bench, "bad.mtl", "newmtl a\nKd 0.5 x 0.5\n");
    bench_text(bench, "uses.obj", "mtllib bad.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Error err = { 0 };
    assert_null(bench_read(bench, "uses.obj", &err));
    assert_non_null(strstr(err.text, "bad.mtl:2"));
    assert_int_equal(array_live(), 0);
}

static void files_that_are_none(void **state)
{
    Bench *bench = *state;

    bench_refused(bench, "absent.obj", "no such file");
    assert_int_equal(mkdir(bench_path(bench, "folder.obj"), 0700), 0);
    bench_refused(bench, "folder.obj", "is a folder");
    assert_int_equal(mkfifo(bench_path(bench, "pipe.obj"), 0600), 0);
    bench_refused(bench, "pipe.obj", "not a regular file");
    bench_text(bench, "scene.xyz9", "hello");
    bench_refused(bench, "scene.xyz9", "no reader knows the ending \".xyz9\"");
    bench_text(bench, "plain", "hello");
    bench_refused(bench, "plain", "known are .msd .obj .gltf");
}

static void lines_and_unknown_words_are_told(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "words.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nl 2 3\n");
    scene_destroy(bench_scene(bench, "words.obj"));
    assert_string_equal(bench->code, "lines-ignored");
    bench_text(bench, "words.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncurv 0 1 1 2\n");
    scene_destroy(bench_scene(bench, "words.obj"));
    assert_string_equal(bench->code, "statement-ignored");
    assert_non_null(strstr(bench->text, "'curv'"));
    bench_text(bench, "words.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n");
    scene_destroy(bench_scene(bench, "words.obj"));
    assert_string_equal(bench->code, "faces-ignored");
}

/* --- into another scene, and without memory -------------------------------------------------- */

static void imports_into_a_soup(void **state)
{
    Bench *bench = *state;
    const SceneReadOptions options = { 0 };
    const Affine mirror = { { -2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 }, { 10, 0, 0 } };
    Scene scene = { 0 };
    uint64_t hash = 1;
    Error err = { 0 };
    const Material grey = material_default();
    uint32_t mine;

    bench_text(bench, "tile.obj", square);
    assert_true(polygons_add_material(&scene.polygons, &grey, &mine, &err));
    assert_true(scene_import_into(&scene.polygons, bench_path(bench, "tile.obj"), mine, &mirror,
                                  &options, &hash, &err));
    assert_int_equal(scene.polygons.material_count, 1);
    assert_string_equal(bench_group(&scene, 0), "tile");
    /* A mirrored face still shows its front to where the front went: +z, four times as large. */
    assert_vec3(bench_normal(&scene, 0), 0, 0, 8, 0, "front");
    assert_true(scene_import_into(&scene.polygons, bench_path(bench, "tile.obj"), UINT32_MAX,
                                  &mirror, &options, &hash, &err));
    assert_int_equal(scene.polygons.material_count, 2);
    assert_int_equal(scene.polygons.vertex_count, 8);
    assert_true(polygons_check(&scene.polygons));
    polygons_clear(&scene.polygons);
    assert_int_equal(array_live(), 0);
}

static void every_allocation_may_fail(void **state)
{
    Bench *bench = *state;
    char text[1000];
    bool done = false;

    materials_scene(bench, text, sizeof text);
    for (long n = 0; !done && n < 1000; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Scene *scene = bench_read(bench, "materials.obj", &err);
        array_fail_after(-1);
        done = scene != NULL;
        if (!done)
            assert_int_equal(err.code, ERROR_MEMORY);
        scene_destroy(scene);
        assert_int_equal(array_live(), 0);
    }
    assert_true(done);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(lines_end_as_they_like, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(indices_count_from_both_ends, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(normals_belong_to_corners, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(polygons_stay_whole, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(positions_keep_double_precision, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(numbers_know_no_locale, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(groups_are_the_last_o_or_g, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(materials_mean_light, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(hash_covers_the_library, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(missing_materials_are_told, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(what_is_missing_is_told_shortly, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(a_library_is_read_once, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(bad_lines_are_named, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(files_that_are_none, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(lines_and_unknown_words_are_told, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(imports_into_a_soup, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(every_allocation_may_fail, bench_open, bench_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
