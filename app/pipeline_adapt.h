/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_adapt.h -- patches divided where light changes, before the factors are closed.
 *
 * From a coarse division on: solve roughly, estimate what the patches leave out, divide the worst,
 * cast the rows of their parts, and again, until there are as many patches as wanted.
 */
#ifndef APP_PIPELINE_ADAPT_H
#define APP_PIPELINE_ADAPT_H

#include "app/pipeline.h"

/* How many patches to begin with. */
uint32_t pipeline_adapt_start(const Settings *settings);

/* Takes patches and links as cast, and leaves finer ones in their place, links still as cast.
 * links   how the first ones were cast.
 * report  { 0 }, or the passes there were already: goes on after them.
 * A stop leaves what was reached, and the session in a hurry. */
bool pipeline_adapt(Pipeline *pipeline, const LinksOptions *links, AdaptReport *report, Error *err);
/* Divides the patches as an earlier run did: `split` chooses. */
bool pipeline_adapt_again(Pipeline *pipeline, const uint8_t *split, Error *err);

#endif
