/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of defects, and what connecting puts on it: kind, faces, place, measure. */
#include "tests/soup_tools.h"

static void test_list(void **state)
{
    (void)state;
    Defects list = { .keep = 2 };
    Error err = { 0 };
    assert_true(defects_add(NULL, &(Defect){ .kind = DEFECT_WINDING }, &err));
    for (uint32_t i = 0; i < 5; i++) {
        const Defect winding = { .kind = DEFECT_WINDING, .repaired = i % 2 == 0, .face = i };
        assert_true(defects_add(&list, &winding, &err));
    }
    assert_true(defects_add(&list, &(Defect){ .kind = DEFECT_OVERLAP, .face = 9 }, &err));
    assert_int_equal(list.count, 3);
    assert_int_equal(list.found[DEFECT_WINDING], 5);
    assert_int_equal(list.repaired[DEFECT_WINDING], 3);
    assert_int_equal(list.found[DEFECT_OVERLAP], 1);
    assert_int_equal(list.repaired[DEFECT_OVERLAP], 0);
    assert_int_equal(list.item[1].face, 1);
    assert_int_equal(list.item[2].face, 9);
    defects_clear(&list);
    assert_null(list.item);
    array_fail_after(0);
    assert_false(defects_add(&list, &(Defect){ .kind = DEFECT_OVERLAP }, &err));
    array_fail_after(-1);
    assert_int_equal(err.code, ERROR_MEMORY);
    defects_clear(&list);
}

/* Each kind has a name of its own. */
static void test_names(void **state)
{
    (void)state;
    for (int i = 0; i < DEFECT_KINDS; i++) {
        assert_true(strlen(defect_name((DefectKind)i)) > 0);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(defect_name((DefectKind)i), defect_name((DefectKind)j));
    }
}

/* One face that has a defect beside one that has none. */
static void test_kinds(void **state)
{
    (void)state;
    const Vec3 flat[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
    static const struct {
        Vec3       p[4];
        size_t     n;
        DefectKind kind;
        bool       repaired;
        double     measure;
        uint32_t   count;     /* surfaces, the good one with them */
    } cases[] = {
        { { { 5, 0, 0 }, { 6, 0, 0 }, { 7, 0, 0 } }, 3, DEFECT_DEGENERATE, true, 0, 1 },
        { { { 5, 0, 0 }, { 5, 0, 0 }, { 7, 0, 0 } }, 3, DEFECT_DEGENERATE, true, 0, 1 },
        { { { 5, 0, 0 }, { 6, 1, 0 }, { 7, 2, 0 }, { 8, 3, 0 } }, 4, DEFECT_DEGENERATE, true, 0,
          1 },
        { { { 5, 0, 0 }, { NAN, 0, 0 }, { 7, 1, 0 } }, 3, DEFECT_NONFINITE, false, 0, 1 },
        { { { 5, 0, 0 }, { 6, INFINITY, 0 }, { 7, 1, 0 }, { 5, 1, 0 } }, 4, DEFECT_NONFINITE,
          false, 0, 1 },
        /* Two corners up, two down: the plane lies between them. */
        { { { 5, 0, -0.05 }, { 6, 0, 0.05 }, { 6, 1, -0.05 }, { 5, 1, 0.05 } }, 4,
          DEFECT_NONPLANAR, true, 0.05, 2 },
        { { { 5, 0, 0 }, { 6, 1, 0 }, { 6, 0, 0 }, { 5, 1, 0 } }, 4, DEFECT_CROSSING, false, 0,
          UINT32_MAX },
        { { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4, DEFECT_DUPLICATE, true, 0,
          1 },
        { { { 1, 1, 0 }, { 1, 0, 0 }, { 0, 0, 0 }, { 0, 1, 0 } }, 4, DEFECT_BACK_TO_BACK, true, 0,
          1 },
        { { { 1, 0, 0 }, { 0, 0, 0 }, { 0.5, 1, 1 } }, 3, DEFECT_KINDS, false, 0, 2 },
        { { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1, 1 } }, 3, DEFECT_WINDING, true, 0, 2 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Polygons soup;
        Defects defects = { 0 };
        Error err = { 0 };
        soup_start(&soup);
        soup_polygon(&soup, flat, 4, 0, 0);
        soup_polygon(&soup, cases[i].p, cases[i].n, 0, 0);
        Surfaces *s = surfaces_repair(&soup, NULL, &defects, NULL, &err);
        assert_non_null(s);
        assert_true(surfaces_check(s));
        for (int kind = 0; kind < DEFECT_KINDS; kind++)
            assert_int_equal(defects.found[kind], kind == (int)cases[i].kind);
        if (cases[i].kind < DEFECT_KINDS) {
            const Defect *d = &defects.item[0];
            assert_int_equal(d->kind, cases[i].kind);
            assert_int_equal(d->repaired, cases[i].repaired);
            assert_int_equal(d->face, 1);
            assert_true(vec3_finite(d->at));
            assert_true(fabs(d->measure - cases[i].measure) < 1e-12);
        } else {
            assert_int_equal(defects.count, 0);
        }
        if (cases[i].count != UINT32_MAX)
            assert_int_equal(s->count, cases[i].count);
        surfaces_destroy(s);
        defects_clear(&defects);
        polygons_clear(&soup);
    }
}

/* Corners off the plane by float rounding are none of it. */
static void test_rounded_is_planar(void **state)
{
    (void)state;
    Polygons soup;
    Defects defects = { 0 };
    Error err = { 0 };
    soup_start(&soup);
    for (int i = 0; i < 100; i++) {
        const double a = 0.1 * i;
        Vec3 p[6];
        for (int k = 0; k < 6; k++) {
            const double u = cos(M_PI * k / 3), v = sin(M_PI * k / 3);
            const Vec3 q = { 3 * i + u * cos(a) - v * sin(a) * 0.6,
                             u * sin(a) + v * cos(a) * 0.6, 0.8 * v + 7 };
            p[k] = vec3((float)q.x, (float)q.y, (float)q.z);
        }
        soup_polygon(&soup, p, 6, 0, 0);
    }
    Surfaces *s = surfaces_repair(&soup, NULL, &defects, NULL, &err);
    assert_non_null(s);
    assert_int_equal(defects.found[DEFECT_NONPLANAR], 0);
    surfaces_destroy(s);
    defects_clear(&defects);
    polygons_clear(&soup);
}

/* An hourglass does not swallow the square with the same corners that comes after it. */
static void test_same_corners_other_order(void **state)
{
    (void)state;
    Polygons soup;
    Defects defects = { 0 };
    Error err = { 0 };
    soup_start(&soup);
    const Vec3 a = { 0, 0, 0 }, b = { 1, 0, 0 }, c = { 1, 1, 0 }, d = { 0, 1, 0 };
    soup_polygon(&soup, (Vec3[]){ a, c, b, d }, 4, 0, 0);
    soup_polygon(&soup, (Vec3[]){ a, b, c, d }, 4, 0, 0);
    Surfaces *s = surfaces_repair(&soup, NULL, &defects, NULL, &err);
    assert_non_null(s);
    assert_int_equal(defects.found[DEFECT_CROSSING], 1);
    double area = 0;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        const uint32_t *k = s->corner + 3 * i;
        const Vec3 p = s->position[k[0]];
        if (s->triangle_face[i] == 1 || s->triangle_back[i] == 1)
            area += vec3_length(vec3_cross(vec3_sub(s->position[k[1]], p),
                                           vec3_sub(s->position[k[2]], p))) / 2;
    }
    for (size_t i = 0; i < defects.count; i++)
        area += defects.item[i].kind == DEFECT_DUPLICATE ? 0.5 : 0;
    assert_true(area >= 1 - 1e-12);
    surfaces_destroy(s);
    defects_clear(&defects);
    polygons_clear(&soup);
}

/* Welding as told: bit for bit, by the derived distance, by a given one. */
static void test_weld_options(void **state)
{
    (void)state;
    static const struct {
        double   gap;
        bool     apart;
        double   weld;
        uint32_t welded;
    } cases[] = {
        { 0, true, 0, 2 },      { 0x1p-40, true, 0, 0 }, { 0x1p-40, false, 0, 2 },
        { 0.001, false, 0, 0 }, { 0.001, false, 0.002, 2 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double x = 1 + cases[i].gap;
        Polygons soup;
        Error err = { 0 };
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { -0.0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } }, 4,
                     0, 0);
        soup_polygon(&soup, (Vec3[]){ { x, -0.0, 0 }, { 2, 0, 0 }, { 2, 1, 0 }, { x, 1, 0 } }, 4,
                     0, 0);
        const SurfaceOptions options = { .keep_apart = cases[i].apart, .weld = cases[i].weld };
        Surfaces *s = surfaces_repair(&soup, &options, NULL, NULL, &err);
        assert_non_null(s);
        assert_int_equal(s->repairs.welded, cases[i].welded);
        assert_int_equal(s->part_count, cases[i].welded ? 1 : 2);
        surfaces_destroy(s);
        polygons_clear(&soup);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_list),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_rounded_is_planar),
        cmocka_unit_test(test_same_corners_other_order),
        cmocka_unit_test(test_weld_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
