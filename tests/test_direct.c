/* SPDX-License-Identifier: BSD-3-Clause */
/* Direct light of point and spot lights on patches: CIE 171 test cases 5.2 and 5.4, and
 * balances. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

static Direct direct_of(const TestRoom *r, bool balance, uint32_t seed)
{
    Error err = { 0 };
    Direct direct;
    Links *links = room_links(r, 16, CLOSURE_NONE);
    const DirectOptions o = { .balance = balance, .seed = seed };
    assert_true(direct_create(&r->room, links, &o, &direct, NULL, &err));
    links_destroy(links);
    return direct;
}

/* CIE 171 case 5.2: illuminance under a small source 3 m above a 4 m x 4 m surface; closed form. */
static void test_cie_5_2(void **state)
{
    (void)state;
    static const struct {
        double x, y, lambertian, isotropic;
    } points[] = {
        { 0, 0, 111.111111111, 111.111111111 },   { 0.5, 0, 105.186267348, 106.637180955 },
        { 1, 0, 90.0, 94.8683298051 },            { 1.5, 0, 71.1111111111, 79.5046392 },
        { 0.5, 0.5, 99.7229916898, 102.455634398 }, { 1, 0.5, 85.6632956573, 91.418787447 },
        { 1.5, 0.5, 68.0529300567, 76.9262379939 }, { 1, 1, 74.3801652893, 82.230366703 },
        { 1.5, 1, 59.9750104123, 69.970845481 },  { 1.5, 1.5, 49.3827160494, 60.4812282169 },
    };
    enum { POINTS = sizeof points / sizeof *points };
    for (int kind = 0; kind < 2; kind++) {
        const Light light = { .kind = kind == 0 ? LIGHT_COSINE : LIGHT_POINT,
                              .position = { 0, 0, 3 }, .direction = { 0, 0, -1 },
                              .intensity = { 1000, 500, 0 } };
        TestRoom r = { 0 };
        const uint32_t m = room_material(&r, 0.5, 0);
        /* A square of 2 cm around each point: the mean differs from the point's value by
         * h^2/24 (E_xx + E_yy) < 2e-4 lux, E changing over some 3 m. */
        for (int k = 0; k < POINTS; k++) {
            char name[16];
            snprintf(name, sizeof name, "p%d", k);
            room_quad(&r, vec3(points[k].x - 0.01, points[k].y - 0.01, 0), vec3(0.02, 0, 0),
                      vec3(0, 0.02, 0), m, name);
        }
        room_finish(&r, 1, &(SidesOptions){ 0 }, &light, 1, NULL);
        Direct direct = direct_of(&r, false, 0);
        for (uint32_t i = 0; i < r.patches->count; i++)
            for (int k = 0; k < POINTS; k++) {
                char name[16];
                snprintf(name, sizeof name, "p%d", k);
                if (r.patches->group[i] != room_group(&r, name) || r.patches->side[i] != 0)
                    continue;
                const double exact = kind == 0 ? points[k].lambertian : points[k].isotropic;
                const double *h = &direct.irradiance[3 * (size_t)i];
                assert_true(fabs(h[0] / exact - 1) < 1e-4);
                assert_true(fabs(h[1] / exact - 0.5) < 1e-4);
                assert_true(h[2] == 0);
            }
        array_free(direct.irradiance);
        room_clear(&r);
    }
}

/* CIE 171 case 5.4: 10,000 lm in the middle of a room 4 x 4 x 3; flux on each face by solid
 * angle. */
static void test_cie_5_4(void **state)
{
    (void)state;
    static const struct {
        const char *face;
        double      flux;
    } faces[] = { { "x0", 1394.67168057 }, { "x1", 1394.67168057 }, { "y0", 1394.67168057 },
                  { "y1", 1394.67168057 }, { "z0", 2210.65663886 }, { "z1", 2210.65663886 } };
    const double i0 = 10000 / (4 * M_PI);
    const Light light = { .kind = LIGHT_POINT, .position = { 2, 2, 1.5 },
                          .intensity = { i0, i0, i0 } };
    for (int balance = 0; balance < 2; balance++) {
        TestRoom r = { 0 };
        room_box(&r, vec3(0, 0, 0), vec3(4, 4, 3), BOX_ALL, true, room_material(&r, 0, 0), "");
        room_finish(&r, 0.4, &(SidesOptions){ 0 }, &light, 1, NULL);
        Direct direct = direct_of(&r, balance, 0);
        double total = 0;
        for (int k = 0; k < 6; k++) {
            double flux = 0;
            for (uint32_t i = 0; i < r.patches->count; i++)
                if (r.patches->group[i] == room_group(&r, faces[k].face))
                    flux += r.patches->area[i] * direct.irradiance[3 * (size_t)i];
            /* 64 points of a (0,2)-net on patches over which H changes by a few per cent. */
            assert_true(fabs(flux / faces[k].flux - 1) < 1e-3);
            total += flux;
        }
        assert_true(fabs(direct.flux.r - 10000) < 1e-8);
        assert_true(direct.escaped.r == 0);
        assert_true(direct.balance_error < 1e-4);
        if (balance)
            assert_true(fabs(total - 10000) < 1e-8);
        array_free(direct.irradiance);
        room_clear(&r);
    }
}

/* An opening 2 m x 1 m in a wall, sill at 1 m: 345.936127619 lm go out through it. */
static void test_opening(void **state)
{
    (void)state;
    const double i0 = 10000 / (4 * M_PI);
    const Light light = { .kind = LIGHT_POINT, .position = { 2, 2, 1.5 },
                          .intensity = { i0, i0, i0 } };
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0, 0);
    room_box(&r, vec3(0, 0, 0), vec3(4, 4, 3), BOX_ALL - BOX_Y1, true, m, "");
    const Vec3 z = { 0, 0, 1 };
    room_quad(&r, vec3(0, 4, 0), vec3(0, 0, 3), vec3(1, 0, 0), m, "left");
    room_quad(&r, vec3(3, 4, 0), vec3(0, 0, 3), vec3(1, 0, 0), m, "right");
    room_quad(&r, vec3(1, 4, 0), z, vec3(2, 0, 0), m, "below");
    room_quad(&r, vec3(1, 4, 2), z, vec3(2, 0, 0), m, "above");
    room_finish(&r, 0.4, &(SidesOptions){ 0 }, &light, 1, NULL);
    Direct direct = direct_of(&r, true, 0);
    /* 16384 rays, 567 of which go out: on a net the count is off by far less than its root. */
    assert_true(fabs(direct.escaped.r - 345.936127619) < 10000 * 24.0 / 16384);
    double arrived = 0;
    for (uint32_t i = 0; i < r.patches->count; i++)
        arrived += r.patches->area[i] * direct.irradiance[3 * (size_t)i];
    assert_true(fabs(arrived + direct.escaped.r - 10000) < 1e-8);
    array_free(direct.irradiance);
    room_clear(&r);
}

/* A spot in the ceiling, a table below it: the table's shadow is dark, the balance exact. */
static void test_spot_shadow(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_SPOT, .position = { 0.5, 0.5, 0.9 },
                          .direction = { 0, 0, -1 }, .intensity = { 3, 2, 1 },
                          .cos_inner = cos(0.3), .cos_outer = cos(0.6) };
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0.5, 0);
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, m, "");
    room_quad(&r, vec3(0.4, 0.4, 0.45), vec3(0.2, 0, 0), vec3(0, 0.2, 0), m, "table");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, &light, 1, NULL);
    Direct direct = direct_of(&r, true, 0);
    double arrived = 0, dark = 0;
    for (uint32_t i = 0; i < r.patches->count; i++) {
        const Vec3 c = r.patches->centre[i];
        const double *h = &direct.irradiance[3 * (size_t)i];
        arrived += r.patches->area[i] * h[0];
        /* The table's shadow on the floor: twice its size. */
        if (r.patches->group[i] == room_group(&r, "z0") && fabs(c.x - 0.5) < 0.15 &&
            fabs(c.y - 0.5) < 0.15)
            dark += h[0];
        assert_true(fabs(h[1] - h[0] * 2 / 3) < 1e-12 && fabs(h[2] - h[0] / 3) < 1e-12);
        if (r.patches->group[i] == room_group(&r, "table"))
            assert_true(r.patches->side[i] == 0 ? h[0] > 0 : h[0] == 0);
    }
    assert_true(dark == 0);
    assert_true(direct.escaped.r == 0);
    assert_true(fabs(arrived / direct.flux.r - 1) < 1e-9);
    array_free(direct.irradiance);
    room_clear(&r);
}

/* A box on the floor: what is hidden under it takes no light and gives none to the means of the
 * patches across its rim, which are in full view of the light. */
static void test_hidden(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 30 },
                          .intensity = { 900, 900, 900 } };
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0.5, 0);
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_Z0, true, m, "");
    room_box(&r, vec3(0.33, 0.33, 0), vec3(0.67, 0.67, 0.0001), BOX_ALL, false, m, "b-");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, &light, 1, NULL);
    Direct direct = direct_of(&r, false, 0);
    assert_true(r.patches->count > 100); /* the light is far off, but it is seen */
    for (uint32_t i = 0; i < r.patches->count; i++) {
        const Vec3 c = r.patches->centre[i];
        if (r.patches->group[i] != room_group(&r, "z0") || r.patches->side[i] != 0)
            continue;
        const bool under = fmax(fabs(c.x - 0.5), fabs(c.y - 0.5)) < 0.11;
        const double h = direct.irradiance[3 * (size_t)i];
        /* H = 900/30^2 = 1, less 1.5 (r/30)^2 < 1e-3; the box is too low to shade more than
         * 1e-4. */
        assert_true(under ? h == 0 : fabs(h - 1) < 2e-3);
    }
    array_free(direct.irradiance);
    room_clear(&r);
}

/* A panel of one square far below a light: H = 1000 / 30^2 times the mean of cos^3 over it,
 * which is 1 less 1.5 (1/6) / 30^2; what escapes is the rest, although none
 * of the light's own rays may find it. */
static void test_far(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 30 },
                          .intensity = { 1000, 1000, 1000 } };
    for (uint32_t seed = 0; seed < 4; seed++) {
        TestRoom r = { 0 };
        room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_Z0, true, room_material(&r, 0.5, 0), "");
        room_finish(&r, 0.5, &(SidesOptions){ .seed = seed }, &light, 1, NULL);
        Direct direct = direct_of(&r, true, seed);
        double arrived = 0;
        for (uint32_t i = 0; i < r.patches->count; i++)
            arrived += direct.irradiance[3 * (size_t)i] * r.patches->area[i];
        assert_true(fabs(arrived / (1000.0 / 900 * (1 - 0.25 / 900)) - 1) < 1e-4);
        assert_true(fabs((arrived + direct.escaped.r) / direct.flux.r - 1) < 1e-12);
        array_free(direct.irradiance);
        room_clear(&r);
    }
}

/* A light 2 cm under the ceiling of a closed cube: the floor has its closed form all the same. */
static void test_near(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 2, 2, 3.98 },
                          .intensity = { 100, 100, 100 } };
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(4, 4, 4), BOX_ALL, true, room_material(&r, 0.5, 0), "");
    room_finish(&r, 0.25, &(SidesOptions){ 0 }, &light, 1, NULL);
    Direct direct = direct_of(&r, true, 0);
    double arrived = 0;
    for (uint32_t i = 0; i < r.patches->count; i++) {
        const Vec3 c = r.patches->centre[i];
        const double h = direct.irradiance[3 * (size_t)i];
        arrived += h * r.patches->area[i];
        if (r.patches->group[i] != room_group(&r, "z0"))
            continue;
        const double d2 = (c.x - 2) * (c.x - 2) + (c.y - 2) * (c.y - 2) + 3.98 * 3.98;
        /* The mean over a patch differs from its centre by less than (0.25 / 3.98)^2 / 4. */
        assert_true(fabs(h / (100 * 3.98 / (d2 * sqrt(d2))) - 1) < 2e-3);
    }
    assert_true(fabs(arrived / direct.flux.r - 1) < 1e-9);
    array_free(direct.irradiance);
    room_clear(&r);
}

static void test_none(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 1), "");
    room_finish(&r, 0.5, &(SidesOptions){ 0 }, NULL, 0, NULL);
    Direct direct = direct_of(&r, true, 0);
    for (uint32_t i = 0; i < 3 * r.patches->count; i++)
        assert_true(direct.irradiance[i] == 0);
    assert_true(direct.flux.r == 0 && direct.rays == 0);
    array_free(direct.irradiance);
    room_clear(&r);
}

static void test_memory(void **state)
{
    (void)state;
    const Light light = { .kind = LIGHT_POINT, .position = { 0.5, 0.5, 0.5 },
                          .intensity = { 1, 1, 1 } };
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 0), "");
    room_finish(&r, 0.5, &(SidesOptions){ 0 }, &light, 1, NULL);
    Links *links = room_links(&r, 16, CLOSURE_NONE);
    const long before = array_live();
    bool made = false;
    for (long n = 0; n < 200 && !made; n++) {
        Error err = { 0 };
        Direct direct;
        array_fail_after(n);
        made = direct_create(&r.room, links, &(DirectOptions){ .threads = 1 }, &direct, NULL, &err);
        array_fail_after(-1);
        assert_int_equal(err.code, made ? ERROR_NONE : ERROR_MEMORY);
        array_free(direct.irradiance);
        assert_int_equal(array_live(), before);
    }
    assert_true(made);
    links_destroy(links);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cie_5_2), cmocka_unit_test(test_cie_5_4),
        cmocka_unit_test(test_opening), cmocka_unit_test(test_spot_shadow),
        cmocka_unit_test(test_hidden),  cmocka_unit_test(test_far), cmocka_unit_test(test_near),
        cmocka_unit_test(test_none),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
