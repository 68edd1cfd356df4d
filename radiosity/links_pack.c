/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_pack.c -- links in 16 bits for the factor and 16 for the source. */
#include "radiosity/links_pack.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "base/spill.h"

enum { PACK_CHUNK = 1024, GAP_MOST = UINT16_MAX };

/* Bits of a float's fraction that are dropped, and the exponent that the code's 0 stands for: that
 * of 1 is then 31, the greatest. */
enum { DROPPED_BITS = 12, EXPONENT_ZERO = 127 - 31 };

static float from_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float decode(uint32_t code)
{
    const uint32_t bits = (code << DROPPED_BITS) + ((uint32_t)EXPONENT_ZERO << 23);
    return from_bits(code != 0 ? bits : 0);
}

/* share: from 0 to 1. Rounds to nearest, halves to even. */
static uint16_t encode(float share)
{
    uint32_t bits;
    memcpy(&bits, &share, sizeof bits);
    if (!(share > 0))
        return 0;
    const uint32_t half = (1u << (DROPPED_BITS - 1)) - 1 + (bits >> DROPPED_BITS & 1);
    const uint32_t code = (bits + half) >> DROPPED_BITS;
    const uint32_t least = ((uint32_t)EXPONENT_ZERO << (23 - DROPPED_BITS)) + 1;
    assert(share <= 1);
    return (uint16_t)((code > least ? code : least) - least + 1);
}

LinksRow links_unpack_row(const Links *links, uint32_t i, LinksScratch *scratch)
{
    const uint64_t n = links->first[i + 1] - links->first[i];
    const uint16_t *from = &links->packed[2 * links->first[i]];
    const float scale = links->scale[i];
    uint32_t source = 0;
    for (uint64_t k = 0; k < n; k++) {
        source += from[2 * k];
        scratch->source[k] = source;
        scratch->form_factor[k] = decode(from[2 * k + 1]) * scale;
    }
    return (LinksRow){ scratch->source, scratch->form_factor, n };
}

void links_packed_free(Links *links)
{
    if (links->mapped > 0)
        spill_unmap(links->packed, links->mapped);
    else
        array_free(links->packed);
    array_free(links->scale);
    links->packed = NULL;
    links->scale = NULL;
    links->mapped = 0;
}

typedef struct {
    const Links *from;
    Links       *to;
    double      *worst;  /* [chunks]  greatest rounding, relative */
} Packing;

/* Entries that a row takes. */
static uint64_t packed_length(const Links *links, uint32_t i)
{
    uint64_t n = 0;
    uint32_t before = 0;
    for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++) {
        const uint32_t gap = links->source[k] - before;
        n += 1 + (gap > 0 ? (gap - 1) / GAP_MOST : 0);
        before = links->source[k];
    }
    return n;
}

static void pack_row(const Packing *p, uint32_t i, double *worst)
{
    const Links *from = p->from;
    uint16_t *out = &p->to->packed[2 * p->to->first[i]];
    float largest = 0;
    double sum = 0, rounded = 0;
    uint32_t before = 0;
    for (uint64_t k = from->first[i]; k < from->first[i + 1]; k++) {
        largest = fmaxf(largest, from->form_factor[k]);
        sum += from->form_factor[k];
    }
    for (uint64_t k = from->first[i]; k < from->first[i + 1]; k++) {
        uint32_t gap = from->source[k] - before;
        for (; gap > GAP_MOST; gap -= GAP_MOST) {
            *out++ = GAP_MOST;
            *out++ = 0;
        }
        *out++ = (uint16_t)gap;
        *out = encode(largest > 0 ? from->form_factor[k] / largest : 0);
        rounded += (double)largest * decode(*out++);
        before = from->source[k];
    }
    assert(out == &p->to->packed[2 * p->to->first[i + 1]]);
    p->to->scale[i] = rounded > 0 ? (float)(largest * (sum / rounded)) : 0;
    out = &p->to->packed[2 * p->to->first[i]];
    for (uint64_t k = from->first[i]; k < from->first[i + 1]; k++, out += 2) {
        while (out[0] == GAP_MOST && out[1] == 0 && from->form_factor[k] > 0)
            out += 2;
        const double f = from->form_factor[k];
        const double error = f > 0 ? fabs(decode(out[1]) * (double)p->to->scale[i] / f - 1) : 0;
        *worst = fmax(*worst, error);
    }
}

static void pack_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Packing *p = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        pack_row(p, i, &p->worst[begin / PACK_CHUNK]);
    links_leave(p->from, begin, end);
    links_leave(p->to, begin, end);
}

/* All but the links. */
static bool copy_rows(const Links *from, Links *to, const char *folder, Error *err)
{
    static const char what[] = "packed links";
    const uint32_t count = from->count;
    to->first = array_create((size_t)count + 1, sizeof *to->first, what, err);
    to->escape = array_create(count, sizeof *to->escape, what, err);
    to->area = array_create(count, sizeof *to->area, what, err);
    to->scale = array_create(count, sizeof *to->scale, what, err);
    if (from->lamp != NULL)
        to->lamp = array_create(count, sizeof *to->lamp, what, err);
    if (folder != NULL)
        to->folder = array_string(folder, err);
    if (error_is_set(err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        to->first[i + 1] = to->first[i] + packed_length(from, i);
    memcpy(to->escape, from->escape, count * sizeof *to->escape);
    memcpy(to->area, from->area, count * sizeof *to->area);
    if (from->lamp != NULL)
        memcpy(to->lamp, from->lamp, count * sizeof *to->lamp);
    return true;
}

Links *links_pack(const Links *links, const char *folder, unsigned threads, double *rounding,
                  Error *err)
{
    assert(links != NULL && links->packed == NULL && rounding != NULL);
    Links *to = array_create(1, sizeof *to, "packed links", err);
    const uint32_t chunks = (links->count + PACK_CHUNK - 1) / PACK_CHUNK;
    double *worst = array_create(chunks, sizeof *worst, "packed links", err);
    if (to == NULL || worst == NULL) {
        array_free(worst);
        return array_free(to);
    }
    to->count = links->count;
    to->rays = links->rays;
    to->clamped = links->clamped;
    to->seconds = links->seconds;
    if (copy_rows(links, to, folder, err)) {
        const uint64_t entries = to->first[to->count];
        if (folder != NULL) {
            to->mapped = (entries > 0 ? entries : 1) * LINKS_PACKED_BYTES;
            to->packed = spill_map(folder, to->mapped, "packed links", err);
        } else {
            to->packed = array_create(entries, LINKS_PACKED_BYTES, "packed links", err);
        }
        to->mapped = to->packed != NULL ? to->mapped : 0;
    }
    *rounding = 0;
    if (!error_is_set(err)) {
        Packing packing = { links, to, worst };
        parallel_for(links->count, PACK_CHUNK, threads, pack_chunk, &packing, NULL, NULL);
        for (uint32_t c = 0; c < chunks; c++)
            *rounding = fmax(*rounding, worst[c]);
    } else {
        array_free(to->scale);
        to->scale = NULL;
        to = links_destroy(to);
    }
    array_free(worst);
    return to;
}
