/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_copies.h -- meshes that a scene keeps by reference: who may use them, and told. */
#ifndef APP_PIPELINE_COPIES_H
#define APP_PIPELINE_COPIES_H

#include "app/pipeline.h"
#include "render/copies.h"

/* Fails with ERROR_INPUT when the command needs patches and the scene keeps meshes by reference. */
bool pipeline_copies_allowed(const Pipeline *pipeline, Error *err);

/* The room with all that is placed in it; NULL without an error when nothing is. After
 * pipeline_room; the caller destroys it. */
RoomCopies *pipeline_copies(Pipeline *pipeline, Error *err);

#endif
