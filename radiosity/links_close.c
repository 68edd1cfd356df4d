/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_close.c -- enforces what must hold of form factors, each way in a new Links. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/internal.h"

static Links *copy(const Links *links, Error *err)
{
    const uint64_t nonzeros = links->first[links->count];
    Links *out = links_allocate_in(links->count, nonzeros, links->folder, err);
    if (out == NULL)
        return NULL;
    memcpy(out->first, links->first, ((size_t)links->count + 1) * sizeof *out->first);
    for (uint32_t i = 0; i < links->count; i++) {
        const uint64_t at = links->first[i], n = links->first[i + 1] - at;
        memcpy(&out->source[at], &links->source[at], n * sizeof *out->source);
        memcpy(&out->form_factor[at], &links->form_factor[at], n * sizeof *out->form_factor);
        links_pass(links, i);
        links_pass(out, i);
    }
    memcpy(out->escape, links->escape, links->count * sizeof *out->escape);
    memcpy(out->area, links->area, links->count * sizeof *out->area);
    if (links->lamp != NULL)
        memcpy(out->lamp, links->lamp, links->count * sizeof *out->lamp);
    return out;
}

static bool is_lamp(const Links *links, uint32_t i)
{
    return links->lamp != NULL && links->lamp[i] != 0;
}

/* Rows miss their sum because lamps' samples bring noise of their own into it. Factors to lamps are
 * the better known part, so the others make up the difference as long as they can. */
static void scale_rows(Links *links)
{
    for (uint32_t i = 0; i < links->count; i++) {
        double lamps = 0, others = links->escape[i];
        links_pass(links, i);
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            *(is_lamp(links, links->source[k]) ? &lamps : &others) += links->form_factor[k];
        if (!(lamps + others > 0))
            continue; /* hidden inside a solid */
        const bool keep = lamps < 1 && others > 0;
        const double scale = keep ? (1 - lamps) / others : 1 / (lamps + others);
        links->escape[i] = (float)fmin(links->escape[i] * scale, 1);
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            if (!keep || !is_lamp(links, links->source[k]))
                links->form_factor[k] = (float)fmin(links->form_factor[k] * scale, 1);
    }
}

/* Pairs S_ij back to factors S_ij / A_i. */
static void divide_by_area(Links *pairs)
{
    for (uint32_t i = 0; i < pairs->count; i++) {
        for (uint64_t k = pairs->first[i]; k < pairs->first[i + 1]; k++)
            pairs->form_factor[k] = (float)fmin(pairs->form_factor[k] / pairs->area[i], 1);
        links_pass(pairs, i);
    }
}

/* Finds patches without partner: they send all they have out of the scene, for there is no one left
 * they could be linked to. Returns the share of all area whose light was not meant to escape. */
static double find_alone(Links *pairs, bool *alone)
{
    double lost = 0, area = 0;
    for (uint32_t i = 0; i < pairs->count; i++) {
        area += pairs->area[i];
        alone[i] = pairs->first[i + 1] == pairs->first[i];
        if (alone[i] && pairs->area[i] > 0) {
            lost += pairs->area[i] * (1 - (double)pairs->escape[i]);
            pairs->escape[i] = 1;
        }
    }
    return area > 0 ? lost / area : 0;
}

/* A row that misses its sum by more than this, or light of more than this share of the scene's area
 * that must be counted as escaped, is worth a warning: what links.h and the design promise. */
static const double MISSED_ABOVE = 1e-7, ALONE_ABOVE = 1e-6;

static bool close_both(Links *pairs, unsigned threads, const Monitor *monitor, Error *err)
{
    bool *alone = array_create(pairs->count, sizeof *alone, "the closure", err);
    BalanceReport report;
    if (alone == NULL)
        return false;
    const double lost = find_alone(pairs, alone);
    const bool done = links_balance(pairs, alone, threads, monitor, &report, err);
    array_free(alone);
    if (done && lost > ALONE_ABOVE)
        monitor_warn(monitor, "closure-alone", "",
                     "patches that no other patch found again, %.2g of all area: their light is "
                     "counted as escaped", lost);
    if (done && report.opened > 0)
        monitor_warn(monitor, "closure-opened", "",
                     "the areas of %u patches that see only each other do not match: of their "
                     "light, some is counted as escaped", report.opened);
    if (done && report.missed > MISSED_ABOVE)
        monitor_warn(monitor, "closure-missed", "",
                     "no scaling makes all rows of form factors sum to 1: they miss it by up to "
                     "%.2g; more rays or smaller patches help", report.missed);
    return done;
}

Links *links_close(const Links *links, const Patches *patches, Closure closure, unsigned threads,
                   const Monitor *monitor, Error *err)
{
    if (error_is_set(err))
        return NULL;
    assert(links != NULL && (unsigned)closure <= CLOSURE_BOTH);
    assert(patches == NULL || patches->count == links->count);
    Links *out = closure == CLOSURE_NONE || closure == CLOSURE_ROWS
                     ? copy(links, err)
                     : links_pairs(links, patches, threads, err);
    if (out == NULL)
        return NULL;
    out->rays = links->rays;
    out->clamped = links->clamped;
    out->seconds = links->seconds;
    if (closure == CLOSURE_ROWS)
        scale_rows(out);
    else if (closure == CLOSURE_RECIPROCITY)
        divide_by_area(out);
    else if (closure == CLOSURE_BOTH && !close_both(out, threads, monitor, err))
        return links_destroy(out);
    return out;
}
