/* SPDX-License-Identifier: BSD-3-Clause */
/* Where around a pixel its samples lie: drawn in proportion to the filter, so that all count alike
 * [ernst06] and pixels stay independent of each other. */
#include <assert.h>
#include <math.h>

#include "render/internal.h"

static const double PI = 3.14159265358979323846;

static double filter_radius(PixelFilter shape)
{
    switch (shape) {
    case FILTER_BOX:
        return 0.5;
    case FILTER_TENT:
        return 1;
    case FILTER_GAUSS:
    case FILTER_BLACKMAN_HARRIS:
        break;
    }
    return 1.5;
}

/* The filter's height at a distance from the pixel's middle, not normalised. */
static double filter_height(PixelFilter shape, double x)
{
    static const double SIGMA = 0.5; /* of the Gaussian, in pixels */
    static const double a[4] = { 0.35875, -0.48829, 0.14128, -0.01168 }; /* [harris78] */
    switch (shape) {
    case FILTER_BOX:
        break;
    case FILTER_TENT:
        return 1 - fabs(x);
    case FILTER_GAUSS:
        return exp(-x * x / (2 * SIGMA * SIGMA));
    case FILTER_BLACKMAN_HARRIS: {
        const double t = PI * (x / filter_radius(shape) + 1); /* 0..2 pi over the window */
        return a[0] + a[1] * cos(t) + a[2] * cos(2 * t) + a[3] * cos(3 * t);
    }
    }
    return 1;
}

void filter_table_init(FilterTable *table, PixelFilter shape)
{
    enum { STEPS = 8192 }; /* of the integral: its error is far below a float's */
    const double radius = filter_radius(shape), width = 2 * radius / STEPS;
    double       sum = 0, total = 0;
    int          next = 0;
    assert(radius > 0);
    for (int i = 0; i < STEPS; i++)
        total += filter_height(shape, -radius + (i + 0.5) * width);
    for (int i = 0; i < STEPS; i++) {
        const double height = filter_height(shape, -radius + (i + 0.5) * width) / total;
        while (next < FILTER_STEPS && (double)next / FILTER_STEPS <= sum + height) {
            const double part = ((double)next / FILTER_STEPS - sum) / height;
            table->quantile[next++] = -radius + (i + part) * width;
        }
        sum += height;
    }
    while (next <= FILTER_STEPS)
        table->quantile[next++] = radius;
}

void filter_table_offset(const FilterTable *table, const float u[2], double offset[2])
{
    assert(u[0] >= 0 && u[0] <= 1 && u[1] >= 0 && u[1] <= 1);
    for (int k = 0; k < 2; k++) {
        const double at = (double)u[k] * FILTER_STEPS;
        const int    i = at < FILTER_STEPS ? (int)at : FILTER_STEPS - 1;
        offset[k] = 0.5 + table->quantile[i] +
                    (at - i) * (table->quantile[i + 1] - table->quantile[i]);
    }
}
