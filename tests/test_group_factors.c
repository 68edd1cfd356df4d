/* SPDX-License-Identifier: BSD-3-Clause */
/* Factors between groups by the best estimator, against closed forms and integrals done otherwise;
 * what a point sees; what a shaft finds. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "math/sight.h"
#include "radiosity/group_factors.h"
#include "raycast/shaft.h"
#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 }, X = { 1, 0, 0 }, Y = { 0, 1, 0 },
                  Z = { 0, 0, 1 };

/* Opposite and adjacent faces of a cube; a square over a square with one a quarter as large half
 * way between, from a tensor quadrature with exact visibility, to 5e-6. */
static const double OPPOSITE = 0.199824895698387, ADJACENT = 0.200043776075403,
                    OBSTRUCTED = 0.099506294598985;

static GroupFactors *factors_of(TestRoom *r, double accuracy, uint32_t seed, unsigned threads)
{
    Error err = { 0 };
    uint32_t *class = array_create(r->patches->count, sizeof *class, "classes", &err);
    for (uint32_t i = 0; i < r->patches->count; i++)
        class[i] = r->patches->group[i];
    const GroupOptions go = { .count = (uint32_t)r->soup.group_count, .patch_class = class,
                              .accuracy = accuracy, .most_rays = 1 << 22, .seed = seed,
                              .threads = threads };
    GroupFactors *f = group_factors_create(&r->room, &go, NULL, &err);
    assert_non_null(f);
    array_free(class);
    return f;
}

/* Only fronts take part, as in a scene without lamp and camera. */
static void finish_fronts(TestRoom *r, double size)
{
    Error err = { 0 };
    room_finish(r, size, &(SidesOptions){ 0 }, NULL, 0, NULL);
    patches_destroy(r->patches);
    memset(r->sides, 1, r->surfaces->count);
    r->patches = patches_create(r->surfaces, &(PatchOptions){ .size = size, .sides = r->sides },
                                NULL, &err);
    assert_non_null(r->patches);
    r->room.patches = r->patches;
    r->room.sides_given = true;
}

/* --- what a point sees ------------------------------------------------------------------------ */

static ConvexPolygon rectangle(Vec3 o, Vec3 a, Vec3 b)
{
    return (ConvexPolygon){ .count = 4, .corner = { o, vec3_add(o, a),
                                                    vec3_add(vec3_add(o, a), b), vec3_add(o, b) } };
}

static void test_sight(void **state)
{
    (void)state;
    static SightScratch scratch;
    /* Howell's B-3: a rectangle of 1 x 2 at 0.7, above one of its corners. */
    const ConvexPolygon whole = rectangle(vec3(0, 0, 0.7), vec3(0, 2, 0), X);
    const double open = sight_factor(ORIGIN, Z, &whole);
    assert_true(fabs(open - 0.199597720423871) < 1e-14);
    /* Half way up a plate of half the size in each direction covers it all. */
    ConvexPolygon plate = rectangle(vec3(0, 0, 0.35), X, vec3(0, 1, 0));
    plate.corner[1].x = plate.corner[2].x = 0.5;
    assert_true(sight_past(ORIGIN, Z, &whole, &plate, 1, &scratch) < 1e-14);
    /* One of a quarter leaves what is not behind it: the rectangle less the part that is. */
    const ConvexPolygon small = rectangle(vec3(0, 0, 0.35), vec3(0.25, 0, 0), vec3(0, 0.5, 0));
    const ConvexPolygon shade = rectangle(vec3(0, 0, 0.7), vec3(0.5, 0, 0), vec3(0, 1, 0));
    const double left = open - sight_factor(ORIGIN, Z, &shade);
    assert_true(fabs(sight_past(ORIGIN, Z, &whole, &small, 1, &scratch) - left) < 1e-14);
    /* Twice the same blocker, and one beside the way, change nothing. */
    const ConvexPolygon both[] = { small, small,
                                   rectangle(vec3(-1, -1, 0.2), vec3(0.5, 0, 0), Y) };
    assert_true(fabs(sight_past(ORIGIN, Z, &whole, both, 3, &scratch) - left) < 1e-14);
    /* Seen edge on, nothing is hidden. */
    const ConvexPolygon edge = rectangle(vec3(0, 0.5, 0.1), X, vec3(0, 0.5, 0.1));
    assert_true(fabs(sight_past(ORIGIN, Z, &whole, &edge, 1, &scratch) - open) < 1e-14);
}

typedef struct {
    bool *seen;
    int   count;
} Seen;

static bool note(void *user, uint32_t primitive)
{
    Seen *s = user;
    assert_false(s->seen[primitive]);
    s->seen[primitive] = true;
    s->count++;
    return true;
}

static bool stop(void *user, uint32_t primitive)
{
    (void)primitive;
    ++*(int *)user;
    return false;
}

/* A shaft between two boxes of a row finds those between, and none that lies off its planes. */
static void test_shaft(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0.5, 0);
    for (int x = 0; x < 20; x++)
        for (int y = 0; y < 20; y++)
            room_quad(&r, vec3(2 * x, 2 * y, 0), X, Y, m, "tile");
    room_connect(&r);
    bool *seen = calloc(r.surfaces->triangle_count, sizeof *seen);
    Seen all = { .seen = seen };
    /* 3 < x < 9.5, 5.5 < y < 8.5 */
    const Plane planes[] = { { X, 3 }, { vec3(-1, 0, 0), -9.5 }, { Y, 5.5 },
                             { vec3(0, -1, 0), -8.5 } };
    assert_true(bvh_shaft(r.bvh, planes, 4, 0, note, &all));
    assert_int_equal(all.count, 3 * 2 * 2); /* tiles at x = 4 6 8, y = 6 8 */
    for (uint32_t k = 0; k < r.surfaces->triangle_count; k++) {
        double x = 0, y = 0;
        for (int c = 0; c < 3; c++) {
            x += r.surfaces->position[r.surfaces->corner[3 * k + (uint32_t)c]].x / 3;
            y += r.surfaces->position[r.surfaces->corner[3 * k + (uint32_t)c]].y / 3;
        }
        assert_true(seen[k] == (x > 4 && x < 9 && y > 6 && y < 9));
    }
    int visits = 0;
    assert_false(bvh_shaft(r.bvh, planes, 4, 0, stop, &visits));
    assert_int_equal(visits, 1);
    free(seen);
    room_clear(&r);
}

/* --- groups ----------------------------------------------------------------------------------- */

static void test_cube(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    finish_fronts(&r, 0.25);
    GroupFactors *f = factors_of(&r, 1e-3, 0, 2);
    assert_int_equal(f->pairs[GROUP_EXACT], 15);
    assert_int_equal(f->pairs[GROUP_RAYS] + f->pairs[GROUP_CLIPPED], 0);
    for (uint32_t i = 0; i < 6; i++) {
        double row = f->escape[i];
        for (uint32_t j = 0; j < 6; j++) {
            const double exact = i == j ? 0 : i / 2 == j / 2 ? OPPOSITE : ADJACENT;
            assert_true(fabs(group_factor(f, i, j) - exact) < 1e-9);
            assert_true(group_factor_error(f, i, j) <= 2e-8);
            row += group_factor(f, i, j);
        }
        assert_true(fabs(row - 1) < 1e-9 && f->escape[i] == 0);
    }
    group_factors_destroy(f);
    room_clear(&r);
}

/* However the walls are cut into faces, sums of exact pairs are exact. */
static void test_pieces(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t m = room_material(&r, 0.5, 0);
    for (int x = 0; x < 3; x++)
        for (int y = 0; y < 4; y++) {
            room_quad(&r, vec3(x / 3.0, y / 4.0, 0), vec3(1 / 3.0, 0, 0), vec3(0, 0.25, 0), m,
                      "floor");
            room_quad(&r, vec3(0, x / 3.0, y / 4.0), vec3(0, 1 / 3.0, 0), vec3(0, 0, 0.25), m,
                      "wall");
        }
    finish_fronts(&r, 1);
    GroupFactors *f = factors_of(&r, 1e-3, 0, 2);
    /* 1/3 is not a float: positions are welded within some 1e-7 of the size. */
    assert_true(fabs(group_factor(f, 0, 1) - ADJACENT) < 1e-7);
    assert_true(fabs(group_factor(f, 1, 0) - ADJACENT) < 1e-7);
    assert_true(group_factor(f, 0, 0) == 0 && group_factor(f, 1, 1) == 0);
    assert_true(fabs(f->escape[0] - (1 - ADJACENT)) < 1e-7);
    group_factors_destroy(f);
    room_clear(&r);
}

static void plates(TestRoom *r)
{
    const uint32_t m = room_material(r, 0.5, 0);
    room_quad(r, ORIGIN, X, Y, m, "below");
    room_quad(r, Z, Y, X, m, "above");
    room_quad(r, vec3(0.25, 0.25, 0.5), vec3(0.5, 0, 0), vec3(0, 0.5, 0), m, "plate");
    finish_fronts(r, 0.5);
}

/* The plate between hides a half; honest errors: of 40 seeds most are within one, all within four,
 * and each is as small as was asked. */
static void test_obstructed(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    plates(&r);
    int within = 0;
    const int seeds = 40;
    for (uint32_t seed = 0; seed < (uint32_t)seeds; seed++) {
        GroupFactors *f = factors_of(&r, 1e-4, seed, 2);
        assert_int_equal(f->pairs[GROUP_CLIPPED], 1);
        const double error = group_factor_error(f, 0, 1);
        const double off = fabs(group_factor(f, 0, 1) - OBSTRUCTED);
        assert_true(error <= 1e-4 && f->reached <= 1e-4 && off < 4 * error);
        assert_true(group_factor(f, 0, 1) <= OPPOSITE);
        within += off < error;
        group_factors_destroy(f);
    }
    /* 27 of 40 are expected; fewer than 18 or more than 36 in one of some hundred such tests. */
    assert_in_range(within, 18, 36);
    room_clear(&r);
}

/* The same bits for any number of threads. */
static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    plates(&r);
    GroupFactors *a = factors_of(&r, 1e-4, 3, 1), *b = factors_of(&r, 1e-4, 3, 5);
    assert_memory_equal(a->exchange, b->exchange, 9 * sizeof *a->exchange);
    assert_memory_equal(a->error, b->error, 9 * sizeof *a->error);
    assert_memory_equal(a->escape, b->escape, 3 * sizeof *a->escape);
    group_factors_destroy(a);
    group_factors_destroy(b);
    room_clear(&r);
}

/* Curved faces go by rays: a sphere of radius 1 around one of radius a half sees it with a quarter,
 * by reciprocity, and is all that one sees. */
/* A sphere of radius 0.5 in one of radius 1. */
static void two_spheres(TestRoom *r)
{
    Error err = { 0 };
    const uint32_t m = room_material(r, 0.5, 0);
    for (int k = 0; k < 2; k++) {
        uint32_t group = 0;
        const double radius = k == 0 ? 0.5 : 1;
        const Affine map = { vec3(radius, 0, 0), vec3(0, radius, 0), vec3(0, 0, radius), ORIGIN };
        Shape sphere;
        assert_true(shape_init(&sphere, SHAPE_SPHERE, 0, &map, &err));
        assert_true(polygons_add_group(&r->soup, k == 0 ? "inner" : "outer", &group, &err));
        assert_true(polygons_add_shape(&r->soup, &sphere, m, group, &err));
    }
    const Vec3 eye = vec3(0, 0, 0.75);
    room_finish(r, 0.5, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
}

static void test_spheres(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    two_spheres(&r);
    GroupFactors *f = factors_of(&r, 1e-3, 0, 2);
    assert_true(fabs(group_factor(f, 0, 1) - 1) <= 3 * group_factor_error(f, 0, 1) + 1e-6);
    assert_true(fabs(group_factor(f, 1, 0) - 0.25) <= 3 * group_factor_error(f, 1, 0) + 1e-6);
    assert_true(fabs(group_factor(f, 1, 1) - 0.75) <= 3 * group_factor_error(f, 1, 1));
    assert_true(group_factor_error(f, 1, 1) > 0 && f->reached <= 1e-3);
    group_factors_destroy(f);
    room_clear(&r);
}

/* Rays beyond the budget until factors can be trusted, and no further. */
static void test_trusted(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    two_spheres(&r);
    uint64_t rays[2];
    for (int k = 0; k < 2; k++) {
        Error err = { 0 };
        const GroupOptions o = { .count = 2, .patch_class = r.patches->group, .accuracy = 1e-9,
                                 .trusted = k == 0 ? 0 : 3e-5,
                                 .trusted_rays = k == 0 ? 0 : 1 << 23 };
        GroupFactors *f = group_factors_create(&r.room, &o, NULL, &err);
        assert_non_null(f);
        assert_true(fabs(group_factor(f, 1, 1) - 0.75) <= 4 * group_factor_error(f, 1, 1));
        assert_true(k == 0 || f->reached <= 3e-5);
        rays[k] = f->rays;
        group_factors_destroy(f);
    }
    assert_true(rays[1] > rays[0] && rays[1] < 1 << 23);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trusted),
        cmocka_unit_test(test_sight),      cmocka_unit_test(test_shaft),
        cmocka_unit_test(test_cube),       cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_obstructed), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_spheres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
