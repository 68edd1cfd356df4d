/* SPDX-License-Identifier: BSD-3-Clause */
/* Grey-body exchange against closed forms of two and three surfaces and a known heat balance. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "radiosity/exchange.h"

static const double CLOSE = 1e-12; /* relative; a dozen operations in double */

static double power(double temperature)
{
    return EXCHANGE_STEFAN_BOLTZMANN * pow(temperature, 4);
}

/* A convex body of area 1 inside a shell of area 4. */
static void a_body_in_a_shell(void **state)
{
    (void)state;
    static const double eps[][2] = { { 1, 1 }, { 0.3, 0.9 }, { 0.05, 0.02 }, { 1, 0.1 } };
    const double factor[] = { 0, 1, 0.25, 0.75 }, t[] = { 400, 300 };
    for (size_t i = 0; i < sizeof eps / sizeof *eps; i++) {
        const ExchangeProblem p = { .count = 2, .factor = factor, .emissivity = eps[i] };
        Error err = { 0 };
        double flux[2], gebhart[4], hottel[4];
        assert_true(exchange_flux(&p, t, 0, flux, &err));
        const double net = (power(400) - power(300)) /
                           (1 / eps[i][0] + 0.25 * (1 / eps[i][1] - 1));
        assert_float_equal(flux[0] / -net, 1, CLOSE);
        assert_float_equal(flux[1] / (0.25 * net), 1, CLOSE);
        assert_true(exchange_factors(&p, gebhart, hottel, &err));
        assert_float_equal(gebhart[0] + gebhart[1], 1, CLOSE);
        assert_float_equal(gebhart[2] + gebhart[3], 1, CLOSE);
        assert_float_equal(hottel[1], 4 * hottel[2], CLOSE);
        assert_float_equal(hottel[1] * (power(400) - power(300)) / net, 1, CLOSE);
    }
}

/* Two large plates with a thin shield between them, each of whose sides is a surface: the side's
 * temperatures are those of the shield when both fluxes cancel. */
static void a_shield_between_plates(void **state)
{
    (void)state;
    const double e = 0.8, s = 0.1, t1 = 500, t2 = 300;
    const double factor[] = { 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0 };
    const double eps[] = { e, s, s, e };
    const double middle = pow((pow(t1, 4) + pow(t2, 4)) / 2, 0.25);
    const double t[] = { t1, middle, middle, t2 };
    const ExchangeProblem p = { .count = 4, .factor = factor, .emissivity = eps };
    Error err = { 0 };
    double flux[4];
    assert_true(exchange_flux(&p, t, 0, flux, &err));
    const double net = (power(t1) - power(t2)) / (2 / e + 2 / s - 2);
    assert_float_equal(flux[0] / -net, 1, CLOSE);
    assert_float_equal(flux[3] / net, 1, CLOSE);
    assert_float_equal((flux[1] + flux[2]) / net, 0, CLOSE);
}

static void what_escapes_meets_the_surroundings(void **state)
{
    (void)state;
    const double factor[] = { 0 }, escape[] = { 1 }, eps[] = { 0.7 }, t[] = { 320 };
    const ExchangeProblem p = { .count = 1, .factor = factor, .escape = escape,
                                .emissivity = eps };
    Error err = { 0 };
    double flux;
    assert_true(exchange_flux(&p, t, 290, &flux, &err));
    assert_float_equal(flux / (0.7 * (power(290) - power(320))), 1, CLOSE);
}

/* The L-shaped room of Pinney and Bean: all walls at 293.15 K but the third, 10 K colder. The net
 * fluxes are those of the well-known listing, given to four digits. */
static void the_l_room(void **state)
{
    (void)state;
    enum { N = 8 };
    const double area[N] = { 9, 3, 6, 6, 3, 9, 5, 5 };
    const double a = 0.11315441, b = 0.37809289, c = 0.0274734, d = 0.03289443, e = 0.18235591;
    const double f = 0.13301684, g = 0.3189967, h = 0.12143445, i = 0.1160761, j = 0.096835632;
    const double factor[N * N] = {
        0, a, b, c, d, e, f, f,
        3 * a, 0, g, 0, 0, 3 * d, h, h,
        1.5 * b, g / 2, 0, 0, 0, 1.5 * c, i, i,
        1.5 * c, 0, 0, 0, g / 2, 1.5 * b, i, i,
        3 * d, 0, 0, g, 0, 3 * a, h, h,
        e, d, c, b, a, 0, f, f,
        1.8 * f, 0.6 * h, 1.2 * i, 1.2 * i, 0.6 * h, 1.8 * f, 0, j,
        1.8 * f, 0.6 * h, 1.2 * i, 1.2 * i, 0.6 * h, 1.8 * f, j, 0,
    };
    const double listed[N] = { -17.06, -14.83, 47.48, -0.3343, -0.4038, -1.769, -6.776, -6.776 };
    double eps[N], t[N], flux[N], sum = 0, open = 0;
    for (int k = 0; k < N; k++) {
        eps[k] = 0.9;
        t[k] = k == 2 ? 283.15 : 293.15;
    }
    const ExchangeProblem p = { .count = N, .factor = factor, .emissivity = eps };
    Error err = { 0 };
    assert_true(exchange_flux(&p, t, 0, flux, &err));
    for (int k = 0; k < N; k++) {
        assert_float_equal(flux[k], listed[k], 0.01); /* the listing's factors had 6 decimals */
        sum += area[k] * flux[k];
        double row = 0;
        for (int m = 0; m < N; m++)
            row += factor[N * k + m];
        open += area[k] * fabs(1 - row) * power(293.15);
    }
    assert_float_equal(sum, 0, open); /* W; what rows that do not quite sum to 1 can lose */
}

static void wrong_values_are_refused(void **state)
{
    (void)state;
    const double factor[] = { 0, 1, 1, 0 }, t[] = { 300, -1 };
    double eps[] = { 0.5, 0 }, flux[2];
    const ExchangeProblem p = { .count = 2, .factor = factor, .emissivity = eps };
    Error err = { 0 };
    assert_false(exchange_flux(&p, t, 0, flux, &err));
    assert_int_equal(err.code, ERROR_INPUT);
    err = (Error){ 0 };
    eps[1] = 0.5;
    assert_false(exchange_flux(&p, t, 0, flux, &err));
    assert_int_equal(err.code, ERROR_INPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_in_a_shell),
        cmocka_unit_test(a_shield_between_plates),
        cmocka_unit_test(what_escapes_meets_the_surroundings),
        cmocka_unit_test(the_l_room),
        cmocka_unit_test(wrong_values_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
