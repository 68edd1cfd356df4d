/* SPDX-License-Identifier: BSD-3-Clause */
/* Lamps dimmed in the window: sums of light against solutions of the scene as it then is. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "app/live_dimming.h"

typedef struct {
    Session    session;
    Pipeline   pipeline;
    Live       live;
    Relighting relighting;
} Window;

/* A scene solved as the window does it. */
static void begin(Window *w)
{
    static char word[][40] = { "view", "scenes/files/two-lights.msd", "--patches", "300",
                               "--rays", "64", "--no-adapt", "--progress", "none",
                               "--tolerance", "1e-8" };
    enum { WORDS = sizeof word / sizeof *word };
    char *argv[WORDS + 1] = { NULL };
    for (int i = 0; i < WORDS; i++)
        argv[i] = word[i];
    Options options;
    Error err = { 0 };
    memset(w, 0, sizeof *w);
    if (!options_parse(&options, WORDS, argv, &err))
        fail_msg("%s", err.text);
    session_init(&w->session, &options);
    w->pipeline.session = &w->session;
    w->live.pipeline = &w->pipeline;
    Pipeline *p = &w->pipeline;
    assert_true(pipeline_read(p, &err) && pipeline_mesh(p, &err) && pipeline_patches(p, &err) &&
                pipeline_factors(p, &err) && pipeline_solve(p, &err));
    assert_true(relighting_begin(&w->relighting, &w->live, &err));
}

static void end(Window *w)
{
    relighting_end(&w->relighting);
    pipeline_clear(&w->pipeline);
    session_clear(&w->session);
}

/* The sum differs from the solution of the pipeline's problem by no more than its knobs' errors. */
static void check_sum(const Pipeline *p)
{
    const SolveOptions exact = { .solver = SOLVER_GAUSS_SEIDEL, .tolerance = 1e-10 };
    Error err = { 0 };
    Solution *s = solve(p->links, &p->problem, &exact, &p->session->monitor, &err);
    assert_non_null(s);
    double square = 0, off = 0;
    for (size_t i = 0; i < (size_t)s->count * s->bands; i++) {
        square += s->irradiance[i] * s->irradiance[i];
        off += pow(s->irradiance[i] - p->solution->irradiance[i], 2);
    }
    assert_true(square > 0);
    /* Residuals of 1e-4, a few knobs turned a few times, 1 / (1 - rho) of some 5. */
    assert_true(sqrt(off / square) < 5e-3);
    solution_destroy(s);
}

static void turn(KnobSetting *s, uint32_t k, Rgb value)
{
    s->turned[k] = true;
    s->value[k] = value;
}

static void test_sums(void **state)
{
    (void)state;
    Window w;
    KnobSetting s = { 0 };
    Error err = { 0 };
    bool could = false;
    begin(&w);
    Relighting *r = &w.relighting;
    uint32_t shining = 0;
    for (uint32_t k = 0; k < r->knob_count; k++)
        shining += knob_shines(&r->knob[k]);
    assert_true(shining >= 2);
    for (int step = 0; step < 4; step++) {
        for (uint32_t k = 0; k < r->knob_count; k++)
            if (knob_shines(&r->knob[k])) {
                const Rgb b = r->knob[k].base;
                const double f[] = { 0.3 * (step + k), 1.7 - 0.2 * step, step == 2 ? 0 : 0.5 };
                turn(&s, k, rgb(f[0] * b.r, f[1] * b.g, f[2] * b.b));
            }
        assert_true(dimming_follow(r, &w.pipeline, &s, &could, &err));
        assert_true(could);
        r->setting = s;
        check_sum(&w.pipeline);
    }
    end(&w);
}

/* Off, and on again; paint is no sum. */
static void test_off_and_on(void **state)
{
    (void)state;
    Window w;
    KnobSetting s = { 0 };
    Error err = { 0 };
    bool could = false;
    begin(&w);
    Relighting *r = &w.relighting;
    uint32_t paint = UINT32_MAX;
    for (uint32_t k = 0; k < r->knob_count; k++)
        if (knob_shines(&r->knob[k]))
            turn(&s, k, rgb(0, 0, 0));
        else
            paint = k;
    assert_true(dimming_follow(r, &w.pipeline, &s, &could, &err) && could);
    r->setting = s;
    const Solution *dark = w.pipeline.solution;
    double most = 0;
    for (size_t i = 0; i < (size_t)dark->count * dark->bands; i++)
        most = fmax(most, dark->irradiance[i]);
    s = (KnobSetting){ 0 };
    assert_true(dimming_follow(r, &w.pipeline, &s, &could, &err) && could);
    r->setting = s;
    check_sum(&w.pipeline);
    double full = 0;
    for (size_t i = 0; i < (size_t)dark->count * dark->bands; i++)
        full = fmax(full, w.pipeline.solution->irradiance[i]);
    if (!(most < 1e-3 * full))
        fail_msg("%g of %g", most, full);
    assert_true(paint != UINT32_MAX);
    turn(&s, paint, rgb(0.1, 0.2, 0.3));
    assert_true(dimming_follow(r, &w.pipeline, &s, &could, &err));
    assert_false(could);
    end(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums),
        cmocka_unit_test(test_off_and_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
