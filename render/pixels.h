/* SPDX-License-Identifier: BSD-3-Clause */
/* render/pixels.h -- finished 8-bit pixels as a PNG, for pictures made elsewhere. */
#ifndef RENDER_PIXELS_H
#define RENDER_PIXELS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

/* sRGB [3 * width * height], rows from the top.
 * fails  false; ERROR_FAILED when the file cannot be written, ERROR_MEMORY. */
bool pixels_write_png(const uint8_t *rgb, int width, int height, const char *path, Error *err);

#endif
