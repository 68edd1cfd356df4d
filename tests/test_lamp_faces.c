/* SPDX-License-Identifier: BSD-3-Clause */
/* Lamps of faces that were cut into pieces, and a large lamp near by among many small ones. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/wave.h"
#include "tests/gather_place.h"

static const double PI = 3.14159265358979323846;

/* A face at height 1 that shines down: corners in order, counter-clockwise from below. */
static void add_lamp(Place *p, const double (*xy)[2], uint32_t count, double radiance)
{
    uint32_t       index[64], group;
    const uint32_t material = grey(p, 0, radiance);
    assert_true(count <= 64);
    for (uint32_t i = 0; i < count; i++)
        assert_true(polygons_add_vertex(&p->soup, vec3(xy[i][0], xy[i][1], 1), &index[i],
                                        &p->err));
    assert_true(polygons_add_group(&p->soup, "", &group, &p->err));
    assert_true(polygons_add_polygon(&p->soup, index, count, material, group, &p->err));
}

/* Corners on its edges cut a rectangle into triangles; it is one lamp all the same. */
static void rectangle_is_whole(void **state)
{
    (void)state;
    static const double xy[][2] = { { -1, -1 }, { -1, -0.3 }, { -1, 1 }, { 0.2, 1 },
                                    { 1, 1 },   { 1, 0.6 },   { 1, -1 }, { -0.1, -1 } };
    Place p = { 0 };
    add_lamp(&p, xy, 8, 3);
    place_finish(&p, 3, 10);
    const Lamps *lamps = &p.gatherer->lamps;
    assert_true(p.surfaces->count > 1);
    assert_int_equal(lamps->count, 1);
    assert_true(lamps->lamp[0].facet.rectangle);
    assert_true(fabs(lamps->lamp[0].area - 4) < 1e-12);
    for (uint32_t i = 0; i < p.surfaces->count; i++)
        assert_int_equal(lamps->first[i], 0);
    /* Under its middle: four times [howell, C-4] of a unit square at distance 1, times pi L. */
    const double exact = 3 * 4 * atan(sqrt(0.5)) / sqrt(2);
    assert_true(fabs(measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 64).direct.g - exact) <
                1e-8 * exact);
    place_clear(&p);
}

/* A regular polygon of n corners, apothem a, at distance h over the point: by Lambert's formula n
 * edges seen under an angle each of 2 atan(half edge / sqrt(a^2 + h^2)). */
static void many_corners_are_a_fan(void **state)
{
    (void)state;
    enum { N = 24 };
    double corner[N][2];
    for (int i = 0; i < N; i++) {
        corner[i][0] = cos(2 * PI * i / N);
        corner[i][1] = -sin(2 * PI * i / N);
    }
    Place p = { 0 };
    add_lamp(&p, (const double(*)[2])corner, N, 3);
    place_finish(&p, 3, 10);
    const Lamps *lamps = &p.gatherer->lamps;
    assert_int_equal(lamps->count, N - 2);
    assert_int_equal(lamps->lamp[0].fan, N - 2);
    const double a = cos(PI / N), half = sin(PI / N), d = sqrt(a * a + 1);
    const double exact = 3 * N * atan(half / d) * a / d;
    assert_true(fabs(measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 64).direct.g - exact) <
                1e-6 * exact);
    place_clear(&p);
}

/* An L fills less than its hull: it stays in pieces, which are as large as it is. */
static void an_angle_stays_in_pieces(void **state)
{
    (void)state;
    static const double xy[][2] = { { -1, -1 }, { -1, 1 }, { 0, 1 }, { 0, 0 }, { 1, 0 },
                                    { 1, -1 } };
    Place p = { 0 };
    add_lamp(&p, xy, 6, 3);
    place_finish(&p, 3, 10);
    const Lamps *lamps = &p.gatherer->lamps;
    double       area = 0;
    assert_true(lamps->count > 1);
    for (uint32_t i = 0; i < lamps->count; i++)
        area += lamps->lamp[i].area;
    assert_true(fabs(area - 3) < 1e-9);
    /* Three of the four unit squares of the whole. */
    const double exact = 3 * 3 * atan(sqrt(0.5)) / sqrt(2);
    assert_true(fabs(measure(&p, vec3(0, 0, 0), vec3(0, 0, 1), 64).direct.g - exact) <
                1e-8 * exact);
    place_clear(&p);
}

/* A wall that meets a large lamp at a right angle, c below its edge, among a hundred small lamps
 * that do not reach the wall: [howell, C-3], twice, for its halves either side of the point. The
 * large lamp is weighed by what it sends, not by where its middle is, so noise is that of one. */
static void large_lamp_near_by(void **state)
{
    (void)state;
    static const double xy[][2] = { { -1, -1 }, { -1, 1 }, { 1, 1 }, { 1, -1 } };
    Place p = { 0 };
    add_lamp(&p, xy, 4, 3);
    const uint32_t small = grey(&p, 0, 3);
    for (int i = 0; i < 100; i++)
        add_quad(&p, vec3(2 + 0.1 * (i % 10), 0.1 * (i / 10), 1), vec3(0, 0.05, 0),
                 vec3(0.05, 0, 0), small);
    place_finish(&p, 3, 100);
    assert_true(p.gatherer->lamps.many);
    assert_int_equal(p.gatherer->lamps.weighed_count, 1);
    for (double c = 0.1; c > 1e-3; c /= 10) {
        const double r = hypot(2, c);
        const double exact = 3 * (atan(1 / c) - c / r * atan(1 / r));
        const Irradiance e = measure(&p, vec3(1, 0, 1 - c), vec3(-1, 0, 0), 4096);
        assert_true(fabs(e.direct.g - exact) < 4 * e.standard_error + 1e-4 * exact);
        assert_true(e.standard_error < 0.01 * exact);
    }
    place_clear(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rectangle_is_whole),
        cmocka_unit_test(many_corners_are_a_fan),
        cmocka_unit_test(an_angle_stays_in_pieces),
        cmocka_unit_test(large_lamp_near_by),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
