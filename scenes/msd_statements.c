/* SPDX-License-Identifier: BSD-3-Clause */
/* Statements of MSD: files and blocks, declarations, OBJECT and REF. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "scenes/msd.h"

/* What a file, a block or a reference changes for its inside only. */
typedef struct {
    uint32_t group, override;
    double   colour_range;
} Setting;

static bool inside_begin(MsdReader *r, Setting *outside)
{
    *outside = (Setting){ r->group, r->override, r->colour_range };
    return msd_deeper(r) && msd_scope_begin(r);
}

static void inside_end(MsdReader *r, const Setting *outside)
{
    msd_scope_end(r);
    r->depth--;
    r->group = outside->group;
    r->override = outside->override;
    r->colour_range = outside->colour_range;
}

/* --- GROUP "name" ---------------------------------------------------------------------------- */

/* Our own word, so not reserved: a matrix of that name begins an object as any other. */

static bool is_group(MsdReader *r)
{
    if (r->token.kind != TOKEN_NAME || msd_starts_matrix(r))
        return false;
    const char *text = r->symbols[r->token.symbol].text;
    return strcmp(text, "GROUP") == 0 || strcmp(text, "group") == 0;
}

static bool group_read(MsdReader *r)
{
    if (!msd_next(r))
        return false;
    if (r->token.kind != TOKEN_STRING || r->string[0] == 0)
        return msd_expected(r, "the group's name in quotes");
    for (const char *p = r->string; *p != 0; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            return msd_error(r, r->token.place,
                             "found a control character in a group's name, expected none");
    return msd_symbol(r, r->string, strlen(r->string), &r->group) && msd_next(r);
}

/* --- declarations ---------------------------------------------------------------------------- */

/* A new name: *symbol, and reads over it. */
static bool new_name(MsdReader *r, uint32_t *symbol)
{
    if (r->token.kind == TOKEN_WORD)
        return msd_expected(r, "a name that is no word of the language");
    if (r->token.kind != TOKEN_NAME)
        return msd_expected(r, "a name");
    *symbol = r->token.symbol;
    return msd_next(r);
}

/* The text of an object is checked where it is declared, and read again at every REF. */
static bool object_value(MsdReader *r, MsdObject *object)
{
    *object = (MsdObject){ .place = r->token.place, .range = r->colour_range };
    r->dry++;
    const bool good = msd_object(r);
    r->dry--;
    return good;
}

static bool declared_value(MsdReader *r, MsdBinding *b)
{
    switch (b->kind) {
    case NAME_FLOAT: return msd_number(r, &b->as.number);
    case NAME_VECTOR: return msd_vector(r, &b->as.vector);
    case NAME_MATRIX: return msd_matrix(r, &b->as.matrix);
    case NAME_OBJECT: return object_value(r, &b->as.object);
    default: assert(b->kind == NAME_CAMERA); return msd_camera(r, b->symbol, &b->as.camera);
    }
}

static NameKind declared_kind(MsdWord word)
{
    return word == WORD_FLOAT ? NAME_FLOAT : word == WORD_VECTOR ? NAME_VECTOR
         : word == WORD_MATRIX ? NAME_MATRIX : word == WORD_OBJECT ? NAME_OBJECT : NAME_CAMERA;
}

bool msd_declaration(MsdReader *r)
{
    const NameKind kind = declared_kind(r->token.word);

    do {
        MsdBinding b = { .kind = kind };
        if (!msd_next(r) || !new_name(r, &b.symbol) || !msd_take(r, '=') ||
            !declared_value(r, &b) || !msd_define(r, &b))
            return false;
    } while (msd_is(r, ','));
    /* The grammar has no sign behind these two, and an INCLUDE as the object brings its own. */
    if ((kind == NAME_OBJECT || kind == NAME_CAMERA) && !msd_is(r, ';'))
        return true;
    return msd_is(r, ';') ? msd_next(r) : msd_expected(r, "',' or ';'");
}

bool msd_definition(MsdReader *r)
{
    MsdBinding b = { .kind = NAME_OBJECT };

    if (!msd_next(r) || !new_name(r, &b.symbol))
        return false;
    b.as.object = (MsdObject){ .place = r->token.place, .range = r->colour_range, .body = true };
    r->dry++;
    const bool good = msd_block(r, WORD_ENDDEF);
    r->dry--;
    return good && msd_define(r, &b);
}

/* --- REF ------------------------------------------------------------------------------------- */

/* Reads the text of binding `index` as if it stood here, with the names of where it stands. */
static bool object_replay(MsdReader *r, uint32_t index)
{
    MsdObject     *object = &r->bindings[index].as.object;
    const uint32_t scope = r->bindings[index].scope, symbol = r->bindings[index].symbol;
    const size_t   here = r->scope_count;
    Setting        outside;

    if (!inside_begin(r, &outside))
        return false;
    for (size_t i = scope + 1; i < here; i++)
        r->scopes[i].hidden++;
    object->busy = true;
    r->colour_range = object->range;
    if (r->group == MSD_NONE)
        r->group = symbol;
    if (!msd_jump(r, object->place) ||
        !(r->bindings[index].as.object.body ? msd_block(r, WORD_ENDDEF) : msd_object(r)))
        return false;
    r->bindings[index].as.object.busy = false; /* the array may have moved */
    for (size_t i = scope + 1; i < here; i++)
        r->scopes[i].hidden--;
    inside_end(r, &outside);
    return true;
}

bool msd_reference(MsdReader *r)
{
    uint32_t index = 0;

    if (!msd_next(r))
        return false;
    const MsdPlace place = r->token.place;
    if (!msd_named(r, NAME_OBJECT, &index))
        return false;
    if (r->dry > 0)
        return true;
    if (r->bindings[index].as.object.busy)
        return msd_error(r, place, "OBJECT %.40s contains itself",
                         r->symbols[r->bindings[index].symbol].text);
    const MsdPlace behind = r->token.place;
    return object_replay(r, index) && msd_jump(r, behind);
}

/* --- objects, blocks, files ------------------------------------------------------------------ */

static bool object_body(MsdReader *r)
{
    if (msd_is_word(r, WORD_BEGIN))
        return msd_next(r) && msd_block(r, WORD_END);
    if (msd_is_word(r, WORD_REF))
        return msd_reference(r);
    if (msd_is_word(r, WORD_INCLUDE))
        return msd_include(r);
    return msd_thing(r);
}

bool msd_object(MsdReader *r)
{
    const Affine outside = r->map;
    const MsdPlace place = r->token.place;
    Affine       inner = affine_identity(), inverse;

    if (msd_starts_matrix(r)) {
        if (!msd_matrix(r, &inner))
            return false;
        r->map = affine_then(&inner, &outside);
        if (!affine_invert(&r->map, &inverse))
            return msd_error(r, place, "this matrix within those around it flattens or overflows "
                                       "space");
    }
    const bool good = object_body(r);
    r->map = outside;
    return good;
}

static bool is_declaration(const MsdReader *r)
{
    return msd_is_word(r, WORD_FLOAT) || msd_is_word(r, WORD_VECTOR) ||
           msd_is_word(r, WORD_MATRIX) || msd_is_word(r, WORD_OBJECT) ||
           msd_is_word(r, WORD_CAMERA);
}

static bool statement(MsdReader *r, MsdWhere where)
{
    if (msd_is(r, ';')) /* an empty one */
        return msd_next(r);
    if (is_declaration(r))
        return msd_declaration(r);
    if (msd_is_word(r, WORD_DEF))
        return msd_definition(r);
    if (msd_is_word(r, WORD_SURFACE))
        return msd_surface(r);
    if (is_group(r))
        return group_read(r);
    if (where != IN_BLOCK && msd_is_global(r))
        return msd_global(r, where == IN_INCLUDE);
    return msd_object(r);
}

bool msd_block(MsdReader *r, MsdWord end)
{
    Setting outside;

    if (!inside_begin(r, &outside))
        return false;
    while (!msd_is_word(r, end)) {
        if (r->token.kind == TOKEN_END)
            return msd_expected(r, end == WORD_END ? "END or an object" : "ENDDEF or an object");
        if (!statement(r, IN_BLOCK))
            return false;
    }
    inside_end(r, &outside);
    return msd_next(r);
}

bool msd_file(MsdReader *r, uint32_t source, MsdWhere where)
{
    assert(source < r->source_count && where != IN_BLOCK);
    static const char mark[] = "\xef\xbb\xbf"; /* some editors begin UTF-8 with it */
    const size_t      start = strncmp(r->sources[source].text, mark, 3) == 0 ? 3 : 0;
    Setting           outside;

    if (!inside_begin(r, &outside) ||
        !msd_jump(r, (MsdPlace){ .source = source, .line = 1, .offset = start,
                                 .line_start = start }))
        return false;
    r->sources[source].active = true;
    while (r->token.kind != TOKEN_END && !msd_is_word(r, WORD_ENDFILE))
        if (!statement(r, where))
            return false;
    if (msd_is_word(r, WORD_ENDFILE) &&
        (!msd_next(r) ||
         (r->token.kind != TOKEN_END && !msd_expected(r, "nothing behind ENDFILE"))))
        return false;
    r->sources[source].active = false;
    inside_end(r, &outside);
    return true;
}
