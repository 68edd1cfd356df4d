/* SPDX-License-Identifier: BSD-3-Clause */
/* The polygon soup: what goes in comes out, names are found again, failures leave it whole. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "mesh/polygons.h"

/* Of the square's corners: it leans to x at the two where x is 1, 3 : 4. */
static const Vec3 slope[4] = { { 0, 0, 9 }, { 3, 0, 4 }, { 0.6, 0, 0.8 }, { 0, 0, 1e-9 } };

/* A square in the plane z = 0 seen from above, a unit sphere about (5, 0, 0), one material, two
 * groups. */
static bool soup_fill(Polygons *soup, Error *err)
{
    const Vec3     corner[4] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } };
    const Material grey = material_default();
    Affine         map = affine_identity();
    uint32_t       index[4], material = 0, square = 0, ball = 0;
    Shape          shape;

    map.t = vec3(5, 0, 0);
    for (int i = 0; i < 4; i++)
        if (!polygons_add_vertex(soup, corner[i], &index[i], err))
            return false;
    return polygons_add_material(soup, &grey, &material, err) &&
           polygons_add_group(soup, "square", &square, err) &&
           polygons_add_group(soup, "ball", &ball, err) &&
           polygons_add_polygon(soup, index, 4, material, square, err) &&
           polygons_set_normals(soup, 0, slope, err) &&
           shape_init(&shape, SHAPE_SPHERE, 0, &map, err) &&
           polygons_add_shape(soup, &shape, material, ball, err);
}

static void what_goes_in_comes_out(void **state)
{
    (void)state;
    Polygons soup = { 0 };
    Error    err = { 0 };

    assert_true(polygons_check(&soup));
    assert_true(soup_fill(&soup, &err));
    assert_true(polygons_check(&soup));
    assert_int_equal(soup.polygon_count, 1);
    assert_int_equal(soup.first[0], 0);
    assert_int_equal(soup.first[1], 4);
    assert_int_equal(soup.vertex_count, 4);
    assert_int_equal(soup.shape_count, 1);
    assert_string_equal(soup.group_name[soup.group[0]], "square");
    assert_string_equal(soup.group_name[soup.shape[0].group], "ball");
    assert_string_equal(soup.materials[0].name, "");
    polygons_clear(&soup);
    assert_int_equal(soup.polygon_count, 0);
    assert_null(soup.first);
    assert_int_equal(array_live(), 0);
}

static void arrays_grow(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    Polygons soup = { 0 };
    Error    err = { 0 };
    uint32_t index[3], material, group;

    const Material grey = material_default();
    assert_true(polygons_add_material(&soup, &grey, &material, &err));
    assert_true(polygons_add_group(&soup, "", &group, &err));
    assert_string_equal(soup.group_name[group], "default");
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++)
            assert_true(polygons_add_vertex(&soup, vec3(i, k, 0), &index[k], &err));
        assert_true(polygons_add_polygon(&soup, index, 3, material, group, &err));
    }
    assert_true(polygons_check(&soup));
    for (uint32_t i = 0; i < COUNT; i++) {
        assert_int_equal(soup.first[i + 1], 3 * (i + 1));
        assert_true(soup.position[soup.corner[3 * i + 1]].x == i);
    }
    polygons_clear(&soup);
}

/* 20,000 names, each asked for twice; and names that were put in past the table. */
static void groups_are_found_again(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    Polygons soup = { 0 };
    Error    err = { 0 };
    uint32_t index;
    char     name[32];

    for (int round = 0; round < 2; round++)
        for (uint32_t i = 0; i < COUNT; i++) {
            snprintf(name, sizeof name, "group-%u", i);
            assert_true(polygons_add_group(&soup, name, &index, &err));
            assert_int_equal(index, i);
        }
    assert_int_equal(soup.group_count, COUNT);
    assert_true(array_reserve((void **)&soup.group_name, &soup.group_capacity, COUNT + 1,
                              sizeof *soup.group_name, "names", &err));
    soup.group_name[soup.group_count++] = array_string("foreign", &err);
    assert_true(polygons_add_group(&soup, "foreign", &index, &err));
    assert_int_equal(index, COUNT);
    polygons_clear(&soup);
}

static void bounds_hold_faces_only(void **state)
{
    (void)state;
    Polygons soup = { 0 };
    Error    err = { 0 };
    uint32_t index;
    Vec3     lo, hi;

    assert_false(polygons_bounds(&soup, &lo, &hi));
    assert_true(polygons_add_vertex(&soup, vec3(100, 100, 100), &index, &err));
    assert_false(polygons_bounds(&soup, &lo, &hi)); /* a point no face uses */
    assert_true(soup_fill(&soup, &err));
    assert_true(polygons_bounds(&soup, &lo, &hi));
    /* The square 0..1 and the ball 4..6 by -1..1 by -1..1. */
    assert_true(fabs(lo.x) < 1e-12 && fabs(lo.y + 1) < 1e-12 && fabs(lo.z + 1) < 1e-12);
    assert_true(fabs(hi.x - 6) < 1e-12 && fabs(hi.y - 1) < 1e-12 && fabs(hi.z - 1) < 1e-12);
    polygons_clear(&soup);
}

static void check_sees_faults(void **state)
{
    (void)state;
    Polygons soup = { 0 };
    Error    err = { 0 };

    assert_true(soup_fill(&soup, &err));
    soup.corner[2] = 4;
    assert_false(polygons_check(&soup));
    soup.corner[2] = 2;
    soup.first[1] = 2;
    assert_false(polygons_check(&soup));
    soup.first[1] = 4;
    soup.group[0] = 2;
    assert_false(polygons_check(&soup));
    soup.group[0] = 0;
    soup.shape[0].material = 1;
    assert_false(polygons_check(&soup));
    soup.shape[0].material = 0;
    soup.materials[0].reflectance.g = 1;
    assert_false(polygons_check(&soup));
    soup.materials[0].reflectance.g = 0.5;
    soup.materials[0].emission.b = INFINITY;
    assert_false(polygons_check(&soup));
    soup.materials[0].emission.b = 0;
    assert_true(polygons_check(&soup));
    polygons_clear(&soup);
}

static Vec3 polygon_normal(const Polygons *soup, size_t i)
{
    const uint32_t *c = soup->corner + soup->first[i];
    const Vec3      a = soup->position[c[0]];
    return vec3_cross(vec3_sub(soup->position[c[1]], a), vec3_sub(soup->position[c[2]], a));
}

/* Mirrored in z and moved up by 2: the square's front looked up and must look down afterwards, the
 * ball's centre comes to z = 2; materials and groups are renumbered. */
static void append_maps_and_renumbers(void **state)
{
    (void)state;
    Polygons soup = { 0 }, other = { 0 };
    Error    err = { 0 };
    Affine   map = affine_identity();

    map.z.z = -1;
    map.t.z = 2;
    assert_true(soup_fill(&soup, &err));
    assert_true(soup_fill(&other, &err));
    assert_true(polygons_append(&soup, &other, &map, UINT32_MAX, UINT32_MAX, &err));
    assert_true(polygons_check(&soup));
    assert_int_equal(soup.polygon_count, 2);
    assert_int_equal(soup.material[1], 1);
    assert_int_equal(soup.group[1], 0); /* the same name is the same group */
    assert_int_equal(soup.group_count, 2);
    assert_true(polygon_normal(&soup, 0).z > 0);
    assert_true(polygon_normal(&soup, 1).z < 0);
    assert_true(soup.position[4].z == 2);
    assert_true(soup.shape[1].shape.to_world.t.z == 2);
    Vec3 n;
    assert_true(polygons_normal_at(&soup, 1, vec3(1, 0.25, 2), &n));
    assert_true(vec3_length(vec3_sub(n, vec3(0.6, 0, -0.8))) < 1e-6);

    assert_true(polygons_append(&soup, &other, &map, 0, 1, &err));
    assert_int_equal(soup.material[2], 0);
    assert_int_equal(soup.group[2], 1);
    assert_int_equal(soup.material_count, 2);
    map.z.z = 0;
    assert_false(polygons_append(&soup, &other, &map, 0, 1, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    polygons_clear(&soup);
    polygons_clear(&other);
    assert_int_equal(array_live(), 0);
}

/* At corners the file's, scaled to 1; between them a blend; none where a corner has none. */
static void normals_are_between_those_of_corners(void **state)
{
    (void)state;
    Polygons soup = { 0 };
    Error    err = { 0 };
    Vec3     n;
    const uint32_t corner[3] = { 0, 1, 2 };
    Vec3     odd[4] = { { 0, 0, 1 }, { 0, NAN, 1 }, { 0, 0, 1 }, { 0, 0, 1 } };
    assert_true(soup_fill(&soup, &err));
    assert_true(polygons_normal_at(&soup, 0, vec3(0, 1, 0), &n));
    assert_true(n.x == 0 && n.z == 1);
    assert_true(polygons_normal_at(&soup, 0, vec3(0.5, 0.5, 0), &n));
    const Vec3 middle = vec3_unit(vec3(0.3, 0, 0.9)); /* of (0,0,1) and (0.6,0,0.8) */
    assert_true(vec3_length(vec3_sub(n, middle)) < 1e-6);
    assert_true(polygons_add_polygon(&soup, corner, 3, 0, 0, &err));
    assert_false(polygons_normal_at(&soup, 1, vec3(0.5, 0.25, 0), &n));
    assert_true(polygons_set_normals(&soup, 1, slope, &err));
    /* Weights 1/2, 1/4, 1/4. */
    assert_true(polygons_normal_at(&soup, 1, vec3(0.5, 0.25, 0), &n));
    assert_true(vec3_length(vec3_sub(n, middle)) < 1e-6);
    assert_true(polygons_set_normals(&soup, 0, odd, &err));
    assert_true(polygons_check(&soup));
    assert_true(polygons_normal_at(&soup, 0, vec3(0, 0, 0), &n) == false);
    soup.normal[0] = 0.5F;
    assert_false(polygons_check(&soup));
    polygons_clear(&soup);
}

/* Every allocation fails once; what is there stays valid and is freed. */
static void allocations_may_fail(void **state)
{
    (void)state;
    bool done = false;

    for (long n = 0; !done; n++) {
        Polygons soup = { 0 }, copy = { 0 };
        Error    err = { 0 };
        const Affine map = affine_identity();
        array_fail_after(n);
        done = soup_fill(&soup, &err) &&
               polygons_append(&copy, &soup, &map, UINT32_MAX, UINT32_MAX, &err);
        array_fail_after(-1);
        assert_true(done || err.code == ERROR_MEMORY);
        assert_true(polygons_check(&soup) && polygons_check(&copy));
        polygons_clear(&soup);
        polygons_clear(&copy);
        assert_int_equal(array_live(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_goes_in_comes_out), cmocka_unit_test(arrays_grow),
        cmocka_unit_test(groups_are_found_again), cmocka_unit_test(bounds_hold_faces_only),
        cmocka_unit_test(check_sees_faults),      cmocka_unit_test(append_maps_and_renumbers),
        cmocka_unit_test(normals_are_between_those_of_corners),
        cmocka_unit_test(allocations_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
