/* SPDX-License-Identifier: BSD-3-Clause */
/* math/rgb.h -- three bands of light, linear, BT.709 primaries. */
#ifndef MATH_RGB_H
#define MATH_RGB_H

#include <math.h>

typedef struct {
    double r, g, b;
} Rgb;

static inline Rgb rgb(double r, double g, double b) { return (Rgb){ r, g, b }; }
static inline Rgb rgb_add(Rgb a, Rgb b) { return rgb(a.r + b.r, a.g + b.g, a.b + b.b); }
static inline Rgb rgb_mul(Rgb a, Rgb b) { return rgb(a.r * b.r, a.g * b.g, a.b * b.b); }
static inline Rgb rgb_scale(Rgb a, double s) { return rgb(a.r * s, a.g * s, a.b * s); }
/* a + s b */
static inline Rgb rgb_mad(Rgb a, double s, Rgb b)
{
    return rgb(a.r + s * b.r, a.g + s * b.g, a.b + s * b.b);
}
static inline double rgb_max(Rgb a) { return fmax(a.r, fmax(a.g, a.b)); }
/* Luminance weights of BT.709 [itu-bt709]. */
static inline double rgb_luminance(Rgb a) { return 0.2126 * a.r + 0.7152 * a.g + 0.0722 * a.b; }

#endif
