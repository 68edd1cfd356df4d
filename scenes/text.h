/* SPDX-License-Identifier: BSD-3-Clause */
/* scenes/text.h -- a text file as lines and words, whatever its encoding and line ends.
 *
 * UTF-8 or UTF-16 with a byte-order mark; lines end with LF, CR LF or CR; a back slash at the end
 * of a line joins the next one. Numbers are read the same way in every locale.
 */
#ifndef SCENES_TEXT_H
#define SCENES_TEXT_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct {
    const char *path;
    char       *bytes;     /* lines, each ended by a 0 byte; owned */
    size_t      size;      /* with the last 0 */
    size_t      at;        /* begin of the next line */
    unsigned    line;      /* number of the current line, from 1 */
    unsigned    joined;    /* lines joined to the current one */
    locale_t    numbers;
} TextFile;

/* Reads a whole file and chains its bytes into *hash.
 * fails  false; text_close is allowed then. */
bool text_open(TextFile *text, const char *path, size_t limit, uint64_t *hash, Error *err);
void text_close(TextFile *text);
/* Back to the first line. */
void text_rewind(TextFile *text);
/* The next line without leading white space, or NULL at the end. */
const char *text_line(TextFile *text);

/* A word of a line: not ended by a 0 byte. */
typedef struct {
    const char *begin;
    size_t      length;
} Word;

/* Takes the next word off the line; length 0 at its end. A # that begins a word ends the line. */
Word text_word(const char **line);
bool word_is(Word word, const char *text);
/* The rest of the line without white space around it, cut to size - 1 bytes. */
void text_rest(const char *line, char *rest, size_t size);
/* The next word as a number. fails  false and *value untouched: no word, or not a number. */
bool text_number(const TextFile *text, const char **line, double *value);
/* ERROR_INPUT at the current line. */
bool text_error(const TextFile *text, Error *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
