/* SPDX-License-Identifier: BSD-3-Clause */
/* Light without links, against closed forms: furnaces, a sphere, facing plates, rooms that must
 * stay dark. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/stochastic.h"
#include "tests/room_maker.h"

/* Noise beyond this many standard errors happens once in 10^6 runs; seeds are fixed. */
static const double SIGMAS = 5;

typedef struct {
    OpenPlaces       places;
    double          *emission, *reflectance;
    Solution        *solution;
    StochasticReport report;
} Lit;

static void light(Lit *lit, const TestRoom *r, const double *received,
                  const StochasticOptions *options)
{
    Error err = { 0 };
    *lit = (Lit){ .solution = NULL };
    assert_true(open_places_find(&r->room, 1, options->threads, &lit->places, NULL, &err));
    assert_true(links_check(lit->places.links));
    room_problem(r, &lit->emission, &lit->reflectance);
    const SolveProblem problem = { ROOM_BANDS, lit->emission, lit->reflectance, received };
    lit->solution = stochastic_solve(&r->room, &lit->places, &problem, options, &lit->report,
                                     NULL, &err);
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

/* Patches no larger than size of all that the emitting sides and an eye see. */
static void build(TestRoom *r, double size, Vec3 eye)
{
    room_finish(r, size, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
}

/* Area, and root mean square over it of irradiance's difference from `exact`, over `exact`. */
static double off_from(const Lit *lit, double exact)
{
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < lit->solution->count; i++) {
        const double off = lit->solution->irradiance[(size_t)i * ROOM_BANDS] / exact - 1;
        sum += lit->places.links->area[i] * off * off;
        area += lit->places.links->area[i];
    }
    return sqrt(sum / area);
}

/* Emitted less absorbed and escaped, relative. */
static double imbalance(const Lit *lit, const double *received)
{
    double emitted = 0, gone = lit->report.escaped[1];
    for (uint32_t i = 0; i < lit->solution->count; i++) {
        const size_t at = (size_t)i * ROOM_BANDS + 1;
        const double area = lit->places.links->area[i];
        emitted += area * (lit->emission[at] + (received != NULL ? received[at] : 0));
        gone += area * (1 - lit->reflectance[at]) * lit->solution->irradiance[at];
    }
    return fabs(emitted - gone) / emitted;
}

/* What sums of some 10^7 shares of power lose by rounding, and what is left unshot. */
static const double SUMS = 1e-7;

/* All walls emit 1 and reflect rho: H = B = 1 / (1 - rho) everywhere. */
static void furnace(double rho, uint32_t rays)
{
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t m = room_material(&r, rho, 1);
    room_box(&r, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL, true, m, "");
    build(&r, 0.25, vec3(0.5, 1, 0.75));
    light(&lit, &r, NULL, &(StochasticOptions){ .rays = rays, .seed = 3, .threads = 2 });
    assert_true(off_from(&lit, 1 / (1 - rho)) < SIGMAS * lit.report.error);
    assert_true(lit.report.error < 0.1);
    assert_true(imbalance(&lit, NULL) < SUMS);
    assert_true(lit.report.escaped[0] <= 0);
    lit_clear(&lit);
    room_clear(&r);
}

static void test_furnace(void **state)
{
    (void)state;
    furnace(0.5, 1024);
    furnace(0.9, 2048);
    furnace(0.99, 4096);
}

/* Light that comes from outside alone: H = H0 + rho H, H = H0 / (1 - rho). */
static void test_received(void **state)
{
    (void)state;
    Error err = { 0 };
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t m = room_material(&r, 0.6, 0);
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, m, "");
    build(&r, 0.2, vec3(0.5, 0.5, 0.5));
    const size_t n = (size_t)r.patches->count * ROOM_BANDS;
    double *received = array_create(n, sizeof *received, "test", &err);
    for (size_t k = 0; k < n; k++)
        received[k] = 2;
    light(&lit, &r, received, &(StochasticOptions){ .rays = 1024, .seed = 5 });
    assert_true(off_from(&lit, 5) < SIGMAS * lit.report.error);
    assert_true(imbalance(&lit, received) < SUMS);
    array_free(received);
    lit_clear(&lit);
    room_clear(&r);
}

/* Two unit squares face each other at distance 1: F = 0.199825 [howell]; black, the lower one emits
 * 1. What the upper one gets is F, the rest escapes. */
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
    light(&lit, &r, NULL, &(StochasticOptions){ .rays = 4096, .tolerance = 0.001 });
    double got = 0;
    for (uint32_t i = 0; i < lit.solution->count; i++)
        got += lit.places.links->area[i] * lit.solution->irradiance[(size_t)i * ROOM_BANDS];
    /* What arrives was made to be what does not escape, and that is known by shots: their standard
     * error, were they random. */
    const double shots = 4096.0 * lit.solution->iterations;
    assert_true(fabs(got - F) < SIGMAS * sqrt(F * (1 - F) / shots));
    assert_true(imbalance(&lit, NULL) < SUMS);
    lit_clear(&lit);
    room_clear(&r);
}

/* Two rooms with a wall without thickness between: no light comes into the dark one. */
static void test_leaks(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    const uint32_t white = room_material(&r, 0.8, 0), lamp = room_material(&r, 0.8, 1);
    room_box(&r, vec3(0, 0, 0), vec3(1.3, 3, 3), BOX_ALL & ~BOX_X1, true, white, "dark-");
    room_box(&r, vec3(1.3, 0, 0), vec3(3, 3, 3), BOX_ALL & ~(BOX_Z1 | BOX_X0), true, white, "");
    room_quad(&r, vec3(1.3, 0, 3), vec3(0, 3, 0), vec3(1.7, 0, 0), lamp, "lamp");
    room_quad(&r, vec3(1.3, 0, 0), vec3(0, 3, 0), vec3(0, 0, 3), white, "wall");
    build(&r, 0.12, vec3(0.5, 1.5, 1.5)); /* in the dark one, so that it takes part */
    light(&lit, &r, NULL, &(StochasticOptions){ .rays = 512, .seed = 2, .threads = 2 });
    uint32_t dark = 0, lit_ones = 0;
    for (uint32_t i = 0; i < lit.solution->count; i++) {
        const Vec3 c = r.patches->centre[i];
        const Vec3 n = r.patches->normal[i];
        const double got = lit.solution->irradiance[(size_t)i * ROOM_BANDS];
        if (vec3_mad(c, 0.01, n).x < 1.3) {
            assert_true(got <= 0);
            dark++;
        } else {
            lit_ones += got > 0;
        }
    }
    assert_true(dark > 500 && lit_ones > 500);
    lit_clear(&lit);
    room_clear(&r);
}

/* Any number of threads: the same bytes. */
static void test_threads(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit one, three;
    const uint32_t m = room_material(&r, 0.7, 1), white = room_material(&r, 0.5, 0);
    room_box(&r, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL & ~BOX_Z0, true, white, "");
    room_quad(&r, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 2, 0), m, "floor");
    build(&r, 0.06, vec3(0.5, 1, 0.75));
    light(&one, &r, NULL, &(StochasticOptions){ .rays = 64, .threads = 1 });
    light(&three, &r, NULL, &(StochasticOptions){ .rays = 64, .threads = 3 });
    assert_int_equal(one.report.rays, three.report.rays);
    assert_memory_equal(one.solution->irradiance, three.solution->irradiance,
                        sizeof(double) * ROOM_BANDS * one.solution->count);
    assert_memory_equal(one.places.open, three.places.open, sizeof(uint64_t) * r.patches->count);
    lit_clear(&one);
    lit_clear(&three);
    room_clear(&r);
}

typedef struct {
    int    left;      /* times that progress is told before the run is to stop */
    bool   stop;
} Break;

static void count_down(void *user, const Progress *progress)
{
    Break *at = user;
    assert_true(progress->done >= 0 && progress->done <= 1);
    at->stop = at->stop || --at->left <= 0;
}

static bool must_stop(void *user)
{
    return ((const Break *)user)->stop;
}

/* Broken off at several moments, its state taken as bytes, and taken up by another run. */
static void test_kept(void **state)
{
    (void)state;
    enum { BREAKS = 8 };
    TestRoom r = { .surfaces = NULL };
    Lit whole;
    Error err = { 0 };
    size_t size;
    uint32_t rounds = 0;
    room_box(&r, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL & ~BOX_Z0, true,
             room_material(&r, 0.7, 1), "");
    build(&r, 0.12, vec3(0.5, 1, 0.75));
    StochasticOptions o = { .rays = 1024, .threads = 2, .tolerance = 1e-9 };
    light(&whole, &r, NULL, &o);
    const SolveProblem problem = { ROOM_BANDS, whole.emission, whole.reflectance, NULL };
    const size_t bytes = sizeof(double) * ROOM_BANDS * whole.solution->count;
    for (int k = 1; k <= BREAKS; k++) {
        StochasticKept *kept = stochastic_kept_create(&err), *on = stochastic_kept_create(&err);
        StochasticReport report;
        Break at = { .left = k };
        const Monitor monitor = { .user = &at, .progress = count_down, .stop = must_stop };
        assert_null(stochastic_kept_bytes(kept, &size));
        o.kept = kept;
        Solution *part = stochastic_solve(&r.room, &whole.places, &problem, &o, &report, &monitor,
                                          &err);
        assert_true(report.rays <= whole.report.rays);
        void *saved = stochastic_kept_bytes(kept, &size);
        if (saved != NULL) {
            void *copy = array_create(size, 1, "test", &err);
            memcpy(copy, saved, size);
            assert_true(stochastic_kept_load(on, copy, size, part->count));
            rounds += report.rays < whole.report.rays;
        }
        o.kept = on;
        Solution *rest = stochastic_solve(&r.room, &whole.places, &problem, &o, &report, NULL,
                                          &err);
        assert_memory_equal(rest->irradiance, whole.solution->irradiance, bytes);
        assert_int_equal(report.rays, whole.report.rays);
        assert_memory_equal(report.escaped, whole.report.escaped, sizeof report.escaped);
        assert_int_equal(rest->iterations, whole.solution->iterations);
        solution_destroy(part);
        solution_destroy(rest);
        stochastic_kept_destroy(kept);
        stochastic_kept_destroy(on);
    }
    assert_true(rounds > 2); /* broken off in the midst, with something to go on from */
    lit_clear(&whole);
    room_clear(&r);
}

/* Bytes that are none of such a run are refused. */
static void test_kept_damaged(void **state)
{
    (void)state;
    enum { COUNT = 3 };
    Error err = { 0 };
    StochasticKept *kept = stochastic_kept_create(&err);
    double power[COUNT * ROOM_BANDS] = { 1, 2, 3 };
    float missed[COUNT] = { 1, 0, 2 }, told[COUNT] = { 16, 16, 16 };
    uint16_t sights[COUNT] = { 4, 0, 1 };
    StochasticPlaces places = { .power = { power, power, power, power }, .missed = missed,
                                .told = told, .sights = sights };
    const StochasticHead good = { .count = COUNT, .batches = 4, .rounds = 2, .round_rays = 16 };
    for (int k = 0; k < 7; k++) {
        StochasticHead head = good;
        size_t size;
        assert_true(stochastic_kept_begin(kept, COUNT, &err));
        head.batches = k == 2 ? 3 : 4;
        head.round_rays = k == 3 ? 5 : 16;
        power[4] = k == 4 ? NAN : 1;
        sights[0] = k == 5 ? 6 : 4;
        stochastic_kept_put(kept, &head, &places);
        const void *from = stochastic_kept_bytes(kept, &size);
        void *copy = array_create(size, 1, "test", &err);
        memcpy(copy, from, size);
        const bool fits = stochastic_kept_load(kept, copy, k == 6 ? size - 1 : size,
                                               k == 1 ? COUNT + 1 : COUNT);
        assert_true(fits == (k == 0));
        assert_true((stochastic_kept_bytes(kept, &size) != NULL) == fits);
    }
    stochastic_kept_destroy(kept);
}

/* A box on the floor hides 1/4 of it: that is found, as an area, and no light leaves from there. */
static void test_hidden(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    OpenPlaces places;
    Error err = { 0 };
    const uint32_t m = room_material(&r, 0.5, 1);
    room_box(&r, vec3(0, 0, 0), vec3(2, 2, 2), BOX_ALL, true, m, "");
    room_box(&r, vec3(0.5, 0.5, 0), vec3(1.5, 1.5, 1), BOX_ALL & ~BOX_Z0, false, m, "box");
    build(&r, 2, vec3(1, 1, 1.7));
    assert_true(open_places_find(&r.room, 1, 1, &places, NULL, &err));
    double floor_area = 0;
    for (uint32_t i = 0; i < r.patches->count; i++)
        if (r.patches->normal[i].z > 0.9 && r.patches->centre[i].z < 0.5)
            floor_area += places.links->area[i];
    /* Places are told apart in cells of 1/64 of a patch; those on the box's rim, 16 of them, count
     * either way. */
    assert_true(fabs(floor_area - 3) <= 16 * 4.0 / 64);
    open_places_clear(&places);
    room_clear(&r);
}

/* Nothing emits: nothing is shot, and nothing is wrong. */
static void test_darkness(void **state)
{
    (void)state;
    TestRoom r = { .surfaces = NULL };
    Lit lit;
    room_box(&r, vec3(0, 0, 0), vec3(1, 1, 1), BOX_ALL, true, room_material(&r, 0.5, 0), "");
    build(&r, 0.25, vec3(0.5, 0.5, 0.5));
    light(&lit, &r, NULL, &(StochasticOptions){ .rays = 64 });
    assert_true(lit.solution->converged);
    assert_int_equal(lit.report.rays, 0);
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
    for (long k = 0; !done; k++) {
        Error err = { 0 };
        OpenPlaces places;
        StochasticReport report;
        double *emission, *reflectance;
        room_problem(&r, &emission, &reflectance);
        const long live = array_live();
        const SolveProblem problem = { ROOM_BANDS, emission, reflectance, NULL };
        array_fail_after(k);
        if (open_places_find(&r.room, 1, 1, &places, NULL, &err)) {
            const StochasticOptions options = { .rays = 8 };
            Solution *s = stochastic_solve(&r.room, &places, &problem, &options, &report, NULL,
                                           &err);
            done = s != NULL;
            solution_destroy(s);
            open_places_clear(&places);
        }
        array_fail_after(-1);
        assert_true(done || err.code == ERROR_MEMORY);
        assert_int_equal(array_live(), live);
        array_free(emission);
        array_free(reflectance);
    }
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_furnace), cmocka_unit_test(test_received),
        cmocka_unit_test(test_plates),  cmocka_unit_test(test_leaks),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_darkness), cmocka_unit_test(test_memory),
        cmocka_unit_test(test_kept),    cmocka_unit_test(test_kept_damaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
