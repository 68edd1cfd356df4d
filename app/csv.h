/* SPDX-License-Identifier: BSD-3-Clause */
/* app/csv.h -- fields of CSV as RFC 4180 has them. */
#ifndef APP_CSV_H
#define APP_CSV_H

#include <stdio.h>

/* A field; quoted, with its quotes doubled, when it holds a comma, a quote or a line break. */
void csv_text(FILE *out, const char *text);

#endif
