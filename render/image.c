/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers of a picture: allocation, and what a pixel holds before anything is known of it. */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "base/array.h"
#include "render/internal.h"

Image *image_create(int width, int height, Error *err)
{
    assert(err != NULL);
    if (error_is_set(err))
        return NULL;
    if (width < 1 || height < 1 || width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX) {
        error_set(err, ERROR_USAGE, "a picture of %d x %d pixels: sides must be 1 to %d", width,
                  height, (int)IMAGE_SIDE_MAX);
        return NULL;
    }
    Image *image = array_create(1, sizeof *image, "picture", err);
    if (image == NULL)
        return NULL;
    const size_t n = (size_t)width * (size_t)height;
    image->width = width;
    image->height = height;
    image->radiance = array_create(3 * n, sizeof(float), "picture layer", err);
    image->direct = array_create(3 * n, sizeof(float), "picture layer", err);
    image->indirect = array_create(3 * n, sizeof(float), "picture layer", err);
    image->albedo = array_create(3 * n, sizeof(float), "picture layer", err);
    image->irradiance = array_create(3 * n, sizeof(float), "picture layer", err);
    image->normal = array_create(3 * n, sizeof(float), "picture layer", err);
    image->depth = array_create(n, sizeof(float), "picture layer", err);
    image->patch = array_create(n, sizeof(uint32_t), "picture layer", err);
    if (error_is_set(err))
        return image_destroy(image);
    for (size_t i = 0; i < n; i++) {
        image->depth[i] = INFINITY;
        image->patch[i] = UINT32_MAX;
    }
    return image;
}

bool image_add_deviation(Image *image, Error *err)
{
    assert(image != NULL && err != NULL);
    if (image->deviation == NULL)
        image->deviation = array_create((size_t)image->width * (size_t)image->height,
                                        sizeof(float), "picture layer", err);
    return image->deviation != NULL;
}

bool image_add_groups(Image *image, const char *const *name, uint32_t count, Error *err)
{
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    assert(image->group == NULL && name != NULL && err != NULL);
    image->group = array_create(3 * pixels * count, sizeof(float), "light group layers", err);
    image->group_name = array_create(count, sizeof *image->group_name, "light group layers", err);
    if (error_is_set(err))
        return false;
    image->group_count = count;
    for (uint32_t k = 0; k < count; k++)
        snprintf(image->group_name[k], IMAGE_NAME, "%s", name[k]);
    return true;
}

Image *image_create_part(int width, int height, const int part[4], Error *err)
{
    const bool whole = part[2] == 0 && part[3] == 0;
    if (!whole && (part[2] > width || part[3] > height)) {
        error_set(err, ERROR_USAGE, "the part %d,%d,%d,%d reaches beyond the picture of %d x %d",
                  part[0], part[1], part[2], part[3], width, height);
        return NULL;
    }
    Image *image = image_create(whole ? width : part[2] - part[0],
                                whole ? height : part[3] - part[1], err);
    if (image == NULL || whole)
        return image;
    image->left = part[0];
    image->top = part[1];
    image->whole_width = width;
    image->whole_height = height;
    return image;
}

Image *image_destroy(Image *image)
{
    if (image == NULL)
        return NULL;
    array_free(image->radiance);
    array_free(image->direct);
    array_free(image->indirect);
    array_free(image->albedo);
    array_free(image->irradiance);
    array_free(image->normal);
    array_free(image->depth);
    array_free(image->patch);
    array_free(image->deviation);
    array_free(image->group);
    array_free(image->group_name);
    return array_free(image);
}
