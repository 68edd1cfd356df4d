/* SPDX-License-Identifier: BSD-3-Clause */
/* Blocks of equal pixels. */
#include "render/rough.h"

#include <assert.h>
#include <string.h>

int rough_step(uint64_t missing, uint64_t samples, int most)
{
    int step = 1;
    assert(samples > 0 && most > 0);
    while (step < most && missing / ((uint64_t)step * (uint64_t)step) > samples)
        step *= 2;
    return step;
}

static void copy(float *layer, size_t values, size_t from, size_t to)
{
    if (layer != NULL)
        memcpy(layer + values * to, layer + values * from, values * sizeof *layer);
}

void rough_copy(Image *image, size_t from, size_t to)
{
    assert(image != NULL);
    if (from == to)
        return;
    copy(image->radiance, 3, from, to);
    copy(image->direct, 3, from, to);
    copy(image->indirect, 3, from, to);
    copy(image->albedo, 3, from, to);
    copy(image->irradiance, 3, from, to);
    copy(image->normal, 3, from, to);
    copy(image->depth, 1, from, to);
    copy(image->deviation, 1, from, to);
    image->patch[to] = image->patch[from];
    for (uint32_t k = 0; k < image->group_count; k++)
        copy(image_group(image, k), 3, from, to);
}
