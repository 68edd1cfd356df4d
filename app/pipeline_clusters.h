/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_clusters.h -- the hierarchical solver's stage. */
#ifndef APP_PIPELINE_CLUSTERS_H
#define APP_PIPELINE_CLUSTERS_H

#include "app/pipeline.h"

/* In place of the solver; after pipeline_light, with places of patches as the stochastic solver
 * has them. */
bool pipeline_clusters_solve(Pipeline *pipeline, Error *err);

/* What is told of it. */
void pipeline_clusters_print(const Pipeline *pipeline);

#endif
