/* SPDX-License-Identifier: BSD-3-Clause */
/* Measuring points out of a text file. */
#include "app/points.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"

/* More would be a mistake, or a device without end. */
static const size_t FILE_LIMIT = (size_t)1 << 30;

enum { COLUMNS = 6 };

typedef enum { LINE_EMPTY, LINE_WORDS, LINE_VALUES } LineKind;

static bool is_separator(char c)
{
    return c == ',' || c == ';' || c == ' ' || c == '\t';
}

/* Reads the values of a line p..end. LINE_WORDS: its first field is no number. */
static LineKind read_line(const char *p, const char *end, double *value, size_t *count,
                          const char **bad)
{
    *count = 0;
    *bad = NULL;
    while (p < end) {
        char field[64], *stop = NULL;
        while (p < end && is_separator(*p))
            p++;
        const char *begin = p;
        while (p < end && !is_separator(*p))
            p++;
        const size_t n = (size_t)(p - begin);
        if (n == 0)
            break;
        *bad = begin;
        if (n >= sizeof field)
            return *count == 0 ? LINE_WORDS : LINE_VALUES;
        memcpy(field, begin, n);
        field[n] = '\0';
        const double v = strtod(field, &stop);
        if (*stop != '\0' || isalpha((unsigned char)field[0]))
            return *count == 0 ? LINE_WORDS : LINE_VALUES;
        *bad = NULL;
        if (*count < COLUMNS)
            value[*count] = v;
        ++*count;
    }
    return *count == 0 ? LINE_EMPTY : LINE_VALUES;
}

static bool add_point(Points *points, const double *v, const char *name, unsigned line, Error *err)
{
    const Vec3 p = vec3(v[0], v[1], v[2]), n = vec3(v[3], v[4], v[5]);
    /* Scaled first: the square of a large or small component must not overflow or vanish. */
    const double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    if (!vec3_finite(p) || !vec3_finite(n))
        return error_at(err, ERROR_INPUT, name, line, "a value is not finite");
    if (!(largest > 0))
        return error_at(err, ERROR_INPUT, name, line, "the normal is 0,0,0");
    const Vec3 scaled = vec3(n.x / largest, n.y / largest, n.z / largest);
    const size_t needed = points->count + 1;
    if (!array_reserve((void **)&points->point, &points->capacity[0], needed, sizeof p, "points",
                       err) ||
        !array_reserve((void **)&points->given, &points->capacity[1], needed, sizeof n, "points",
                       err) ||
        !array_reserve((void **)&points->normal, &points->capacity[2], needed, sizeof n, "points",
                       err))
        return false;
    points->point[points->count] = p;
    points->given[points->count] = n;
    points->normal[points->count++] = vec3_unit(scaled);
    return true;
}

static bool parse_line(Points *points, const char *begin, const char *end, const char *name,
                       unsigned line, bool *heading, Error *err)
{
    double value[COLUMNS];
    size_t count = 0;
    const char *bad = NULL;
    const LineKind kind = read_line(begin, end, value, &count, &bad);
    if (kind == LINE_EMPTY)
        return true;
    const bool first = *heading;
    *heading = false;
    if (kind == LINE_WORDS && first)
        return true;
    if (bad != NULL) {
        const size_t n = strcspn(bad, ",; \t\r\n");
        return error_at(err, ERROR_INPUT, name, line, "'%.*s' is not a number",
                        (int)(n < 40 ? n : 40), bad);
    }
    if (count != COLUMNS)
        return error_at(err, ERROR_INPUT, name, line,
                        "%zu values where x,y,z,nx,ny,nz are expected", count);
    return add_point(points, value, name, line, err);
}

bool points_parse(Points *points, const char *text, size_t size, const char *name, Error *err)
{
    assert(points != NULL && text != NULL && text[size] == '\0' && name != NULL);
    bool heading = true;
    unsigned line = 1;
    if (memchr(text, '\0', size) != NULL)
        return error_at(err, ERROR_INPUT, name, 0, "holds a 0 byte; points are text");
    if (size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) /* what some editors put before UTF-8 */
        text += 3;
    for (const char *p = text; *p != '\0'; line++) {
        const char *next = p + strcspn(p, "\n");
        const char *end = p + strcspn(p, "#\n");
        while (end > p && end[-1] == '\r')
            end--;
        if (!parse_line(points, p, end, name, line, &heading, err))
            return false;
        p = next + (*next == '\n');
    }
    if (points->count == 0)
        return error_at(err, ERROR_INPUT, name, 0, "holds no points");
    return true;
}

/* Standard input to its end, with a 0 after it. */
static char *read_input(size_t *size, Error *err)
{
    char *text = NULL;
    size_t capacity = 0, used = 0;
    enum { STEP = 65536 };
    for (;;) {
        if (!array_reserve((void **)&text, &capacity, used + STEP, 1, "points", err))
            break;
        const size_t n = fread(text + used, 1, STEP - 1, stdin);
        used += n;
        text[used] = '\0';
        if (n == 0) {
            if (ferror(stdin))
                error_set(err, ERROR_INPUT, "standard input cannot be read");
            break;
        }
        if (used > FILE_LIMIT) {
            error_set(err, ERROR_INPUT, "standard input holds more than 1 GiB");
            break;
        }
    }
    *size = used;
    return error_is_set(err) ? array_free(text) : text;
}

bool points_read(Points *points, const char *path, Error *err)
{
    size_t size = 0;
    const bool input = strcmp(path, "-") == 0;
    char *text = input ? read_input(&size, err) : file_read(path, FILE_LIMIT, &size, err);
    const bool good = text != NULL && points_parse(points, text, size,
                                                   input ? "standard input" : path, err);
    array_free(text);
    return good;
}

void points_free(Points *points)
{
    array_free(points->point);
    array_free(points->given);
    array_free(points->normal);
    *points = (Points){ 0 };
}
