/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_path.h -- pictures that need no solution: --renderer path, whitted. */
#ifndef APP_PIPELINE_PATH_H
#define APP_PIPELINE_PATH_H

#include "app/pipeline.h"
#include "render/copies.h"

/* Sides and lamps alone, after pipeline_camera; and copies of meshes kept by reference, *copies,
 * NULL where there are none.
 * owns   the caller frees *copies with copies_destroy. */
bool pipeline_path_begin(Pipeline *pipeline, RoomCopies **copies, Error *err);
/* The picture of pipeline->camera.
 * owns   the caller frees the image.
 * fails  NULL; stopped: what there is and *err ERROR_STOPPED. */
Image *pipeline_path(Pipeline *pipeline, const RoomCopies *copies, Error *err);

#endif
