/* SPDX-License-Identifier: BSD-3-Clause */
/* PLY's header, and its values in text and in both orders of bytes. */
#include "scenes/ply_header.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"

static bool is_blank(uint8_t c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
static bool is_end(uint8_t c) { return c == '\n' || c == '\r'; }

/* --- words and lines -------------------------------------------------------------------------- */

/* The next word of the line, cut to `size`; false at the line's end. */
static bool word_next(PlyReader *r, char *word, size_t size)
{
    size_t length = 0;

    while (r->at < r->end && is_blank(*r->at))
        r->at++;
    for (; r->at < r->end && !is_blank(*r->at) && !is_end(*r->at); r->at++)
        if (length + 1 < size)
            word[length++] = (char)*r->at;
    word[length] = 0;
    return length > 0;
}

static void line_skip(PlyReader *r)
{
    while (r->at < r->end && !is_end(*r->at))
        r->at++;
    if (r->end - r->at >= 2 && r->at[0] == '\r' && r->at[1] == '\n' && !r->bare_cr)
        r->at++;
    if (r->at < r->end)
        r->at++;
    r->line++;
}

/* --- the header ------------------------------------------------------------------------------- */

static bool header_wrong(const PlyReader *r, const char *what)
{
    return error_at(r->err, ERROR_INPUT, r->path, r->line, "%s", what);
}

static PlyType type_of(const char *name)
{
    static const struct { const char *name; PlyType type; } types[] = {
        { "char", PLY_I8 },    { "uchar", PLY_U8 },   { "short", PLY_I16 },   { "ushort", PLY_U16 },
        { "int", PLY_I32 },    { "uint", PLY_U32 },   { "float", PLY_F32 },   { "double", PLY_F64 },
        { "int8", PLY_I8 },    { "uint8", PLY_U8 },   { "int16", PLY_I16 },   { "uint16", PLY_U16 },
        { "int32", PLY_I32 },  { "uint32", PLY_U32 }, { "float32", PLY_F32 },
        { "float64", PLY_F64 } };

    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcasecmp(name, types[i].name) == 0)
            return types[i].type;
    return PLY_NO_TYPE;
}

static bool element_read(PlyReader *r)
{
    char digits[32], *end;
    PlyElement element = { .first = r->property_count, .end = r->property_count };

    if (!array_reserve((void **)&r->element, &r->element_capacity, r->element_count + 1,
                       sizeof *r->element, "elements", r->err))
        return false;
    if (!word_next(r, element.name, sizeof element.name) || !word_next(r, digits, sizeof digits))
        return header_wrong(r, "an element needs a name and a number");
    element.count = strtoull(digits, &end, 10);
    if (*end != 0 || digits[0] < '0' || digits[0] > '9' || element.count >= UINT32_MAX)
        return error_at(r->err, ERROR_INPUT, r->path, r->line,
                        "\"%s\" is not a possible number of elements \"%s\"", digits,
                        element.name);
    r->element[r->element_count++] = element;
    return true;
}

static bool property_read(PlyReader *r)
{
    char type[32];
    PlyProperty property = { .count_type = PLY_NO_TYPE };

    if (r->element_count == 0)
        return header_wrong(r, "a property stands before the first element");
    if (!array_reserve((void **)&r->property, &r->property_capacity, r->property_count + 1,
                       sizeof *r->property, "properties", r->err))
        return false;
    (void)word_next(r, type, sizeof type);
    if (strcmp(type, "list") == 0) {
        (void)word_next(r, type, sizeof type);
        property.count_type = type_of(type);
        if (property.count_type == PLY_NO_TYPE || property.count_type >= PLY_F32)
            return error_at(r->err, ERROR_INPUT, r->path, r->line,
                            "\"%s\" cannot count the members of a list", type);
        (void)word_next(r, type, sizeof type);
    }
    property.type = type_of(type);
    if (property.type == PLY_NO_TYPE)
        return error_at(r->err, ERROR_INPUT, r->path, r->line, "\"%s\" is no type of a property",
                        type);
    (void)word_next(r, property.name, sizeof property.name);
    r->property[r->property_count++] = property;
    r->element[r->element_count - 1].end = r->property_count;
    return true;
}

static bool format_read(PlyReader *r)
{
    char word[32];

    (void)word_next(r, word, sizeof word);
    r->encoding = strcmp(word, "ascii") == 0                ? PLY_ASCII
                : strcmp(word, "binary_little_endian") == 0 ? PLY_LITTLE
                : strcmp(word, "binary_big_endian") == 0    ? PLY_BIG
                                                            : PLY_UNKNOWN;
    if (r->encoding == PLY_UNKNOWN)
        return error_at(r->err, ERROR_INPUT, r->path, r->line, "\"%s\" is no format of PLY", word);
    return true;
}

/* CR alone ends lines when the first one ends so: a body may begin with a byte that is LF. */
static bool magic_read(PlyReader *r)
{
    char word[32];

    if (!word_next(r, word, sizeof word) || strcasecmp(word, "ply") != 0)
        return error_at(r->err, ERROR_INPUT, r->path, 0,
                        "its content is not what its name says: it does not begin with \"ply\"");
    while (r->at < r->end && !is_end(*r->at))
        r->at++;
    r->bare_cr = r->end - r->at >= 2 && r->at[0] == '\r' && r->at[1] != '\n';
    return true;
}

static bool header_read(PlyReader *r)
{
    char word[32];

    if (!magic_read(r))
        return false;
    for (;;) {
        line_skip(r);
        if (r->at >= r->end)
            return error_at(r->err, ERROR_INPUT, r->path, 0, "the file ends within its header");
        (void)word_next(r, word, sizeof word);
        if (strcmp(word, "end_header") == 0)
            break;
        if ((strcmp(word, "format") == 0 && !format_read(r)) ||
            (strcmp(word, "element") == 0 && !element_read(r)) ||
            (strcmp(word, "property") == 0 && !property_read(r)))
            return false;
    }
    if (r->encoding == PLY_UNKNOWN)
        return header_wrong(r, "the header names no format");
    /* Nothing in the file would end a walk over them. */
    for (size_t i = 0; i < r->element_count; i++)
        if (r->element[i].count > 0 && r->element[i].first == r->element[i].end)
            return error_at(r->err, ERROR_INPUT, r->path, 0, "element \"%s\" has no properties",
                            r->element[i].name);
    line_skip(r);
    r->body = r->at;
    return true;
}

bool ply_open(PlyReader *r, const char *path, const uint8_t *bytes, size_t size, Error *err)
{
    assert(r != NULL && path != NULL && bytes != NULL && err != NULL);
    assert(bytes[size] == 0);
    *r = (PlyReader){ .path = path, .at = bytes, .end = bytes + size, .line = 1, .err = err };
    r->numbers = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (r->numbers == (locale_t)0)
        return error_set(err, ERROR_MEMORY, "no locale to read numbers with");
    return header_read(r);
}

void ply_close(PlyReader *r)
{
    assert(r != NULL);
    if (r->numbers != (locale_t)0)
        freelocale(r->numbers);
    array_free(r->element);
    array_free(r->property);
    *r = (PlyReader){ 0 };
}

void ply_rewind(PlyReader *r)
{
    assert(r != NULL && r->body != NULL);
    r->at = r->body;
}

/* --- values ----------------------------------------------------------------------------------- */

static unsigned type_size(PlyType type)
{
    static const unsigned char size[] = { 0, 1, 1, 2, 2, 4, 4, 4, 8 };
    return size[type];
}

/* Numbers may go on in the next line. */
static bool ascii_value(PlyReader *r, double *value)
{
    char *end;

    while (r->at < r->end && (is_blank(*r->at) || is_end(*r->at)))
        r->at++;
    if (r->at >= r->end)
        return false;
    *value = strtod_l((const char *)r->at, &end, r->numbers);
    const uint8_t *after = (const uint8_t *)end;
    if (after == r->at || after > r->end ||
        (after < r->end && !is_blank(*after) && !is_end(*after)))
        return false;
    r->at = after;
    return true;
}

static double bits_value(uint64_t bits, PlyType type)
{
    float narrow;
    double wide;
    const uint32_t low = (uint32_t)bits;

    switch (type) {
    case PLY_I8: return (double)(int8_t)bits;
    case PLY_I16: return (double)(int16_t)bits;
    case PLY_I32: return (double)(int32_t)bits;
    case PLY_F32: memcpy(&narrow, &low, sizeof narrow); return (double)narrow;
    case PLY_F64: memcpy(&wide, &bits, sizeof wide); return wide;
    default: return (double)bits;
    }
}

bool ply_value(PlyReader *r, PlyType type, double *value)
{
    assert(r != NULL && type != PLY_NO_TYPE && value != NULL);
    const unsigned size = type_size(type);
    const uint8_t *p = r->at;
    uint64_t bits = 0;

    if (r->encoding == PLY_ASCII)
        return ascii_value(r, value);
    if (size > (size_t)(r->end - p))
        return false;
    for (unsigned i = 0; i < size; i++)
        bits = bits << 8 | p[r->encoding == PLY_BIG ? i : size - 1 - i];
    r->at += size;
    *value = bits_value(bits, type);
    return true;
}

bool ply_count(PlyReader *r, PlyType type, uint64_t *count)
{
    double value;

    if (!ply_value(r, type, &value) || !(value >= 0 && value <= UINT32_MAX) ||
        value != floor(value))
        return false;
    *count = (uint64_t)value;
    return true;
}

bool ply_skip(PlyReader *r, const PlyProperty *property)
{
    assert(r != NULL && property != NULL);
    uint64_t count = 1;
    double ignored;

    if (property->count_type != PLY_NO_TYPE && !ply_count(r, property->count_type, &count))
        return false;
    if (r->encoding == PLY_ASCII) {
        for (; count > 0; count--)
            if (!ascii_value(r, &ignored))
                return false;
        return true;
    }
    const uint64_t size = count * type_size(property->type); /* < 2^32 * 8 */
    if (size > (uint64_t)(r->end - r->at))
        return false;
    r->at += size;
    return true;
}

void ply_element_end(PlyReader *r)
{
    if (r->encoding == PLY_ASCII)
        line_skip(r);
}

bool ply_broken(PlyReader *r, const PlyElement *element, uint64_t number)
{
    assert(r != NULL && element != NULL);
    return error_at(r->err, ERROR_INPUT, r->path, 0,
                    "the file ends, or holds what is no number, within element \"%s\" %llu of %llu",
                    element->name, (unsigned long long)number + 1,
                    (unsigned long long)element->count);
}
