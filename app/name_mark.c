/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of groups and cameras within names of files. */
#include "app/name_mark.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <string.h>

static char plain(char c)
{
    return isalnum((unsigned char)c) || c == '-' || c == '.' ? c : '_';
}

/* Whether both become the same in a file's name. */
static bool same_name(const char *a, const char *b)
{
    for (; *a != '\0' && plain(*a) == plain(*b); a++, b++)
        ;
    return *a == '\0' && *b == '\0';
}

bool name_mark_fill(const char *pattern, const char *mark, const char *const *name, uint32_t count,
                    uint32_t k, char *out, size_t size, Error *err)
{
    const char *at = strstr(pattern, mark);
    char        number[16] = "";
    uint32_t    before = 0;
    assert(at != NULL && k < count);
    for (uint32_t j = 0; j < k; j++)
        before += same_name(name[j], name[k]);
    if (before > 0)
        snprintf(number, sizeof number, "+%u", before + 1);
    const size_t begin = (size_t)(at - pattern), length = strlen(name[k]);
    const int whole = snprintf(out, size, "%.*s%s%s%s", (int)begin, pattern, name[k], number,
                               at + strlen(mark));
    if (whole < 0 || (size_t)whole >= size)
        return error_set(err, ERROR_USAGE, "-o %.200s: the name for '%.80s' is too long", pattern,
                         name[k]);
    for (size_t i = begin; i < begin + length; i++)
        out[i] = plain(out[i]);
    return true;
}
