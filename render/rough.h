/* SPDX-License-Identifier: BSD-3-Clause */
/* render/rough.h -- what a picture lacks that was stopped: a sample for each block of pixels, so
 * that it is whole at once, if rough.
 */
#ifndef RENDER_ROUGH_H
#define RENDER_ROUGH_H

#include <stddef.h>
#include <stdint.h>

#include "render/image.h"

/* Edge of the blocks: a power of two, the least that makes do with about `samples` for `missing`
 * pixels, but not above `most`. */
int rough_step(uint64_t missing, uint64_t samples, int most);
/* Copies a pixel to another, all layers of it. */
void rough_copy(Image *image, size_t from, size_t to);

#endif
