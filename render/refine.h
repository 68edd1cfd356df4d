/* SPDX-License-Identifier: BSD-3-Clause */
/* render/refine.h -- a tile of a picture with as many samples per pixel as its noise asks for. */
#ifndef RENDER_REFINE_H
#define RENDER_REFINE_H

#include "render/eye.h"

enum { REFINE_TILE = 16 };

typedef struct {
    int    x0, y0, x1, y1;  /* pixels x0 <= x < x1, y0 <= y < y1, at most REFINE_TILE each way */
    double mean;            /* of the picture's luminance, roughly */
} RefineTile;

/* Renders the tile into the image, `deviation` included, until the standard error of pixels is
 * below options->error times the mean luminance (or a brighter pixel's own), or all samples are
 * taken. Each pixel has two halves, scrambled independently: their difference tells the noise.
 * Returns how many samples were taken. */
uint64_t refine_tile(Eye *eye, const RefineTile *tile, Image *image, const Monitor *monitor);

/* Relative standard error of a finished picture's pixels: root mean square. */
double refine_reached(const Image *image, double mean);

#endif
