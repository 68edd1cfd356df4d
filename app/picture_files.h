/* SPDX-License-Identifier: BSD-3-Clause */
/* app/picture_files.h -- names of pictures, one for each camera, and the files themselves. */
#ifndef APP_PICTURE_FILES_H
#define APP_PICTURE_FILES_H

#include "app/pipeline.h"

/* What can be told of -o before the scene is read.
 * fails  ERROR_USAGE; as output_probe. */
bool picture_files_allowed(const Options *options, Error *err);
/* Makes pipeline->picture, with a report for each of its views: names, sizes.
 * fails  ERROR_USAGE: several cameras, but nothing in -o that tells them apart; as output_probe. */
bool picture_files_name(Pipeline *pipeline, Error *err);
/* Whether all files of a picture are there. */
bool picture_files_exist(const PictureReport *picture);
/* The command line without what must not change the bytes of a picture: threads, names of results,
 * limits. */
void picture_files_command(const Options *options, char *out, size_t size);
/* EXR, PNG and what else was asked for, of pipeline->camera; sets pipeline->exposure. */
bool picture_files_write(Pipeline *pipeline, const Image *image, const PictureReport *picture,
                         Error *err);

#endif
