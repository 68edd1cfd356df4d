/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_picture.h -- pictures of a solved scene, or of one that needs no solution. */
#ifndef APP_PIPELINE_PICTURE_H
#define APP_PIPELINE_PICTURE_H

#include "app/pipeline.h"
#include "render/copies.h"
#include "render/records.h"

/* What all pictures of a run share. */
typedef struct {
    Gatherer   *gatherer;
    Records    *records;  /* or NULL */
    RoomCopies *copies;   /* or NULL */
} PictureMaker;

/* Once the renderer has all that it needs: a solution, or for paths pipeline_camera. The pipeline
 * must not change until picture_maker_end, which also follows a failure. */
bool picture_maker_begin(PictureMaker *maker, Pipeline *pipeline, Error *err);
void picture_maker_end(PictureMaker *maker);

/* The picture of pipeline->camera.
 * owns   the caller frees the image.
 * fails  NULL; stopped: what there is and *err ERROR_STOPPED. */
Image *picture_make(PictureMaker *maker, Pipeline *pipeline, Error *err);
/* For a picture that an earlier run has made: what the next ones have from it. */
bool picture_skip(PictureMaker *maker, Pipeline *pipeline, Error *err);

#endif
