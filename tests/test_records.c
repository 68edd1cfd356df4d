/* SPDX-License-Identifier: BSD-3-Clause */
/* Records of light: fields that they must give back, and places where they must not be used. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "render/records.h"

enum { SIDE = 9 };

/* A grid of records over the unit square at z = 0, facing up, of a field that is linear. */
static double field(Vec3 p) { return 2 + p.x - 0.5 * p.y; }

static Records *grid(double radius, double deviation)
{
    Error    err = { 0 };
    Records *records = records_create(&err);
    assert_non_null(records);
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            Record r = { .at = { vec3(i / (SIDE - 1.0), j / (SIDE - 1.0), 0), vec3(0, 0, 1) },
                         .along = { 1, 0, 0 }, .radius = radius, .stretch = 1,
                         .deviation = deviation };
            const double e = field(r.at.point);
            r.irradiance = rgb(e, 2 * e, 1);
            assert_true(records_add(records, &r, 1, &err));
        }
    assert_int_equal(records_count(records), SIDE * SIDE);
    return records;
}

/* Between the records a linear field comes back. What is lost is what keeps fits from swinging:
 * 0.005 of the weight against neighbours whose mean square distance along an axis is over 0.05
 * radii^2 inside the grid: slopes are at most a tenth too small, and a plane is read over less than
 * a radius. */
static void linear_fields_come_back(void **state)
{
    (void)state;
    const double radius = 0.3;
    Records     *records = grid(radius, 0);
    records_fit(records, 0, SIDE * SIDE);
    for (int k = 0; k < 200; k++) {
        const Receiver at = { .point = { 0.3 + 0.4 * k / 200,
                                         0.3 + 0.4 * (k * 37 % 200) / 200, 0 },
                              .normal = { 0, 0, 1 } };
        const double slope = sqrt(1.25);
        Recorded     out;
        assert_true(records_find(records, &at, &out));
        assert_true(fabs(out.irradiance.r - field(at.point)) < 0.1 * slope * radius);
        assert_true(fabs(out.irradiance.g - 2 * out.irradiance.r) < 1e-12);
        assert_true(fabs(out.irradiance.b - 1) < 1e-12);
        assert_true(out.nearness > 0 && out.nearness <= 1);
    }
    records_destroy(records);
}

/* The mean of n values of the same noise has less; one value has its own. */
static void noise_is_told(void **state)
{
    (void)state;
    const Receiver at = { .point = { 0.5, 0.5, 0 }, .normal = { 0, 0, 1 } };
    Recorded       out;
    Records       *alone = grid(0.1, 0.25), *many = grid(0.4, 0.25);
    assert_true(records_find(alone, &at, &out));
    assert_true(fabs(out.deviation - 0.25) < 1e-12); /* spacing 1/8: no neighbour reaches it */
    assert_true(records_find(many, &at, &out));
    assert_true(out.deviation < 0.25 / 2);           /* at least nine do */
    records_fit(many, 0, SIDE * SIDE);
    assert_true(records_find(many, &at, &out));
    assert_true(out.deviation > 0 && out.deviation < 0.25 / 2);
    records_destroy(alone);
    records_destroy(many);
}

/* Beyond the radius, on the other side, on a shelf above and on a wall there is no record. */
static void strangers_are_refused(void **state)
{
    (void)state;
    Records *records = grid(0.2, 0);
    static const Receiver far[] = {
        { .point = { 1.5, 0.5, 0 }, .normal = { 0, 0, 1 } },
        { .point = { 0.5, 0.5, 0 }, .normal = { 0, 0, -1 } },
        { .point = { 0.5, 0.5, 0.05 }, .normal = { 0, 0, 1 } },
        { .point = { 0.5, 0.5, 0 }, .normal = { 1, 0, 0 } },
        { .point = { -1e30, 1e30, 0 }, .normal = { 0, 0, 1 } }
    };
    Recorded out;
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++)
        assert_false(records_find(records, &far[i], &out));
    records_destroy(records);
    Error err = { 0 };
    records = records_create(&err);
    assert_false(records_find(records, &far[0], &out)); /* of none */
    records_destroy(records);
}

/* An ellipse three times as long as wide, along a diagonal: nearness falls to 0 at its rim, and on
 * the way there it is what the same share of either half-axis gives. */
static void ellipses_reach_as_far_as_they_say(void **state)
{
    (void)state;
    const double root = sqrt(0.5), radius = 0.1;
    const Vec3   along = vec3(root, root, 0), across = vec3(-root, root, 0);
    Record r = { .at = { vec3(2, 3, 0), vec3(0, 0, 1), vec3(0, 0, 1) }, .along = along,
                 .radius = radius, .stretch = 3, .irradiance = { 1, 2, 3 } };
    Error    err = { 0 };
    Records *records = records_create(&err);
    assert_true(records_add(records, &r, 1, &err));
    for (int k = 0; k < 20; k++) {
        const double share = (k + 0.5) / 10;
        for (int i = 0; i < 4; i++) {
            const double turn = M_PI_2 * i + 0.3 * k; /* any way of the ellipse's plane */
            const Vec3 p = vec3_mad(vec3_mad(r.at.point, 3 * radius * share * cos(turn), along),
                                    radius * share * sin(turn), across);
            const Receiver at = { p, vec3(0, 0, 1), vec3(0, 0, 1) };
            Recorded out;
            assert_true(records_find(records, &at, &out) == (share < 1));
            if (share < 1) {
                assert_true(fabs(out.nearness - (1 - share)) < 1e-12);
                assert_true(fabs(out.irradiance.g - 2) < 1e-12);
            }
        }
    }
    records_destroy(records);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_fields_come_back),
        cmocka_unit_test(ellipses_reach_as_far_as_they_say),
        cmocka_unit_test(noise_is_told),
        cmocka_unit_test(strangers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
