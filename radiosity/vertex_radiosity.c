/* SPDX-License-Identifier: BSD-3-Clause */
/* Values of patches carried over to the vertices they share. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/mean_value.h"
#include "radiosity/solve.h"
#include "radiosity/vertex_fit.h"

/* How far a vertex at a rim may leave the range of the patches' values, as a share of that range:
 * what a linear function does is up to 1/2 at the rim of a grid, 2/3 at the tip of a triangle, more
 * beside finer patches. */
static const double RIM_RANGE = 1;

/* What is the same for all values on the same patches. */
struct VertexCarry {
    VertexFit fit;
    double   *area;          /* [patches]  a copy */
    uint64_t *first;         /* [vertices + 1]  rows of the planes: */
    size_t    capacity, weight_capacity;
    uint32_t *patch;         /* [first[vertices]] */
    double   *weight;        /* the same */
    bool     *inside;        /* [vertices] */
    double   *corner_weight; /* [corners of faces]  of the mean over a face */
};

typedef struct {
    VertexFit     fit;
    const VertexCarry *kept; /* NULL: rows are made as they are needed */
    unsigned      bands;
    const double *value;     /* [patches * bands] */
    double       *out;       /* [vertices * bands] */
    double       *missing;   /* [patches * bands]  value less the mean that the vertices make */
    double       *weight;    /* [most corners of a face] */
} Carry;

/* A row wherever it lies. */
typedef struct {
    uint32_t        count;
    const uint32_t *patch;
    const double   *weight;
    bool            inside;
} Row;

static Row row_of(const Carry *c, uint32_t vertex, FitRow *made)
{
    const VertexCarry *k = c->kept;
    if (k != NULL) {
        const uint64_t first = k->first[vertex];
        return (Row){ (uint32_t)(k->first[vertex + 1] - first), k->patch + first, k->weight + first,
                      k->inside[vertex] };
    }
    vertex_fit_row(&c->fit, vertex, made);
    return (Row){ made->count, made->patch, made->weight, made->inside };
}

static double row_sum(const Row *row, unsigned bands, const double *value)
{
    double sum = 0;
    for (uint32_t k = 0; k < row->count; k++)
        sum += row->weight[k] * value[(size_t)row->patch[k] * bands];
    return sum;
}

/* v kept within what the patches allow. */
static double row_limit(const Row *row, unsigned bands, const double *value, double v)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t k = 0; k < row->count; k++) {
        low = fmin(low, value[(size_t)row->patch[k] * bands]);
        high = fmax(high, value[(size_t)row->patch[k] * bands]);
    }
    const double more = row->inside ? 0 : RIM_RANGE * (high - low);
    /* Light is not negative; a caller's other quantities keep their sign. */
    const double floor = low >= 0 ? fmax(low - more, 0) : low - more;
    return fmin(fmax(v, floor), high + more);
}

/* Adds what the planes through `patch_value` say to all vertices. */
static void carry_add(Carry *c, const double *patch_value)
{
    FitRow made;
    for (uint32_t v = 0; v < c->fit.patches->vertex_count; v++) {
        const Row row = row_of(c, v, &made);
        for (unsigned b = 0; b < c->bands && row.count > 0; b++) {
            double *out = &c->out[(size_t)v * c->bands + b];
            *out = row_limit(&row, c->bands, c->value + b,
                             *out + row_sum(&row, c->bands, patch_value + b));
        }
    }
}

/* Takes the mean over one face, which is `share` of patch i, off what patch i misses. */
static void take_face(Carry *c, uint32_t i, uint32_t face, double share)
{
    const Patches *p = c->fit.patches;
    const uint32_t first = p->first_corner[face], n = p->first_corner[face + 1] - first;
    const IndexPolygon polygon = { p->position, p->corner + first, n };
    const double *weight = c->kept != NULL ? c->kept->corner_weight + first : c->weight;
    if (c->kept == NULL)
        mean_value_average(&polygon, c->weight);
    for (uint32_t k = 0; k < n; k++) {
        const double *at = c->out + (size_t)polygon.corner[k] * c->bands;
        for (unsigned b = 0; b < c->bands; b++)
            c->missing[(size_t)i * c->bands + b] -= share * weight[k] * at[b];
    }
}

static void find_missing(Carry *c)
{
    const Patches *p = c->fit.patches;
    for (uint32_t i = 0; i < p->count; i++) {
        double *missing = c->missing + (size_t)i * c->bands;
        const uint32_t first = p->first_piece[i], pieces = p->first_piece[i + 1] - first;
        for (unsigned b = 0; b < c->bands; b++)
            missing[b] = c->value[(size_t)i * c->bands + b];
        if (pieces == 0)
            take_face(c, i, p->face_of[i], 1);
        for (uint32_t k = 0; k < pieces; k++)
            take_face(c, i, p->face_of[i] + k,
                      p->piece_end[first + k] - (k > 0 ? p->piece_end[first + k - 1] : 0));
        /* The mean of a patch that is half hidden says that of its other half only. */
        const double seen = fmin(c->fit.area[i] / p->area[i], 1);
        for (unsigned b = 0; b < c->bands; b++)
            missing[b] *= seen;
    }
}

static uint32_t most_corners(const Patches *p)
{
    uint32_t most = 0;
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t corners = p->first_corner[f + 1] - p->first_corner[f];
        most = corners > most ? corners : most;
    }
    return most;
}

/* Planes cut peaks off and fill hollows: what the patches have lost is given once more ("twicing")
 * [tukey77]. Cornell box, 2000 patches: RMSE 2.7 to 1.8 %, and the mean is right to 0.1 % where it
 * was 0.5 % low. */
static bool carry(Carry *c, Error *err)
{
    const Patches *p = c->fit.patches;
    memset(c->out, 0, (size_t)p->vertex_count * c->bands * sizeof *c->out);
    c->weight = array_create(most_corners(p), sizeof *c->weight, "vertex values", err);
    c->missing = array_create((size_t)p->count * c->bands, sizeof *c->missing, "vertex values",
                              err);
    if (!error_is_set(err)) {
        carry_add(c, c->value);
        find_missing(c);
        carry_add(c, c->missing);
    }
    array_free(c->missing);
    array_free(c->weight);
    return !error_is_set(err);
}

bool vertex_radiosity(const Patches *patches, const double *area, unsigned bands,
                      const double *patch_value, double *out, Error *err)
{
    assert(patches != NULL && area != NULL && patch_value != NULL && out != NULL && bands > 0);
    Carry c = { .bands = bands, .value = patch_value, .out = out };
    const bool done = vertex_fit_create(&c.fit, patches, area, err) && carry(&c, err);
    vertex_fit_clear(&c.fit);
    return done;
}

/* --- kept ------------------------------------------------------------------------------------- */

static bool keep_row(VertexCarry *k, uint32_t vertex, Error *err)
{
    FitRow row;
    vertex_fit_row(&k->fit, vertex, &row);
    const uint64_t first = k->first[vertex], end = first + row.count;
    if (!array_reserve((void **)&k->patch, &k->capacity, end, sizeof *k->patch, "planes", err) ||
        !array_reserve((void **)&k->weight, &k->weight_capacity, end, sizeof *k->weight, "planes",
                       err))
        return false;
    memcpy(k->patch + first, row.patch, row.count * sizeof *row.patch);
    memcpy(k->weight + first, row.weight, row.count * sizeof *row.weight);
    k->inside[vertex] = row.inside;
    k->first[vertex + 1] = end;
    return true;
}

static bool keep_all(VertexCarry *k, const Patches *p, const double *area, Error *err)
{
    static const char what[] = "planes";
    const uint32_t corners = p->first_corner[p->face_count];
    k->area = array_create(p->count, sizeof *k->area, what, err);
    k->first = array_create((size_t)p->vertex_count + 1, sizeof *k->first, what, err);
    k->inside = array_create(p->vertex_count, sizeof *k->inside, what, err);
    k->corner_weight = array_create(corners, sizeof *k->corner_weight, what, err);
    if (error_is_set(err))
        return false;
    memcpy(k->area, area, p->count * sizeof *area);
    if (!vertex_fit_create(&k->fit, p, k->area, err))
        return false;
    for (uint32_t v = 0; v < p->vertex_count; v++)
        if (!keep_row(k, v, err))
            return false;
    for (uint32_t f = 0; f < p->face_count; f++) {
        const uint32_t first = p->first_corner[f], n = p->first_corner[f + 1] - first;
        const IndexPolygon polygon = { p->position, p->corner + first, n };
        mean_value_average(&polygon, k->corner_weight + first);
    }
    return true;
}

VertexCarry *vertex_carry_create(const Patches *patches, const double *area, Error *err)
{
    assert(patches != NULL && area != NULL);
    VertexCarry *k = array_create(1, sizeof *k, "planes", err);
    if (k == NULL || keep_all(k, patches, area, err))
        return k;
    return vertex_carry_destroy(k);
}

VertexCarry *vertex_carry_destroy(VertexCarry *k)
{
    if (k == NULL)
        return NULL;
    vertex_fit_clear(&k->fit);
    array_free(k->area);
    array_free(k->first);
    array_free(k->patch);
    array_free(k->weight);
    array_free(k->inside);
    array_free(k->corner_weight);
    return array_free(k);
}

bool vertex_carry_fits(const VertexCarry *k, const Patches *patches, const double *area)
{
    return k != NULL && k->fit.patches == patches &&
           memcmp(k->area, area, patches->count * sizeof *area) == 0;
}

bool vertex_carry_values(const VertexCarry *k, unsigned bands, const double *patch_value,
                         double *out, Error *err)
{
    assert(k != NULL && patch_value != NULL && out != NULL && bands > 0);
    Carry c = { .fit = k->fit, .kept = k, .bands = bands, .value = patch_value, .out = out };
    return carry(&c, err);
}
