/* SPDX-License-Identifier: BSD-3-Clause */
/* app/json.h -- JSON put together one value after the other, in the order it shall have.
 *
 * Keys keep their order; numbers read back as the same double; what is not a
 * number becomes null; bytes that are not UTF-8 become U+FFFD, so that any file name can be told.
 */
#ifndef APP_JSON_H
#define APP_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/error.h"

enum { JSON_DEPTH = 16 };

struct json_t;
typedef struct {
    FILE *out;
    bool  one_line;   /* no line breaks: for streams of objects */
    bool  failed;     /* out of memory, or the stream took no more */
    int   depth;      /* open objects and arrays */
    struct json_t *open[JSON_DEPTH];
} Json;

/* key NULL: inside an array, or the outermost value. Closing that writes it all. */
void json_open(Json *json, const char *key, char bracket);
void json_close(Json *json, char bracket);
void json_text(Json *json, const char *key, const char *value);
void json_number(Json *json, const char *key, double value);
void json_count(Json *json, const char *key, uint64_t value);
void json_bool(Json *json, const char *key, bool value);
void json_numbers(Json *json, const char *key, const double *values, int count);

/* --- reading ---------------------------------------------------------------------------------- */

/* Takes one member of a member, its value as text. */
typedef bool (*JsonTake)(void *user, const char *name, const char *member, const char *value,
                         Error *err);

/* Reads { "name": { "member": value, ... }, ... } with values that are texts, numbers, or arrays of
 * numbers (as text: with commas between); path is for messages.
 * fails  false; ERROR_INPUT with the line, or what `take` says. */
bool json_read_members(const char *bytes, size_t size, const char *path, JsonTake take, void *user,
                       Error *err);

#endif
