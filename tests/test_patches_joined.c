/* SPDX-License-Identifier: BSD-3-Clause */
/* Small things of many parts put together: those in one room, and never through a wall. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "math/sampling.h"
#include "tests/room_maker.h"

enum { LEAVES = 600 };

static double chance(uint32_t k, uint32_t of)
{
    return sampling_mix(sampling_seed(k, of, 0, 0)) * 0x1p-32;
}

/* A triangle of some 2 cm, anywhere in the box, turned anyhow; never through x = 0. */
static void add_leaf(TestRoom *r, uint32_t k, uint32_t material)
{
    Error err = { 0 };
    uint32_t corner[3], group = 0;
    const double side = k % 2 == 0 ? 1 : -1;
    const Vec3 at = vec3(side * (0.02 + 0.3 * chance(k, 0)), 0.1 + 0.8 * chance(k, 1),
                         0.1 + 0.8 * chance(k, 2));
    assert_true(polygons_add_group(&r->soup, "leaves", &group, &err));
    for (uint32_t c = 0; c < 3; c++) {
        const Vec3 d = sampling_sphere(chance(k, 3 + 2 * c), chance(k, 4 + 2 * c));
        assert_true(polygons_add_vertex(&r->soup, vec3_mad(at, 0.015, d), &corner[c], &err));
    }
    assert_true(polygons_add_polygon(&r->soup, corner, 3, material, group, &err));
}

/* Two rooms that share a wall without thickness, leaves in both and close to it; or one room. */
static void make_rooms(TestRoom *r, bool wall)
{
    const uint32_t grey = room_material(r, 0.5, 0);
    room_box(r, vec3(-1, 0, 0), vec3(1, 1, 1), BOX_ALL, true, grey, "");
    if (wall)
        room_quad(r, vec3(0, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), grey, "wall");
    for (uint32_t k = 0; k < LEAVES; k++)
        add_leaf(r, k, grey);
    room_connect(r);
}

static Patches *divide(const TestRoom *r, bool join, double size)
{
    Error err = { 0 };
    const SidesJoined context = { r->bvh, ray_offset(r->surfaces->largest_coordinate) };
    const PatchOptions options = { .size = size, .joined = join ? sides_joined : NULL,
                                   .joined_context = &context };
    Patches *p = patches_create(r->surfaces, &options, NULL, &err);
    assert_non_null(p);
    assert_true(patches_check(p, r->surfaces));
    return p;
}

/* Merged patches whose pieces lie on both sides of x = 0. */
static uint32_t count_across(const TestRoom *r, const Patches *p)
{
    uint32_t across = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        bool left = false, right = false;
        for (uint32_t k = p->first_piece[i]; k < p->first_piece[i + 1]; k++) {
            const Surface *f = &r->surfaces->surface[p->piece[k]];
            const double x = r->surfaces->position[r->surfaces->corner[3 * f->primitive]].x;
            left = left || x < 0;
            right = right || x > 0;
        }
        across += left && right;
    }
    return across;
}

static void test_wall(void **state)
{
    (void)state;
    static const double sizes[] = { 0.1, 0.3, 1 };
    for (size_t k = 0; k < 3; k++) {
        TestRoom r = { 0 };
        make_rooms(&r, true);
        Patches *alone = divide(&r, false, sizes[k]), *joined = divide(&r, true, sizes[k]);
        const uint32_t leaves = alone->count - joined->count;
        assert_int_equal(alone->first_piece[alone->count], 0);
        assert_int_equal(count_across(&r, joined), 0);
        /* At 0.1 a cell of the grid has about 4 leaf sides, of which few look alike; else a quarter
         * of all sides at least finds another. */
        assert_true(leaves > (k == 0 ? 0 : LEAVES / 2));
        patches_destroy(alone);
        patches_destroy(joined);
        room_clear(&r);
    }
}

/* The same leaves without the wall are joined across: it is the wall that parts them. */
static void test_air(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    make_rooms(&r, false);
    Patches *p = divide(&r, true, 1);
    /* The grid of places has a border at x = 0: the box's least corner is at -1. */
    Patches *q = divide(&r, true, 0.7);
    assert_int_equal(count_across(&r, p), 0);
    assert_true(count_across(&r, q) > 0);
    patches_destroy(p);
    patches_destroy(q);
    room_clear(&r);
}

static void test_walled_at_odd_size(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    make_rooms(&r, true);
    Patches *p = divide(&r, true, 0.7);
    assert_int_equal(count_across(&r, p), 0);
    patches_destroy(p);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wall),
        cmocka_unit_test(test_air),
        cmocka_unit_test(test_walled_at_odd_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
