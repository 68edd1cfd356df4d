/* SPDX-License-Identifier: BSD-3-Clause */
/* render/compare.h -- how far one picture is from another, in luminance.
 *
 * Errors are root mean squares of the difference, divided by the reference's mean over the pixels
 * counted. Left out: lamps (luminance above `lamp`) with a rim of two pixels, and pixels whose
 * 3 x 3 neighbourhood in the reference holds a black pixel (background).
 *   all     every counted pixel
 *   smooth  without pixels whose 3 x 3 neighbourhood in the reference spans more than a quarter of
 *           its mean: silhouettes and hard shadow edges, where antialiasing decides
 *   block   smooth, after averaging 8 x 8 pixels: bias and blotches, without pixel noise
 *   bias    mean signed difference over smooth pixels
 */
#ifndef RENDER_COMPARE_H
#define RENDER_COMPARE_H

#include "base/error.h"

typedef struct {
    double mean;              /* of the reference's luminance over all counted pixels */
    double counted, smooth;   /* shares of the picture */
    double all_error, smooth_error, block_error, bias; /* relative to mean */
    double psnr;              /* dB over all counted pixels, peak: the reference's largest there */
} Comparison;

/* Both pictures are [3 * width * height], linear, row by row. lamp 0: 5.
 * fails  false; ERROR_MEMORY; ERROR_INPUT when no pixel counts. */
bool image_compare(const float *reference, const float *picture, int width, int height,
                   double lamp, Comparison *out, Error *err);

#endif
