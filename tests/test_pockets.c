/* SPDX-License-Identifier: BSD-3-Clause */
/* Places in narrow gaps, which take no part in a picture's solution: behind a picture on a wall all
 * do, in the corners of a room none. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 };

enum { RAYS = 128, CELLS = RAYS / 4 }; /* four rays of a patch judge a cell of it */

static double group_area(const TestRoom *r, const Links *links, const char *name)
{
    const uint32_t group = name != NULL ? room_group(r, name) : 0;
    double         area = 0;
    for (uint32_t i = 0; i < links->count; i++)
        area += name == NULL || r->patches->group[i] == group ? links->area[i] : 0;
    return area;
}

/* An empty cube has no gaps, whatever the size of its patches. A cell in a corner of three walls is
 * taken for one with a chance of (3/4)^16, 1 %, at most; there are 24 such cells, and where two
 * walls meet the chance is 1.5e-5. So more than 3 of all cells are lost once in 4,000 times. */
static void test_no_gap_in_corners(void **state)
{
    static const double edges[] = { 1, 0.25 };
    (void)state;
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
        const Vec3 eye = vec3(0.5, 0.5, 0.5);
        room_finish(&r, edges[k], &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
        r.room.pocket = sqrt(3) / 8;
        Links *links = room_links(&r, RAYS, CLOSURE_NONE);
        const double cell = edges[k] * edges[k] / CELLS;
        assert_true(group_area(&r, links, NULL) > 6 - 3.5 * cell);
        links_destroy(links);
        room_clear(&r);
    }
}

/* A panel at a distance g before a wall. At r from its rim the share
 * F = (1 - r / sqrt(r^2 + g^2)) / 2 <= g^2 / (4 r^2) of the rays gets out, and a place is open when
 * one of 16 does, whose chance is 1 - (1 - F)^16 <= 1 - exp(-4 g^2 / r^2) but for F's square:
 * summed over all r, a strip of 2 sqrt(pi) g along the rim at most takes part, and nothing else
 * behind the panel. */
static void test_behind_a_picture(void **state)
{
    const double gap = 0.01, side = 0.5, chance = 0.02;
    const double strip = 2 * sqrt(M_PI) * gap * 4 * side;
    (void)state;
    for (int k = 0; k < 2; k++) {
        TestRoom r = { 0 };
        const uint32_t grey = room_material(&r, 0.5, 0);
        room_box(&r, ORIGIN, UNIT, BOX_ALL, true, grey, "");
        room_box(&r, vec3(gap, 0.25, 0.25), vec3(0.03, 0.75, 0.75), BOX_ALL, false, grey, "p-");
        const Vec3 eye = vec3(0.5, 0.5, 0.5);
        room_finish(&r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
        r.room.pocket = k == 0 ? 0 : sqrt(3) / 8;
        Links *links = room_links(&r, RAYS, CLOSURE_NONE);
        const double wall = group_area(&r, links, "x0"), back = group_area(&r, links, "p-x0");
        if (k == 0) {
            assert_true(fabs(wall - 1) < 1e-9 && fabs(back - side * side) < 1e-9);
        } else {
            assert_true(wall > 1 - side * side - chance);
            assert_true(wall < 1 - side * side + strip + chance);
            assert_true(back < strip + chance);
            assert_true(group_area(&r, links, "p-x1") > side * side * (1 - chance));
        }
        links_destroy(links);
        room_clear(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_gap_in_corners),
        cmocka_unit_test(test_behind_a_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
