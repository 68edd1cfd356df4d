/* SPDX-License-Identifier: BSD-3-Clause */
/* Pixels made elsewhere, written as they are. */
#include "render/pixels.h"

#include <math.h>

#include "render/internal.h"

bool pixels_write_png(const uint8_t *rgb, int width, int height, const char *path, Error *err)
{
    const ImageInfo info = { .version = ISOLUX_VERSION };
    return png_write_pixels(rgb, width, height, NAN, &info, path, err);
}
