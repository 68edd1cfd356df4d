/* SPDX-License-Identifier: BSD-3-Clause */
/* app/group_files.h -- a solved mesh per light group: -o 'room-{group}.ply' with --light-groups. */
#ifndef APP_GROUP_FILES_H
#define APP_GROUP_FILES_H

#include "app/pipeline.h"

/* Whether a result's name asks for a file per group. */
bool group_files_asked(const char *output);
/* What is wrong with such a name, if anything.
 * fails  ERROR_USAGE. */
bool group_files_allowed(const Options *options, Error *err);
/* Writes a mesh for each light group alone, as it was solved, before any change; and one, "all",
 * with the solution as it is. In names of groups, what is no letter, digit, '-' or '.' becomes '_';
 * where two are the same then, the later ones get +2, +3 ...
 * fails  as ply_write. */
bool group_files_write(Pipeline *pipeline, const char *output, Error *err);

#endif
