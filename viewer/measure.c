/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics of weighted values, and readings at a place. */
#include "viewer/measure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"

typedef struct {
    double value, weight;
} Weighted;

static int by_value(const void *a, const void *b)
{
    const double x = ((const Weighted *)a)->value, y = ((const Weighted *)b)->value;
    return (x > y) - (x < y);
}

/* Of n > 0 sorted values. */
static void sum_up(const Weighted *sorted, uint32_t n, Statistics *out)
{
    double sum = 0, squares = 0, passed = 0;
    for (uint32_t i = 0; i < n; i++) {
        out->weight += sorted[i].weight;
        sum += sorted[i].weight * sorted[i].value;
    }
    out->mean = sum / out->weight;
    for (uint32_t i = 0; i < n; i++) {
        const double d = sorted[i].value - out->mean;
        squares += sorted[i].weight * d * d;
    }
    uint32_t middle = 0;
    while (middle + 1 < n && (passed += sorted[middle].weight) < 0.5 * out->weight)
        middle++;
    out->least = sorted[0].value;
    out->greatest = sorted[n - 1].value;
    out->median = sorted[middle].value;
    out->deviation = sqrt(squares / out->weight);
}

bool statistics_find(const double *value, const double *weight, uint32_t count, Statistics *out,
                     Error *err)
{
    *out = (Statistics){ NAN, NAN, NAN, NAN, NAN, 0, 0 };
    Weighted *sorted = array_create(count, sizeof *sorted, "statistics", err);
    if (sorted == NULL)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const double w = weight != NULL ? weight[i] : 1;
        if (!isnan(value[i]) && w > 0)
            sorted[out->count++] = (Weighted){ value[i], w };
    }
    qsort(sorted, out->count, sizeof *sorted, by_value);
    if (out->count > 0)
        sum_up(sorted, out->count, out);
    array_free(sorted);
    return true;
}

static Rgb rgb_of(const float *value)
{
    return rgb((double)value[0], (double)value[1], (double)value[2]);
}

static double of_layer(const Snapshot *s, Layer layer, uint32_t patch)
{
    return s->layer[layer] != NULL ? rgb_luminance(rgb_of(s->layer[layer] + 3 * (size_t)patch))
                                   : NAN;
}

void reading_take(const Snapshot *snapshot, uint32_t triangle, double u, double v, Reading *out)
{
    const ShownMesh *mesh = snapshot->mesh;
    assert(triangle < mesh->triangle_count);
    const uint32_t *corner = mesh->corner + 3 * (size_t)triangle;
    const uint32_t patch = mesh->triangle_patch[triangle];
    const double share[3] = { 1 - u - v, u, v };
    const ShownPatch *p = &mesh->patch[patch];
    *out = (Reading){ .normal = p->normal, .patch = patch, .group = p->group,
                      .material = p->material, .area = p->area };
    for (unsigned k = 0; k < 3; k++) {
        out->place = vec3_mad(out->place, share[k], mesh->position[corner[k]]);
        out->here += share[k] * rgb_luminance(rgb_of(snapshot->vertex + 3 * (size_t)corner[k]));
    }
    out->irradiance = of_layer(snapshot, LAYER_IRRADIANCE, patch);
    out->radiosity = of_layer(snapshot, LAYER_RADIOSITY, patch);
    out->error = of_layer(snapshot, LAYER_ERROR, patch);
    out->luminance = out->radiosity / M_PI;
    out->row_sum = snapshot->row_sum != NULL ? (double)snapshot->row_sum[patch] : NAN;
}
