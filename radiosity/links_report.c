/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_report.c -- links as an object: made, freed, checked and measured. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "radiosity/internal.h"

Links *links_allocate(uint32_t count, uint64_t nonzeros, Error *err)
{
    Links *links = array_create(1, sizeof *links, "links", err);
    if (links == NULL)
        return NULL;
    links->count = count;
    links->first = array_create((size_t)count + 1, sizeof *links->first, "rows of links", err);
    links->escape = array_create(count, sizeof *links->escape, "rows of links", err);
    links->area = array_create(count, sizeof *links->area, "rows of links", err);
    links->lamp = array_create(count, sizeof *links->lamp, "rows of links", err);
    links->source = array_create(nonzeros, sizeof *links->source, "links", err);
    links->form_factor = array_create(nonzeros, sizeof *links->form_factor, "links", err);
    return error_is_set(err) ? links_destroy(links) : links;
}

Links *links_destroy(Links *links)
{
    if (links == NULL)
        return NULL;
    array_free(links->first);
    array_free(links->source);
    array_free(links->form_factor);
    array_free(links->escape);
    array_free(links->area);
    array_free(links->lamp);
    return array_free(links);
}

bool links_check(const Links *links)
{
    assert(links != NULL);
    if (links->first[0] != 0)
        return false;
    for (uint32_t i = 0; i < links->count; i++) {
        if (links->first[i + 1] < links->first[i] || !(links->area[i] >= 0))
            return false;
        if (!(links->escape[i] >= 0 && links->escape[i] <= 1))
            return false;
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++) {
            if (links->source[k] >= links->count)
                return false;
            if (k > links->first[i] && links->source[k] <= links->source[k - 1])
                return false;
            if (!(links->form_factor[k] >= 0 && links->form_factor[k] <= 1))
                return false;
        }
    }
    return true;
}

bool link_columns_create(const Links *links, LinkColumns *columns, Error *err)
{
    const uint32_t count = links->count;
    const uint64_t nonzeros = links->first[count];
    *columns = (LinkColumns){ 0 };
    columns->first = array_create((size_t)count + 1, sizeof *columns->first, "columns", err);
    columns->receiver = array_create(nonzeros, sizeof *columns->receiver, "columns", err);
    columns->form_factor = array_create(nonzeros, sizeof *columns->form_factor, "columns", err);
    if (error_is_set(err)) {
        link_columns_clear(columns);
        return false;
    }
    /* first[j] counts column j - 2 at first, so that filling leaves it where it belongs. */
    uint64_t *next = columns->first;
    for (uint64_t k = 0; k < nonzeros; k++)
        if (links->source[k] + 2 <= count)
            next[links->source[k] + 2]++;
    for (uint32_t j = 2; j <= count; j++)
        next[j] += next[j - 1];
    for (uint32_t i = 0; i < count; i++)
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++) {
            const uint64_t at = next[links->source[k] + 1]++;
            columns->receiver[at] = i;
            columns->form_factor[at] = links->form_factor[k];
        }
    return true;
}

void link_columns_clear(LinkColumns *columns)
{
    array_free(columns->first);
    array_free(columns->receiver);
    array_free(columns->form_factor);
    *columns = (LinkColumns){ 0 };
}

/* F_ji, or 0 when j has no link to i. Asked for rising i, so each row is walked along once: *cursor
 * is how far row j has been. Without it (memory is short) the row is searched. */
static double factor_back(const Links *links, uint32_t j, uint32_t i, uint64_t *cursor)
{
    const uint64_t end = links->first[j + 1];
    uint64_t low = links->first[j], high = end;
    if (cursor != NULL) {
        for (low += *cursor; low < end && links->source[low] < i; low++)
            continue;
        *cursor = low - links->first[j];
    } else {
        while (low < high) {
            const uint64_t middle = low + (high - low) / 2;
            if (links->source[middle] < i)
                low = middle + 1;
            else
                high = middle;
        }
    }
    return low < end && links->source[low] == i ? links->form_factor[low] : 0;
}

void links_report(const Links *links, LinksReport *report)
{
    assert(links != NULL && report != NULL);
    *report = (LinksReport){ .nonzeros = links->first[links->count] };
    double area = 0, row_squares = 0, pair_squares = 0;
    uint64_t pairs = 0;
    uint32_t rows = 0;
    Error ignored = { 0 };
    uint64_t *cursor = array_create(links->count, sizeof *cursor, "a report", &ignored);
    for (uint32_t i = 0; i < links->count; i++) {
        double sum = links->escape[i];
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++) {
            const uint32_t j = links->source[k];
            const double f = links->form_factor[k];
            const double back = factor_back(links, j, i, cursor != NULL ? &cursor[j] : NULL);
            sum += f;
            if (j < i && back > 0)
                continue; /* met from the other side already */
            const double larger = fmax(links->area[i], links->area[j]);
            const double error =
                larger > 0 ? fabs(links->area[i] * f - links->area[j] * back) / larger : 0;
            report->reciprocity_error_max = fmax(report->reciprocity_error_max, error);
            pair_squares += error * error;
            pairs++;
        }
        if (!(links->area[i] > 0))
            continue; /* hidden inside a solid: takes no part */
        area += links->area[i];
        report->escaped += links->area[i] * links->escape[i];
        report->row_sum_error_max = fmax(report->row_sum_error_max, fabs(sum - 1));
        row_squares += (sum - 1) * (sum - 1);
        rows++;
    }
    array_free(cursor);
    report->escaped = area > 0 ? report->escaped / area : 0;
    report->row_sum_error_rms = rows > 0 ? sqrt(row_squares / rows) : 0;
    report->reciprocity_error_rms = pairs > 0 ? sqrt(pair_squares / (double)pairs) : 0;
    report->bytes = report->nonzeros * (sizeof *links->source + sizeof *links->form_factor) +
                    (uint64_t)links->count * (sizeof *links->first + sizeof *links->escape +
                                              sizeof *links->area + sizeof *links->lamp);
}
