/* SPDX-License-Identifier: BSD-3-Clause */
/* Standard errors of factors between patches: spreads by hand, and whether casts of a cube are as
 * far from the closed forms as its errors say. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "radiosity/links_errors.h"
#include "tests/room_maker.h"

static const Vec3 ORIGIN = { 0, 0, 0 }, UNIT = { 1, 1, 1 };

/* Opposite and adjacent faces of a cube. */
static const double OPPOSITE = 0.199824895698387, ADJACENT = 0.200043776075403;

enum { SEEDS = 24, FACES = 6 };

static void test_spread(void **state)
{
    (void)state;
    Spread s = { .first = 0.25 };
    spread_add(&s, 0.5);
    spread_add(&s, 0.0);
    spread_add(&s, 0.25);
    /* 1/4, 1/2, 0, 1/4: mean 1/4, squares of differences 1/8, over three. */
    assert_true(fabs(spread_error(&s, 4) - sqrt(1.0 / 24)) < 1e-7);
    Spread same = { .first = 1 };
    spread_add(&same, 1);
    assert_true(spread_error(&same, 2) == FLT_EPSILON / 2);
}

static Links *hand_links(const uint64_t first[4], const uint32_t *source, const float *factor)
{
    Error err = { 0 };
    Links *links = links_empty(3, first[3], &err);
    assert_non_null(links);
    for (uint32_t i = 0; i <= 3; i++)
        links->first[i] = first[i];
    for (uint64_t k = 0; k < first[3]; k++) {
        links->source[k] = source[k];
        links->form_factor[k] = factor[k];
    }
    return links;
}

/* Pairs that only one of two casts has found: half the difference's square over one. */
static void test_union(void **state)
{
    (void)state;
    Error err = { 0 };
    Links *a = hand_links((const uint64_t[]){ 0, 2, 2, 3 }, (const uint32_t[]){ 1, 2, 0 },
                          (const float[]){ 0.5f, 0.5f, 0.25f });
    Links *b = hand_links((const uint64_t[]){ 0, 2, 3, 3 }, (const uint32_t[]){ 0, 2, 1 },
                          (const float[]){ 0.125f, 0.75f, 1 });
    b->escape[0] = 0.125f;
    LinksErrors *e = links_errors_create(a, &err);
    assert_non_null(e);
    assert_false(links_errors_add(e, b, 16, &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    err = (Error){ 0 };
    assert_true(links_errors_add(e, b, 0, &err));
    static const uint32_t source[] = { 0, 1, 2, 1, 0 };
    static const double difference[] = { 0.125, 0.5, 0.25, 1, 0.25 };
    assert_int_equal(e->begin[1], 3);
    assert_int_equal(e->begin[2], 4);
    assert_int_equal(e->begin[3], 5);
    for (int k = 0; k < 5; k++) {
        assert_int_equal(e->pair[k].source, source[k]);
        assert_true(fabs(links_pair_error(e, &e->pair[k]) - difference[k] / sqrt(2)) < 1e-7);
    }
    assert_true(fabs(links_row_error(e, 0) - 0.5 / sqrt(2)) < 1e-7);
    assert_true(fabs(spread_error(&e->escape[0], 2) - 0.125 / sqrt(2)) < 1e-7);
    assert_true(spread_error(&e->sum[0], 2) < 1e-7); /* 1 both times */
    links_errors_destroy(e);
    links_destroy(a);
    links_destroy(b);
}

/* Face by face of the closed cube: of one cast, how far it is off in its own standard errors. */
static void test_honest(void **state)
{
    (void)state;
    TestRoom r = { 0 };
    const Vec3 eye = vec3(0.5, 0.5, 0.5);
    room_box(&r, ORIGIN, UNIT, BOX_ALL, true, room_material(&r, 0.5, 0), "");
    room_finish(&r, 1, &(SidesOptions){ .eye = &eye, .eye_count = 1 }, NULL, 0, NULL);
    assert_int_equal(r.patches->count, FACES);
    int one = 0, three = 0, all = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Error err = { 0 };
        const LinksOptions lo = { .rays = 256, .seed = seed, .threads = 1 + seed % 2 };
        Links *links = links_create(&r.room, &lo, NULL, &err);
        LinksErrors *e = links_errors_create(links, &err);
        assert_non_null(e);
        for (uint32_t k = 1; k < LINKS_CASTS; k++) {
            Links *cast = links_cast_again(&r.room, &lo, k, NULL, &err);
            assert_true(links_errors_add(e, cast, 0, &err));
            links_destroy(cast);
        }
        assert_int_equal(e->begin[FACES], FACES * (FACES - 1));
        for (uint32_t i = 0; i < FACES; i++)
            for (uint64_t k = e->begin[i]; k < e->begin[i + 1]; k++) {
                const Vec3 to = r.patches->normal[e->pair[k].source];
                const bool facing = vec3_dot(r.patches->normal[i], to) < -0.5;
                const double off = fabs((double)e->pair[k].first - (facing ? OPPOSITE : ADJACENT));
                const double error = links_pair_error(e, &e->pair[k]);
                one += off <= error;
                three += off <= 3 * error;
                all++;
            }
        links_errors_destroy(e);
        links_destroy(links);
    }
    /* Student's law of 15 degrees: 66.7 % within one, 99.1 % within three; a row's five pairs hang
     * together, so rows alone count as independent. */
    const double rows = SEEDS * FACES, p = (double)one / all, q = (double)three / all;
    assert_true(fabs(p - 0.667) < 3 * sqrt(0.667 * 0.333 / rows));
    assert_true(q > 0.991 - 3 * sqrt(0.991 * 0.009 / rows));
    room_clear(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread),
        cmocka_unit_test(test_union),
        cmocka_unit_test(test_honest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
