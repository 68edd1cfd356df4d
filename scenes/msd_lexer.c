/* SPDX-License-Identifier: BSD-3-Clause */
/* MSD text into tokens. Columns count characters, not bytes; a tab is one. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "scenes/msd.h"

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
static bool is_name(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

/* The text ends with a 0 byte, so looking one ahead of any byte but that one is allowed. */
static const char *text_at(const MsdReader *r)
{
    assert(r->cursor.source < r->source_count);
    assert(r->cursor.offset <= r->sources[r->cursor.source].size);
    return r->sources[r->cursor.source].text + r->cursor.offset;
}

static bool at_end(const MsdReader *r)
{
    return r->cursor.offset == r->sources[r->cursor.source].size;
}

static void step(MsdReader *r)
{
    const char c = *text_at(r);

    assert(!at_end(r));
    r->cursor.offset++;
    if (c == '\n') {
        r->cursor.line++;
        r->cursor.line_start = r->cursor.offset;
    }
}

/* --- between tokens -------------------------------------------------------------------------- */

static bool comment_skip(MsdReader *r)
{
    const MsdPlace start = r->cursor;

    step(r);
    step(r);
    while (!at_end(r)) {
        const char *p = text_at(r);
        if (p[0] == '*' && p[1] == '/') {
            step(r);
            step(r);
            return true;
        }
        step(r);
    }
    return msd_error(r, start, "found a comment without end, expected */");
}

static bool blank_skip(MsdReader *r)
{
    while (!at_end(r)) {
        const char *p = text_at(r);
        if (*p == ' ' || *p == '\t' || *p == '\n' || *p == '\r' || *p == '\f' || *p == '\v') {
            step(r);
        } else if (p[0] == '/' && p[1] == '/') {
            while (!at_end(r) && *text_at(r) != '\n')
                step(r);
        } else if (p[0] == '/' && p[1] == '*') {
            if (!comment_skip(r))
                return false;
        } else {
            break;
        }
    }
    return true;
}

/* --- numbers and names ----------------------------------------------------------------------- */

/* Length of the longest number at p: digits with at most one point among or beside them, then an
 * exponent if it has digits. */
static size_t number_length(const char *p, bool *whole)
{
    size_t n = 0, digits = 0;

    for (; is_digit(p[n]); n++)
        digits++;
    *whole = true;
    if (p[n] == '.') {
        *whole = false;
        for (n++; is_digit(p[n]); n++)
            digits++;
    }
    if (digits > 0 && (p[n] == 'e' || p[n] == 'E')) {
        const size_t sign = p[n + 1] == '+' || p[n + 1] == '-';
        if (is_digit(p[n + 1 + sign])) {
            *whole = false;
            for (n += 1 + sign; is_digit(p[n]); n++)
                continue;
        }
    }
    return digits > 0 ? n : 0;
}

static bool number_read(MsdReader *r)
{
    const char  *p = text_at(r);
    const size_t n = number_length(p, &r->token.whole);

    if (n == 0)
        return msd_error(r, r->cursor, "found '.', expected a number or a word");
    r->cursor.offset += n;
    if (is_name(p[n]) || p[n] == '.') {
        size_t more = n;
        while (more < n + 20 && (is_name(p[more]) || p[more] == '.'))
            more++;
        return msd_error(r, r->token.place, "found '%.*s', which is neither number nor name",
                         (int)(more > 40 ? 40 : more), p);
    }
    r->token.kind = TOKEN_NUMBER;
    r->token.number = strtod_l(p, NULL, r->locale);
    if (!isfinite(r->token.number))
        return msd_error(r, r->token.place, "the number %.*s is too large", (int)(n > 40 ? 40 : n),
                         p);
    return true;
}

static bool name_read(MsdReader *r)
{
    const char *p = text_at(r);
    size_t      n = 1;

    while (is_name(p[n]))
        n++;
    r->cursor.offset += n;
    if (!msd_symbol(r, p, n, &r->token.symbol))
        return false;
    r->token.word = r->symbols[r->token.symbol].word;
    r->token.kind = r->token.word != WORD_NONE ? TOKEN_WORD : TOKEN_NAME;
    return true;
}

/* --- strings --------------------------------------------------------------------------------- */

static int hex_value(char c)
{
    return is_digit(c) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Reads one escape behind the backslash into *value; 0 stands for "none such". */
static void escape_read(MsdReader *r, unsigned *value)
{
    static const char letters[] = "ntvbrfa\\?'\"", meanings[] = "\n\t\v\b\r\f\a\\?'\"";
    const char *p = text_at(r);
    const char *found = *p != 0 ? strchr(letters, *p) : NULL;
    int         length = 0;

    *value = 0;
    if (found != NULL) {
        *value = (unsigned char)meanings[found - letters];
        length = 1;
    } else if (*p == 'x') {
        for (length = 1; length < 3 && hex_value(p[length]) >= 0; length++)
            *value = 16 * *value + (unsigned)hex_value(p[length]);
    } else {
        for (; length < 3 && p[length] >= '0' && p[length] <= '7'; length++)
            *value = 8 * *value + (unsigned)(p[length] - '0');
    }
    while (length-- > 0)
        step(r);
}

/* Bytes of the UTF-8 character at p, or 0 when there is none [rfc3629]. */
static size_t utf8_length(const char *text)
{
    const unsigned char *p = (const unsigned char *)text;
    const size_t n = p[0] < 0x80 ? 1 : p[0] >= 0xc2 && p[0] < 0xe0 ? 2
                   : p[0] >= 0xe0 && p[0] < 0xf0 ? 3 : p[0] >= 0xf0 && p[0] < 0xf5 ? 4 : 0;

    for (size_t i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80)
            return 0;
    /* Overlong forms, surrogates, beyond U+10FFFF. */
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f) ||
        (p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f))
        return 0;
    return n;
}

static bool utf8_valid(const char *text)
{
    while (*text != 0) {
        const size_t n = utf8_length(text);
        if (n == 0)
            return false;
        text += n;
    }
    return true;
}

/* One character of a string's value; `used` bytes of r->string are filled. */
static bool string_byte(MsdReader *r, size_t *used)
{
    unsigned value = (unsigned char)*text_at(r);

    if (value == '\n' || value == '\r' || value == 0)
        return msd_error(r, r->token.place, "found a string without end, expected \"");
    const MsdPlace place = r->cursor;
    step(r);
    if (value == '\\') {
        if (!at_end(r))
            escape_read(r, &value);
        if (value == 0 || at_end(r))
            return msd_error(r, place, "found an escape that stands for nothing, expected one of "
                                       "C's (\\n \\t \\\\ \\\" \\x41 ...)");
    }
    if (!array_reserve((void **)&r->string, &r->string_capacity, *used + 2, 1, "string", r->err))
        return false;
    r->string[(*used)++] = (char)value;
    return true;
}

static bool string_read(MsdReader *r)
{
    size_t used = 0;

    step(r);
    while (at_end(r) || *text_at(r) != '"')
        if (!string_byte(r, &used))
            return false;
    step(r);
    if (!array_reserve((void **)&r->string, &r->string_capacity, used + 1, 1, "string", r->err))
        return false;
    r->string[used] = 0;
    r->token.kind = TOKEN_STRING;
    if (!utf8_valid(r->string))
        return msd_error(r, r->token.place, "found a string that is not UTF-8");
    return true;
}

bool msd_file_name(MsdReader *r, char *buffer, size_t size)
{
    assert(buffer != NULL && size > 0);
    r->cursor.offset = r->token.end; /* the token behind has not been read yet */
    if (!blank_skip(r))
        return false;
    if (*text_at(r) == '"')
        return msd_next(r) && msd_string(r, "a file name", buffer, size);
    const char *p = text_at(r);
    size_t      n = 0;
    while (is_name(p[n]) || p[n] == '.' || p[n] == '/' || p[n] == '-')
        n++;
    if (n == 0)
        return msd_next(r) && msd_expected(r, "a file name");
    if (n >= size)
        return msd_error(r, r->cursor, "found a file name that is too long");
    memcpy(buffer, p, n);
    buffer[n] = 0;
    r->cursor.offset += n;
    return msd_next(r);
}

/* --- tokens ---------------------------------------------------------------------------------- */

static bool sign_read(MsdReader *r)
{
    const char c = *text_at(r);

    if (c != 0 && strchr("()<>,;=+-*/", c) != NULL) {
        r->token.kind = TOKEN_SIGN;
        r->token.sign = c;
        step(r);
        return true;
    }
    if (c > ' ' && c < 0x7f)
        return msd_error(r, r->cursor, "found '%c', which is no part of the language", c);
    return msd_error(r, r->cursor, "found the byte 0x%02X, which is no part of the language",
                     (unsigned)(unsigned char)c);
}

static bool token_read(MsdReader *r)
{
    const char c = *text_at(r);

    if (at_end(r)) {
        r->token.kind = TOKEN_END;
        return true;
    }
    if (is_digit(c) || c == '.')
        return number_read(r);
    if (is_letter(c))
        return name_read(r);
    return c == '"' ? string_read(r) : sign_read(r);
}

bool msd_next(MsdReader *r)
{
    assert(r != NULL && r->source_count > 0);
    if (error_is_set(r->err))
        return false;
    const size_t before = r->cursor.offset;
    if (!blank_skip(r))
        return false;
    r->token = (MsdToken){ .place = r->cursor };
    if (!token_read(r))
        return false;
    r->token.end = r->cursor.offset;
    r->text_used += r->cursor.offset - before;
    if (r->text_used > r->text_max)
        return msd_error(r, r->token.place, "REF and INCLUDE repeat more than %.3g bytes of text",
                         (double)r->text_max);
    return true;
}

bool msd_jump(MsdReader *r, MsdPlace place)
{
    r->cursor = place;
    return msd_next(r);
}

bool msd_take(MsdReader *r, char sign)
{
    const char what[] = { '\'', sign, '\'', 0 };
    return msd_is(r, sign) ? msd_next(r) : msd_expected(r, what);
}

bool msd_take_word(MsdReader *r, MsdWord word, const char *what)
{
    return msd_is_word(r, word) ? msd_next(r) : msd_expected(r, what);
}
