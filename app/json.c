/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON built as a tree by jansson and written when its outermost value is closed. */
#include "app/json.h"

#include <assert.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* Takes over `value` (NULL, when memory ran out, shows as a failed write at the end). */
static void put(Json *json, const char *key, json_t *value)
{
    json_t *parent = json->depth > 0 ? json->open[json->depth - 1] : NULL;
    assert(parent == NULL || json_is_object(parent) == (key != NULL));
    const int failed = parent == NULL        ? value == NULL
                       : key != NULL         ? json_object_set_new_nocheck(parent, key, value)
                                             : json_array_append_new(parent, value);
    json->failed |= failed != 0;
}

void json_open(Json *json, const char *key, char bracket)
{
    assert(bracket == '{' || bracket == '[');
    assert(json->depth < JSON_DEPTH);
    json_t *value = bracket == '{' ? json_object() : json_array();
    put(json, key, value);
    json->open[json->depth++] = value;
}

void json_close(Json *json, char bracket)
{
    assert(json->depth > 0 && (bracket == '}' || bracket == ']'));
    json_t *value = json->open[--json->depth];
    assert(value == NULL || json_is_object(value) == (bracket == '}'));
    if (json->depth > 0)
        return;
    const size_t flags = json->one_line ? JSON_COMPACT : JSON_INDENT(2);
    if (json->failed || json_dumpf(value, json->out, flags) != 0)
        json->failed = true;
    fputc('\n', json->out);
    json_decref(value);
}

/* A copy of a text in which every byte that jansson refuses stands as U+FFFD; NULL: no memory. */
static json_t *text_repaired(const char *text)
{
    static const char replacement[] = "\xEF\xBF\xBD";
    Error  err = { 0 };
    char  *copy = array_create(3 * strlen(text) + 1, 1, "JSON text", &err);
    json_t *result = NULL;
    size_t  n = 0;
    for (const char *p = text; copy != NULL && *p != '\0';) {
        size_t length = 4;
        json_t *part = NULL;
        /* Sequences of UTF-8 are at most four bytes; the shortest good prefix is one character. */
        for (size_t k = 1; part == NULL && k <= 4 && k <= strnlen(p, 4); k++) {
            part = json_stringn(p, k);
            length = k;
        }
        memcpy(copy + n, part != NULL ? p : replacement, part != NULL ? length : 3);
        n += part != NULL ? length : 3;
        p += part != NULL ? length : 1;
        json_decref(part);
    }
    if (copy != NULL)
        result = json_stringn(copy, n);
    array_free(copy);
    return result;
}

void json_text(Json *json, const char *key, const char *value)
{
    json_t *text = json_string(value != NULL ? value : "");
    put(json, key, text != NULL ? text : text_repaired(value));
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

void json_number(Json *json, const char *key, double value)
{
    put(json, key, number(value));
}

void json_count(Json *json, const char *key, uint64_t value)
{
    /* jansson's integers are signed; beyond them a count is only a size to look at. */
    put(json, key, value <= INT64_MAX ? json_integer((json_int_t)value)
                                      : json_real((double)value));
}

void json_bool(Json *json, const char *key, bool value)
{
    put(json, key, json_boolean(value));
}

void json_numbers(Json *json, const char *key, const double *values, int count)
{
    assert(count >= 0);
    json_open(json, key, '[');
    for (int i = 0; i < count; i++)
        put(json, NULL, number(values[i]));
    json_close(json, ']');
}

/* --- reading ---------------------------------------------------------------------------------- */

enum { VALUE_MOST = 256 };

static bool put_number(const json_t *value, char *out, size_t size)
{
    const int n = snprintf(out, size, "%.17g", json_number_value(value));
    return json_is_number(value) && n > 0 && (size_t)n < size;
}

/* A value as the text that an option would have. */
static bool put_value(const json_t *value, char out[VALUE_MOST])
{
    size_t used = 0;
    if (json_is_string(value))
        return snprintf(out, VALUE_MOST, "%s", json_string_value(value)) < VALUE_MOST;
    if (!json_is_array(value))
        return put_number(value, out, VALUE_MOST);
    for (size_t k = 0; k < json_array_size(value); k++) {
        if (k > 0 && used + 1 < VALUE_MOST)
            out[used++] = ',';
        if (!put_number(json_array_get(value, k), out + used, VALUE_MOST - used))
            return false;
        used += strlen(out + used);
    }
    return used > 0;
}

static bool take_members(const char *name, json_t *object, const char *path, JsonTake take,
                         void *user, Error *err)
{
    const char *member;
    json_t *value;
    char text[VALUE_MOST];
    json_object_foreach(object, member, value) {
        if (!put_value(value, text))
            return error_at(err, ERROR_INPUT, path, 0, "'%s' of '%s' is no text, number or array "
                            "of numbers", member, name);
        if (!take(user, name, member, text, err))
            return false;
    }
    return true;
}

bool json_read_members(const char *bytes, size_t size, const char *path, JsonTake take, void *user,
                       Error *err)
{
    json_error_t why;
    json_t *root = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &why), *value;
    const char *name;
    if (root == NULL)
        return error_at(err, ERROR_INPUT, path, (unsigned)(why.line > 0 ? why.line : 0), "%s",
                        why.text);
    if (!json_is_object(root))
        error_at(err, ERROR_INPUT, path, 0, "is not { \"NAME\": { ... } }");
    json_object_foreach(root, name, value) {
        if (!json_is_object(value))
            error_at(err, ERROR_INPUT, path, 0, "'%s' is not { ... }", name);
        if (error_is_set(err) || !take_members(name, value, path, take, user, err))
            break;
    }
    json_decref(root);
    return !error_is_set(err);
}
