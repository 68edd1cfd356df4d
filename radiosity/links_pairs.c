/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_pairs.c -- what i found of j and j of i, made one number: a symmetric matrix. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/internal.h"

enum { PAIR_CHUNK = 256 };

static bool is_lamp(const Links *links, uint32_t i)
{
    return links->lamp != NULL && links->lamp[i] != 0;
}

/* How far the word of a lamp's own rays counts, 0 to 1. Visibility rays from another patch to a
 * small lamp near it are few close to the lamp, where nearly all of the light arrives. On a disc of
 * radius R, seen from a point e above its middle, F = R^2/(R^2 + e^2), and with q = (e/R)^2
 *   a point spread evenly over the disc carries A G, of mean F, relative variance 1/(3 q (1 + q));
 *   a ray of the lamp meets the disc or not: relative variance (1 - F)/F = q.
 * There are RAYS_PER_SAMPLE rays for each such point, fewer points where there are several lamps.
 * Weights by inverse variances: RAYS_PER_SAMPLE/(RAYS_PER_SAMPLE + 3 q^2 (1 + q)), 1 at the disc,
 * 0.4 one radius off, 1/60 two radii off; from NEAR_MOST on, 1/600, it is not worth a link that the
 * visibility rays have not found. It knows nothing of what was sampled: no bias. */
static double lamp_nearness(const Patches *patches, uint32_t lamp, uint32_t other)
{
    const double RAYS_PER_SAMPLE = 4, NEAR_MOST = 3; /* radii */
    const double square = patches->area[other] / M_PI;
    const Vec3 way = vec3_sub(patches->centre[lamp], patches->centre[other]);
    const double all = vec3_dot(way, way), up = vec3_dot(way, patches->normal[other]);
    const double out = fmax(0, sqrt(fmax(0, all - up * up)) - sqrt(square));
    const double q = (up * up + out * out) / square;
    if (!(q < NEAR_MOST * NEAR_MOST))
        return 0;
    return RAYS_PER_SAMPLE / (RAYS_PER_SAMPLE + 3 * q * q * (1 + q));
}

/* S_ij = A_i F_ij out of both estimates, the same bits whichever comes first.
 *
 * Rays of i that meet j are rare events: of n rays about n F_ij do, so A_i F_ij has the variance
 * A_i S / n, and the best mean of the two estimates weights them by 1/A_i and 1/A_j. It depends on
 * nothing that was sampled, so it adds no bias. A lamp is found by the other patch's own visibility
 * rays, with an error that is small beside that of the few rays of the lamp that come back: between
 * a lamp and another patch the other's word counts alone, unless the lamp is near. */
static double pair_value(const Links *links, const Patches *patches, uint32_t i, uint32_t j,
                         double f, double back)
{
    const double a = links->area[i], b = links->area[j];
    if (!(a > 0 && b > 0 && links->escape[i] < 1 && links->escape[j] < 1))
        return 0;
    double s = (f + back) * (a * b / (a + b));
    if (is_lamp(links, i) != is_lamp(links, j)) {
        const bool own = is_lamp(links, i);
        const double near = patches != NULL ? lamp_nearness(patches, own ? i : j, own ? j : i) : 0;
        const double other = own ? b * back : a * f;
        s = other + near * (s - other);
    }
    return fmin(s, fmin(a, b)); /* neither factor may exceed 1 */
}

typedef struct {
    const Links   *links;
    const Patches *patches; /* NULL: no lamp is near */
    const uint64_t *total;  /* [count + 1]  links in all columns before */
    LinkColumns    columns; /* the block at hand */
    uint64_t      *length;  /* [count + 1]  links in row i at i + 1 */
    Links         *out;     /* NULL: only count */
} Pairing;

/* Merges row i and column i, both sorted, into the row of pairs. */
static void pair_row(Pairing *p, uint32_t i)
{
    const Links *links = p->links;
    const LinkColumns *columns = &p->columns;
    uint64_t r = links->first[i], c = columns->first[i - columns->begin];
    const uint64_t r_end = links->first[i + 1], c_end = columns->first[i - columns->begin + 1];
    uint64_t at = p->out != NULL ? p->out->first[i] : 0;
    const uint64_t begin = at;
    while (r < r_end || c < c_end) {
        const uint32_t from_row = r < r_end ? links->source[r] : PATCH_NONE;
        const uint32_t from_column = c < c_end ? columns->receiver[c] : PATCH_NONE;
        const uint32_t j = from_row < from_column ? from_row : from_column;
        const double f = from_row == j ? links->form_factor[r++] : 0;
        const double back = from_column == j ? columns->form_factor[c++] : 0;
        const float s = (float)pair_value(links, p->patches, i, j, f, back);
        if (!(s > 0))
            continue;
        if (p->out != NULL) {
            p->out->source[at] = j;
            p->out->form_factor[at] = s;
        }
        at++;
    }
    if (p->out == NULL)
        p->length[i + 1] = at - begin;
    else
        assert(at == p->out->first[i + 1]);
}

static void pair_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Pairing *p = context;
    const uint32_t base = p->columns.begin;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        pair_row(p, base + i);
    links_leave(p->links, base + begin, base + end);
    if (p->out != NULL)
        links_leave(p->out, base + begin, base + end);
}

/* All rows, a block of columns at a time where links are mapped, else all at once: these columns
 * stay for the second time. */
static bool pair_rows(Pairing *p, unsigned threads, Error *err)
{
    const Links *links = p->links;
    const uint64_t most = links->mapped > 0 ? COLUMN_BLOCK : UINT64_MAX;
    for (uint32_t begin = 0, end; begin < links->count; begin = end) {
        end = link_columns_end(p->total, links->count, begin, most);
        if (p->columns.first == NULL || p->columns.begin != begin || p->columns.end != end) {
            link_columns_clear(&p->columns);
            if (!link_columns_create(links, p->total, begin, end, false, &p->columns, err))
                return false;
        }
        parallel_for(end - begin, PAIR_CHUNK, threads, pair_chunk, p, NULL, NULL);
    }
    return true;
}

static void fill_rows(const Links *links, const uint64_t *length, Links *out)
{
    for (uint32_t i = 0; i < links->count; i++) {
        out->first[i + 1] = length[i + 1];
        out->escape[i] = links->escape[i];
        out->area[i] = links->area[i];
        out->lamp[i] = is_lamp(links, i);
    }
}

Links *links_pairs(const Links *links, const Patches *patches, unsigned threads, Error *err)
{
    const uint32_t count = links->count;
    uint64_t *length = array_create((size_t)count + 1, sizeof *length, "pairs of links", err);
    uint64_t *total = links_column_totals(links, err);
    Pairing pairing = { .links = links, .patches = patches, .total = total,
                        .length = length };
    Links *out = NULL;
    if (length != NULL && total != NULL && pair_rows(&pairing, threads, err)) {
        for (uint32_t i = 0; i < count; i++)
            length[i + 1] += length[i];
        pairing.out = out = links_allocate_in(count, length[count], links->folder, err);
        if (out != NULL) {
            fill_rows(links, length, out);
            if (!pair_rows(&pairing, threads, err))
                out = links_destroy(out);
        }
    }
    link_columns_clear(&pairing.columns);
    array_free(length);
    array_free(total);
    return out;
}
