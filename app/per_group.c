/* SPDX-License-Identifier: BSD-3-Clause */
/* Values per group: "0.9", "wall=0.9,floor=0.5" or a CSV file. */
#include "app/per_group.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "app/options.h"
#include "base/array.h"
#include "base/file.h"

enum { NAME_MOST = 256 };
static const size_t FILE_MOST = (size_t)64 << 20;

static bool assign(const char *word, double number, const char *const *name, size_t count,
                   double *value)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(name[i], word) == 0) {
            value[i] = number;
            return true;
        }
    return false;
}

/* --- the command line ------------------------------------------------------------------------- */

static bool read_pairs(const char *text, const char *const *name, size_t count, double *value,
                       Error *err)
{
    char word[NAME_MOST], digits[64];
    for (const char *p = text; *p != '\0';) {
        const char *equals = strchr(p, '='), *end = p + strcspn(p, ",");
        double number;
        /* A name may hold commas: it goes on to the next equals sign. */
        if (equals == NULL || equals == p || equals - p >= NAME_MOST)
            return error_set(err, ERROR_USAGE, "'%.60s' is not NAME=VALUE", p);
        end = equals + strcspn(equals, ",");
        if (end - equals - 1 >= (ptrdiff_t)sizeof digits)
            return error_set(err, ERROR_USAGE, "'%.60s' is not NAME=VALUE", p);
        memcpy(word, p, (size_t)(equals - p));
        word[equals - p] = '\0';
        memcpy(digits, equals + 1, (size_t)(end - equals - 1));
        digits[end - equals - 1] = '\0';
        if (!value_number(digits, &number))
            return error_set(err, ERROR_USAGE, "'%s' of group '%s' is not a number", digits, word);
        if (!assign(word, number, name, count, value))
            return error_set(err, ERROR_USAGE, "there is no group '%s' in the matrix", word);
        p = *end == ',' ? end + 1 : end;
    }
    return true;
}

/* --- a file ----------------------------------------------------------------------------------- */

/* The first field of a CSV line into word, quotes undone; returns what follows its comma, or
 * NULL. */
static const char *first_field(const char *line, char word[NAME_MOST])
{
    size_t n = 0;
    const char *p = line;
    if (*p != '"') {
        n = strcspn(p, ",");
        if (p[n] != ',' || n >= NAME_MOST)
            return NULL;
        memcpy(word, p, n);
        word[n] = '\0';
        return p + n + 1;
    }
    for (p++; *p != '\0' && n + 1 < NAME_MOST; p++) {
        if (*p == '"' && p[1] != '"')
            break;
        p += *p == '"';
        word[n++] = *p;
    }
    word[n] = '\0';
    return *p == '"' && p[1] == ',' ? p + 2 : NULL;
}

static bool read_file(const char *path, const char *const *name, size_t count, double *value,
                      Error *err)
{
    size_t size;
    char word[NAME_MOST], *rest = NULL;
    char *bytes = file_read(path, FILE_MOST, &size, err);
    if (bytes == NULL)
        return false;
    int line = 0;
    for (char *at = bytes; !error_is_set(err) && (at = strtok_r(at, "\n", &rest)) != NULL;
         at = NULL) {
        double number;
        at[strcspn(at, "\r")] = '\0';
        line++;
        if (*at == '\0' || *at == '#')
            continue;
        const char *field = first_field(at, word);
        const bool good = field != NULL && value_number(field, &number);
        if (!good && line > 1)
            error_at(err, ERROR_INPUT, path, line, "is not a name, a comma and a number");
        else if (good && !assign(word, number, name, count, value))
            error_at(err, ERROR_INPUT, path, line, "there is no group '%s' in the matrix", word);
    }
    array_free(bytes);
    return !error_is_set(err);
}

bool per_group_read(const char *text, const char *const *name, size_t count, double *value,
                    Error *err)
{
    double number;
    assert(text != NULL && value != NULL && err != NULL);
    if (value_number(text, &number)) {
        for (size_t i = 0; i < count; i++)
            value[i] = number;
        return true;
    }
    if (strchr(text, '=') != NULL)
        return read_pairs(text, name, count, value, err);
    return read_file(text, name, count, value, err);
}
