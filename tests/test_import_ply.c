/* SPDX-License-Identifier: BSD-3-Clause */
/* PLY: types, byte orders, order of elements, strips, line ends, and what is refused. */
#include "tests/import_tools.h"

#define HEAD(format) "ply\nformat " format " 1.0\n"
#define XYZ          "property float x\nproperty float y\nproperty float z\n"
#define CORNERS      "property list uchar int vertex_indices\n"
#define SQUARE       "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

static void square_check(Bench *bench, const char *name, size_t warnings)
{
    Scene *scene = bench_scene(bench, name);
    assert_int_equal(scene->polygons.polygon_count, 1);
    assert_int_equal(scene->polygons.vertex_count, 4);
    assert_vec3(bench_normal(scene, 0), 0, 0, 2, 0, name);
    assert_int_equal(bench->warnings, warnings);
    scene_destroy(scene);
}

static void text_as_it_likes(void **state)
{
    Bench *bench = *state;
    static const char *const texts[] = {
        HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n" SQUARE
                      "4 0 1 2 3",
        /* faces first */
        HEAD("ascii") "element face 1\n" CORNERS "element vertex 4\n" XYZ "end_header\n"
                      "4 0 1 2 3\n" SQUARE,
        /* white space, other names of types, another name of the list */
        "ply \r\n  format\tascii   1.0\t\r\ncomment x\r\nobj_info y\r\n\telement  vertex\t4 \r\n"
        "property float64 x\r\nproperty  int32 y\r\nproperty\tuint8 z\r\nelement face 1\r\n"
        "property list uint16 uint32 vertex_index\r\nend_header \r\n"
        " 0 0 0\r\n1\t0 0\r\n\r\n1e0 1 0 \r\n0 1 0\r\n 4 0 1 2 3\r\n",
        /* values over several lines, more in a line than was said */
        HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n"
                      "0 0\n0\n1 0 0 what\n1 1 0 7 7\n0 1 0\n4\n0 1 2 3\n9 9 9\n",
        /* properties of no use before, between and after, lists among them */
        HEAD("ascii") "element camera 2\nproperty list uchar float k\nelement vertex 4\n"
                      "property char a\nproperty float z\nproperty list int int b\n"
                      "property float y\nproperty float x\nelement face 1\nproperty uchar red\n"
                      CORNERS "property list uchar float texcoord\nend_header\n"
                      "0\n3 1 2 3\n5 0 0 0 0\n5 0 1 7 0 1\n5 0 2 7 7 1 1\n5 0 0 1 0\n"
                      "255 4 0 1 2 3 2 0.5 0.5\n",
        /* LF and CR mixed up, CR alone */
        "ply\rformat ascii 1.0\relement vertex 4\rproperty float x\rproperty float y\r"
        "property float z\relement face 1\rproperty list uchar int vertex_indices\rend_header\r"
        "0 0 0\r1 0 0\r1 1 0\r0 1 0\r4 0 1 2 3\r" };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        bench_text(bench, "square.ply", texts[i]);
        square_check(bench, "square.ply", 0);
    }
}

/* A strip's triangles take those of their vertices; without nz there are none. */
static void normals_belong_to_vertices(void **state)
{
    Bench *bench = *state;
    static const char head[] = HEAD("ascii") "element vertex 4\n" XYZ "property float nx\n"
                               "property float ny\nproperty float %s\nelement tristrips 1\n"
                               CORNERS "end_header\n0 0 0 0 0 2\n1 0 0 3 0 4\n0 1 0 0 3 4\n"
                               "1 1 0 nan 0 1\n4 0 1 2 3\n";
    char text[600];
    snprintf(text, sizeof text, head, "nz");
    bench_text(bench, "normals.ply", text);
    Scene *scene = bench_scene(bench, "normals.ply");
    assert_int_equal(scene->polygons.polygon_count, 2);
    assert_vec3(bench_shading(scene, 0, 0), 0, 0, 1, 1e-6, "0");
    assert_vec3(bench_shading(scene, 0, 1), 0.6, 0, 0.8, 1e-6, "1");
    assert_vec3(bench_shading(scene, 1, 0), 0, 0.6, 0.8, 1e-6, "2, the other way round");
    assert_vec3(bench_shading(scene, 1, 2), 0, 0, 0, 0, "3");
    scene_destroy(scene);
    snprintf(text, sizeof text, head, "w");
    bench_text(bench, "normals.ply", text);
    scene = bench_scene(bench, "normals.ply");
    assert_int_equal(scene->polygons.normal_count, 0);
    scene_destroy(scene);
}

/* Appends the bytes of a value, lowest first or last. */
static size_t put(char *to, const void *value, size_t size, int big)
{
    const char *from = value; /* this machine: lowest first */
    for (size_t i = 0; i < size; i++)
        to[i] = from[big ? size - 1 - i : i];
    return size;
}

static void bytes_in_both_orders(void **state)
{
    Bench *bench = *state;
    static const double corner[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };

    for (int big = 0; big < 2; big++) {
        char bytes[600];
        size_t size = (size_t)sprintf(bytes, "%selement vertex 4\nproperty double x\n"
                                             "property float y\nproperty short z\nelement face 1\n"
                                             "property list int ushort vertex_index\nend_header\n",
                                      big ? HEAD("binary_big_endian")
                                          : HEAD("binary_little_endian"));
        for (int i = 0; i < 4; i++) {
            const float y = (float)corner[i][1];
            const int16_t z = (int16_t)corner[i][2];
            size += put(bytes + size, &corner[i][0], 8, big);
            size += put(bytes + size, &y, 4, big);
            size += put(bytes + size, &z, 2, big);
        }
        const int32_t count = 4;
        size += put(bytes + size, &count, 4, big);
        for (uint16_t i = 0; i < 4; i++)
            size += put(bytes + size, &i, 2, big);
        bench_bytes(bench, "bytes.ply", bytes, size);
        square_check(bench, "bytes.ply", 0);
        /* Cut anywhere it is refused: nothing of it comes by halves. */
        for (size_t cut = 1; cut < size; cut++) {
            bench_bytes(bench, "cut.ply", bytes, cut);
            bench_refused(bench, "cut.ply", "cut.ply");
        }
    }
}

static void strips_turn_every_other_triangle(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "strip.ply",
               HEAD("ascii") "element vertex 5\n" XYZ "element tristrips 1\n"
               "property list int int vertex_indices\nend_header\n"
               "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 3\n");
    Scene *scene = bench_scene(bench, "strip.ply");
    assert_int_equal(scene->polygons.polygon_count, 4);
    for (size_t i = 0; i < 4; i++)
        assert_vec3(bench_normal(scene, i), 0, 0, 1, 0, "all face up");
    scene_destroy(scene);
}

static void small_faces_are_left_out_and_told(void **state)
{
    Bench *bench = *state;
    bench_text(bench, "small.ply", HEAD("ascii") "element vertex 4\n" XYZ "element face 3\n" CORNERS
                                   "end_header\n" SQUARE "2 0 1\n4 0 1 2 3\n0\n");
    square_check(bench, "small.ply", 1);
    assert_string_equal(bench->code, "lines-ignored");
}

static void broken_files_say_where(void **state)
{
    Bench *bench = *state;
    static const struct { const char *text, *says; } files[] = {
        { "hello\n", "does not begin with \"ply\"" },
        { HEAD("ascii") "element vertex 3\n", "the file ends within its header" },
        { HEAD("klingon") "end_header\n", "ply:2: \"klingon\" is no format" },
        { "ply\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", "the header names no format" },
        { HEAD("ascii") "property float x\n", "ply:3: a property stands before" },
        { HEAD("ascii") "element vertex\n", "ply:3: an element needs a name and a number" },
        { HEAD("ascii") "element vertex 4294967295\n", "is not a possible number" },
        { HEAD("ascii") "element vertex -1\n", "is not a possible number" },
        { HEAD("ascii") "element vertex 3\nproperty quad x\n", "ply:4: \"quad\" is no type" },
        { HEAD("ascii") "element vertex 3\nproperty list float int x\n", "cannot count" },
        { HEAD("ascii") "element vertex 4000000000\nend_header\n", "has no properties" },
        { HEAD("ascii") "element vertex 1\nproperty float x\nend_header\n0\n", "x, y and z" },
        { HEAD("ascii") "element vertex 4000000000\n" XYZ "end_header\n0 0 0\n",
          "within element \"vertex\" 2 of 4000000000" },
        { HEAD("ascii") "element vertex 1\n" XYZ "end_header\n0 nan 0\n", "is not finite" },
        { HEAD("ascii") "element vertex 1\n" XYZ "end_header\n0 1e999 0\n", "is not finite" },
        { HEAD("ascii") "element vertex 1\n" XYZ "end_header\n0 1x 0\n", "within element" },
        { HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n" SQUARE
          "3 0 1 4\n", "names vertex 4, but there are 4" },
        { HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n" SQUARE
          "3 0 1 -1\n", "names vertex -1, but there are 4" },
        { HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n" SQUARE
          "3 0 1 0.5\n", "names vertex 0.5" },
        { HEAD("ascii") "element vertex 4\n" XYZ "element face 1\n" CORNERS "end_header\n" SQUARE
          "4000000000 0 1 2\n", "within element \"face\" 1 of 1" },
        { HEAD("ascii") "element vertex 4\n" XYZ "end_header\n" SQUARE, "has no faces" } };

    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        bench_text(bench, "broken.ply", files[i].text);
        bench_refused(bench, "broken.ply", files[i].says);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(text_as_it_likes, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(bytes_in_both_orders, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(strips_turn_every_other_triangle, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(normals_belong_to_vertices, bench_open, bench_close),
        cmocka_unit_test_setup_teardown(small_faces_are_left_out_and_told, bench_open,
                                        bench_close),
        cmocka_unit_test_setup_teardown(broken_files_say_where, bench_open, bench_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
