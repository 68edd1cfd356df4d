/* SPDX-License-Identifier: BSD-3-Clause */
/* Values of options: numbers, sizes, times and words, always read to their last letter. */
#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "app/options.h"

/* A number at the start of text, and where it ends. strtod alone would also take "nan", "inf",
 * hexadecimal and leading blanks. */
static bool number_prefix(const char *text, double *value, const char **end)
{
    const char *p = text + (*text == '-' || *text == '+');
    if (!isdigit((unsigned char)*p) && !(*p == '.' && isdigit((unsigned char)p[1])))
        return false;
    if (p[0] == '0' && (p[1] == 'x' || p[1] == 'X'))
        return false;
    char *stop = NULL;
    errno = 0;
    const double v = strtod(text, &stop);
    if (!isfinite(v))
        return false;
    *value = v;
    *end = stop;
    return true;
}

bool value_number(const char *text, double *value)
{
    assert(text != NULL && value != NULL);
    const char *end = NULL;
    double v = 0;
    if (!number_prefix(text, &v, &end) || *end != '\0')
        return false;
    *value = v;
    return true;
}

bool value_share(const char *text, double *value)
{
    assert(text != NULL && value != NULL);
    const char *end = NULL;
    double v = 0;
    if (!number_prefix(text, &v, &end))
        return false;
    const bool percent = *end == '%';
    if (end[percent ? 1 : 0] != '\0')
        return false;
    *value = percent ? v / 100 : v;
    return true;
}

bool value_count(const char *text, uint32_t *value)
{
    assert(text != NULL && value != NULL);
    uint64_t v = 0;
    if (*text == '\0')
        return false;
    for (const char *p = text; *p != '\0'; p++) {
        if (!isdigit((unsigned char)*p))
            return false;
        v = v * 10 + (uint64_t)(*p - '0');
        if (v > UINT32_MAX)
            return false;
    }
    *value = (uint32_t)v;
    return true;
}

bool value_counts(const char *text, uint32_t value[2])
{
    assert(text != NULL && value != NULL);
    const size_t length = strcspn(text, ":");
    char first[16];
    uint32_t v[2] = { 0, value[1] };
    if (length >= sizeof first)
        return false;
    memcpy(first, text, length);
    first[length] = '\0';
    if (!value_count(first, &v[0]) || v[0] == 0 ||
        (text[length] == ':' && (!value_count(text + length + 1, &v[1]) || v[1] == 0)))
        return false;
    memcpy(value, v, sizeof v);
    return true;
}

/* 512MB, 2G, 1.5 GiB, 100000: powers of 1024, as memory is counted. */
bool value_bytes(const char *text, uint64_t *value)
{
    assert(text != NULL && value != NULL);
    static const struct {
        const char *unit;
        double      factor;
    } units[] = { { "", 1 }, { "B", 1 }, { "K", 0x1p10 }, { "KB", 0x1p10 }, { "KiB", 0x1p10 },
                  { "M", 0x1p20 }, { "MB", 0x1p20 }, { "MiB", 0x1p20 }, { "G", 0x1p30 },
                  { "GB", 0x1p30 }, { "GiB", 0x1p30 }, { "T", 0x1p40 }, { "TB", 0x1p40 },
                  { "TiB", 0x1p40 } };
    const char *end = NULL;
    double v = 0;
    if (!number_prefix(text, &v, &end) || v < 0)
        return false;
    end += *end == ' ';
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(end, units[i].unit) == 0) {
            if (v * units[i].factor >= 0x1p63)
                return false;
            *value = (uint64_t)(v * units[i].factor);
            return true;
        }
    return false;
}

bool value_seconds(const char *text, double *value)
{
    assert(text != NULL && value != NULL);
    static const struct {
        const char *unit;
        double      factor;
    } units[] = { { "", 1 }, { "s", 1 }, { "sec", 1 }, { "min", 60 }, { "m", 60 }, { "h", 3600 },
                  { "ms", 0.001 } };
    const char *end = NULL;
    double v = 0;
    if (!number_prefix(text, &v, &end) || v < 0)
        return false;
    end += *end == ' ';
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(end, units[i].unit) == 0) {
            *value = v * units[i].factor;
            return true;
        }
    return false;
}

bool value_pixels(const char *text, int value[2])
{
    assert(text != NULL && value != NULL);
    enum { LARGEST = 65536 };
    const char *cross = strpbrk(text, "xX");
    char width[16];
    uint32_t w = 0, h = 0;
    if (cross == NULL || (size_t)(cross - text) >= sizeof width)
        return false;
    memcpy(width, text, (size_t)(cross - text));
    width[cross - text] = '\0';
    if (!value_count(width, &w) || !value_count(cross + 1, &h) || w < 1 || h < 1 || w > LARGEST ||
        h > LARGEST)
        return false;
    value[0] = (int)w;
    value[1] = (int)h;
    return true;
}

bool value_numbers(const char *text, double *value, int count)
{
    enum { MOST = 4 };
    double v[MOST];
    assert(text != NULL && value != NULL && count >= 1 && count <= MOST);
    for (int k = 0; k < count; k++) {
        const char *end = NULL;
        if (!number_prefix(text, &v[k], &end) || *end != (k < count - 1 ? ',' : '\0'))
            return false;
        text = end + 1;
    }
    memcpy(value, v, (size_t)count * sizeof *value);
    return true;
}

bool value_vector(const char *text, Vec3 *value)
{
    double v[3];
    assert(value != NULL);
    if (!value_numbers(text, v, 3))
        return false;
    *value = vec3(v[0], v[1], v[2]);
    return true;
}

int value_choice(const char *text, const char *words)
{
    assert(text != NULL && words != NULL);
    const size_t length = strlen(text);
    int position = 0;
    for (const char *p = words; p != NULL; position++) {
        const char *comma = strchr(p, ',');
        const size_t size = comma != NULL ? (size_t)(comma - p) : strlen(p);
        if (size == length && memcmp(p, text, size) == 0)
            return position;
        p = comma != NULL ? comma + 1 : NULL;
    }
    return -1;
}

bool value_set(const char *text, const char *words, uint32_t *value)
{
    char word[32];
    uint32_t all = 1, set = *text == '-' ? UINT32_MAX : 0;
    for (const char *p = words; (p = strchr(p, ',')) != NULL; p++)
        all = all << 1 | 1;
    for (const char *p = text; p != NULL; p = strchr(p, ',')) {
        p += p != text;
        const bool out = *p == '-';
        const size_t length = strcspn(p + out, ",");
        if (length >= sizeof word)
            return false;
        memcpy(word, p + out, length);
        word[length] = '\0';
        const int position = value_choice(word, words);
        const bool every = strcmp(word, "all") == 0, none = strcmp(word, "none") == 0;
        if (position < 0 && !every && !none)
            return false;
        const uint32_t bits = every ? all : none ? 0 : 1u << position;
        set = none ? (out ? all : 0) : out ? set & ~bits : set | bits;
    }
    *value = set & all;
    return true;
}

void value_word(const char *words, int position, char *out, size_t size)
{
    assert(words != NULL && position >= 0 && size > 0);
    for (; position > 0 && strchr(words, ',') != NULL; position--)
        words = strchr(words, ',') + 1;
    size_t n = strcspn(words, ",");
    if (n >= size)
        n = size - 1;
    memcpy(out, words, n);
    out[n] = '\0';
}

unsigned word_distance(const char *a, const char *b, unsigned limit)
{
    enum { LONGEST = 32 };
    const size_t n = strlen(a), m = strlen(b);
    unsigned row[LONGEST + 1];
    if (n > LONGEST || m > LONGEST)
        return limit;
    for (size_t j = 0; j <= m; j++)
        row[j] = (unsigned)j;
    for (size_t i = 1; i <= n; i++) {
        unsigned diagonal = row[0];
        row[0] = (unsigned)i;
        for (size_t j = 1; j <= m; j++) {
            const unsigned change = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            const unsigned step = 1 + (row[j] < row[j - 1] ? row[j] : row[j - 1]);
            row[j] = change < step ? change : step;
        }
    }
    return row[m] < limit ? row[m] : limit;
}
