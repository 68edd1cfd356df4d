/* SPDX-License-Identifier: BSD-3-Clause */
/* Errors: the first one is kept, always as one printable line. */
#include "base/error.h"

#include <assert.h>
#include <stdio.h>

/* Texts quote bytes of files; a control character among them must not break the line or steer the
 * user's terminal. Bytes above 127 stay: they are UTF-8. */
static void text_clean(char *text)
{
    for (unsigned char *p = (unsigned char *)text; *p != 0; p++)
        if (*p < 0x20 || *p == 0x7f)
            *p = ' ';
}

static void text_append(Error *err, int used, const char *format, va_list list)
{
    const size_t room = sizeof err->text;

    if (used < 0)
        used = 0;
    if ((size_t)used < room)
        vsnprintf(err->text + used, room - (size_t)used, format, list);
    text_clean(err->text);
}

bool error_set(Error *err, ErrorCode code, const char *format, ...)
{
    assert(err != NULL && format != NULL);
    assert(code != ERROR_NONE);
    if (error_is_set(err))
        return false;
    va_list list;
    va_start(list, format);
    err->code = code;
    text_append(err, 0, format, list);
    va_end(list);
    return false;
}

bool error_at(Error *err, ErrorCode code, const char *file, unsigned line, const char *format, ...)
{
    assert(err != NULL && file != NULL && format != NULL);
    assert(code != ERROR_NONE);
    if (error_is_set(err))
        return false;
    va_list list;
    va_start(list, format);
    err->code = code;
    const int used = line > 0 ? snprintf(err->text, sizeof err->text, "%s:%u: ", file, line)
                              : snprintf(err->text, sizeof err->text, "%s: ", file);
    text_append(err, used, format, list);
    va_end(list);
    return false;
}
