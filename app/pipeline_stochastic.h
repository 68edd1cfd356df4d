/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_stochastic.h -- the solver without links: when it is chosen, and its stages. */
#ifndef APP_PIPELINE_STOCHASTIC_H
#define APP_PIPELINE_STOCHASTIC_H

#include "app/pipeline.h"

/* Rays to each point or spot light, from each patch: patches are small. */
enum { STOCHASTIC_LIGHT_SAMPLES = 16 };

/* Estimated error where no tolerance is given. */
#define STOCHASTIC_TOLERANCE 0.02

/* Chooses it for that many patches when they are too many for links and nothing else was asked for;
 * says so. Before the patches are made, and again after. */
void pipeline_stochastic_choose(Pipeline *pipeline, uint32_t patches);

/* In place of the factors: which places of patches are hidden. */
bool pipeline_stochastic_places(Pipeline *pipeline, Error *err);
/* In place of the solver; after pipeline_light. */
bool pipeline_stochastic_solve(Pipeline *pipeline, Error *err);

/* What pipeline->tolerance asks for by now, and rays per patch for it: more where it is less than
 * at first, up to `most` times as many. False: nobody asks. */
bool pipeline_stochastic_wish(const Pipeline *pipeline, uint32_t most, double *tolerance,
                              uint32_t *rays);

#endif
