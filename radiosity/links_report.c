/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_report.c -- how far links are from what must hold, and from other links. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "radiosity/internal.h"
#include "radiosity/links_store.h"

typedef struct {
    double   area, row_squares, pair_squares;
    uint64_t pairs;
    uint32_t rows;
} Sums;

static void add_row(const Links *links, const LinkColumns *columns, uint32_t i, Sums *sums,
                    LinksReport *report)
{
    uint64_t c = columns->first[i - columns->begin];
    const uint64_t c_end = columns->first[i - columns->begin + 1];
    double sum = links->escape[i];
    for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++) {
        const uint32_t j = links->source[k];
        const double f = links->form_factor[k];
        while (c < c_end && columns->receiver[c] < j)
            c++;
        const double back = c < c_end && columns->receiver[c] == j ? columns->form_factor[c] : 0;
        sum += f;
        if (j < i && back > 0)
            continue; /* met from the other side already */
        const double larger = fmax(links->area[i], links->area[j]);
        const double error =
            larger > 0 ? fabs(links->area[i] * f - links->area[j] * back) / larger : 0;
        report->reciprocity_error_max = fmax(report->reciprocity_error_max, error);
        sums->pair_squares += error * error;
        sums->pairs++;
    }
    if (!(links->area[i] > 0))
        return; /* hidden inside a solid: takes no part */
    sums->area += links->area[i];
    report->escaped += links->area[i] * links->escape[i];
    report->row_sum_error_max = fmax(report->row_sum_error_max, fabs(sum - 1));
    sums->row_squares += (sum - 1) * (sum - 1);
    sums->rows++;
}

/* Columns are made in blocks: few megabytes, however many links there are. */
bool links_report(const Links *links, LinksReport *report, Error *err)
{
    assert(links != NULL && report != NULL && links->packed == NULL);
    const uint32_t count = links->count;
    Sums sums = { .area = 0 };
    *report = (LinksReport){ .nonzeros = links->first[count] };
    uint64_t *total = links_column_totals(links, err);
    for (uint32_t begin = 0, end; begin < count && !error_is_set(err); begin = end) {
        LinkColumns columns;
        end = link_columns_end(total, count, begin, COLUMN_BLOCK);
        if (!link_columns_create(links, total, begin, end, false, &columns, err))
            break;
        for (uint32_t i = begin; i < end; i++) {
            add_row(links, &columns, i, &sums, report);
            links_pass(links, i);
        }
        link_columns_clear(&columns);
    }
    array_free(total);
    report->escaped = sums.area > 0 ? report->escaped / sums.area : 0;
    report->row_sum_error_rms = sums.rows > 0 ? sqrt(sums.row_squares / sums.rows) : 0;
    report->reciprocity_error_rms =
        sums.pairs > 0 ? sqrt(sums.pair_squares / (double)sums.pairs) : 0;
    report->bytes = links_bytes(links);
    return !error_is_set(err);
}

uint64_t links_bytes(const Links *links)
{
    const uint64_t entry = links->packed != NULL
                               ? 2 * sizeof *links->packed
                               : sizeof *links->source + sizeof *links->form_factor;
    return links->first[links->count] * entry +
           (uint64_t)links->count * (sizeof *links->first + sizeof *links->escape +
                                     sizeof *links->area + sizeof *links->lamp +
                                     (links->packed != NULL ? sizeof *links->scale : 0));
}

void links_change(const Links *before, const Links *after, LinksChange *change)
{
    assert(before->count == after->count && before->packed == NULL && after->packed == NULL);
    *change = (LinksChange){ .largest = 0 };
    for (uint32_t i = 0; i < before->count; i++) {
        uint64_t a = before->first[i], b = after->first[i];
        const uint64_t a_end = before->first[i + 1], b_end = after->first[i + 1];
        while (a < a_end || b < b_end) {
            const uint32_t from = a < a_end ? before->source[a] : PATCH_NONE;
            const uint32_t to = b < b_end ? after->source[b] : PATCH_NONE;
            const uint32_t j = from < to ? from : to;
            const double old = from == j ? before->form_factor[a++] : 0;
            const double new = to == j ? after->form_factor[b++] : 0;
            if (fabs(new - old) > change->largest) {
                change->largest = fabs(new - old);
                change->before = old;
                change->after = new;
                change->row = i;
                change->column = j;
            }
        }
        change->escape = fmax(change->escape, fabs((double)after->escape[i] - before->escape[i]));
        links_pass(before, i);
        links_pass(after, i);
    }
}
