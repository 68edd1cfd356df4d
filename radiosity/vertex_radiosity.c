/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/vertex_radiosity.c -- values of patches carried over to the vertices they share. */
#include <assert.h>

#include "base/array.h"
#include "radiosity/solve.h"

bool vertex_radiosity(const Patches *patches, const double *area, unsigned bands,
                      const double *patch_value, double *out, Error *err)
{
    assert(patches != NULL && area != NULL && patch_value != NULL && out != NULL && bands > 0);
    const size_t values = (size_t)patches->vertex_count * bands;
    double *weight = array_create(patches->vertex_count, sizeof *weight, "vertex weights", err);
    if (weight == NULL)
        return false;
    for (size_t k = 0; k < values; k++)
        out[k] = 0;
    for (uint32_t i = 0; i < patches->count; i++)
        for (uint32_t k = patches->first_corner[i]; k < patches->first_corner[i + 1]; k++) {
            const uint32_t vertex = patches->corner[k];
            assert(vertex < patches->vertex_count);
            weight[vertex] += area[i];
            for (unsigned b = 0; b < bands; b++)
                out[(size_t)vertex * bands + b] += area[i] * patch_value[(size_t)i * bands + b];
        }
    for (size_t k = 0; k < values; k++)
        if (weight[k / bands] > 0)
            out[k] /= weight[k / bands];
    array_free(weight);
    return true;
}
