/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_accuracy.h -- rays added until light is known as well as was asked (--accuracy).
 *
 * Light is found twice from independent rays, and half of what the two differ by is the standard
 * error of their mean: as root mean square over the patches, weighted by area, over that of the
 * irradiance itself. Rays are multiplied until this is small enough, or until both together have
 * cast what --rays allow for each patch. Of what the mesh is off by, this knows nothing.
 */
#ifndef APP_PIPELINE_ACCURACY_H
#define APP_PIPELINE_ACCURACY_H

#include "app/pipeline.h"

/* Whether --accuracy was given to a command that solves; false and *err when an option beside it
 * makes no sense. */
bool pipeline_accuracy_allowed(const Options *options, Error *err);

/* pipeline_factors and pipeline_solve, until they are as accurate as asked if it was. */
bool pipeline_accurate(Pipeline *pipeline, Error *err);

/* Rays of one measuring point that --accuracy may come to. */
uint32_t pipeline_accuracy_point_rays(const Pipeline *pipeline);

#endif
