/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_relight.h -- changes of light and paint after a scene was solved: --set, --changes
 * and --light-groups. */
#ifndef APP_PIPELINE_RELIGHT_H
#define APP_PIPELINE_RELIGHT_H

#include "app/pipeline.h"

/* Solves for each group that emits and each point light apart; after pipeline_light, before any
 * change. */
bool pipeline_light_groups(Pipeline *pipeline, Error *err);
/* Carries the changes out: in the materials and lights, so that all that follows sees them, and in
 * the solution. solved: the solution is that of the changed scene already. */
bool pipeline_relight(Pipeline *pipeline, bool solved, Error *err);

#endif
