/* SPDX-License-Identifier: BSD-3-Clause */
/* app/name_mark.h -- file names with a mark that stands for one of several: 'room-{camera}.exr'. */
#ifndef APP_NAME_MARK_H
#define APP_NAME_MARK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

/* Name number k of name [count], the names that may stand for the mark, in its place in `pattern`,
 * which holds it. In names, what is no letter, digit, '-' or '.' becomes '_'; where two are the
 * same then, the later ones get +2, +3 ...
 * fails  ERROR_USAGE when the result does not fit. */
bool name_mark_fill(const char *pattern, const char *mark, const char *const *name, uint32_t count,
                    uint32_t k, char *out, size_t size, Error *err);

#endif
