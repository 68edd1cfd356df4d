/* SPDX-License-Identifier: BSD-3-Clause */
/* render/false_colour.h -- pictures of a quantity: colours for values, a legend, isolines.
 *
 * The scale runs from dark violet over blue, green and yellow to near white in even steps of
 * perceived lightness, so that a copy in grey still reads right. On the right stands a legend with
 * round values and the unit.
 */
#ifndef RENDER_FALSE_COLOUR_H
#define RENDER_FALSE_COLOUR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "render/image.h"

typedef struct {
    double low, high;   /* values at the scale's ends; low < high, and low > 0 when logarithmic */
    bool   logarithmic;
    bool   isolines;    /* along the legend's values, from values smoothed over 5 x 5 pixels */
    bool   signs;       /* blue below 0, red above, dark at 0; low = -high */
} FalseColour;

/* sRGB bytes of a place on the scale, clamped to 0..1. */
void false_colour_at(double place, uint8_t rgb[3]);
/* The same of a scale: its own colours. */
void false_colour_of(const FalseColour *scale, double place, uint8_t rgb[3]);
/* Place of a value on the scale: 0..1 within the range. */
double false_colour_place(const FalseColour *scale, double value);

/* A range for values [count] when none is given: up to what all but 0.2 % stay below, rounded up;
 * from 0, or from what all but 0.2 % of the positive ones pass when logarithmic. NANs do not count.
 * Without any value above 0: 0..1 (0.1..1). */
void false_colour_range(const float *values, size_t count, FalseColour *scale);

/* Round values for a legend: up to `most`, rising, within the range; returns how many. */
int false_colour_ticks(const FalseColour *scale, int most, double *ticks);

/* PNG of values [width * height], row by row from the top, NAN: nothing there (grey). label: of the
 * legend, "lux"; ASCII.
 * fails  false; ERROR_MEMORY, ERROR_FAILED for the file. */
bool false_colour_write(const float *values, int width, int height, const FalseColour *scale,
                        const char *label, const ImageInfo *info, const char *path, Error *err);

#endif
