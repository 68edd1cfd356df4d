/* SPDX-License-Identifier: BSD-3-Clause */
/* app/solved_shown.h -- a solved mesh out of a file, as the window shows it. */
#ifndef APP_SOLVED_SHOWN_H
#define APP_SOLVED_SHOWN_H

#include "app/options.h"
#include "app/ply_read.h"
#include "viewer/snapshot.h"

/* Patches, values at vertices and patches, cameras and lights as the file has them; first the
 * camera of the options, else the file's, else one that shows the room.
 * owns   the caller frees with snapshot_destroy; its mesh is referenced by it alone.
 * fails  NULL; ERROR_INPUT for numbers of patches that cannot be, ERROR_USAGE for a camera,
 *        ERROR_MEMORY. */
Snapshot *solved_shown(SolvedMesh *solved, const Options *options, Error *err);

#endif
