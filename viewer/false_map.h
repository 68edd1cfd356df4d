/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/false_map.h -- the scale of false colours as the hand moves it.
 *
 * The colours and the round values are those of pictures (render/false_colour.h).
 */
#ifndef VIEWER_FALSE_MAP_H
#define VIEWER_FALSE_MAP_H

#include "render/false_colour.h"

enum { FALSE_TEXELS = 256, FALSE_TICKS = 8 };

typedef struct {
    FalseColour scale;
    bool        held;       /* the range was set by hand: do not fit it */
} FalseMap;

/* Linear from 0 to 1, to be fitted. */
void false_map_init(FalseMap *map);
/* sRGB bytes along the scale, texel k at place (k + 0.5) / FALSE_TEXELS. */
void false_map_texels(const FalseMap *map, uint8_t rgb[3 * FALSE_TEXELS]);
/* Range from values [count], unless it is held. */
void false_map_fit(FalseMap *map, const float *values, size_t count);
/* Linear or logarithmic; a range from 0 on begins at a thousandth of its end when logarithmic. */
void false_map_set_log(FalseMap *map, bool logarithmic);
/* Moves an end (1: the high one) by a share of the legend's length, and holds the range. It never
 * passes the other end. */
void false_map_drag(FalseMap *map, int end, double share);
/* Shifts both ends. */
void false_map_shift(FalseMap *map, double share);

#endif
