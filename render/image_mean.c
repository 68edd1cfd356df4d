/* SPDX-License-Identifier: BSD-3-Clause */
/* The mean of several pictures. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "render/image.h"

static size_t pixels_of(const Image *image)
{
    return (size_t)image->width * (size_t)image->height;
}

static void add_layer(float *sum, const float *layer, size_t count)
{
    for (size_t i = 0; i < count; i++)
        sum[i] += layer[i];
}

static void scale_layer(float *layer, size_t count, double share)
{
    for (size_t i = 0; i < count; i++)
        layer[i] = (float)(layer[i] * share);
}

void image_add(Image *sum, const Image *image)
{
    const size_t n = pixels_of(image);
    assert(sum->width == image->width && sum->height == image->height);
    assert(sum->group_count == image->group_count);
    assert((sum->deviation == NULL) == (image->deviation == NULL));
    add_layer(sum->radiance, image->radiance, 3 * n);
    add_layer(sum->direct, image->direct, 3 * n);
    add_layer(sum->indirect, image->indirect, 3 * n);
    add_layer(sum->albedo, image->albedo, 3 * n);
    add_layer(sum->irradiance, image->irradiance, 3 * n);
    for (uint32_t k = 0; k < sum->group_count; k++)
        add_layer(image_group(sum, k), image_group(image, k), 3 * n);
    for (size_t i = 0; sum->deviation != NULL && i < n; i++)
        sum->deviation[i] = hypotf(sum->deviation[i], image->deviation[i]);
}

void image_scale(Image *image, double share)
{
    const size_t n = pixels_of(image);
    assert(share > 0);
    scale_layer(image->radiance, 3 * n, share);
    scale_layer(image->direct, 3 * n, share);
    scale_layer(image->indirect, 3 * n, share);
    scale_layer(image->albedo, 3 * n, share);
    scale_layer(image->irradiance, 3 * n, share);
    for (uint32_t k = 0; k < image->group_count; k++)
        scale_layer(image_group(image, k), 3 * n, share);
    if (image->deviation != NULL)
        scale_layer(image->deviation, n, share);
}

void image_take_places(Image *image, const Image *from)
{
    const size_t n = pixels_of(from);
    assert(image->width == from->width && image->height == from->height);
    memcpy(image->normal, from->normal, 3 * n * sizeof *image->normal);
    memcpy(image->depth, from->depth, n * sizeof *image->depth);
    memcpy(image->patch, from->patch, n * sizeof *image->patch);
}
