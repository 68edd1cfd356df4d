/* SPDX-License-Identifier: BSD-3-Clause */
/* The check of light by paths, against rooms whose light is known: what is right, what was spoilt
 * by a known amount, what few rays made. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "base/array.h"
#include "radiosity/light_check.h"
#include "radiosity/stochastic.h"
#include "tests/room_maker.h"

/* Noise beyond this many standard errors happens once in 10^6 runs; seeds are fixed. */
static const double SIGMAS = 5;

/* A box whose walls all emit `emission` and reflect rho, with H0 received: B = (E + rho H0) /
 * (1 - rho) everywhere, H = H0 + B, of which H0 + E come straight. */
typedef struct {
    TestRoom     r;
    OpenPlaces   places;
    SolveProblem problem;
    double      *emission, *reflectance, *received;
    Solution     solution;
    double       exact;
    size_t       n;
} Furnace;

static void furnace_make(Furnace *f, double rho, double emission, double received)
{
    Error err = { 0 };
    const Vec3 eye = vec3(0.5, 1, 0.75);
    *f = (Furnace){ .exact = received + (emission + rho * received) / (1 - rho) };
    const uint32_t m = room_material(&f->r, rho, emission);
    room_box(&f->r, vec3(0, 0, 0), vec3(1, 2, 1.5), BOX_ALL, true, m, "");
    room_finish(&f->r, 0.25, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    assert_true(open_places_find(&f->r.room, 1, 1, &f->places, NULL, &err));
    room_problem(&f->r, &f->emission, &f->reflectance);
    f->n = (size_t)f->r.patches->count * ROOM_BANDS;
    double **all[] = { &f->received, &f->solution.irradiance, &f->solution.direct };
    const double value[] = { received, f->exact, received + emission };
    for (unsigned k = 0; k < 3; k++) {
        *all[k] = array_create(f->n, sizeof **all[k], "test", &err);
        assert_non_null(*all[k]);
        for (size_t i = 0; i < f->n; i++)
            (*all[k])[i] = value[k];
    }
    f->problem = (SolveProblem){ ROOM_BANDS, f->emission, f->reflectance, f->received };
}

static void furnace_clear(Furnace *f)
{
    open_places_clear(&f->places);
    array_free(f->emission);
    array_free(f->reflectance);
    array_free(f->received);
    array_free(f->solution.irradiance);
    array_free(f->solution.direct);
    room_clear(&f->r);
}

static LightCheck check(const Furnace *f, const Solution *solution, uint32_t patches,
                        unsigned threads)
{
    Error err = { 0 };
    LightCheck found;
    const LightCheckOptions options = { .patches = patches, .rays = 64, .seed = 7,
                                        .threads = threads };
    assert_true(light_check(&f->r.room, f->places.links, &f->problem, solution, &options, &found,
                            NULL, &err));
    assert_int_equal(found.patches, patches);
    assert_true(found.apart && found.worst >= 0 && found.worst <= 1);
    return found;
}

/* The mean square is `exact` within its standard error. */
static void assert_error(const LightError *error, double exact)
{
    const double up = error->found + error->standard_error, square = error->found * error->found;
    assert_true(up > error->found);
    assert_true(fabs(square - exact * exact) <= SIGMAS * (up * up - square));
}

static void test_right(void **state)
{
    (void)state;
    static const double room[][3] = { { 0.5, 1, 0 }, { 0.9, 1, 0 }, { 0.6, 0, 2 }, { 0.3, 2, 1 } };
    for (size_t k = 0; k < sizeof room / sizeof *room; k++) {
        Furnace f;
        furnace_make(&f, room[k][0], room[k][1], room[k][2]);
        const LightCheck c = check(&f, &f.solution, 400, 2);
        /* A path sends back 1 / (1 - rho) on average, and its square at most twice that squared;
         * in two halves. */
        const double paths = 400.0 * 64 * 2;
        assert_true(fabs(c.mean / f.exact - 1) < SIGMAS * sqrt(2 / paths));
        assert_error(&c.all, 0);
        assert_error(&c.reflected, 0);
        furnace_clear(&f);
    }
}

/* Every other patch a tenth too bright, the others too dark: all of it in one kind of light. */
static void test_spoilt(void **state)
{
    (void)state;
    Furnace f;
    furnace_make(&f, 0.5, 1, 0);
    for (size_t k = 0; k < f.n; k++)
        f.solution.irradiance[k] *= k / ROOM_BANDS % 2 == 0 ? 1.1 : 0.9;
    LightCheck c = check(&f, &f.solution, 400, 1);
    assert_error(&c.all, 0.1);
    assert_error(&c.reflected, 0.1);
    assert_true(c.all.found > 0.09); /* and it is not lost in noise */
    for (size_t k = 0; k < f.n; k++)
        f.solution.direct[k] += f.solution.irradiance[k] - f.exact;
    c = check(&f, &f.solution, 400, 1);
    assert_error(&c.all, 0.1);
    assert_error(&c.direct, 0.1);
    assert_error(&c.reflected, 0);
    assert_true(c.direct.found > 0.09);
    furnace_clear(&f);
}

/* What few rays left of noise, patch by patch, is what is found; more rays leave less. */
static void test_few_rays(void **state)
{
    (void)state;
    static const uint32_t rays[] = { 64, 8192 };
    Furnace f;
    double last = INFINITY;
    furnace_make(&f, 0.5, 1, 0);
    for (unsigned k = 0; k < 2; k++) {
        Error err = { 0 };
        StochasticReport report;
        const StochasticOptions options = { .rays = rays[k], .tolerance = 1e-6, .apart = true };
        Solution *s = stochastic_solve(&f.r.room, &f.places, &f.problem, &options, &report, NULL,
                                       &err);
        assert_non_null(s);
        double square = 0, area = 0;
        for (uint32_t i = 0; i < s->count; i++) {
            const double off = s->irradiance[(size_t)i * ROOM_BANDS] / f.exact - 1;
            square += f.places.links->area[i] * off * off;
            area += f.places.links->area[i];
        }
        /* As many as there are, of one size: each is chosen once. */
        const LightCheck c = check(&f, s, s->count, 2);
        assert_error(&c.all, sqrt(square / area));
        assert_true(c.all.found < last);
        last = c.all.found;
        solution_destroy(s);
    }
    furnace_clear(&f);
}

static void test_threads(void **state)
{
    (void)state;
    Furnace f;
    furnace_make(&f, 0.5, 1, 0);
    const LightCheck one = check(&f, &f.solution, 50, 1), three = check(&f, &f.solution, 50, 3);
    assert_memory_equal(&one.all, &three.all, sizeof one.all);
    assert_memory_equal(&one.mean, &three.mean, sizeof one.mean);
    assert_int_equal(one.cast, three.cast);
    furnace_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_right),
        cmocka_unit_test(test_spoilt),
        cmocka_unit_test(test_few_rays),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
