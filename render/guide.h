/* SPDX-License-Identifier: BSD-3-Clause */
/* render/guide.h -- where light comes from, roughly: hemisphere rays go there more often.
 *
 * A histogram over the unit square that sampling_cosine maps to the hemisphere. Rays drawn from it
 * are weighted by 1 / density, so the mean stays what it was; the density is never below
 * GUIDE_PLAIN, so no weight is above 1 / GUIDE_PLAIN.
 */
#ifndef RENDER_GUIDE_H
#define RENDER_GUIDE_H

#include <stdbool.h>

enum { GUIDE_SIDE = 16 };

/* Share of the rays that stay as they were, for what the histogram did not see. */
#define GUIDE_PLAIN 0.25

/* One axis: below[i] <= u < below[i + 1] goes to cell i, at shift[i] + scale[i] u of the axis. */
typedef struct {
    float below[GUIDE_SIDE + 1]; /* running sums, 0..1 */
    float shift[GUIDE_SIDE], scale[GUIDE_SIDE];
} GuideAxis;

typedef struct {
    GuideAxis row;
    GuideAxis column[GUIDE_SIDE];        /* within each row */
    float     worth[GUIDE_SIDE][GUIDE_SIDE]; /* 1 / density */
} Guide;

/* From mean light per cell, >= 0. false: no light at all, the guide is of no use. */
bool guide_init(Guide *guide, const double light[GUIDE_SIDE][GUIDE_SIDE]);
/* Moves a uniform point of [0,1)^2 to the guide's density; returns 1 / density there. */
double guide_map(const Guide *guide, float u[2]);

#endif
