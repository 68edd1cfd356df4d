/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields of CSV. */
#include "app/csv.h"

#include <assert.h>
#include <string.h>

void csv_text(FILE *out, const char *text)
{
    assert(out != NULL && text != NULL);
    if (strpbrk(text, ",\"\r\n") == NULL) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (const char *p = text; *p != '\0'; p++) {
        if (*p == '"')
            fputc('"', out);
        fputc(*p, out);
    }
    fputc('"', out);
}
