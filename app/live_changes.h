/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_changes.h -- what the window's knobs were turned to, as a file for --changes. */
#ifndef APP_LIVE_CHANGES_H
#define APP_LIVE_CHANGES_H

#include "scenes/scene.h"
#include "viewer/knobs.h"

/* Writes SCENE-changes.json, or -changes-2 ... which is not there yet, in the current folder; its
 * name is put into `path`. Names in the file are groups first, then materials, then lights: what
 * would be taken for something else is told in *err with the file left unwritten.
 * fails  false; ERROR_FAILED, ERROR_USAGE for a name too long, ERROR_MEMORY. */
bool live_changes_save(const Scene *scene, const char *scene_path, const Knob *knob,
                       uint32_t count, const KnobSetting *setting, char *path, size_t size,
                       Error *err);

#endif
