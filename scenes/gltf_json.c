/* SPDX-License-Identifier: BSD-3-Clause */
/* Typed values out of JSON, with the place in each complaint. jansson reads here; app/json.c writes
 * with it. */
#include "scenes/gltf.h"

#include <assert.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool gltf_error(const GltfContext *c, const char *where, const char *format, ...)
{
    char text[300];
    va_list list;

    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return error_at(c->err, ERROR_INPUT, c->path, 0, "%s%s%s", where, where[0] != 0 ? ": " : "",
                    text);
}

Json *gltf_parse(const GltfContext *c, const char *text, size_t size)
{
    assert(c != NULL && text != NULL);
    json_error_t problem;

    if (error_is_set(c->err))
        return NULL;
    if (size > gltf_json_limit) {
        gltf_error(c, "", "its JSON is larger than %zu MiB", gltf_json_limit >> 20);
        return NULL;
    }
    Json *json = json_loadb(text, size, 0, &problem);
    if (json == NULL && json_error_code(&problem) == json_error_out_of_memory)
        error_set(c->err, ERROR_MEMORY, "%s: no memory for its JSON", c->path);
    else if (json == NULL)
        error_at(c->err, ERROR_INPUT, c->path, problem.line > 0 ? (unsigned)problem.line : 0,
                 "is not valid JSON: %s", problem.text);
    else if (!json_is_object(json))
        gltf_error(c, "", "its JSON is not an object");
    if (error_is_set(c->err)) {
        json_decref(json);
        return NULL;
    }
    return json;
}

void gltf_free(Json *json) { json_decref(json); }

const Json *gltf_member(const Json *object, const char *key)
{
    assert(key != NULL);
    return json_object_get(object, key); /* NULL for what is not an object */
}

bool gltf_is_object(const Json *json) { return json_is_object(json); }

const Json *gltf_list(const GltfContext *c, const Json *object, const char *where, const char *key)
{
    const Json *list = gltf_member(object, key);

    if (list != NULL && !json_is_array(list)) {
        gltf_error(c, where, "\"%s\" is not an array", key);
        return NULL;
    }
    return list;
}

const Json *gltf_object(const GltfContext *c, const Json *object, const char *where,
                        const char *key)
{
    const Json *member = gltf_member(object, key);

    if (member != NULL && !json_is_object(member)) {
        gltf_error(c, where, "\"%s\" is not an object", key);
        return NULL;
    }
    return member;
}

size_t gltf_count(const Json *list) { return json_array_size(list); }

const Json *gltf_item(const Json *list, size_t index)
{
    assert(index < json_array_size(list));
    return json_array_get(list, index);
}

const char *gltf_word(const GltfContext *c, const Json *object, const char *where, const char *key,
                      const char *fallback)
{
    const Json *member = gltf_member(object, key);

    if (member == NULL)
        return fallback;
    if (!json_is_string(member)) {
        gltf_error(c, where, "\"%s\" is not a string", key);
        return fallback;
    }
    return json_string_value(member);
}

double gltf_number(const GltfContext *c, const Json *object, const char *where, const char *key,
                   double fallback)
{
    const Json *member = gltf_member(object, key);

    if (member == NULL)
        return fallback;
    if (!json_is_number(member) || !isfinite(json_number_value(member))) {
        gltf_error(c, where, "\"%s\" is not a number", key);
        return fallback;
    }
    return json_number_value(member);
}

/* SIZE_MAX and an error when it is not a whole number below limit. A real such as 3.0 counts. */
static size_t index_value(const GltfContext *c, const Json *json, const char *where,
                          const char *key, size_t limit)
{
    const double value = json_is_number(json) ? json_number_value(json) : -1;

    if (!(value >= 0) || value != floor(value)) {
        gltf_error(c, where, "\"%s\" is not an index", key);
        return SIZE_MAX;
    }
    if (value >= (double)limit) {
        gltf_error(c, where, "\"%s\" is %.0f, but must be below %zu", key, value, limit);
        return SIZE_MAX;
    }
    return (size_t)value;
}

size_t gltf_index(const GltfContext *c, const Json *object, const char *where, const char *key,
                  size_t limit)
{
    const Json *member = gltf_member(object, key);
    return member != NULL ? index_value(c, member, where, key, limit) : SIZE_MAX;
}

size_t gltf_index_item(const GltfContext *c, const Json *list, const char *where, size_t item,
                       size_t limit)
{
    char key[32];

    snprintf(key, sizeof key, "[%zu]", item);
    return index_value(c, gltf_item(list, item), where, key, limit);
}

const char *gltf_string_item(const GltfContext *c, const Json *list, const char *where,
                             size_t item)
{
    const char *text = json_string_value(gltf_item(list, item));

    if (text == NULL)
        gltf_error(c, where, "[%zu] is not a string", item);
    return text;
}

bool gltf_numbers(const GltfContext *c, const Json *object, const char *where, const char *key,
                  double *values, size_t count)
{
    assert(values != NULL && count <= 16);
    const Json *list = gltf_list(c, object, where, key);
    double read[16];

    if (list == NULL)
        return false;
    if (json_array_size(list) != count)
        return gltf_error(c, where, "\"%s\" has %zu numbers instead of %zu", key,
                          json_array_size(list), count);
    for (size_t i = 0; i < count; i++) {
        const Json *item = json_array_get(list, i);
        if (!json_is_number(item) || !isfinite(json_number_value(item)))
            return gltf_error(c, where, "\"%s\"[%zu] is not a number", key, i);
        read[i] = json_number_value(item);
    }
    memcpy(values, read, count * sizeof *values);
    return true;
}

char *gltf_text(const Json *json) { return json_dumps(json, JSON_COMPACT | JSON_ENCODE_ANY); }

void gltf_text_free(char *text)
{
    json_free_t give_back;

    json_get_alloc_funcs(NULL, &give_back);
    if (text != NULL)
        give_back(text);
}
