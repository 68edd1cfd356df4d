/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/files.h -- what the window saves: names that are free, and pictures of the view. */
#ifndef VIEWER_FILES_H
#define VIEWER_FILES_H

#include <stdbool.h>
#include <stddef.h>

struct Viewer;

/* The first of room-word.png, room-word-2.png ... that is free, for the scene room.glb in the
 * current folder; `ending` ".png". False: 9999 are there, or the name is too long. */
bool files_free_name(const struct Viewer *viewer, const char *word, const char *ending, char *path,
                     size_t size);
/* The frame as it was drawn, panels and all. What fails is told, what is saved only if `tell`. */
void files_save_frame(struct Viewer *viewer, const char *path, bool tell);
/* The gathered picture, once it is finished and shown; else the next frame. */
void files_save_png(struct Viewer *viewer);
/* The gathered picture with all its layers, or the view by values at vertices. */
void files_save_exr(struct Viewer *viewer);

#endif
