/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/texture_read.h -- images from files; this folder and tests. */
#ifndef SCENES_TEXTURE_READ_H
#define SCENES_TEXTURE_READ_H

#include "base/monitor.h"
#include "scenes/pipe.h"
#include "scenes/texture.h"

/* Reads an image file in a child process.
 * owns   the caller clears *texture.
 * fails  false; ERROR_INPUT, ERROR_MEMORY, ERROR_STOPPED. */
bool texture_read(const char *path, const Monitor *monitor, Texture *texture, Error *err);

/* In a child: decodes `size` bytes and sends a record of them. fails  false; ERROR_INPUT. */
bool texture_put(PipeWriter *out, const void *bytes, size_t size, const char *name, Error *err);
/* In a child: mean over the image's pixels, linear light. fails  false; ERROR_INPUT. */
bool texture_mean(const void *bytes, size_t size, const char *name, Rgb *mean, Error *err);
/* In the parent: what follows the record's kind. fails  false; in->state tells, or *err. */
bool texture_take(PipeReader *in, Texture *texture, Error *err);

#endif
