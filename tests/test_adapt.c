/* SPDX-License-Identifier: BSD-3-Clause */
/* What patches leave out of the light on them, against shadows with known edges; which are
 * divided. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "radiosity/adapt_internal.h"
#include "tests/room_maker.h"

/* Far above: H = I / z^2 = 1 on all of the floor to 1e-7, and shadows fall straight down. */
static const Light SUN = { .kind = LIGHT_POINT, .position = { 2, 2, 1e4 },
                           .intensity = { 1e8, 1e8, 1e8 } };

/* Errors of a room lit by point lights or lamps, by its own links and solution. */
static double *errors_of(const TestRoom *r, const AdaptOptions *options)
{
    Error err = { 0 };
    double *emission, *reflectance;
    Direct direct;
    Links *links = room_links(r, 256, CLOSURE_ROWS);
    double *error = array_create(r->patches->count, sizeof *error, "errors", &err);
    room_problem(r, &emission, &reflectance);
    assert_true(direct_create(&r->room, links, &(DirectOptions){ 0 }, &direct, NULL, &err));
    const SolveProblem p = { .bands = ROOM_BANDS, .emission = emission,
                             .reflectance = reflectance, .received = direct.irradiance };
    Solution *s = solve(links, &p, &(SolveOptions){ 0 }, NULL, &err);
    assert_non_null(s);
    assert_true(adapt_errors(&r->room, links, s->irradiance, options, error, NULL, &err));
    solution_destroy(s);
    links_destroy(links);
    array_free(direct.irradiance);
    array_free(emission);
    array_free(reflectance);
    return error;
}

/* A black floor of 6 x 4 patches under the sun, a plate over it up to x = 2.5. */
static void half_shaded_floor(TestRoom *r)
{
    const uint32_t black = room_material(r, 0, 0);
    room_quad(r, vec3(0, 0, 0), vec3(6, 0, 0), vec3(0, 4, 0), black, "floor");
    room_quad(r, vec3(-1, -1, 1), vec3(3.5, 0, 0), vec3(0, 6, 0), black, "plate");
    room_finish(r, 1, &(SidesOptions){ 0 }, &SUN, 1, NULL);
}

/* The light 1 | 1/2 | 0 of three columns of patches becomes 3/4 and 1/4 at the vertices between
 * them, and as the lit column has lost 1/8 of its mean by that and gets it back half here, half at
 * its other side (where vertices may not pass the 1 around them), 13/16 and 3/16. Across the middle
 * column that is 13/16 - 5/8 x for a step at x = 1/2: the square of the error is (3/16 + 5/8 x)^2
 * up to there, (1/8 - 27/4096) 16/15 in the mean; beside it (1 - x)^2 9/256, in the mean 3/256.
 * Sixteen points, one in each row and column, miss a mean by less than what the integrand changes
 * across a column of strata, in the mean of the columns. */
static void test_shadow_edge(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    half_shaded_floor(&r);
    double *error = errors_of(&r, &(AdaptOptions){ 0 });
    int middle = 0, beside = 0, far = 0;
    for (uint32_t i = 0; i < r.patches->count; i++) {
        const double x = r.patches->centre[i].x, square = error[i] * error[i];
        if (r.patches->group[i] != room_group(&r, "floor") || r.patches->side[i] != 0)
            continue;
        if (x > 2 && x < 3) {
            assert_true(fabs(square - (1.0 / 8 - 27.0 / 4096) * 16 / 15) < (64 - 9) / 512.0);
            middle++;
        } else if (x > 3 && x < 4) {
            assert_true(fabs(square - 3.0 / 256) < 9.0 / 1024);
            beside++;
        } else if (x > 5) {
            assert_true(square < 1e-10);
            far++;
        }
    }
    assert_int_equal(middle, 4);
    assert_int_equal(beside, 4);
    assert_int_equal(far, 4);
    array_free(error);
    room_clear(&r);
}

/* A low box stands on the evenly lit floor: what it hides of patches is no shadow. */
static void test_hidden_part(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t black = room_material(&r, 0, 0);
    room_quad(&r, vec3(0, 0, 0), vec3(4, 0, 0), vec3(0, 4, 0), black, "floor");
    room_box(&r, vec3(0.7, 0.7, 0), vec3(2.6, 2.6, 0.5), BOX_ALL - BOX_Z0, false, black, "box-");
    room_finish(&r, 1, &(SidesOptions){ 0 }, &SUN, 1, NULL);
    double *error = errors_of(&r, &(AdaptOptions){ 0 });
    int floor = 0;
    for (uint32_t i = 0; i < r.patches->count; i++)
        if (r.patches->group[i] == room_group(&r, "floor")) {
            /* The sun is not quite straight above: shadows of 0.5e-4 at most. */
            assert_true(error[i] < 1e-3);
            floor++;
        }
    assert_int_equal(floor, 16);
    array_free(error);
    room_clear(&r);
}

/* A furnace, all walls alike: the light is 2 everywhere, and no error is seen in it beyond what
 * chance can do to a row of 256 rays. */
static void test_furnace(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 1), "");
    room_finish(&r, 0.25, &(SidesOptions){ 0 }, NULL, 0, NULL);
    double *error = errors_of(&r, &(AdaptOptions){ 0 });
    double squares = 0;
    for (uint32_t i = 0; i < r.patches->count; i++)
        squares += error[i] * error[i] / r.patches->count;
    assert_true(sqrt(squares) < 2 / sqrt(256.0));
    array_free(error);
    room_clear(&r);
}

/* What a point sees of a rectangle x * y at height 1 over one of its corners. */
static double corner_factor(double x, double y)
{
    const double a = sqrt(1 + x * x), b = sqrt(1 + y * y);
    return (x / a * atan(y / a) + y / b * atan(x / b)) / (2 * M_PI);
}

/* A source of 2 x 2 at height 1, its light 1 + x: seen whole from below its middle, where it is 2
 * by symmetry; at the corner x = y = 0 the four pieces count with 1.5 and 2.5; from above, not at
 * all. A wall's horizon cuts half of it away. */
static void test_pieces(void **state)
{
    (void)state;
    enum { N = 4 };
    TestRoom r = { 0 };
    AdaptPiece piece[ADAPT_PIECES];
    float kernel[N] = { 0 }, lit[N] = { 0 };
    PatchPoint at[N] = { 0 };
    const uint32_t black = room_material(&r, 0, 0);
    room_quad(&r, vec3(0, 0, 1), vec3(0, 2, 0), vec3(2, 0, 0), black, "source");
    room_finish(&r, 2, &(SidesOptions){ 0 }, NULL, 0, NULL);
    assert_int_equal(r.patches->count, 2);
    assert_int_equal(r.patches->vertex_count, 8);
    double vertex[8];
    for (uint32_t v = 0; v < 8; v++)
        vertex[v] = 1 + r.patches->position[v].x;
    adapt_pieces(&r.room, vertex, r.patches->side[0] == 0 ? 0 : 1, piece);
    at[0].point = (SurfacePoint){ .point = { 1, 1, 0 }, .normal = { 0, 0, 1 } };
    at[1].point = (SurfacePoint){ .point = { 0, 0, 0 }, .normal = { 0, 0, 1 } };
    at[2].point = (SurfacePoint){ .point = { 1, 1, 2 }, .normal = { 0, 0, -1 } };
    at[3].point = (SurfacePoint){ .point = { 1, 1, 1 - 1e-9 }, .normal = { 1, 0, 0 } };
    adapt_pieces_seen(piece, at, N, kernel, lit);
    const double whole = corner_factor(2, 2), near = corner_factor(1, 2);
    assert_float_equal(kernel[0], 4 * corner_factor(1, 1), FLT_EPSILON);
    assert_float_equal(lit[0], 2 * 4 * corner_factor(1, 1), 2 * FLT_EPSILON);
    assert_float_equal(kernel[1], whole, FLT_EPSILON);
    assert_float_equal(lit[1], 1.5 * near + 2.5 * (whole - near), 2 * FLT_EPSILON);
    assert_true(kernel[2] == 0 && lit[2] == 0);
    /* In the plane of the source's own edge half the hemisphere is filled. */
    assert_float_equal(kernel[3], 0.5, 1e-6);
    room_clear(&r);
}

static void test_choose(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error err = { 0 };
    half_shaded_floor(&r);
    const uint32_t count = r.patches->count;
    double *error = errors_of(&r, &(AdaptOptions){ 0 });
    uint8_t *split = array_create(count, 1, "marks", &err);
    uint32_t chosen = 0;
    assert_true(adapt_choose(&r.room, error, count + 12, 0, split, &chosen, &err));
    assert_int_equal(chosen, 4);
    for (uint32_t i = 0; i < count; i++) {
        const double x = r.patches->centre[i].x;
        const bool floor = r.patches->group[i] == room_group(&r, "floor");
        assert_int_equal(split[i], floor && r.patches->side[i] == 0 && x > 2 && x < 3);
    }
    /* However many are wanted, none of little worth: twice the mean is more than all but those. */
    assert_true(adapt_choose(&r.room, error, 1000 * count, 2, split, &chosen, &err));
    assert_int_equal(chosen, 4);
    /* No room for the parts of even one. */
    assert_true(adapt_choose(&r.room, error, count + 2, 0, split, &chosen, &err));
    assert_int_equal(chosen, 0);
    array_free(error);
    error = errors_of(&r, &(AdaptOptions){ .least_size = 0.6 });
    for (uint32_t i = 0; i < count; i++)
        assert_true(error[i] == 0);
    array_free(split);
    array_free(error);
    room_clear(&r);
}

/* Same bytes for any number of threads. */
static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.7, 0);
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, wall, "");
    room_box(&r, vec3(0.2, 0.3, 0), vec3(0.6, 0.6, 0.4), BOX_ALL, false, wall, "box-");
    room_quad(&r, vec3(0.4, 0.4, 0.95), vec3(0, 0.2, 0), vec3(0.2, 0, 0),
              room_material(&r, 0, 20), "lamp");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
    double *one = errors_of(&r, &(AdaptOptions){ .threads = 1 });
    double *three = errors_of(&r, &(AdaptOptions){ .threads = 3 });
    assert_memory_equal(one, three, r.patches->count * sizeof *one);
    array_free(one);
    array_free(three);
    room_clear(&r);
}

static void test_memory(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    Error none = { 0 };
    half_shaded_floor(&r);
    Links *links = room_links(&r, 64, CLOSURE_NONE);
    const size_t count = r.patches->count;
    double *light = array_create(ROOM_BANDS * count, sizeof *light, "light", &none);
    double *error = array_create(count, sizeof *error, "errors", &none);
    uint8_t *split = array_create(count, 1, "marks", &none);
    const long live = array_live();
    for (long n = 0;; n++) {
        Error err = { 0 };
        uint32_t chosen;
        array_fail_after(n);
        const bool done = adapt_errors(&r.room, links, light, &(AdaptOptions){ .threads = 2 },
                                       error, NULL, &err) &&
                          adapt_choose(&r.room, error, 100, 0, split, &chosen, &err);
        array_fail_after(-1);
        assert_int_equal(array_live(), live);
        assert_int_equal(done, !error_is_set(&err));
        if (done)
            break;
        assert_int_equal(err.code, ERROR_MEMORY);
    }
    array_free(light);
    array_free(error);
    array_free(split);
    links_destroy(links);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shadow_edge), cmocka_unit_test(test_hidden_part),
        cmocka_unit_test(test_furnace),     cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_choose),      cmocka_unit_test(test_threads),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
