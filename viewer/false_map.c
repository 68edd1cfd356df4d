/* SPDX-License-Identifier: BSD-3-Clause */
/* Ranges of false colour, fitted and dragged. */
#include "viewer/false_map.h"

#include <assert.h>
#include <math.h>

/* The least share of a legend's range, or the least ratio of its ends less 1, that dragging leaves:
 * what four digits can tell apart. */
static const double LEAST_RANGE = 1e-3;

void false_map_init(FalseMap *map)
{
    *map = (FalseMap){ .scale = { .low = 0, .high = 1, .isolines = true } };
}

void false_map_texels(const FalseMap *map, uint8_t rgb[3 * FALSE_TEXELS])
{
    for (int k = 0; k < FALSE_TEXELS; k++)
        false_colour_of(&map->scale, (k + 0.5) / FALSE_TEXELS, rgb + (size_t)3 * (size_t)k);
}

void false_map_fit(FalseMap *map, const float *values, size_t count)
{
    if (!map->held)
        false_colour_range(values, count, &map->scale);
}

void false_map_set_log(FalseMap *map, bool logarithmic)
{
    FalseColour *scale = &map->scale;
    if (logarithmic && !(scale->low > 0))
        scale->low = LEAST_RANGE * scale->high;
    scale->logarithmic = logarithmic;
}

/* Value at a place of the legend, also beyond its ends. */
static double value_at(const FalseColour *scale, double place)
{
    return scale->logarithmic ? scale->low * pow(scale->high / scale->low, place)
                              : scale->low + place * (scale->high - scale->low);
}

void false_map_drag(FalseMap *map, int end, double share)
{
    FalseColour *scale = &map->scale;
    const FalseColour before = *scale;
    assert(isfinite(share));
    if (end == 1) {
        scale->high = value_at(&before, fmax(LEAST_RANGE, 1 + share));
    } else {
        const double low = value_at(&before, fmin(1 - LEAST_RANGE, share));
        scale->low = before.low >= 0 ? fmax(0, low) : low; /* light is never less than none */
    }
    if (!(scale->high > scale->low) || !isfinite(scale->high) ||
        (scale->logarithmic && !(scale->low > 0)))
        *scale = before;
    map->held = true;
}

void false_map_shift(FalseMap *map, double share)
{
    const FalseColour before = map->scale;
    FalseColour *scale = &map->scale;
    scale->low = value_at(&before, share);
    scale->high = value_at(&before, 1 + share);
    if ((before.low >= 0 && scale->low < 0) || !isfinite(scale->high) ||
        !(scale->high > scale->low) || (scale->logarithmic && !(scale->low > 0)))
        *scale = before;
    map->held = true;
}
