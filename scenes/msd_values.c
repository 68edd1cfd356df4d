/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers, vectors, colours and sizes of MSD. No value that is not finite leaves here. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scenes/msd.h"

/* Refuses what no number is: 1/0, SQRT(-1), EXP(1000). Checked at each step, as 1/(1/0) is 0. */
static bool finite_or_error(MsdReader *r, MsdPlace place, double value)
{
    return isfinite(value) ||
           msd_error(r, place, "the value is not a finite number, expected one that is");
}

static double function_value(MsdWord word, double x)
{
    switch (word) {
    case WORD_SQR: return x * x;
    case WORD_SQRT: return sqrt(x);
    case WORD_EXP: return exp(x);
    case WORD_COS: return cos(x);
    case WORD_SIN: return sin(x);
    default: assert(word == WORD_TAN); return tan(x);
    }
}

static bool is_function(const MsdReader *r)
{
    if (r->token.kind != TOKEN_WORD)
        return false;
    const MsdWord w = r->token.word;
    return w == WORD_SQR || w == WORD_SQRT || w == WORD_EXP || w == WORD_POW || w == WORD_COS ||
           w == WORD_SIN || w == WORD_TAN;
}

static bool function_read(MsdReader *r, double *value)
{
    const MsdWord  word = r->token.word;
    const MsdPlace place = r->token.place;
    double         a = 0, b = 0;

    if (!msd_next(r) || !msd_take(r, '(') || !msd_number(r, &a))
        return false;
    if (word == WORD_POW && (!msd_take(r, ',') || !msd_number(r, &b)))
        return false;
    if (!msd_take(r, ')'))
        return false;
    *value = word == WORD_POW ? pow(a, b) : function_value(word, a);
    return finite_or_error(r, place, *value);
}

static bool factor_read(MsdReader *r, double *value);

static bool signed_read(MsdReader *r, double *value)
{
    const bool minus = msd_is(r, '-');

    if (!msd_deeper(r) || !msd_next(r) || !factor_read(r, value))
        return false;
    r->depth--;
    *value = minus ? -*value : *value;
    return true;
}

static bool factor_read(MsdReader *r, double *value)
{
    uint32_t name = 0;

    if (r->token.kind == TOKEN_NUMBER) {
        *value = r->token.number;
        return msd_next(r);
    }
    if (r->token.kind == TOKEN_NAME) {
        if (!msd_named(r, NAME_FLOAT, &name))
            return false;
        *value = r->bindings[name].as.number;
        return true;
    }
    if (msd_is(r, '+') || msd_is(r, '-'))
        return signed_read(r, value);
    if (msd_is(r, '('))
        return msd_next(r) && msd_number(r, value) && msd_take(r, ')');
    if (msd_is_word(r, WORD_TIME)) {
        *value = r->options != NULL ? r->options->time : 0;
        r->scene->timed = true;
        return msd_next(r);
    }
    return is_function(r) ? function_read(r, value) : msd_expected(r, "a number");
}

static bool term_read(MsdReader *r, double *value)
{
    double other = 0;

    if (!factor_read(r, value))
        return false;
    while (msd_is(r, '*') || msd_is(r, '/')) {
        const bool     times = msd_is(r, '*');
        const MsdPlace place = r->token.place;
        if (!msd_next(r) || !factor_read(r, &other))
            return false;
        *value = times ? *value * other : *value / other;
        if (!finite_or_error(r, place, *value))
            return false;
    }
    return true;
}

bool msd_number(MsdReader *r, double *value)
{
    double other = 0;

    if (!msd_deeper(r) || !term_read(r, value))
        return false;
    while (msd_is(r, '+') || msd_is(r, '-')) {
        const bool     plus = msd_is(r, '+');
        const MsdPlace place = r->token.place;
        if (!msd_next(r) || !term_read(r, &other))
            return false;
        *value = plus ? *value + other : *value - other;
        if (!finite_or_error(r, place, *value))
            return false;
    }
    r->depth--;
    return true;
}

bool msd_number_in(MsdReader *r, const char *what, double least, bool open, double most,
                   double *value)
{
    assert(what != NULL && least <= most);
    const MsdPlace place = r->token.place;

    if (!msd_number(r, value))
        return false;
    if (*value < least || (open && *value <= least) || *value > most) {
        char range[80];
        if (most < DBL_MAX)
            snprintf(range, sizeof range, "%s %g to %g", open ? "above" : "from", least, most);
        else
            snprintf(range, sizeof range, "%s %g", open ? "above" : "of at least", least);
        return msd_error(r, place, "found %g, expected %s %s", *value, what, range);
    }
    return true;
}

bool msd_length(MsdReader *r, const char *what, double *value)
{
    return msd_number_in(r, what, 0, true, DBL_MAX, value);
}

bool msd_integer(MsdReader *r, const char *what, uint32_t least, uint32_t most, uint32_t *value)
{
    assert(what != NULL && value != NULL && least <= most);
    char text[120];

    snprintf(text, sizeof text, "%s, a whole number from %u to %u", what, least, most);
    if (r->token.kind != TOKEN_NUMBER || !r->token.whole || r->token.number < least ||
        r->token.number > most)
        return msd_expected(r, text);
    *value = (uint32_t)r->token.number;
    return msd_next(r);
}

static bool triple_read(MsdReader *r, Vec3 *value)
{
    return msd_take(r, '(') && msd_number(r, &value->x) && msd_take(r, ',') &&
           msd_number(r, &value->y) && msd_take(r, ',') && msd_number(r, &value->z) &&
           msd_take(r, ')');
}

bool msd_vector(MsdReader *r, Vec3 *value)
{
    uint32_t name = 0;

    if (msd_is(r, '('))
        return triple_read(r, value);
    if (r->token.kind != TOKEN_NAME)
        return msd_expected(r, "a vector (x, y, z)");
    if (!msd_named(r, NAME_VECTOR, &name))
        return false;
    *value = r->bindings[name].as.vector;
    return true;
}

bool msd_direction(MsdReader *r, const char *what, Vec3 *unit)
{
    const MsdPlace place = r->token.place;
    Vec3           v = { 0 };

    if (!msd_vector(r, &v))
        return false;
    /* Scaled by the largest component first: squares must neither overflow nor vanish. */
    const double largest = fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
    if (!(largest > 0))
        return msd_error(r, place, "found (0, 0, 0), expected %s", what);
    *unit = vec3_unit(vec3(v.x / largest, v.y / largest, v.z / largest));
    return true;
}

bool msd_colour(MsdReader *r, Rgb *value)
{
    const MsdPlace place = r->token.place;
    Vec3           v = { 0 };

    if (r->token.kind != TOKEN_NAME && !msd_is(r, '('))
        return msd_expected(r, "a colour (r, g, b)");
    if (!msd_vector(r, &v))
        return false;
    if (v.x < 0 || v.y < 0 || v.z < 0)
        return msd_error(r, place, "found (%g, %g, %g), expected a colour without negative parts",
                         v.x, v.y, v.z);
    *value = rgb(v.x / r->colour_range, v.y / r->colour_range, v.z / r->colour_range);
    /* Brighter than any light, and still far from what sums over a scene could not hold. */
    const double largest = 1e100;
    if (!(rgb_max(*value) <= largest))
        return msd_error(r, place, "found (%g, %g, %g), expected a colour of at most %g", v.x, v.y,
                         v.z, largest * r->colour_range);
    return true;
}

bool msd_sizes(MsdReader *r, int least, int most, bool zero, double value[3], int *count)
{
    assert(1 <= least && least <= most && most <= 3);
    int n = 0;

    if (!msd_is(r, '<'))
        return msd_expected(r, least == 1 && most == 1 ? "a size <a>"
                               : most == 3 ? "sizes <a, b, c>" : "sizes <a, b>");
    do {
        if (!msd_next(r) ||
            !msd_number_in(r, "a size", 0, !zero, DBL_MAX, &value[n]))
            return false;
        n++;
    } while (n < most && msd_is(r, ','));
    if (n < least)
        return msd_expected(r, "',' and one more size");
    *count = n;
    return msd_take(r, '>');
}

bool msd_string(MsdReader *r, const char *what, char *buffer, size_t size)
{
    if (r->token.kind != TOKEN_STRING)
        return msd_expected(r, what);
    const size_t length = strlen(r->string);
    if (length == 0 || length >= size)
        return msd_error(r, r->token.place, "found a string of %zu bytes, expected %s of 1 to %zu",
                         length, what, size - 1);
    memcpy(buffer, r->string, length + 1);
    return msd_next(r);
}
