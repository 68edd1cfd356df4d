/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_store.c -- links as an object: made, freed, their rows and columns read, wherever
 * they lie. */
#include "radiosity/links_store.h"

#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/spill.h"
#include "radiosity/links_pack.h"

/* What must be in memory though the links are not: per patch the vectors of closing and solving,
 * and what a block of columns and the threads' rows take. */
static const double BYTES_PER_PATCH = 256, BYTES_OF_BLOCKS = 24 << 20;

bool links_choose_folder(double bytes, uint32_t patches, const LinksOptions *options,
                         const char **folder, Error *err)
{
    const double most = (double)options->max_bytes, MIB = 0x1p20;
    *folder = NULL;
    if (options->max_bytes == 0 || bytes <= most)
        return true;
    if (options->folder == NULL)
        return error_set(err, ERROR_MEMORY,
                         "form factors of %u patches need about %.0f MiB, %.0f MiB are allowed: "
                         "use fewer rays or larger patches", patches, ceil(bytes / MIB),
                         most / MIB);
    const double least = patches * BYTES_PER_PATCH + BYTES_OF_BLOCKS;
    if (least > most)
        return error_set(err, ERROR_MEMORY,
                         "even with the form factors in a file, %u patches need about %.0f MiB, "
                         "%.0f MiB are allowed: use larger patches", patches, ceil(least / MIB),
                         most / MIB);
    const double room = (double)spill_free_bytes(options->folder);
    if (bytes > room)
        return error_at(err, ERROR_MEMORY, options->folder, 0,
                        "form factors of %u patches need about %.0f MiB of disk there, %.0f MiB "
                        "are free: set TMPDIR, or use fewer rays", patches, ceil(bytes / MIB),
                        room / MIB);
    *folder = options->folder;
    return true;
}

/* --- made and freed --------------------------------------------------------------------------- */

bool links_chunk_create(uint64_t links, const char *folder, uint32_t **source, float **form_factor,
                        uint64_t *mapped, Error *err)
{
    *mapped = 0;
    if (folder == NULL) {
        *source = array_create(links, sizeof **source, "links", err);
        *form_factor = array_create(links, sizeof **form_factor, "links", err);
        return !error_is_set(err);
    }
    const uint64_t bytes = (links > 0 ? links : 1) * (sizeof **source + sizeof **form_factor);
    *source = spill_map(folder, bytes, "links", err);
    *form_factor = *source != NULL ? (float *)(*source + links) : NULL;
    *mapped = *source != NULL ? bytes : 0;
    return *source != NULL;
}

void links_chunk_leave(const uint32_t *source, uint64_t mapped)
{
    if (mapped > 0)
        spill_leave(source, 0, mapped);
}

void links_chunk_free(uint32_t **source, float **form_factor, uint64_t *mapped)
{
    if (*mapped > 0) {
        spill_unmap(*source, *mapped);
    } else {
        array_free(*source);
        array_free(*form_factor);
    }
    *source = NULL;
    *form_factor = NULL;
    *mapped = 0;
}

Links *links_allocate_in(uint32_t count, uint64_t nonzeros, const char *folder, Error *err)
{
    static const char what[] = "rows of links";
    Links *links = array_create(1, sizeof *links, "links", err);
    if (links == NULL)
        return NULL;
    links->count = count;
    links->first = array_create((size_t)count + 1, sizeof *links->first, what, err);
    links->escape = array_create(count, sizeof *links->escape, what, err);
    links->area = array_create(count, sizeof *links->area, what, err);
    links->lamp = array_create(count, sizeof *links->lamp, what, err);
    if (folder != NULL)
        links->folder = array_string(folder, err);
    if (!error_is_set(err))
        links_chunk_create(nonzeros, folder, &links->source, &links->form_factor, &links->mapped,
                           err);
    return error_is_set(err) ? links_destroy(links) : links;
}

Links *links_allocate(uint32_t count, uint64_t nonzeros, Error *err)
{
    return links_allocate_in(count, nonzeros, NULL, err);
}

Links *links_destroy(Links *links)
{
    if (links == NULL)
        return NULL;
    if (links->packed != NULL) {
        links_packed_free(links);
    } else {
        links_chunk_free(&links->source, &links->form_factor, &links->mapped);
    }
    array_free(links->first);
    array_free(links->escape);
    array_free(links->area);
    array_free(links->lamp);
    array_free(links->folder);
    return array_free(links);
}

bool links_check(const Links *links)
{
    assert(links != NULL && links->packed == NULL);
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
        links_pass(links, i);
    }
    return true;
}

void links_leave(const Links *links, uint32_t begin, uint32_t end)
{
    assert(begin <= end && end <= links->count);
    if (links->mapped == 0)
        return;
    const uint64_t low = links->first[begin], high = links->first[end];
    if (links->packed != NULL) {
        spill_leave(links->packed, low * LINKS_PACKED_BYTES, high * LINKS_PACKED_BYTES);
    } else {
        spill_leave(links->source, low * sizeof *links->source, high * sizeof *links->source);
        spill_leave(links->form_factor, low * sizeof *links->form_factor,
                    high * sizeof *links->form_factor);
    }
}

/* --- rows ------------------------------------------------------------------------------------- */

bool links_scratch_create(const Links *links, LinksScratch *scratch, Error *err)
{
    uint64_t longest = 0;
    *scratch = (LinksScratch){ NULL, NULL };
    if (links->packed == NULL)
        return true;
    for (uint32_t i = 0; i < links->count; i++) {
        const uint64_t n = links->first[i + 1] - links->first[i];
        longest = n > longest ? n : longest;
    }
    scratch->source = array_create(longest, sizeof *scratch->source, "a row of links", err);
    scratch->form_factor = array_create(longest, sizeof *scratch->form_factor, "a row of links",
                                        err);
    if (error_is_set(err))
        links_scratch_clear(scratch);
    return !error_is_set(err);
}

void links_scratch_clear(LinksScratch *scratch)
{
    array_free(scratch->source);
    array_free(scratch->form_factor);
    *scratch = (LinksScratch){ NULL, NULL };
}

/* --- columns ---------------------------------------------------------------------------------- */

uint64_t *links_column_totals(const Links *links, Error *err)
{
    const uint32_t count = links->count;
    LinksScratch scratch = { NULL, NULL };
    uint64_t *total = array_create((size_t)count + 1, sizeof *total, "columns", err);
    if (total == NULL || !links_scratch_create(links, &scratch, err))
        return array_free(total);
    for (uint32_t i = 0; i < count; i++) {
        const LinksRow row = links_row(links, i, &scratch);
        for (uint64_t k = 0; k < row.count; k++)
            total[row.source[k] + 1]++;
        links_pass(links, i);
    }
    for (uint32_t j = 0; j < count; j++)
        total[j + 1] += total[j];
    links_scratch_clear(&scratch);
    return total;
}

uint32_t link_columns_end(const uint64_t *total, uint32_t count, uint32_t begin, uint64_t most)
{
    assert(begin < count);
    uint32_t low = begin + 1, high = count;
    while (low < high) {
        const uint32_t middle = high - (high - low) / 2;
        if (total[middle] - total[begin] <= most)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The first link of a row whose source is `source` or more. */
static uint64_t find_source(const LinksRow *row, uint32_t source)
{
    uint64_t low = 0, high = row->count;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (row->source[middle] < source)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Appends the links of all rows to columns [begin, end), each from next[j - begin] on. */
static void fill_columns(const Links *links, LinksScratch *scratch, uint32_t begin, uint32_t end,
                         LinkColumns *columns, uint64_t *next)
{
    for (uint32_t i = 0; i < links->count; i++) {
        const LinksRow row = links_row(links, i, scratch);
        const uint64_t from = begin > 0 ? find_source(&row, begin) : 0;
        for (uint64_t k = from; k < row.count && row.source[k] < end; k++) {
            const uint64_t at = next[row.source[k] - begin]++;
            columns->receiver[at] = i;
            columns->form_factor[at] = row.form_factor[k];
        }
        links_pass(links, i);
    }
}

/* Into a mapped file a block at a time, so that what is written to lies together. */
static void fill_blocks(const Links *links, const uint64_t *total, LinksScratch *scratch,
                        LinkColumns *columns, uint64_t *next)
{
    const uint64_t base = total[columns->begin];
    for (uint32_t begin = columns->begin, end; begin < columns->end; begin = end) {
        end = columns->mapped > 0 ? link_columns_end(total, columns->end, begin, COLUMN_BLOCK)
                                  : columns->end;
        fill_columns(links, scratch, begin, end, columns, next + (begin - columns->begin));
        if (columns->mapped > 0) {
            spill_leave(columns->receiver, (total[begin] - base) * sizeof *columns->receiver,
                        (total[end] - base) * sizeof *columns->receiver);
            spill_leave(columns->form_factor, (total[begin] - base) * sizeof(float),
                        (total[end] - base) * sizeof(float));
        }
    }
}

bool link_columns_create(const Links *links, const uint64_t *total, uint32_t begin, uint32_t end,
                         bool own_file, LinkColumns *columns, Error *err)
{
    assert(begin <= end && end <= links->count);
    const size_t n = end - begin;
    LinksScratch scratch = { NULL, NULL };
    *columns = (LinkColumns){ .begin = begin, .end = end };
    columns->first = array_create(n + 1, sizeof *columns->first, "columns", err);
    uint64_t *next = array_create(n + 1, sizeof *next, "columns", err);
    if (!error_is_set(err))
        links_chunk_create(total[end] - total[begin], own_file ? links->folder : NULL,
                           &columns->receiver, &columns->form_factor, &columns->mapped, err);
    if (!error_is_set(err) && links_scratch_create(links, &scratch, err)) {
        for (size_t j = 0; j <= n; j++)
            columns->first[j] = next[j] = total[begin + j] - total[begin];
        fill_blocks(links, total, &scratch, columns, next);
    } else {
        link_columns_clear(columns);
    }
    links_scratch_clear(&scratch);
    array_free(next);
    return !error_is_set(err);
}

void link_columns_leave(const LinkColumns *columns, uint32_t j)
{
    const uint64_t low = columns->first[j - columns->begin];
    const uint64_t high = columns->first[j - columns->begin + 1];
    if (columns->mapped == 0)
        return;
    spill_leave(columns->receiver, low * sizeof *columns->receiver,
                high * sizeof *columns->receiver);
    spill_leave(columns->form_factor, low * sizeof(float), high * sizeof(float));
}

void link_columns_clear(LinkColumns *columns)
{
    array_free(columns->first);
    links_chunk_free(&columns->receiver, &columns->form_factor, &columns->mapped);
    *columns = (LinkColumns){ 0 };
}
