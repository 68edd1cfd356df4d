/* SPDX-License-Identifier: BSD-3-Clause */
/* app/light_layers.h -- pictures with a layer for each light group: render --light-groups. */
#ifndef APP_LIGHT_LAYERS_H
#define APP_LIGHT_LAYERS_H

#include "app/pipeline.h"

/* How many layers pictures get; 0: not asked for, or nothing gives light. */
uint32_t light_layers_count(const Pipeline *pipeline);
/* Once the groups are solved: tells them to the gatherer. In names of layers, what is no letter,
 * digit or '-' becomes '_'; where two are the same then, the later ones get +2, +3 ... */
bool light_layers_split(Pipeline *pipeline, Gatherer *gatherer, Error *err);

#endif
