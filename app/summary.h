/* SPDX-License-Identifier: BSD-3-Clause */
/* app/summary.h -- what a run has to say at its end: JSON for scripts, a few lines for people. */
#ifndef APP_SUMMARY_H
#define APP_SUMMARY_H

#include "app/json.h"
#include "app/pipeline.h"

/* Opens the summary and writes what all commands say of themselves; the caller adds its own keys
 * and calls summary_finish. */
typedef struct {
    struct OutFile *file;
    Json            json;
} Summary;

/* False and *err when --json names a file that cannot be written; file NULL when none is wanted. */
bool summary_begin(Summary *summary, const Session *session, int exit_code, const Error *failure,
                   Error *err);
bool summary_finish(Summary *summary, const Session *session, Error *err);

/* The keys scene .. memory of a pipeline, as far as its stages got. */
void summary_pipeline(Json *json, const Pipeline *pipeline);

/* Writes the whole summary of a run to --json, if asked for. failure: what ended it early. */
bool summary_write(const Pipeline *pipeline, int exit_code, const Error *failure, Error *err);

/* The closing report for people. */
void summary_print(const Pipeline *pipeline);

#endif
