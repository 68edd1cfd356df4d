/* SPDX-License-Identifier: BSD-3-Clause */
/* What is put right, or found out, before or after assimp reads COLLADA, 3DS, STL and OFF. */
#include "scenes/import_quirks.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/array.h"

/* Directions come as floats, with errors of 6e-8; what is left of one across a direction that far
 * from parallel tells an angle to 1e-4 radian or better. */
static const double across_least = 1e-3;

/* --- COLLADA ---------------------------------------------------------------------------------- */

static char *text_find(char *from, const char *end, const char *what)
{
    return from < end ? memmem(from, (size_t)(end - from), what, strlen(what)) : NULL;
}

/* Gives an element another name of the same length. */
static void element_rename(char *begin, const char *end, const char *name, const char *to)
{
    const size_t length = strlen(name);
    assert(strlen(to) == length);

    for (char *at = begin; (at = text_find(at, end, name)) != NULL; at += length)
        if (at > begin && (at[-1] == '<' || at[-1] == '/'))
            memcpy(at, to, length);
}

void collada_mend(char *text, size_t size)
{
    assert(text != NULL);
    const char *end = text + size;

    for (char *at = text; (at = text_find(at, end, "<perspective")) != NULL;) {
        char *close = text_find(at, end, "</perspective");
        if (close == NULL)
            return;
        if (text_find(at, close, "<yfov") != NULL &&
            text_find(at, close, "<aspect_ratio") == NULL) {
            element_rename(at, close, "xfov", "none");
            element_rename(at, close, "yfov", "xfov");
        }
        at = close;
    }
}

bool collada_has_cones(const char *text, size_t size)
{
    static const char *const names[] = { "<outer_cone", "<penumbra_angle", "<falloff>",
                                         "<falloff " };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (memmem(text, size, names[i], strlen(names[i])) != NULL)
            return true;
    return false;
}

/* --- 3DS: chunks of a 2-byte kind and a 4-byte length ----------------------------------------- */

enum { CHUNK_HEAD = 6, CHUNK_MAIN = 0x4D4D, CHUNK_EDIT = 0x3D3D, CHUNK_OBJECT = 0x4000,
       CHUNK_MESH = 0x4100 };

typedef struct {
    unsigned       kind;
    const uint8_t *begin, *end; /* what is inside */
} Chunk;

/* Takes a chunk off the front; false at the end and when the rest is none. */
static bool chunk_next(const uint8_t **at, const uint8_t *end, Chunk *chunk)
{
    const uint8_t *p = *at;

    if (end - p < CHUNK_HEAD)
        return false;
    const size_t length = (size_t)p[2] | (size_t)p[3] << 8 | (size_t)p[4] << 16
                        | (size_t)p[5] << 24;
    if (length < CHUNK_HEAD || length > (size_t)(end - p))
        return false;
    *chunk = (Chunk){ (unsigned)p[0] | (unsigned)p[1] << 8, p + CHUNK_HEAD, p + length };
    *at = p + length;
    return true;
}

static bool chunk_find(const uint8_t *at, const uint8_t *end, unsigned kind, Chunk *chunk)
{
    while (chunk_next(&at, end, chunk))
        if (chunk->kind == kind)
            return true;
    return false;
}

bool discreet_names(const uint8_t *bytes, size_t size, const char ***name, size_t *count,
                    Error *err)
{
    assert(bytes != NULL && name != NULL && count != NULL && err != NULL);
    size_t capacity = 0;
    Chunk whole, edit, object, mesh;

    *name = NULL;
    *count = 0;
    if (!chunk_find(bytes, bytes + size, CHUNK_MAIN, &whole) ||
        !chunk_find(whole.begin, whole.end, CHUNK_EDIT, &edit))
        return true;
    while (chunk_next(&edit.begin, edit.end, &object)) {
        const uint8_t *zero = memchr(object.begin, 0, (size_t)(object.end - object.begin));
        if (object.kind != CHUNK_OBJECT || zero == NULL)
            continue;
        for (const uint8_t *at = zero + 1; chunk_next(&at, object.end, &mesh);) {
            if (mesh.kind != CHUNK_MESH)
                continue;
            if (!array_reserve((void **)name, &capacity, *count + 1, sizeof **name, "names", err))
                return false;
            (*name)[(*count)++] = (const char *)object.begin;
        }
    }
    return true;
}

/* The part of v across the unit vector d. */
static Vec3 vec3_across(Vec3 v, Vec3 d)
{
    return vec3_sub(v, vec3_scale(d, vec3_dot(v, d)));
}

Vec3 discreet_up(Vec3 look, Vec3 up)
{
    const Vec3 y = vec3_across(vec3(0, 1, 0), look), z = vec3_across(vec3(0, 0, 1), look);
    const Vec3 turned = vec3_across(up, look);

    if (!(vec3_length(z) > across_least)) /* straight up or down: y is as good as it gets */
        return up;
    if (!(vec3_length(y) > across_least) || !(vec3_length(turned) > across_least))
        return vec3(0, 0, 1);
    const double roll = atan2(vec3_dot(look, vec3_cross(y, turned)), vec3_dot(y, turned));
    return vec3_add(vec3_scale(z, cos(roll)), vec3_scale(vec3_cross(look, z), sin(roll)));
}

/* --- STL and OFF ------------------------------------------------------------------------------ */

static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

bool stl_is_cut(const char *text, size_t size)
{
    assert(text != NULL);
    static const char last[] = "endsolid";

    if (size < 5 || strncasecmp(text, "solid", 5) != 0 || memchr(text, 0, size) != NULL)
        return false; /* not text */
    while (size > 0 && is_space(text[size - 1]))
        size--;
    size_t begin = size;
    while (begin > 0 && text[begin - 1] != '\n' && text[begin - 1] != '\r')
        begin--;
    while (begin < size && is_space(text[begin]))
        begin++;
    return size - begin < strlen(last) || strncasecmp(text + begin, last, strlen(last)) != 0;
}

/* White space and comments. */
static const char *off_skip(const char *c)
{
    for (; is_space(*c) || *c == '#'; c++)
        if (*c == '#')
            c += strcspn(c, "\r\n") - 1;
    return c;
}

uint64_t off_faces(const char *text)
{
    assert(text != NULL);
    char *end;
    const char *c = off_skip(text);

    while (*c != 0 && !is_space(*c) && (*c < '0' || *c > '9'))
        c++; /* OFF, COFF, ... */
    c = off_skip(c);
    (void)strtoull(c, &end, 10);
    if (end == c)
        return 0;
    c = off_skip(end);
    return *c >= '0' && *c <= '9' ? strtoull(c, &end, 10) : 0;
}

void spot_cones(Light *light, bool added, bool single, double inner, double outer)
{
    if (added)
        outer -= inner;
    else if (single)
        outer = inner;
    light->kind = LIGHT_SPOT;
    light->cos_outer = cos(fmin(fabs(outer) / 2, M_PI / 2));
    light->cos_inner = fmax(cos(fmin(fabs(inner) / 2, M_PI / 2)), light->cos_outer);
}
