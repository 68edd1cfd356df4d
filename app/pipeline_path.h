/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_path.h -- pictures that need no solution: --renderer path, whitted. */
#ifndef APP_PIPELINE_PATH_H
#define APP_PIPELINE_PATH_H

#include "app/pipeline.h"

/* Sides and lamps alone, after pipeline_camera, and the picture.
 * owns   the caller frees the image.
 * fails  NULL; stopped: what there is and *err ERROR_STOPPED. */
Image *pipeline_path(Pipeline *pipeline, Error *err);

#endif
