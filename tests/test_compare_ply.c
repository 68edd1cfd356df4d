/* SPDX-License-Identifier: BSD-3-Clause */
/* Solved meshes read back, and compared where the difference is known. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "app/compare_ply.h"
#include "base/array.h"

/* --- files made by hand ----------------------------------------------------------------------- */

typedef struct {
    uint8_t *byte;
    size_t   size, capacity;
} Bytes;

static void put(Bytes *b, const void *data, size_t size)
{
    Error err = { 0 };
    assert_true(array_reserve((void **)&b->byte, &b->capacity, b->size + size, 1, "test", &err));
    memcpy(b->byte + b->size, data, size);
    b->size += size;
}
static void put_text(Bytes *b, const char *text) { put(b, text, strlen(text)); }
/* Little endian, as machines that run this test are. */
static void put_int(Bytes *b, uint32_t value) { put(b, &value, 4); }
static void put_float(Bytes *b, double value) { put(b, &(float){ (float)value }, 4); }

typedef double (*Field)(double x, double y);
static double flat(double x, double y) { return 2 + 0 * (x + y); }
static double sloped(double x, double y) { return 1 + 0.5 * x + 0.25 * y; }
static double steeper(double x, double y) { return 1.1 * sloped(x, y); }
static double shifted(double x, double y) { return sloped(x, y) + 0.5 * x; }
static double dark(double x, double y) { return 0 * (x + y); }

typedef struct {
    uint32_t    n, m;     /* cells of the unit square along x and y */
    Field       field;
    const char *group;
    double      height;   /* z */
    uint32_t    side;
} Square;

static void put_bands(Bytes *b, double value)
{
    for (int band = 0; band < 3; band++)
        put_float(b, value);
}

static void square_vertices(Bytes *b, const Square *s)
{
    for (uint32_t j = 0; j <= s->m; j++)
        for (uint32_t i = 0; i <= s->n; i++) {
            const double x = (double)i / s->n, y = (double)j / s->m;
            put_float(b, x);
            put_float(b, y);
            put_float(b, s->height);
            put(b, "abc", 3);
            put_bands(b, 0);
            put_bands(b, s->field(x, y));
        }
}

static void square_faces(Bytes *b, const Square *s, uint32_t group)
{
    const uint32_t row = s->n + 1;
    for (uint32_t j = 0; j < s->m; j++)
        for (uint32_t i = 0; i < s->n; i++) {
            const uint32_t first = j * row + i;
            put(b, "\4", 1);
            put_int(b, first);
            put_int(b, s->side == 0 ? first + 1 : first + row);
            put_int(b, first + row + 1);
            put_int(b, s->side == 0 ? first + row : first + 1);
            put_int(b, j * s->n + i);
            put_int(b, 0);
            put_int(b, s->side);
            put_int(b, group);
            put_int(b, 0);
            put_float(b, 1.0 / (s->n * s->m));
            put_float(b, 1.0 / (s->n * s->m));
            put_bands(b, 0);
            put_bands(b, s->field((i + 0.5) / s->n, (j + 0.5) / s->m));
            put_bands(b, 0.5);
        }
}

/* A solved unit square; its group is number 1. */
static void square_file(Bytes *b, const Square *s)
{
    char line[128];
    *b = (Bytes){ 0 };
    put_text(b, "ply\nformat binary_little_endian 1.0\ncomment made by isolux 0.1.0\n"
                "comment x y z: scene units\ncomment group 0 nothing\ncomment group 1 ");
    put_text(b, s->group);
    snprintf(line, sizeof line, "\ncomment material 0 m\nelement vertex %u\n",
             (s->n + 1) * (s->m + 1));
    put_text(b, line);
    put_text(b, PLY_FLOATS PLY_VERTEX_LAYOUT);
    snprintf(line, sizeof line, "element face %u\nproperty list uchar int vertex_indices\n",
             s->n * s->m);
    put_text(b, line);
    put_text(b, PLY_FACE_LAYOUT "end_header\n");
    square_vertices(b, s);
    square_faces(b, s, 1);
}

static void square_mesh(SolvedMesh *mesh, const Square *s)
{
    Bytes b;
    Error err = { 0 };
    *mesh = (SolvedMesh){ 0 };
    square_file(&b, s);
    assert_true(solved_mesh_parse(mesh, b.byte, b.size, "test.ply", &err));
    array_free(b.byte);
}

typedef struct {
    bool       good;
    Error      err;
    CompareRow all, group;
} Compared;

static Compared compare_squares(const Square *a, const Square *b, bool constant)
{
    SolvedMesh reference, mesh;
    MeshComparison out = { 0 };
    Compared c = { .good = false };
    square_mesh(&reference, a);
    square_mesh(&mesh, b);
    const CompareOptions options = { .samples = 1u << 14, .constant = constant };
    c.good = mesh_compare(&reference, &mesh, &options, &out, &c.err);
    c.all = out.all;
    if (c.good)
        c.group = out.group[1];
    mesh_comparison_clear(&out);
    solved_mesh_clear(&reference);
    solved_mesh_clear(&mesh);
    assert_int_equal(array_live(), 0);
    return c;
}

/* --- tests ------------------------------------------------------------------------------------ */

/* Files hold floats, values are near 1. */
static const double FLOAT = 1e-6;
/* A net of 2^14 points misses means of smooth functions by less. */
static const double NET = 1e-3;

static void meshes_are_read(void **state)
{
    (void)state;
    SolvedMesh m;
    square_mesh(&m, &(Square){ 3, 2, sloped, "floor of\tstone", 1, 1 });
    assert_int_equal(m.vertex_count, 12);
    assert_int_equal(m.face_count, 6);
    assert_int_equal(m.group_count, 2);
    assert_string_equal(m.group_name[1], "floor of stone"); /* one line, no tab in it */
    assert_int_equal(m.first_corner[6], 24);
    assert_int_equal(m.side[5], 1);
    assert_int_equal(m.patch[5], 5);
    assert_true(fabs(m.area[0] - 1.0 / 6) < FLOAT);
    assert_true(fabs(m.irradiance[3 * 11] - 1.75) < FLOAT);
    assert_true(fabs(m.face_irradiance[3 * 5 + 2] - sloped(2.5 / 3, 0.75)) < FLOAT);
    solved_mesh_clear(&m);
}

static void one_function_on_two_meshes(void **state)
{
    (void)state;
    const Square a = { 7, 5, sloped, "g", 0, 0 }, b = { 3, 8, sloped, "g", 0, 0 };
    const Compared c = compare_squares(&a, &b, false);
    assert_true(c.good && c.all.matched == 1 && c.group.share == 1 && c.group.matched == 1);
    assert_true(c.all.error < FLOAT && fabs(c.all.mean - 1.375) < NET);
    assert_true(fabs(c.all.other - c.all.mean) < FLOAT);
    const Compared same = compare_squares(&a, &a, true);
    assert_true(same.good && same.all.error == 0 && same.all.matched == 1);
}

static void known_differences(void **state)
{
    (void)state;
    const Square a = { 7, 5, sloped, "g", 0, 0 }, more = { 4, 4, steeper, "g", 0, 0 },
                 tilted = { 2, 9, shifted, "g", 0, 0 }, even = { 6, 6, flat, "g", 0, 0 },
                 black = { 1, 1, dark, "g", 0, 0 };
    /* A tenth more everywhere: a tenth of the root mean square, which is that of the mean times
     * sqrt(1 + variance): variances of x / 2 and y / 4 are (1/4 + 1/16) / 12. */
    Compared c = compare_squares(&a, &more, false);
    const double square = 1.375 * 1.375 + (0.25 + 0.0625) / 12;
    assert_true(fabs(c.all.error - 0.1 * sqrt(square) / 1.375) < NET);
    assert_true(fabs(c.all.other / c.all.mean - 1.1) < FLOAT);
    /* x / 2 more: the root of the mean of x^2 / 4. */
    c = compare_squares(&a, &tilted, false);
    assert_true(fabs(c.all.error - sqrt(1.0 / 12) / 1.375) < NET);
    assert_true(fabs(c.all.other - 1.625) < NET);
    c = compare_squares(&even, &black, true);
    assert_true(c.good && fabs(c.all.error - 1) < FLOAT && c.all.other == 0);
    /* Steps of 1 / n against steps of 1 / (2 n), both of slope 1/2 along x: off by 1 / (8 n). */
    const Square coarse = { 4, 1, sloped, "g", 0, 0 }, fine = { 8, 1, sloped, "g", 0, 0 };
    c = compare_squares(&fine, &coarse, true);
    assert_true(fabs(c.all.error - 0.5 / 16 / 1.375) < NET);
}

static void only_what_is_the_same_place(void **state)
{
    (void)state;
    const Square a = { 4, 4, sloped, "g", 0, 0 }, other = { 4, 4, sloped, "h", 0, 0 },
                 back = { 4, 4, sloped, "g", 0, 1 }, far = { 4, 4, sloped, "g", 1, 0 },
                 black = { 4, 4, dark, "g", 0, 0 };
    const Square *strangers[] = { &other, &back, &far };
    for (int k = 0; k < 3; k++) {
        const Compared c = compare_squares(&a, strangers[k], false);
        assert_true(!c.good && c.err.code == ERROR_INPUT);
    }
    const Compared c = compare_squares(&black, &a, false);
    assert_true(!c.good && c.err.code == ERROR_INPUT && strstr(c.err.text, "dark") != NULL);
}

static void damaged_files(void **state)
{
    (void)state;
    Bytes b;
    square_file(&b, &(Square){ 2, 2, flat, "g", 0, 0 });
    for (size_t size = 0; size < b.size; size++) { /* cut anywhere */
        uint8_t *cut = malloc(size + (size == 0));
        Error err = { 0 };
        SolvedMesh m = { 0 };
        memcpy(cut, b.byte, size);
        assert_false(solved_mesh_parse(&m, cut, size, "cut.ply", &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_null(strchr(err.text, '\n'));
        solved_mesh_clear(&m);
        free(cut);
    }
    for (size_t at = 0; at < b.size; at++) { /* any byte changed */
        Error err = { 0 };
        SolvedMesh m = { 0 };
        b.byte[at] ^= 0xff;
        if (!solved_mesh_parse(&m, b.byte, b.size, "bent.ply", &err))
            assert_int_equal(err.code, ERROR_INPUT);
        for (uint32_t k = 0; !error_is_set(&err) && k < m.first_corner[m.face_count]; k++)
            assert_true(m.corner[k] < m.vertex_count);
        solved_mesh_clear(&m);
        b.byte[at] ^= 0xff;
    }
    array_free(b.byte);
    assert_int_equal(array_live(), 0);
}

static void without_memory(void **state)
{
    (void)state;
    const Square s = { 3, 3, sloped, "g", 0, 0 };
    SolvedMesh a, b;
    square_mesh(&a, &s);
    square_mesh(&b, &s);
    const long before = array_live();
    bool good = false;
    for (long n = 0; !good; n++) {
        MeshComparison out = { 0 };
        Error err = { 0 };
        array_fail_after(n);
        good = mesh_compare(&a, &b, &(CompareOptions){ .samples = 16 }, &out, &err);
        array_fail_after(-1);
        mesh_comparison_clear(&out);
        assert_true(good || err.code == ERROR_MEMORY);
        assert_int_equal(array_live(), before);
        assert_true(n < 99);
    }
    solved_mesh_clear(&a);
    solved_mesh_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_read),   cmocka_unit_test(one_function_on_two_meshes),
        cmocka_unit_test(known_differences), cmocka_unit_test(only_what_is_the_same_place),
        cmocka_unit_test(damaged_files),     cmocka_unit_test(without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
