/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_errors.c -- what independent casts of the same rows disagree by. */
#include "radiosity/links_errors.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/internal.h"

Links *links_cast_again(const Room *room, const LinksOptions *options, uint32_t k,
                        const Monitor *monitor, Error *err)
{
    assert(k >= 1 && k < LINKS_CASTS);
    LinksOptions again = *options;
    again.seed = sampling_seed(options->seed, SEED_AGAIN, k, 0);
    again.kept = NULL;
    return links_create(room, &again, monitor, err);
}

void spread_add(Spread *spread, double value)
{
    const double d = value - spread->first;
    spread->sum += d;
    spread->squares += d * d;
}

double spread_error(const Spread *spread, uint32_t casts)
{
    assert(casts >= 2);
    const double n = casts, rounding = spread->first * FLT_EPSILON / 2;
    const double variance = (spread->squares - spread->sum * spread->sum / n) / (n - 1);
    return sqrt(fmax(variance, 0) + rounding * rounding);
}

/* --- pairs ------------------------------------------------------------------------------------ */

/* Sum of a row with what escapes. */
static double sum_of(const LinksRow *row, double escape)
{
    double sum = escape;
    for (uint64_t k = 0; k < row->count; k++)
        sum += row->form_factor[k];
    return sum;
}

/* One more cast of the pair; those before found nothing of a new one. */
static LinksPair pair_with(LinksPair pair, double factor)
{
    const double d = factor - pair.first;
    pair.sum += (float)d;
    pair.squares += (float)(d * d);
    return pair;
}

/* Both rows as one, into `out` unless it is NULL; how many pairs it has. */
static uint64_t merge(const LinksPair *pair, uint64_t pairs, const LinksRow *row, LinksPair *out)
{
    uint64_t a = 0, b = 0, n = 0;
    while (a < pairs || b < row->count) {
        const uint32_t ours = a < pairs ? pair[a].source : UINT32_MAX;
        const uint32_t theirs = b < row->count ? row->source[b] : UINT32_MAX;
        const uint32_t source = ours < theirs ? ours : theirs;
        const LinksPair old = ours == source ? pair[a] : (LinksPair){ .source = source };
        const double factor = theirs == source ? (double)row->form_factor[b] : 0;
        if (out != NULL)
            out[n] = pair_with(old, factor);
        n++;
        a += ours == source;
        b += theirs == source;
    }
    return n;
}

static bool allocate(LinksErrors *errors, const Links *links, Error *err)
{
    static const char what[] = "standard errors";
    const size_t n = links->count;
    errors->count = links->count;
    errors->casts = 1;
    errors->begin = array_create(n + 1, sizeof *errors->begin, what, err);
    errors->pair = array_create(links->first[n], sizeof *errors->pair, what, err);
    errors->escape = array_create(n, sizeof *errors->escape, what, err);
    errors->sum = array_create(n, sizeof *errors->sum, what, err);
    return !error_is_set(err);
}

LinksErrors *links_errors_create(const Links *links, Error *err)
{
    assert(links != NULL && err != NULL);
    LinksScratch scratch;
    LinksErrors *errors = array_create(1, sizeof *errors, "standard errors", err);
    if (errors == NULL)
        return NULL;
    if (!allocate(errors, links, err) || !links_scratch_create(links, &scratch, err))
        return links_errors_destroy(errors);
    uint64_t at = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, &scratch);
        for (uint64_t k = 0; k < row.count; k++)
            if (row.form_factor[k] > 0) /* those of packed rows that are 0 stand out of order */
                errors->pair[at++] =
                    (LinksPair){ .source = row.source[k], .first = row.form_factor[k] };
        errors->begin[i + 1] = at;
        errors->escape[i].first = (double)links->escape[i];
        errors->sum[i].first = sum_of(&row, (double)links->escape[i]);
        links_leave(links, i, i + 1);
    }
    links_scratch_clear(&scratch);
    return errors;
}

bool links_errors_add(LinksErrors *errors, const Links *cast, uint64_t max_bytes, Error *err)
{
    static const char what[] = "standard errors";
    assert(errors->count == cast->count && cast->packed == NULL);
    const uint32_t n = errors->count;
    uint64_t *begin = array_create((size_t)n + 1, sizeof *begin, what, err);
    if (begin == NULL)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        const LinksRow row = links_row(cast, i, NULL);
        begin[i + 1] = begin[i] + merge(&errors->pair[errors->begin[i]],
                                        errors->begin[i + 1] - errors->begin[i], &row, NULL);
    }
    const uint64_t bytes = (begin[n] + errors->begin[n]) * sizeof *errors->pair;
    LinksPair *pair = NULL;
    if (max_bytes > 0 && bytes > max_bytes)
        error_set(err, ERROR_MEMORY, "standard errors of %.3g factors take %.0f MiB",
                  (double)begin[n], (double)bytes / (1 << 20));
    else
        pair = array_create(begin[n], sizeof *pair, what, err);
    for (uint32_t i = 0; pair != NULL && i < n; i++) {
        const LinksRow row = links_row(cast, i, NULL);
        merge(&errors->pair[errors->begin[i]], errors->begin[i + 1] - errors->begin[i], &row,
              &pair[begin[i]]);
        spread_add(&errors->escape[i], (double)cast->escape[i]);
        spread_add(&errors->sum[i], sum_of(&row, (double)cast->escape[i]));
    }
    if (pair == NULL) {
        array_free(begin);
        return false;
    }
    array_free(errors->pair);
    array_free(errors->begin);
    errors->pair = pair;
    errors->begin = begin;
    errors->casts++;
    return true;
}

LinksErrors *links_errors_destroy(LinksErrors *errors)
{
    if (errors == NULL)
        return NULL;
    array_free(errors->begin);
    array_free(errors->pair);
    array_free(errors->escape);
    array_free(errors->sum);
    return array_free(errors);
}

double links_pair_error(const LinksErrors *errors, const LinksPair *pair)
{
    const Spread spread = { (double)pair->first, (double)pair->sum, (double)pair->squares };
    return spread_error(&spread, errors->casts);
}

double links_row_error(const LinksErrors *errors, uint32_t i)
{
    assert(i < errors->count);
    double worst = 0;
    for (uint64_t k = errors->begin[i]; k < errors->begin[i + 1]; k++)
        worst = fmax(worst, links_pair_error(errors, &errors->pair[k]));
    return worst;
}
