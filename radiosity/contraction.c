/* SPDX-License-Identifier: BSD-3-Clause */
/* How much light is reflected once more at most: sums over the columns of rho F, in the norm in
 * which power adds up. */
#include "radiosity/contraction.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "radiosity/links_store.h"

/* Rows are summed in this many parts, each by one thread into sums of its own. */
enum { PARTS = 4 };

/* Patches whose sums are joined by a thread at a time. */
enum { JOIN_CHUNK = 4096 };

static const char what[] = "a bound on the error";

typedef struct {
    const Links  *links;
    const double *reflectance, *before;  /* before: what is taken off; NULL: 0 */
    const uint32_t *row;                 /* [rows]  to be read; NULL: all */
    uint32_t      rows;
    unsigned      bands;
    double       *sum[PARTS];            /* [count * bands] */
    double       *plain[PARTS];          /* [count]  for rho = 1; NULL: known */
    double       *change;                /* [PARTS * bands] */
    double       *out;                   /* [count * bands]  what they are added to */
    LinksScratch  scratch[PARTS];
} Columns;

/* The usual three bands, with what is added in registers. */
static void add_row_rgb(const LinksRow *row, double area, const double *rho, double *sum)
{
    const double r = area * rho[0], g = area * rho[1], b = area * rho[2];
    for (uint64_t k = 0; k < row->count; k++) {
        double *to = &sum[(size_t)row->source[k] * 3];
        const double f = row->form_factor[k];
        to[0] += f * r;
        to[1] += f * g;
        to[2] += f * b;
    }
}

static void add_row(const Columns *c, uint32_t i, uint32_t part)
{
    double *change = &c->change[(size_t)part * c->bands];
    const LinksRow row = links_row(c->links, i, (LinksScratch *)&c->scratch[part]);
    for (unsigned b = 0; b < c->bands; b++) {
        const size_t at = (size_t)i * c->bands + b;
        change[b] = c->reflectance[at] - (c->before != NULL ? c->before[at] : 0);
    }
    if (c->plain[part] != NULL)
        for (uint64_t k = 0; k < row.count; k++)
            c->plain[part][row.source[k]] += c->links->area[i] * row.form_factor[k];
    if (c->bands == 3) {
        add_row_rgb(&row, c->links->area[i], change, c->sum[part]);
        return;
    }
    for (uint64_t k = 0; k < row.count; k++)
        for (unsigned b = 0; b < c->bands; b++)
            c->sum[part][(size_t)row.source[k] * c->bands + b] +=
                c->links->area[i] * row.form_factor[k] * change[b];
}

static void add_part(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Columns *c = context;
    (void)worker;
    for (uint32_t part = begin; part < end; part++) {
        const uint32_t last = (uint32_t)((uint64_t)c->rows * (part + 1) / PARTS);
        for (uint32_t k = (uint32_t)((uint64_t)c->rows * part / PARTS); k < last; k++) {
            add_row(c, c->row != NULL ? c->row[k] : k, part);
            if (c->row == NULL)
                links_pass(c->links, k);
        }
    }
}

static void join(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Columns *c = context;
    const size_t first = (size_t)begin * c->bands, last = (size_t)end * c->bands;
    (void)worker;
    for (int part = 0; part < PARTS; part++)
        for (size_t k = first; k < last; k++)
            c->out[k] += c->sum[part][k];
    for (int part = 1; part < PARTS && c->plain[0] != NULL; part++)
        for (uint32_t i = begin; i < end; i++)
            c->plain[0][i] += c->plain[part][i];
}

static double find_most(const Links *links, unsigned bands, const double *column)
{
    double most = 0;
    /* A patch without visible area has no row: its own value is exact from the start. */
    for (size_t k = 0; k < (size_t)links->count * bands; k++)
        if (links->area[k / bands] > 0)
            most = fmax(most, column[k] / links->area[k / bands]);
    return most;
}

static bool add_rows(Columns *c, unsigned threads, Reflected *r, Error *err)
{
    const size_t values = (size_t)c->links->count * c->bands;
    c->change = array_create((size_t)PARTS * c->bands, sizeof *c->change, what, err);
    for (int k = 0; k < PARTS && !error_is_set(err); k++) {
        c->sum[k] = array_create(values, sizeof *c->sum[k], what, err);
        if (c->before == NULL)
            c->plain[k] = array_create(c->links->count, sizeof *c->plain[k], what, err);
        links_scratch_create(c->links, &c->scratch[k], err);
    }
    if (!error_is_set(err)) {
        parallel_for(PARTS, 1, threads, add_part, c, NULL, NULL);
        parallel_for(c->links->count, JOIN_CHUNK, threads, join, c, NULL, NULL);
        if (c->before == NULL)
            r->plain = find_most(c->links, 1, c->plain[0]);
    }
    for (int k = 0; k < PARTS; k++) {
        array_free(c->sum[k]);
        array_free(c->plain[k]);
        links_scratch_clear(&c->scratch[k]);
    }
    array_free(c->change);
    return !error_is_set(err);
}

/* Rows of patches that reflect otherwise than before. */
static uint32_t *changed_rows(const Columns *c, uint32_t *rows, Error *err)
{
    uint32_t *row = array_create(c->links->count, sizeof *row, what, err);
    *rows = 0;
    for (uint32_t i = 0; row != NULL && i < c->links->count; i++)
        if (memcmp(&c->reflectance[(size_t)i * c->bands], &c->before[(size_t)i * c->bands],
                   c->bands * sizeof *c->before) != 0)
            row[(*rows)++] = i;
    return row;
}

Reflected *reflected_create(const Links *links, unsigned bands, const double *reflectance,
                            const Reflected *before, unsigned threads, Error *err)
{
    assert(links != NULL && reflectance != NULL && bands > 0);
    assert(before == NULL || before->values == (size_t)links->count * bands);
    const size_t values = (size_t)links->count * bands;
    Reflected *r = array_create(1, sizeof *r, what, err);
    if (r == NULL)
        return NULL;
    r->values = values;
    r->column = array_create(values, sizeof *r->column, what, err);
    r->reflectance = array_create(values, sizeof *r->reflectance, what, err);
    if (error_is_set(err))
        return reflected_destroy(r);
    memcpy(r->reflectance, reflectance, values * sizeof *reflectance);
    Columns c = { .links = links, .reflectance = reflectance, .bands = bands, .out = r->column,
                  .rows = links->count };
    uint32_t *row = NULL;
    if (before != NULL) {
        memcpy(r->column, before->column, values * sizeof *r->column);
        c.before = before->reflectance;
        r->plain = before->plain;
        c.row = row = changed_rows(&c, &c.rows, err);
    }
    if (!error_is_set(err) && c.rows > 0)
        add_rows(&c, threads, r, err);
    array_free(row);
    if (error_is_set(err))
        return reflected_destroy(r);
    r->most = find_most(links, bands, r->column);
    return r;
}

Reflected *reflected_destroy(Reflected *r)
{
    if (r == NULL)
        return NULL;
    array_free(r->column);
    array_free(r->reflectance);
    return array_free(r);
}
