/* SPDX-License-Identifier: BSD-3-Clause */
/* Light between nodes of a tree over the patches, against enclosures with exact answers. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 };

/* Factors are floats, 2^-24 relative each, and what they are off by comes back 1 / (1 - rho) times;
 * rows of closed links hold to 1e-7 as well. */
static const double FLOAT_FACTORS = 1e-6;

static Solution *solve_nodes(const TestRoom *r, const Links *links, unsigned threads)
{
    Error err = { 0 };
    double *emission, *reflectance;
    room_problem(r, &emission, &reflectance);
    const SolveProblem p = { .bands = ROOM_BANDS, .emission = emission,
                             .reflectance = reflectance };
    const SolveOptions o = { .solver = SOLVER_HIERARCHICAL, .tolerance = 1e-8,
                             .centre = r->patches->centre, .normal = r->patches->normal,
                             .threads = threads };
    Solution *s = solve(links, &p, &o, NULL, &err);
    assert_non_null(s);
    assert_true(s->converged);
    array_free(emission);
    array_free(reflectance);
    return s;
}

/* --- a sphere: each patch sees every other by its share of the area --------------------------- */

enum { SPHERE = 24 };

typedef struct {
    Links    links;
    uint64_t first[SPHERE + 1];
    uint32_t source[SPHERE * SPHERE];
    float    form_factor[SPHERE * SPHERE], escape[SPHERE];
    double   area[SPHERE], total;
    Vec3     centre[SPHERE], normal[SPHERE];
} Sphere;

static void make_sphere(Sphere *s)
{
    *s = (Sphere){ .links = { .count = SPHERE } };
    for (uint32_t i = 0; i < SPHERE; i++) {
        const double z = 1 - (2.0 * i + 1) / SPHERE, angle = 2.4 * i, q = sqrt(1 - z * z);
        s->centre[i] = vec3(q * cos(angle), q * sin(angle), z);
        s->normal[i] = vec3_scale(s->centre[i], -1);
        s->area[i] = 1 + i % 5;
        s->total += s->area[i];
    }
    for (uint32_t k = 0; k < SPHERE * SPHERE; k++) {
        s->source[k] = k % SPHERE;
        s->form_factor[k] = (float)(s->area[k % SPHERE] / s->total);
        s->first[k / SPHERE + 1] = k + 1;
    }
    s->links.first = s->first;
    s->links.source = s->source;
    s->links.form_factor = s->form_factor;
    s->links.escape = s->escape;
    s->links.area = s->area;
    assert_true(links_check(&s->links));
}

/* B = E + rho H, H = sum A E / (A (1 - rho)) everywhere, whatever nodes the light goes between. */
static void test_sphere(void **state)
{
    (void)state;
    static const double rho[2] = { 0.3, 0.99 };
    double emission[SPHERE * 2], reflectance[SPHERE * 2], power[2] = { 0, 0 };
    Sphere s;
    make_sphere(&s);
    for (uint32_t k = 0; k < SPHERE * 2; k++) {
        emission[k] = k / 2 % 7 == 3 ? 1 + k % 2 : 0;
        reflectance[k] = rho[k % 2];
        power[k % 2] += s.area[k / 2] * emission[k];
    }
    Error err = { 0 };
    const SolveProblem p = { .bands = 2, .emission = emission, .reflectance = reflectance };
    const SolveOptions o = { .solver = SOLVER_HIERARCHICAL, .tolerance = 1e-12,
                             .centre = s.centre, .normal = s.normal };
    Solution *got = solve(&s.links, &p, &o, NULL, &err);
    assert_non_null(got);
    for (uint32_t k = 0; k < SPHERE * 2; k++) {
        const double h = power[k % 2] / (s.total * (1 - rho[k % 2]));
        assert_true(fabs(got->irradiance[k] / h - 1) < FLOAT_FACTORS / (1 - rho[k % 2]));
        assert_true(fabs(got->radiosity[k] - emission[k] - rho[k % 2] * h) <
                    h * FLOAT_FACTORS / (1 - rho[k % 2]));
    }
    solution_destroy(got);
}

static void test_memory(void **state)
{
    (void)state;
    double emission[SPHERE], reflectance[SPHERE];
    Sphere s;
    make_sphere(&s);
    for (uint32_t k = 0; k < SPHERE; k++) {
        emission[k] = k == 0;
        reflectance[k] = 0.5;
    }
    const SolveProblem p = { .bands = 1, .emission = emission, .reflectance = reflectance };
    const SolveOptions o = { .solver = SOLVER_HIERARCHICAL, .centre = s.centre,
                             .normal = s.normal };
    const long before = array_live();
    bool done = false;
    for (long n = 0; !done; n++) {
        Error err = { 0 };
        array_fail_after(n);
        Solution *got = solve(&s.links, &p, &o, NULL, &err);
        array_fail_after(-1);
        done = got != NULL;
        assert_true(done || err.code == ERROR_MEMORY);
        solution_destroy(got);
        assert_int_equal(array_live(), before);
        assert_true(n < 1000);
    }
}

/* --- rooms ------------------------------------------------------------------------------------ */

/* All faces E = 1, rho = 0.5: B = 2 on every patch. Once as lamps, that patches sample themselves;
 * once as if they were not, with rows as cast, 11 % off: nodes' rows are made whole. */
static void test_furnace(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 1), "");
    room_finish(&r, 0.1, &(SidesOptions){ 0 }, NULL, 0, NULL);
    for (int k = 0; k < 2; k++) {
        Links *links = room_links(&r, 16, k == 0 ? CLOSURE_BOTH : CLOSURE_NONE);
        for (uint32_t i = 0; k == 1 && i < links->count; i++)
            links->lamp[i] = 0;
        Solution *s = solve_nodes(&r, links, 1);
        for (size_t i = 0; i < (size_t)ROOM_BANDS * links->count; i++)
            assert_true(fabs(s->radiosity[i] - 2) < 2 * FLOAT_FACTORS);
        solution_destroy(s);
        links_destroy(links);
    }
    room_clear(&r);
}

static double face_mean(const TestRoom *r, const Links *links, const Solution *s,
                        const char *group)
{
    const uint32_t g = room_group(r, group);
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < links->count; i++)
        if (r->patches->group[i] == g) {
            sum += links->area[i] * s->radiosity[ROOM_BANDS * (size_t)i];
            area += links->area[i];
        }
    return sum / area;
}

/* Unit cube, the ceiling emits 1, reflectance 0.5: means of the continuous radiosity equation, by
 * an integral equation solver, good to 1e-8. Rays and patches put 1.3e-3 on them with any solver
 * (test_links.c). A link that stays whole carries less than 2 % of a patch's mean light, and takes
 * its source for even: where that is twice as bright at one end as at the other, half of the link
 * may be wrong: 1e-2. The same bytes from one thread and three. */
static void test_cube(void **state)
{
    (void)state;
    static const double TOLERANCE = 1.3e-3 + 1e-2;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.5, 0);
    room_box(&r, ORIGIN, UNIT, BOX_ALL - BOX_Z1, true, wall, "");
    room_box(&r, ORIGIN, UNIT, BOX_Z1, true, room_material(&r, 0.5, 1), "");
    room_finish(&r, 0.05, &(SidesOptions){ 0 }, NULL, 0, NULL);
    Links *links = room_links(&r, 256, CLOSURE_BOTH);
    Solution *s = solve_nodes(&r, links, 1), *other = solve_nodes(&r, links, 3);
    assert_true(fabs(face_mean(&r, links, s, "z0") / 0.1712160573 - 1) < TOLERANCE);
    assert_true(fabs(face_mean(&r, links, s, "x1") / 0.1811055969 - 1) < TOLERANCE);
    assert_true(fabs(face_mean(&r, links, s, "z1") / 1.104361555 - 1) < TOLERANCE);
    const size_t bytes = (size_t)ROOM_BANDS * links->count * sizeof(double);
    assert_memory_equal(s->irradiance, other->irradiance, bytes);
    assert_memory_equal(s->radiosity, other->radiosity, bytes);
    solution_destroy(other);
    solution_destroy(s);
    links_destroy(links);
    room_clear(&r);
}

/* A closed box with a lamp in it, its walls a hair thick, floating in a room: none of the light
 * gets out, though patches inside and out lie close to each other and face the same way. */
static void test_dark(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const uint32_t wall = room_material(&r, 0.7, 0);
    const Vec3 lo = { 0.3, 0.3, 0.3 }, hi = { 0.7, 0.7, 0.7 }, d = { 1e-3, 1e-3, 1e-3 };
    const Vec3 eye = { 0.1, 0.1, 0.1 };
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, wall, "room-");
    room_box(&r, lo, hi, BOX_ALL, false, wall, "out-");
    room_box(&r, vec3_add(lo, d), vec3_sub(hi, d), BOX_ALL, true, wall, "in-");
    room_quad(&r, vec3(0.45, 0.45, 0.6), vec3(0, 0.1, 0), vec3(0.1, 0, 0),
              room_material(&r, 0.7, 100), "lamp");
    room_finish(&r, 0.1, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    Links *links = room_links(&r, 16, CLOSURE_BOTH);
    Solution *s = solve_nodes(&r, links, 2);
    uint32_t dark = 0, lit = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        const char *group = r.soup.group_name[r.patches->group[i]];
        const bool out = strncmp(group, "room-", 5) == 0 || strncmp(group, "out-", 4) == 0;
        const double light = s->irradiance[ROOM_BANDS * (size_t)i];
        dark += out;
        lit += !out && light > 0;
        assert_true(!out || light == 0);
    }
    assert_true(dark >= 600 && lit >= 6 * 16);
    solution_destroy(s);
    links_destroy(links);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere), cmocka_unit_test(test_memory),
        cmocka_unit_test(test_furnace), cmocka_unit_test(test_cube), cmocka_unit_test(test_dark),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
