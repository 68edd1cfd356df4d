/* SPDX-License-Identifier: BSD-3-Clause */
/* Light over links between clusters, against closed forms: furnaces, facing plates, a room that
 * must stay dark; and importance against the light that it stands for. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/clusters.h"
#include "tests/room_maker.h"

/* Rows are closed in single precision, and sweeps end when the power that all further ones would
 * move is below this share of the tolerance, as far as the last two tell. */
static const double ROUNDING = 1e-5, SWEPT = 0.02;

typedef struct {
    OpenPlaces     places;
    double        *emission, *reflectance;
    Solution      *solution;
    ClustersReport report;
} Lit;

static void light(Lit *lit, const TestRoom *r, const double *received,
                  const ClustersOptions *options)
{
    Error err = { 0 };
    *lit = (Lit){ .solution = NULL };
    assert_true(open_places_find(&r->room, 1, options->threads, &lit->places, NULL, &err));
    room_problem(r, &lit->emission, &lit->reflectance);
    const SolveProblem problem = { ROOM_BANDS, lit->emission, lit->reflectance, received };
    lit->solution = clusters_solve(&r->room, &lit->places, &problem, options, &lit->report, NULL,
                                   &err);
    assert_non_null(lit->solution);
    assert_false(error_is_set(&err));
}

static void lit_clear(Lit *lit)
{
    solution_destroy(lit->solution);
    open_places_clear(&lit->places);
    array_free(lit->emission);
    array_free(lit->reflectance);
}

static void build(TestRoom *r, double size, Vec3 eye)
{
    room_finish(r, size, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
}

/* The most by which a patch's irradiance is off, relative. */
static double most_off(const Lit *lit, double exact)
{
    double most = 0;
    for (uint32_t i = 0; i < lit->solution->count; i++)
        most = fmax(most, fabs(lit->solution->irradiance[(size_t)i * ROOM_BANDS] / exact - 1));
    return most;
}

/* All walls emit 1 and reflect rho: H = B = 1 / (1 - rho) everywhere. Rows sum to 1 exactly, so
 * only what sweeps leave is missing. */
static void furnace(double rho, uint32_t gather)
{
    static const double tolerance = 0.01;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t m = room_material(&r, rho, 1);
    room_box(&r, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL, true, m, "");
    build(&r, 0.25, vec3(0.5, 1, 0.75));
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 256, .gather = gather, .sights = gather / 4,
                                              .tolerance = tolerance, .threads = 2 });
    /* A last reflection has noise of its own, where lamps are sampled: that is told. */
    const double left = 2.5 * SWEPT * tolerance + ROUNDING;
    if (gather == 0)
        assert_true(most_off(&lit, 1 / (1 - rho)) < left);
    assert_true(lit.report.escaped[1] <= 0);
    assert_true(lit.report.links > 0 && lit.report.nodes > lit.solution->count);
    double mean = 0, area = 0;
    for (uint32_t i = 0; i < lit.solution->count; i++) {
        area += lit.places.links->area[i];
        mean += lit.places.links->area[i] * lit.solution->irradiance[(size_t)i * ROOM_BANDS];
    }
    assert_true(fabs(mean / area * (1 - rho) - 1) < left);
    lit_clear(&lit);
    room_clear(&r);
}

/* The same box shines outwards too: patches that face each other's way, some of them inside where
 * nothing escapes and some outside where all does, share nodes of the tree. */
static void test_shell(void **state)
{
    (void)state;
    static const double tolerance = 0.01, rho = 0.9;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t m = room_material(&r, rho, 1);
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, m, "in-");
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, false, m, "out-");
    build(&r, 0.1, vec3(0.5, 0.5, 0.5));
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 64, .gather = 64, .sights = 16,
                                              .tolerance = tolerance, .threads = 2 });
    uint32_t inside = 0;
    for (uint32_t i = 0; i < lit.solution->count; i++) {
        const Vec3 c = r.patches->centre[i], n = r.patches->normal[i];
        const bool in = vec3_dot(n, vec3_sub(vec3(0.5, 0.5, 0.5), c)) > 0;
        const double h = lit.solution->irradiance[(size_t)i * ROOM_BANDS];
        inside += in;
        if (in)
            assert_true(fabs(h * (1 - rho) - 1) < tolerance);
        else
            assert_true(h < tolerance / (1 - rho));
    }
    assert_true(inside >= 600 && lit.solution->count >= 2 * inside);
    lit_clear(&lit);
    room_clear(&r);
}

static void test_furnace(void **state)
{
    (void)state;
    furnace(0.5, 0);
    furnace(0.99, 0);
    furnace(0.5, 64);
    furnace(0.9, 64);
}

/* Light that comes from outside alone: H = H0 / (1 - rho). */
static void test_received(void **state)
{
    (void)state;
    Error err = { 0 };
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.6, 0), "");
    build(&r, 0.2, vec3(0.5, 0.5, 0.5));
    const size_t n = (size_t)r.patches->count * ROOM_BANDS;
    double *received = array_create(n, sizeof *received, "test", &err);
    for (size_t k = 0; k < n; k++)
        received[k] = 2;
    light(&lit, &r, received, &(ClustersOptions){ .rays = 256, .gather = 32, .tolerance = 0.01 });
    assert_true(most_off(&lit, 5) < 2.5 * SWEPT * 0.01 * 0.6 / 0.4 + ROUNDING);
    array_free(received);
    lit_clear(&lit);
    room_clear(&r);
}

/* Two unit squares face each other at distance 1: F = 0.199825 [howell]; the lower one emits 1, the
 * upper one is black and gets F. */
static void test_plates(void **state)
{
    (void)state;
    static const double F = 0.19982489569838746;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t lamp = room_material(&r, 0, 1), black = room_material(&r, 0, 0);
    room_quad(&r, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), lamp, "lower");
    room_quad(&r, vec3(0, 0, 1), vec3(0, 1, 0), vec3(1, 0, 0), black, "upper");
    build(&r, 0.1, vec3(0.5, 0.5, 0.5));
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 4096, .tolerance = 0.002 });
    double got = 0;
    for (uint32_t i = 0; i < lit.solution->count; i++)
        got += lit.places.links->area[i] * lit.solution->irradiance[(size_t)i * ROOM_BANDS];
    /* Rows are closed against escapes that few rays tell: to some 1/sqrt(rays of all patches). */
    const double told = 1 / sqrt((double)lit.places.links->rays);
    assert_true(fabs(got / F - 1) < 5 * (lit.report.error + told));
    lit_clear(&lit);
    room_clear(&r);
}

/* A room with a lamp and a wall that hides part of it: two rooms beside each other. */
static void two_rooms(TestRoom *r)
{
    const uint32_t white = room_material(r, 0.8, 0), lamp = room_material(r, 0.8, 1);
    room_box(r, vec3(0, 0, 0), vec3(3, 3, 3), BOX_ALL & ~BOX_Z1, true, white, "");
    room_quad(r, vec3(1.3, 0, 3), vec3(0, 3, 0), vec3(1.7, 0, 0), lamp, "lamp");
    room_quad(r, vec3(0, 0, 3), vec3(0, 3, 0), vec3(1.3, 0, 0), white, "ceiling");
    room_quad(r, vec3(1.3, 0, 0), vec3(0, 1.5, 0), vec3(0, 0, 3), white, "wall");
    build(r, 0.25, vec3(0.5, 1.5, 1.5));
}

/* What the camera receives is the same by the light that comes to it as by the importance that
 * comes to lamps. The transposed way shares the links but not a sum. */
static void test_adjoint(void **state)
{
    (void)state;
    Error err = { 0 };
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    two_rooms(&r);
    double *seen = array_create(r.patches->count, sizeof *seen, "test", &err);
    for (uint32_t i = 0; i < r.patches->count; i++)
        seen[i] = r.patches->centre[i].x < 1 && r.patches->normal[i].x > 0.5 ? 0.01 : 0;
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 512, .tolerance = 1e-5, .seen = seen });
    /* Sweeps end at SWEPT of the tolerance; 0.8 is reflected, five times as much is missing. */
    for (unsigned b = 0; b < ROOM_BANDS; b++) {
        assert_true(lit.report.response[b] > 0);
        assert_true(fabs(lit.report.adjoint[b] / lit.report.response[b] - 1) < ROUNDING);
    }
    array_free(seen);
    lit_clear(&lit);
    room_clear(&r);
}

/* Root mean square over seen patches of the difference in irradiance. */
static double off_where_seen(const Lit *lit, const Lit *exact, const double *seen)
{
    double sum = 0, mean = 0, area = 0;
    for (uint32_t i = 0; i < lit->solution->count; i++) {
        if (!(seen[i] > 0))
            continue;
        const double a = lit->places.links->area[i];
        const double h = exact->solution->irradiance[(size_t)i * ROOM_BANDS];
        const double off = lit->solution->irradiance[(size_t)i * ROOM_BANDS] - h;
        sum += a * off * off;
        mean += a * h;
        area += a;
    }
    return sqrt(sum * area) / mean;
}

/* With no more links, what is seen comes out better by importance: against many more rays. */
static void test_importance(void **state)
{
    (void)state;
    Error err = { 0 };
    TestRoom r = { .surfaces = NULL };
    Lit plain, guided, exact;
    two_rooms(&r);
    double *seen = array_create(r.patches->count, sizeof *seen, "test", &err);
    for (uint32_t i = 0; i < r.patches->count; i++)
        seen[i] = r.patches->centre[i].x < 0.1 && r.patches->normal[i].x > 0.5 ? 0.01 : 0;
    light(&plain, &r, NULL, &(ClustersOptions){ .rays = 64, .tolerance = 1e-4 });
    light(&guided, &r, NULL, &(ClustersOptions){ .rays = 32, .tolerance = 1e-4, .seen = seen });
    light(&exact, &r, NULL, &(ClustersOptions){ .rays = 2048, .tolerance = 1e-4 });
    const double with = off_where_seen(&guided, &exact, seen);
    const double without = off_where_seen(&plain, &exact, seen);
    print_message("  seen patches off by %.2f %% with importance, %llu links; %.2f %% without, "
                  "%llu links\n", 100 * with, (unsigned long long)guided.report.links,
                  100 * without, (unsigned long long)plain.report.links);
    assert_true(plain.report.links >= guided.report.links);
    assert_true(with < without);
    array_free(seen);
    lit_clear(&plain);
    lit_clear(&guided);
    lit_clear(&exact);
    room_clear(&r);
}

/* Any number of threads: the same bytes. */
static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit one, three;
    two_rooms(&r);
    light(&one, &r, NULL, &(ClustersOptions){ .rays = 64, .gather = 16, .threads = 1 });
    light(&three, &r, NULL, &(ClustersOptions){ .rays = 64, .gather = 16, .threads = 3 });
    assert_int_equal(one.report.rays, three.report.rays);
    assert_int_equal(one.report.links, three.report.links);
    assert_memory_equal(one.solution->irradiance, three.solution->irradiance,
                        sizeof(double) * ROOM_BANDS * one.solution->count);
    lit_clear(&one);
    lit_clear(&three);
    room_clear(&r);
}

static void test_darkness(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 0), "");
    build(&r, 0.25, vec3(0.5, 0.5, 0.5));
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 64, .gather = 8 });
    assert_true(lit.solution->converged);
    for (size_t k = 0; k < (size_t)lit.solution->count * ROOM_BANDS; k++)
        assert_true(lit.solution->irradiance[k] >= 0 && lit.solution->irradiance[k] <= 0);
    lit_clear(&lit);
    room_clear(&r);
}

/* Few links are allowed: it ends, says so, and is usable. */
static void test_full(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    two_rooms(&r);
    light(&lit, &r, NULL, &(ClustersOptions){ .rays = 4096, .tolerance = 1e-5, .memory = 1 << 20 });
    assert_true(lit.report.full);
    assert_false(lit.solution->converged);
    for (size_t k = 0; k < (size_t)lit.solution->count * ROOM_BANDS; k++)
        assert_true(isfinite(lit.solution->irradiance[k]) && lit.solution->irradiance[k] >= 0);
    lit_clear(&lit);
    room_clear(&r);
}

static void test_memory(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 1), "");
    build(&r, 0.5, vec3(0.5, 0.5, 0.5));
    bool done = false;
    Error err = { 0 };
    double *emission, *reflectance;
    OpenPlaces places;
    room_problem(&r, &emission, &reflectance);
    assert_true(open_places_find(&r.room, 1, 1, &places, NULL, &err));
    const SolveProblem problem = { ROOM_BANDS, emission, reflectance, NULL };
    for (long k = 0; !done; k++) {
        ClustersReport report;
        const ClustersOptions options = { .rays = 64, .gather = 8, .threads = 1 };
        const long live = array_live();
        err = (Error){ 0 };
        array_fail_after(k);
        Solution *s = clusters_solve(&r.room, &places, &problem, &options, &report, NULL, &err);
        array_fail_after(-1);
        done = s != NULL;
        solution_destroy(s);
        assert_true(done || err.code == ERROR_MEMORY);
        assert_int_equal(array_live(), live);
    }
    open_places_clear(&places);
    array_free(emission);
    array_free(reflectance);
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_furnace),
        cmocka_unit_test(test_shell),
        cmocka_unit_test(test_received),
        cmocka_unit_test(test_plates),
        cmocka_unit_test(test_adjoint),
        cmocka_unit_test(test_importance),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_darkness),
        cmocka_unit_test(test_full),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
