/* SPDX-License-Identifier: BSD-3-Clause */
/* JSON written as it comes. */
#include "app/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Length of the UTF-8 sequence at p, 0 when it is not valid: overlong forms, surrogates and values
 * beyond U+10FFFF are not. */
static int utf8_length(const unsigned char *p)
{
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    if (p[0] < 0x80)
        return 1;
    const int n = p[0] >= 0xF0 ? 4 : p[0] >= 0xE0 ? 3 : 2;
    if (p[0] < 0xC2 || p[0] > 0xF4)
        return 0;
    uint32_t code = p[0] & (0xFFu >> (n + 1));
    for (int i = 1; i < n; i++) {
        if ((p[i] & 0xC0) != 0x80)
            return 0;
        code = code << 6 | (p[i] & 0x3F);
    }
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    return code < least[n] || code > 0x10FFFF || surrogate ? 0 : n;
}

static void print_string(FILE *out, const char *text)
{
    fputc('"', out);
    for (const unsigned char *p = (const unsigned char *)text; *p != '\0';) {
        const int n = utf8_length(p);
        if (n == 0) {
            fputs("\xEF\xBF\xBD", out);
            p++;
            continue;
        }
        if (*p == '"' || *p == '\\')
            fprintf(out, "\\%c", *p);
        else if (*p < 0x20)
            fprintf(out, "\\u%04x", *p);
        else
            fwrite(p, 1, (size_t)n, out);
        p += n;
    }
    fputc('"', out);
}

/* Comma, line and indent before the next value, and its key. */
static void begin_value(Json *json, const char *key)
{
    if (json->begun)
        fputc(',', json->out);
    if (json->depth > 0 && json->one_line)
        fputs(json->begun ? " " : "", json->out);
    else if (json->depth > 0)
        fprintf(json->out, "\n%*s", 2 * json->depth, "");
    json->begun = true;
    if (key != NULL) {
        print_string(json->out, key);
        fputs(": ", json->out);
    }
}

void json_open(Json *json, const char *key, char bracket)
{
    assert(bracket == '{' || bracket == '[');
    begin_value(json, key);
    fputc(bracket, json->out);
    json->depth++;
    json->begun = false;
}

void json_close(Json *json, char bracket)
{
    assert(json->depth > 0 && (bracket == '}' || bracket == ']'));
    json->depth--;
    if (json->begun && !json->one_line)
        fprintf(json->out, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->out);
    json->begun = true;
    if (json->depth == 0)
        fputc('\n', json->out);
}

void json_text(Json *json, const char *key, const char *value)
{
    begin_value(json, key);
    print_string(json->out, value != NULL ? value : "");
}

static void print_number(FILE *out, double value)
{
    char text[40];
    if (!isfinite(value)) {
        fputs("null", out);
        return;
    }
    /* The shortest of the forms that read back as the same number. */
    for (int digits = 9; digits <= 17; digits++) {
        double back = 0;
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (sscanf(text, "%lf", &back) == 1 && back == value)
            break;
    }
    fputs(text, out);
}

void json_number(Json *json, const char *key, double value)
{
    begin_value(json, key);
    print_number(json->out, value);
}

void json_count(Json *json, const char *key, uint64_t value)
{
    begin_value(json, key);
    fprintf(json->out, "%" PRIu64, value);
}

void json_bool(Json *json, const char *key, bool value)
{
    begin_value(json, key);
    fputs(value ? "true" : "false", json->out);
}

void json_numbers(Json *json, const char *key, const double *values, int count)
{
    assert(count >= 0);
    begin_value(json, key);
    fputc('[', json->out);
    for (int i = 0; i < count; i++) {
        fputs(i > 0 ? ", " : "", json->out);
        print_number(json->out, values[i]);
    }
    fputc(']', json->out);
}
