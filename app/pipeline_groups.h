/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_groups.h -- factors between groups or materials without those between patches. */
#ifndef APP_PIPELINE_GROUPS_H
#define APP_PIPELINE_GROUPS_H

#include "app/pipeline.h"

/* Whether factors are asked for by group or material alone, and no patches by hand; and there are
 * not too many. */
bool pipeline_groups_wanted(const Pipeline *pipeline);
/* Patches that are to be made then, else as the settings say. */
uint32_t pipeline_groups_patches(const Pipeline *pipeline);
/* Fills pipeline->groups, and pipeline->links with a row per class. */
bool pipeline_groups(Pipeline *pipeline, Error *err);

#endif
