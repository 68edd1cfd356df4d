/* SPDX-License-Identifier: BSD-3-Clause */
/* Neighbouring patches taken together. */
#include "radiosity/aggregates.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"

/* Patches per aggregate, and most aggregates: their dense system is to cost little beside a pass
 * over the links. */
enum { PATCHES_EACH = 32, WANTED_MOST = 1024, COUNT_MOST = 2048 };

/* Rows read of each: what differs between them averages out, and what is left only costs the
 * solver a step. */
enum { ROWS_EACH = 8 };

/* Places of the table of cells; a power of two above COUNT_MOST. */
enum { TABLE = 4 * COUNT_MOST };

/* Aggregates whose rows a thread finds at a time. */
enum { AGGREGATE_CHUNK = 16 };

/* How much larger cells become when there were too many. */
static const double GROWTH = 1.5;

static const char what[] = "aggregates of patches";

/* --- cells ------------------------------------------------------------------------------------ */

/* Which of six ways a normal faces most. */
static uint64_t facing(Vec3 n)
{
    const double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    if (x >= y && x >= z)
        return n.x < 0 ? 1 : 0;
    return y >= z ? (n.y < 0 ? 3 : 2) : (n.z < 0 ? 5 : 4);
}

/* 20 bits for each coordinate, in units of cells from the corner of all. */
static uint64_t along(double x, double low, double per_length)
{
    static const double most = (1 << 20) - 1;
    return (uint64_t)fmin((x - low) * per_length, most);
}

static Vec3 lowest(const Vec3 *centre, uint32_t count)
{
    Vec3 low = count > 0 ? centre[0] : vec3(0, 0, 0);
    for (uint32_t i = 1; i < count; i++)
        low = vec3(fmin(low.x, centre[i].x), fmin(low.y, centre[i].y), fmin(low.z, centre[i].z));
    return low;
}

typedef struct {
    uint64_t key[TABLE];
    uint32_t number[TABLE]; /* UINT32_MAX: empty */
} CellTable;

/* Number of a cell, in the order in which patches come upon them. */
static uint32_t cell_number(CellTable *table, uint64_t key, uint32_t *count)
{
    static const uint64_t multiplier = 0x9e3779b97f4a7c15; /* 2^64 over the golden ratio */
    uint32_t at = (uint32_t)(key * multiplier >> 40) % TABLE;
    while (table->number[at] != UINT32_MAX && table->key[at] != key)
        at = (at + 1) % TABLE;
    if (table->number[at] == UINT32_MAX) {
        table->key[at] = key;
        table->number[at] = (*count)++;
    }
    return table->number[at];
}

/* False when there are more than COUNT_MOST. */
static bool number_cells(Aggregates *a, const SolveSystem *system, CellTable *table, Vec3 low,
                         double per_length)
{
    const SolveOptions *o = system->options;
    memset(table->number, 0xff, sizeof table->number);
    a->count = 0;
    for (uint32_t i = 0; i < system->links->count && a->count <= COUNT_MOST; i++) {
        const Vec3 c = o->centre[i];
        const uint64_t key = facing(o->normal[i]) << 60 | along(c.x, low.x, per_length) << 40 |
                             along(c.y, low.y, per_length) << 20 | along(c.z, low.z, per_length);
        a->of[i] = cell_number(table, key, &a->count);
    }
    return a->count <= COUNT_MOST;
}

static bool number_patches(Aggregates *a, const SolveSystem *system, Error *err)
{
    const uint32_t count = system->links->count;
    const uint32_t many = count / PATCHES_EACH;
    const uint32_t wanted = many < 1 ? 1 : many > WANTED_MOST ? WANTED_MOST : many;
    if (system->options->centre == NULL || system->options->normal == NULL) {
        const uint32_t each = count / wanted + (count % wanted != 0);
        for (uint32_t i = 0; i < count; i++)
            a->of[i] = i / each;
        a->count = count > 0 ? (count - 1) / each + 1 : 0;
        return true;
    }
    CellTable *table = array_create(1, sizeof *table, what, err);
    double area = 0;
    for (uint32_t i = 0; i < count; i++)
        area += system->links->area[i];
    double per_length = area > 0 ? sqrt(wanted / area) : 0;
    const Vec3 low = lowest(system->options->centre, count);
    while (table != NULL && !number_cells(a, system, table, low, per_length))
        per_length /= GROWTH;
    array_free(table);
    return table != NULL;
}

/* --- how they see each other ------------------------------------------------------------------ */

typedef struct {
    const SolveSystem *system;
    const Aggregates  *a;
    const uint32_t    *first, *member; /* [count + 1], [patches]  patches of each */
} Rows;

static void add_row(const Rows *rows, uint32_t patch, double weight, unsigned worker, float *out)
{
    const LinksRow row = links_row(rows->system->links, patch, &rows->system->scratch[worker]);
    const float w = (float)weight;
    for (uint64_t k = 0; k < row.count; k++)
        out[rows->a->of[row.source[k]]] += w * row.form_factor[k];
}

static void find_rows(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Rows *rows = context;
    const double *area = rows->system->links->area;
    for (uint32_t n = begin; n < end; n++) {
        const uint32_t from = rows->first[n], to = rows->first[n + 1];
        const uint32_t step = (to - from) / ROWS_EACH + 1;
        double sum = 0;
        for (uint32_t k = from + (step - 1) / 2; k < to; k += step)
            sum += area[rows->member[k]];
        for (uint32_t k = from + (step - 1) / 2; k < to && sum > 0; k += step)
            add_row(rows, rows->member[k], area[rows->member[k]] / sum, worker,
                    &rows->a->factor[(size_t)n * rows->a->count]);
    }
}

/* Patches by aggregate, in order. */
static void collect(const Aggregates *a, uint32_t patches, uint32_t *first, uint32_t *member)
{
    for (uint32_t i = 0; i < patches; i++)
        first[a->of[i] + 1]++;
    for (uint32_t n = 0; n < a->count; n++)
        first[n + 1] += first[n];
    for (uint32_t i = patches; i-- > 0;)
        member[--first[a->of[i] + 1]] = i;
    /* Each entry n + 1 has come down to where n begins. */
    memmove(first, first + 1, a->count * sizeof *first);
    first[a->count] = patches;
}

bool aggregates_create(Aggregates *a, const SolveSystem *system, Error *err)
{
    const uint32_t patches = system->links->count;
    *a = (Aggregates){ 0 };
    a->of = array_create(patches, sizeof *a->of, what, err);
    if (a->of == NULL || !number_patches(a, system, err))
        return false;
    a->area = array_create(a->count, sizeof *a->area, what, err);
    a->factor = array_create((size_t)a->count * a->count, sizeof *a->factor, what, err);
    uint32_t *first = array_create((size_t)a->count + 1, sizeof *first, what, err);
    uint32_t *member = array_create(patches, sizeof *member, what, err);
    if (!error_is_set(err)) {
        collect(a, patches, first, member);
        for (uint32_t i = 0; i < patches; i++)
            a->area[a->of[i]] += system->links->area[i];
        Rows rows = { system, a, first, member };
        parallel_for(a->count, AGGREGATE_CHUNK, system->threads, find_rows, &rows, NULL, NULL);
    }
    array_free(first);
    array_free(member);
    return !error_is_set(err);
}

void aggregates_clear(Aggregates *a)
{
    array_free(a->of);
    array_free(a->area);
    array_free(a->factor);
    *a = (Aggregates){ 0 };
}
