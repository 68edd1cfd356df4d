/* SPDX-License-Identifier: BSD-3-Clause */
/* Open edges and rims of meshes whose holes are known. */
#include "tests/inspect_tools.h"

/* Lengths and boxes are sums of a few rounded doubles of size 10. */
static const double EXACT = 1e-14;

static void cube_with_a_missing_face(void **state)
{
    (void)state;
    for (unsigned face = 0; face < 6; face++)
        for (unsigned cut = 0; cut < 64; cut += 63) {
            Polygons  soup;
            Inspected i;
            soup_start(&soup);
            soup_block(&soup, cube, cut, 1u << face);
            inspect_soup(&i, &soup, NULL, NULL);
            assert_int_equal(i.found.open_edges, 4);
            assert_int_equal(i.found.rims, 1);
            assert_int_equal(i.found.rim[0].edges, 4);
            assert_true(i.found.rim[0].flat);
            assert_true(near(i.found.rim[0].length, 4, EXACT));
            const Vec3 size = vec3_sub(i.found.rim[0].hi, i.found.rim[0].lo);
            assert_true(near(size.x + size.y + size.z, 2, EXACT));
            assert_true(near(inspected_defect(&i, DEFECT_OPEN_EDGE, 2)->measure, 1, EXACT));
            assert_int_equal(i.defects.found[DEFECT_INTERSECTION], 0);
            assert_int_equal(i.defects.found[DEFECT_OVERLAP], 0);
            inspected_clear(&i);
        }
}

static void closed_cube(void **state)
{
    (void)state;
    Polygons  soup;
    Inspected i;
    soup_start(&soup);
    soup_block(&soup, cube, 9, 0);
    inspect_soup(&i, &soup, NULL, NULL);
    assert_int_equal(i.found.rims, 0);
    assert_int_equal(i.defects.count, 0);
    assert_int_equal(i.found.closed_parts, 1);
    assert_true(near(i.found.part[0].volume, 1, EXACT));
    assert_true(near(i.found.part[0].area, 6, EXACT));
    inspected_clear(&i);
}

/* Cells of a 4 x 4 board, some missing: holes that touch at a corner are two rims, not one. */
static void holes_that_touch(void **state)
{
    (void)state;
    Polygons  soup;
    Inspected i;
    soup_start(&soup);
    for (int k = 0; k < 16; k++) {
        const double x = k % 4, y = k / 4;
        const bool   hole = k == 5 || k == 10;
        if (!hole)
            soup_polygon(&soup, (Vec3[]){ { x, y, 7 }, { x + 1, y, 7 }, { x + 1, y + 1, 7 },
                                          { x, y + 1, 7 } }, 4, 0, 0);
    }
    inspect_soup(&i, &soup, NULL, NULL);
    assert_int_equal(i.found.open_edges, 24);
    assert_int_equal(i.found.rims, 3);
    assert_int_equal(i.found.rim[0].edges, 16);
    assert_true(near(i.found.rim[0].length, 16, EXACT));
    for (int k = 1; k < 3; k++) {
        assert_int_equal(i.found.rim[k].edges, 4);
        assert_true(i.found.rim[k].flat);
        assert_true(near(i.found.rim[k].hi.x - i.found.rim[k].lo.x, 1, EXACT));
    }
    inspected_clear(&i);
}

/* The border of a Moebius strip is one closed curve, and lies in no plane. */
static void moebius_strip(void **state)
{
    (void)state;
    enum { N = 24 };
    Polygons  soup;
    Inspected i;
    Vec3      p[N + 1][2];
    soup_start(&soup);
    for (int k = 0; k <= N; k++)
        for (int side = 0; side < 2; side++) {
            const double a = 2 * M_PI * k / N, w = side == 0 ? -0.3 : 0.3;
            const double r = 1 + w * cos(a / 2);
            p[k][side] = vec3(r * cos(a), r * sin(a), w * sin(a / 2));
        }
    p[N][0] = p[0][1];
    p[N][1] = p[0][0];
    for (int k = 0; k < N; k++) {
        soup_polygon(&soup, (Vec3[]){ p[k][0], p[k + 1][0], p[k + 1][1] }, 3, 0, 0);
        soup_polygon(&soup, (Vec3[]){ p[k][0], p[k + 1][1], p[k][1] }, 3, 0, 0);
    }
    inspect_soup(&i, &soup, NULL, NULL);
    assert_int_equal(i.found.open_edges, 2 * N);
    assert_int_equal(i.found.rims, 1);
    assert_int_equal(i.found.rim[0].edges, 2 * N);
    assert_false(i.found.rim[0].flat);
    assert_int_equal(i.defects.found[DEFECT_INTERSECTION], 0);
    inspected_clear(&i);
}

/* A wall of one large square beside two small ones. Left open, the seam is a rim of its own, of
 * three edges and no width; stitched, only the border is left. */
static void wall_with_t_junction(void **state)
{
    (void)state;
    for (int stitched = 0; stitched < 2; stitched++) {
        Polygons  soup;
        Inspected i;
        const SurfaceOptions options = { .keep_junctions = !stitched };
        soup_start(&soup);
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 } }, 4, 0,
                     0);
        soup_polygon(&soup, (Vec3[]){ { 2, 0, 0 }, { 3, 0, 0 }, { 3, 1, 0 }, { 2, 1, 0 } }, 4, 0,
                     0);
        soup_polygon(&soup, (Vec3[]){ { 2, 1, 0 }, { 3, 1, 0 }, { 3, 2, 0 }, { 2, 2, 0 } }, 4, 0,
                     0);
        inspect_soup(&i, &soup, &options, NULL);
        assert_int_equal(i.found.open_edges, stitched ? 7 : 10);
        assert_int_equal(i.found.rims, stitched ? 1 : 2);
        assert_int_equal(i.found.rim[0].edges, 7);
        assert_true(near(i.found.rim[0].length, 10, EXACT));
        if (!stitched)
            assert_true(near(i.found.rim[1].length, 4, EXACT));
        inspected_clear(&i);
    }
}

/* Two faces back to back are a body without thickness: each edge has two faces. */
static void plate(void **state)
{
    (void)state;
    const Vec3 p[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
    const Vec3 q[] = { p[3], p[2], p[1], p[0] };
    Polygons   soup;
    Inspected  i;
    soup_start(&soup);
    soup_polygon(&soup, p, 4, 0, 0);
    soup_polygon(&soup, q, 4, 0, 0);
    inspect_soup(&i, &soup, NULL, NULL);
    assert_int_equal(i.found.open_edges, 0);
    assert_int_equal(i.found.rims, 0);
    inspected_clear(&i);
}

/* Many sheets at one point: rims are still followed, each edge once. */
static void fan_of_sheets(void **state)
{
    (void)state;
    enum { N = 200 };
    Polygons  soup;
    Inspected i;
    soup_start(&soup);
    for (int k = 0; k < N; k++) {
        const double a = 2 * M_PI * k / N, b = a + M_PI / N;
        soup_polygon(&soup, (Vec3[]){ { 0, 0, 0 }, { cos(a), sin(a), 0 }, { cos(b), sin(b), 0 } },
                     3, 0, 0);
    }
    inspect_soup(&i, &soup, NULL, NULL);
    uint64_t edges = 0;
    for (size_t k = 0; k < i.found.rim_count; k++)
        edges += i.found.rim[k].edges;
    assert_int_equal(i.found.open_edges, 3 * N);
    assert_int_equal(edges, 3 * N);
    inspected_clear(&i);
}

static void curved_faces_with_a_border(void **state)
{
    (void)state;
    Polygons     soup;
    Inspected    i;
    const Affine map = affine_identity();
    soup_start(&soup);
    soup_shape(&soup, SHAPE_SPHERE, 1, &map);
    soup_shape(&soup, SHAPE_DISC, 1, &map);
    soup_shape(&soup, SHAPE_FRUSTUM, 0.5, &map);
    inspect_soup(&i, &soup, NULL, NULL);
    assert_int_equal(i.found.open_edges, 0);
    assert_int_equal(i.found.bordered, 2);
    inspected_clear(&i);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cube_with_a_missing_face), cmocka_unit_test(closed_cube),
        cmocka_unit_test(holes_that_touch),         cmocka_unit_test(moebius_strip),
        cmocka_unit_test(wall_with_t_junction),     cmocka_unit_test(plate),
        cmocka_unit_test(fan_of_sheets),            cmocka_unit_test(curved_faces_with_a_border),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
