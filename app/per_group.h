/* SPDX-License-Identifier: BSD-3-Clause */
/* app/per_group.h -- a value for each group, from the command line or a file. */
#ifndef APP_PER_GROUP_H
#define APP_PER_GROUP_H

#include <stddef.h>

#include "base/error.h"

/* text  a number for all; "NAME=VALUE,NAME=VALUE,..." for some; or the name of a CSV file with
 *       lines of a name and a value (a first line whose value is no number is its heading).
 * value [count]  values of the groups that are named are replaced.
 * fails false; ERROR_USAGE for the command line, ERROR_INPUT for a file: a name that no group has,
 *       a value that is none. */
bool per_group_read(const char *text, const char *const *name, size_t count, double *value,
                    Error *err);

#endif
