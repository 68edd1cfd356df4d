/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines and words of text files that come from anywhere. */
#include "scenes/text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"

/* Stands for the end of a line that a back slash joined to the next: white space, but counted. */
#define JOINT '\v'

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/* --- encodings -------------------------------------------------------------------------------- */

static size_t utf8_put(uint32_t code, char *out)
{
    if (code < 0x80) {
        out[0] = (char)code;
        return 1;
    }
    if (code < 0x800) {
        out[0] = (char)(0xC0 | code >> 6);
        out[1] = (char)(0x80 | (code & 0x3F));
        return 2;
    }
    const size_t more = code < 0x10000 ? 2 : 3;
    out[0] = (char)((more == 2 ? 0xE0 : 0xF0) | code >> 6 * more);
    for (size_t i = 1; i <= more; i++)
        out[i] = (char)(0x80 | ((code >> 6 * (more - i)) & 0x3F));
    return more + 1;
}

/* A surrogate without its partner becomes U+FFFD. */
static char *utf8_from_utf16(const uint8_t *bytes, size_t size, bool big, size_t *made, Error *err)
{
    const size_t count = size / 2;
    char *out = array_create(3 * count + 1, 1, "text", err); /* 2 bytes make at most 3 */
    size_t used = 0;

    if (out == NULL)
        return NULL;
    for (size_t i = 0; i < count; i++) {
        const uint8_t *p = bytes + 2 * i;
        uint32_t code = big ? (uint32_t)(p[0] << 8 | p[1]) : (uint32_t)(p[1] << 8 | p[0]);
        if (code >= 0xD800 && code < 0xDC00 && i + 1 < count) {
            const uint32_t low = big ? (uint32_t)(p[2] << 8 | p[3]) : (uint32_t)(p[3] << 8 | p[2]);
            if (low >= 0xDC00 && low < 0xE000) {
                code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
                i++;
            }
        }
        used += utf8_put(code >= 0xD800 && code < 0xE000 ? 0xFFFD : code, out + used);
    }
    *made = used;
    return out;
}

/* Turns every kind of line end into a 0 byte, in place. */
static size_t lines_split(char *bytes, size_t size)
{
    size_t to = 0;

    for (size_t i = 0; i < size; i++) {
        const char c = bytes[i];
        if (c != '\n' && c != '\r') {
            bytes[to++] = c == 0 || c == JOINT ? '?' : c;
            continue;
        }
        if (c == '\r' && i + 1 < size && bytes[i + 1] == '\n')
            i++;
        if (to > 0 && bytes[to - 1] == '\\')
            bytes[to - 1] = JOINT;
        else
            bytes[to++] = 0;
    }
    bytes[to++] = 0;
    return to;
}

/* --- files ------------------------------------------------------------------------------------ */

bool text_open(TextFile *text, const char *path, size_t limit, uint64_t *hash, Error *err)
{
    assert(text != NULL && path != NULL && hash != NULL && err != NULL);
    *text = (TextFile){ .path = path };
    size_t size = 0;
    char *bytes = file_read(path, limit, &size, err);

    if (bytes == NULL)
        return false;
    *hash = file_hash(bytes, size, *hash);
    const uint8_t *b = (const uint8_t *)bytes;
    if (size >= 2 && ((b[0] == 0xFE && b[1] == 0xFF) || (b[0] == 0xFF && b[1] == 0xFE))) {
        char *utf8 = utf8_from_utf16(b + 2, size - 2, b[0] == 0xFE, &size, err);
        array_free(bytes);
        if (utf8 == NULL)
            return false;
        bytes = utf8;
    } else if (size >= 3 && b[0] == 0xEF && b[1] == 0xBB && b[2] == 0xBF) {
        size -= 3;
        memmove(bytes, bytes + 3, size);
    }
    text->bytes = bytes;
    text->size = lines_split(bytes, size);
    text->numbers = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (text->numbers == (locale_t)0)
        return error_set(err, ERROR_MEMORY, "no locale to read numbers with");
    return true;
}

void text_close(TextFile *text)
{
    assert(text != NULL);
    if (text->numbers != (locale_t)0)
        freelocale(text->numbers);
    array_free(text->bytes);
    *text = (TextFile){ 0 };
}

void text_rewind(TextFile *text)
{
    text->at = 0;
    text->line = 0;
    text->joined = 0;
}

const char *text_line(TextFile *text)
{
    assert(text != NULL && text->bytes != NULL);
    if (text->at >= text->size)
        return NULL;
    const char *line = text->bytes + text->at;

    text->line += 1 + text->joined;
    text->joined = 0;
    for (const char *c = line; *c != 0; c++)
        text->joined += *c == JOINT;
    text->at += strlen(line) + 1;
    while (is_space(*line))
        line++;
    return line;
}

/* --- words ------------------------------------------------------------------------------------ */

Word text_word(const char **line)
{
    assert(line != NULL && *line != NULL);
    const char *c = *line;

    while (is_space(*c))
        c++;
    const char *begin = c;
    if (*c != '#')
        while (*c != 0 && !is_space(*c))
            c++;
    *line = c;
    return (Word){ begin, (size_t)(c - begin) };
}

bool word_is(Word word, const char *text)
{
    return strlen(text) == word.length && memcmp(word.begin, text, word.length) == 0;
}

void text_rest(const char *line, char *rest, size_t size)
{
    assert(line != NULL && rest != NULL && size > 0);
    size_t length = 0;

    while (is_space(*line))
        line++;
    while (line[length] != 0 &&
           !(line[length] == '#' && (length == 0 || is_space(line[length - 1]))))
        length++;
    while (length > 0 && is_space(line[length - 1]))
        length--;
    snprintf(rest, size, "%.*s", (int)(length < size ? length : size), line);
}

bool text_number(const TextFile *text, const char **line, double *value)
{
    const char *after = *line;
    const Word word = text_word(&after);
    char *end = NULL;

    if (word.length == 0)
        return false;
    const double number = strtod_l(word.begin, &end, text->numbers);
    if (end != word.begin + word.length)
        return false;
    *value = number;
    *line = after;
    return true;
}

bool text_error(const TextFile *text, Error *err, const char *format, ...)
{
    char what[400];
    va_list list;

    va_start(list, format);
    vsnprintf(what, sizeof what, format, list);
    va_end(list);
    return error_at(err, ERROR_INPUT, text->path, text->line, "%s", what);
}
