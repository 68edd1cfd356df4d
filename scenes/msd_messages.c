/* SPDX-License-Identifier: BSD-3-Clause */
/* What the MSD reader says: always file, line, column, what was found, what was expected. */
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "scenes/msd.h"

enum { QUOTE_MAX = 40 };

/* Characters from the start of the line, from 1: bytes that do not continue one. */
static unsigned column_of(const MsdSource *source, MsdPlace place)
{
    unsigned column = 1;

    assert(place.line_start <= place.offset && place.offset <= source->size);
    for (size_t i = place.line_start; i < place.offset; i++)
        column += ((unsigned char)source->text[i] & 0xc0) != 0x80;
    return column;
}

void msd_where(const MsdReader *r, MsdPlace place, char where[MSD_WHERE_MAX])
{
    assert(place.source < r->source_count);
    const MsdSource *source = &r->sources[place.source];
    const size_t     length = strlen(source->path);
    /* Of a long path the end tells more. */
    const size_t room = MSD_WHERE_MAX - 32;
    const char  *path = length > room ? source->path + (length - room) : source->path;

    snprintf(where, MSD_WHERE_MAX, "%s%s:%u:%u", length > room ? "..." : "", path, place.line,
             column_of(source, place));
}

static void line_format(char *line, size_t size, const char *format, va_list list)
{
    vsnprintf(line, size, format, list);
}

bool msd_error(MsdReader *r, MsdPlace place, const char *format, ...)
{
    char    where[MSD_WHERE_MAX], line[256];
    va_list list;

    if (error_is_set(r->err))
        return false;
    msd_where(r, place, where);
    va_start(list, format);
    line_format(line, sizeof line, format, list);
    va_end(list);
    return error_at(r->err, ERROR_INPUT, where, 0, "%s", line);
}

bool msd_error_from(MsdReader *r, MsdPlace place, const Error *cause)
{
    char where[MSD_WHERE_MAX];

    assert(cause->code != ERROR_NONE);
    if (error_is_set(r->err))
        return false;
    if (cause->code == ERROR_MEMORY)
        return error_set(r->err, cause->code, "%s", cause->text);
    msd_where(r, place, where);
    return error_at(r->err, cause->code, where, 0, "%s", cause->text);
}

void msd_warn(MsdReader *r, MsdPlace place, const char *code, const char *format, ...)
{
    char    where[MSD_WHERE_MAX], line[256];
    va_list list;

    if (r->options == NULL || r->options->monitor == NULL)
        return;
    msd_where(r, place, where);
    va_start(list, format);
    line_format(line, sizeof line, format, list);
    va_end(list);
    monitor_warn(r->options->monitor, code, where, "%s", line);
}

/* Whether a name would be a word if its letters were all of one case. */
static bool is_mixed_word(const MsdToken *t, const char *text, size_t length)
{
    char lower[QUOTE_MAX];

    if (t->kind != TOKEN_NAME || length > sizeof lower)
        return false;
    for (size_t i = 0; i < length; i++)
        lower[i] = text[i] >= 'A' && text[i] <= 'Z' ? (char)(text[i] - 'A' + 'a') : text[i];
    return msd_word(lower, length) != WORD_NONE;
}

bool msd_expected(MsdReader *r, const char *what)
{
    const MsdToken *t = &r->token;
    const char     *text = r->sources[t->place.source].text + t->place.offset;
    size_t          length = t->end - t->place.offset;

    if (error_is_set(r->err))
        return false;
    if (t->kind == TOKEN_END)
        return msd_error(r, t->place, "found the end of the file, expected %s", what);
    /* Strings may hold any character; cut them between two. */
    const bool cut = length > QUOTE_MAX;
    if (cut)
        for (length = QUOTE_MAX; length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80;)
            length--;
    if (t->kind == TOKEN_WORD && t->word == WORD_UNBUILT)
        return msd_error(r, t->place, "found %.*s, which is not built yet, expected %s",
                         (int)length, text, what);
    if (is_mixed_word(t, text, length))
        return msd_error(r, t->place, "found '%.*s', a word in mixed case, expected %s",
                         (int)length, text, what);
    return msd_error(r, t->place, "found '%.*s%s', expected %s", (int)length, text,
                     cut ? "..." : "", what);
}

bool msd_deeper(MsdReader *r)
{
    static const unsigned depth_max = 200; /* far from the stack's end, beyond any real file */

    if (r->depth >= depth_max)
        return msd_error(r, r->token.place, "nested more than %u deep", depth_max);
    r->depth++;
    return true;
}
