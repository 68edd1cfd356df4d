/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_relight.h -- changes of light and paint after a scene was solved: --set, --changes
 * and --light-groups. */
#ifndef APP_PIPELINE_RELIGHT_H
#define APP_PIPELINE_RELIGHT_H

#include "app/pipeline.h"

/* Whether all changes only dim: are factors on the light of groups and point lights. */
bool changes_dim(const Pipeline *pipeline);
/* Solves for each group that emits and each point light apart, unless an earlier run has; after
 * pipeline_light, before any change. */
bool pipeline_light_groups(Pipeline *pipeline, Error *err);
/* Carries the changes out: in the materials and lights, so that all that follows sees them, and in
 * the solution. solved: the solution is that of the changed scene already. Where pictures are made
 * by light groups, these are those of the changed scene then. */
bool pipeline_relight(Pipeline *pipeline, bool solved, Error *err);

#endif
