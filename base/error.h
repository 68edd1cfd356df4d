/* SPDX-License-Identifier: BSD-3-Clause */
/* base/error.h -- what went wrong in the world: a code, a sentence, the place.
 *
 * An Error belongs to the caller and starts as { 0 }. The first failure is kept: every creator
 * returns NULL at once when it is given an Error that is already set, so a program may chain its
 * stages and look once at the end. A caller's bug is not an Error, it is an assert.
 */
#ifndef BASE_ERROR_H
#define BASE_ERROR_H

#include <stdarg.h>
#include <stdbool.h>

/* The value is the exit code of the program. */
typedef enum {
    ERROR_NONE = 0,
    ERROR_FAILED = 1,  /* anything without a better name: disk full, a child that died */
    ERROR_USAGE = 2,   /* command line or options */
    ERROR_INPUT = 3,   /* a file that cannot be read or is not valid */
    ERROR_STOPPED = 5, /* cancelled, signal or time limit; what is there is usable */
    ERROR_MEMORY = 6   /* out of memory or over the stated limit */
} ErrorCode;

typedef struct {
    ErrorCode code;
    char      text[512]; /* one line, no newline at the end */
} Error;

/* Sets code and text unless an error is set already. Always returns false, so that a check can
 * end with `return error_set(...)`. */
bool error_set(Error *err, ErrorCode code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with "file:line: " (line > 0) or "file: " before the text. */
bool error_at(Error *err, ErrorCode code, const char *file, unsigned line, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Whether an earlier stage failed. */
static inline bool error_is_set(const Error *err) { return err->code != ERROR_NONE; }

#endif
