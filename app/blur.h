/* SPDX-License-Identifier: BSD-3-Clause */
/* app/blur.h -- motion blur: pictures as the mean of several moments. */
#ifndef APP_BLUR_H
#define APP_BLUR_H

#include "app/pipeline.h"

/* All of render with --shutter but the summary. Moments that differ in cameras alone share patches,
 * factors and solution; for others all is made anew, and of the pipeline the last one's is left.
 * Each moment gets its share of samples. *stopped: what there was time for is written.
 * fails  as any stage of the pipeline. */
bool blur_render(Pipeline *pipeline, bool *stopped, Error *err);

#endif
