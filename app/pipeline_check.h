/* SPDX-License-Identifier: BSD-3-Clause */
/* app/pipeline_check.h -- --check: how far light on patches is off, by paths of its own. */
#ifndef APP_PIPELINE_CHECK_H
#define APP_PIPELINE_CHECK_H

#include "app/json.h"
#include "app/pipeline.h"

/* Once the patches are there: paths can tell of such a room. fails  false; ERROR_USAGE. */
bool pipeline_check_allowed(const Pipeline *pipeline, Error *err);
/* If it was asked for, into pipeline->check. Asked to stop, it makes none, and *exit_code is 5.
 * fails  false; ERROR_MEMORY. */
bool pipeline_check(Pipeline *pipeline, int *exit_code, Error *err);

/* Nothing where none was made. */
void pipeline_check_put(Json *json, const LightCheck *check);
void pipeline_check_print(const Pipeline *pipeline);

#endif
