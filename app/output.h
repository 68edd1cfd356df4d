/* SPDX-License-Identifier: BSD-3-Clause */
/* app/output.h -- names of result files, and whether they can be written, asked before the work. */
#ifndef APP_OUTPUT_H
#define APP_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

#include "app/options.h"
#include "base/error.h"

/* Tries to make a file beside `path`, and removes it. NULL and "-" are fine.
 * fails  ERROR_FAILED and why; ERROR_USAGE when it is a file that the command reads. */
bool output_probe(const char *path, const Options *options, Error *err);

/* `path` with its ending (what follows the last dot of the last part) replaced. `ending` has its
 * dot. fails  ERROR_USAGE when the result does not fit. */
bool output_name(const char *path, const char *ending, char *out, size_t size, Error *err);
/* Whether the name ends so, in small letters or capitals. */
bool output_ends(const char *path, const char *ending);
/* The last part of a path. */
const char *output_base(const char *path);

#endif
