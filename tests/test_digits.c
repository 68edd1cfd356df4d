/* SPDX-License-Identifier: BSD-3-Clause */
/* Fast numbers as text against the C library's. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/digits.h"

static char text[64];
static Digits digits;

static const char *written(double value)
{
    FILE *out = fmemopen(text, sizeof text, "w");
    digits = (Digits){ .out = out };
    digits_number(&digits, value);
    digits_flush(&digits);
    fclose(out);
    return text;
}

static void the_same_as_printf(void **state)
{
    (void)state;
    static const double values[] = {
        0, 1, 0.5, 0.1, 10, 100, 123456789, 999999999, 1e9, 1234567890123, 0.0001, 0.00012345,
        0.00001, 1e-5, 9.99999999e-5, 0.999999999, 0.9999999999, 9.9999999999, 1e-30, 1e29, 1e30,
        1e-31, 1e-300, DBL_MAX, DBL_MIN, -1, -0.25, 3.14159265358979, 0.199824896, 2.5e-7,
        0.1f, 1.0f / 3, 1 - FLT_EPSILON, 256.125, 65536, 1e8, 99999999.5, 5e-324,
    };
    char expected[64];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        snprintf(expected, sizeof expected, "%.9g", values[i]);
        assert_string_equal(written(values[i]), expected);
    }
    assert_string_equal(written(INFINITY), "inf");
    assert_string_equal(written(-0.0), "-0");
}

/* Numbers of all sizes: equal to printf's, but for one in 10^5 that lies on the edge. */
static void many_numbers(void **state)
{
    (void)state;
    enum { COUNT = 200000 };
    uint64_t seed = 1;
    int other = 0;
    for (int i = 0; i < COUNT; i++) {
        char expected[64];
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const double mantissa = 1 + (double)(seed >> 12) * 0x1p-52;
        const double value = ldexp(mantissa, (int)(seed >> 5 & 127) - 90);
        snprintf(expected, sizeof expected, "%.9g", value);
        if (strcmp(written(value), expected) != 0) {
            other++;
            assert_true(fabs(strtod(text, NULL) / value - 1) <= 5.001e-9);
        }
    }
    assert_true(other <= 2);
}

static void counts(void **state)
{
    (void)state;
    static const uint64_t values[] = { 0, 9, 10, 12345, UINT32_MAX, UINT64_MAX };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char expected[64];
        FILE *out = fmemopen(text, sizeof text, "w");
        digits = (Digits){ .out = out };
        digits_count(&digits, values[i]);
        digits_letter(&digits, '\0');
        digits_flush(&digits);
        fclose(out);
        snprintf(expected, sizeof expected, "%llu", (unsigned long long)values[i]);
        assert_string_equal(text, expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_as_printf),
        cmocka_unit_test(many_numbers),
        cmocka_unit_test(counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
