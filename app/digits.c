/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers as text, fast: nine digits by one multiplication and a few divisions by constants. */
#include "app/digits.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { DIGITS = 9, EXPONENT_MOST = 30 };

/* 10^k is exact in double up to k = 22; further on it is rounded once, 1e-16 of itself. */
static double power_of_ten(int k)
{
    static const double power[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                    1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
                                    1e20, 1e21, 1e22, 1e23, 1e24, 1e25, 1e26, 1e27, 1e28, 1e29,
                                    1e30, 1e31, 1e32, 1e33, 1e34, 1e35, 1e36, 1e37, 1e38 };
    assert(k >= 0 && k < (int)(sizeof power / sizeof *power));
    return power[k];
}

/* value * 10^(8 - exponent), rounded: nine digits when exponent is the value's. */
static uint64_t nine_digits(double value, int exponent)
{
    const int shift = DIGITS - 1 - exponent;
    const double scaled = shift >= 0 ? value * power_of_ten(shift) : value / power_of_ten(-shift);
    return (uint64_t)(scaled + 0.5);
}

static void two_digits(char *to, uint32_t value)
{
    to[0] = (char)('0' + value / 10);
    to[1] = (char)('0' + value % 10);
}

/* The digits of n, 10^8 <= n < 10^9, less the zeros at their end; returns how many. */
static int write_digits(char *to, uint32_t n)
{
    int count = DIGITS;
    to[0] = (char)('0' + n / 100000000);
    n %= 100000000;
    two_digits(to + 1, n / 1000000);
    two_digits(to + 3, n / 10000 % 100);
    two_digits(to + 5, n / 100 % 100);
    two_digits(to + 7, n % 100);
    while (count > 1 && to[count - 1] == '0')
        count--;
    return count;
}

/* As %g: 0.000123, 1.5, 15000, 1.5e-07. */
static uint32_t lay_out(char *to, const char *digit, int count, int exponent)
{
    char *at = to;
    if (exponent < -4 || exponent >= DIGITS) {
        *at++ = digit[0];
        if (count > 1) {
            *at++ = '.';
            memcpy(at, digit + 1, (size_t)count - 1);
            at += count - 1;
        }
        *at++ = 'e';
        *at++ = exponent < 0 ? '-' : '+';
        two_digits(at, (uint32_t)(exponent < 0 ? -exponent : exponent));
        return (uint32_t)(at + 2 - to);
    }
    if (exponent < 0) {
        memcpy(at, "0.0000", (size_t)(1 - exponent));
        at += 1 - exponent;
        memcpy(at, digit, (size_t)count);
        return (uint32_t)(at + count - to);
    }
    for (int k = 0; k <= exponent || k < count; k++) {
        if (k == exponent + 1)
            *at++ = '.';
        *at++ = k < count ? digit[k] : '0';
    }
    return (uint32_t)(at - to);
}

static void make_room(Digits *d)
{
    if (d->used > DIGITS_BUFFER - DIGITS_MOST)
        digits_flush(d);
}

void digits_number(Digits *d, double value)
{
    char digit[DIGITS + 1];
    make_room(d);
    char *to = d->text + d->used;
    int binary = 0;
    if (value == 0 && !signbit(value)) {
        *to = '0';
        d->used++;
        return;
    }
    /* log10(2) times the binary exponent: the decimal one, or one more. */
    frexp(value, &binary);
    int exponent = (int)floor((binary - 1) * 0.30102999566398119);
    if (!(value > 0) || !isfinite(value) || exponent < -EXPONENT_MOST ||
        exponent >= EXPONENT_MOST) {
        d->used += (uint32_t)snprintf(to, DIGITS_MOST, "%.9g", value);
        return;
    }
    uint64_t n = nine_digits(value, exponent);
    if (n >= 1000000000) {
        exponent++;
        n = nine_digits(value, exponent);
    }
    const int count = write_digits(digit, (uint32_t)n);
    d->used += lay_out(to, digit, count, exponent);
}

void digits_count(Digits *d, uint64_t value)
{
    char reverse[24];
    int n = 0;
    make_room(d);
    do {
        reverse[n++] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    while (n > 0)
        d->text[d->used++] = reverse[--n];
}

void digits_letter(Digits *d, char letter)
{
    make_room(d);
    d->text[d->used++] = letter;
}

void digits_flush(Digits *d)
{
    fwrite(d->text, 1, d->used, d->out);
    d->used = 0;
}
