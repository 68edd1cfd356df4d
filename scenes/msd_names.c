/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of the MSD reader: each spelling once, and what it stands for in which scope.
 *
 * Bindings lie on a stack, those of one symbol chained from the innermost outwards. A scope that a
 * REF has left for the text it refers to is hidden: its bindings are stepped over. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/file.h"
#include "scenes/msd.h"

static size_t symbol_slot(const MsdReader *r, const char *text, size_t length)
{
    const size_t mask = r->symbol_slots - 1;
    size_t       slot = (size_t)file_hash(text, length, 0) & mask;

    for (; r->symbol_slot[slot] != 0; slot = (slot + 1) & mask) {
        const char *other = r->symbols[r->symbol_slot[slot] - 1].text;
        if (strncmp(other, text, length) == 0 && other[length] == 0)
            break;
    }
    return slot;
}

/* Room for one more symbol at a load of at most a half. */
static bool slots_grow(MsdReader *r)
{
    if (2 * (r->symbol_count + 1) <= r->symbol_slots)
        return true;
    const size_t slots = r->symbol_slots > 0 ? 2 * r->symbol_slots : 64;
    uint32_t    *table = array_create(slots, sizeof *table, "names", r->err);
    if (table == NULL)
        return false;
    array_free(r->symbol_slot);
    r->symbol_slot = table;
    r->symbol_slots = slots;
    for (size_t i = 0; i < r->symbol_count; i++) {
        const char *text = r->symbols[i].text;
        table[symbol_slot(r, text, strlen(text))] = (uint32_t)i + 1;
    }
    return true;
}

bool msd_symbol(MsdReader *r, const char *text, size_t length, uint32_t *symbol)
{
    assert(text != NULL && symbol != NULL && memchr(text, 0, length) == NULL);
    if (!slots_grow(r))
        return false;
    const size_t slot = symbol_slot(r, text, length);
    if (r->symbol_slot[slot] != 0) {
        *symbol = r->symbol_slot[slot] - 1;
        return true;
    }
    if (!array_reserve((void **)&r->symbols, &r->symbol_capacity, r->symbol_count + 1,
                       sizeof *r->symbols, "names", r->err))
        return false;
    char *copy = array_create(length + 1, 1, "names", r->err);
    if (copy == NULL)
        return false;
    memcpy(copy, text, length);
    r->symbols[r->symbol_count] = (MsdSymbol){ .text = copy, .word = msd_word(text, length),
                                               .binding = MSD_NONE, .group = MSD_NONE };
    *symbol = (uint32_t)r->symbol_count++;
    r->symbol_slot[slot] = *symbol + 1;
    return true;
}

bool msd_surface_symbol(MsdReader *r, uint32_t number, uint32_t *symbol)
{
    char text[16];
    const int length = snprintf(text, sizeof text, "#%u", number);
    return msd_symbol(r, text, (size_t)length, symbol);
}

MsdBinding *msd_lookup(MsdReader *r, uint32_t symbol)
{
    assert(symbol < r->symbol_count);
    uint32_t i = r->symbols[symbol].binding;

    while (i != MSD_NONE && r->scopes[r->bindings[i].scope].hidden > 0)
        i = r->bindings[i].hidden;
    return i != MSD_NONE ? &r->bindings[i] : NULL;
}

bool msd_define(MsdReader *r, const MsdBinding *binding)
{
    assert(r->scope_count > 0 && binding->symbol < r->symbol_count);
    MsdSymbol     *symbol = &r->symbols[binding->symbol];
    const uint32_t scope = (uint32_t)r->scope_count - 1;
    uint32_t       at = symbol->binding, hidden = at;

    if (at != MSD_NONE && r->bindings[at].scope == scope) {
        hidden = r->bindings[at].hidden; /* defined here already: the last one holds */
    } else {
        if (!array_reserve((void **)&r->bindings, &r->binding_capacity, r->binding_count + 1,
                           sizeof *r->bindings, "names", r->err))
            return false;
        at = (uint32_t)r->binding_count++;
        symbol->binding = at;
    }
    r->bindings[at] = *binding;
    r->bindings[at].scope = scope;
    r->bindings[at].hidden = hidden;
    return true;
}

bool msd_scope_begin(MsdReader *r)
{
    if (!array_reserve((void **)&r->scopes, &r->scope_capacity, r->scope_count + 1,
                       sizeof *r->scopes, "scopes", r->err))
        return false;
    r->scopes[r->scope_count++] = (MsdScope){ .bindings = r->binding_count };
    return true;
}

void msd_scope_end(MsdReader *r)
{
    assert(r->scope_count > 0);
    const MsdScope *scope = &r->scopes[--r->scope_count];

    while (r->binding_count > scope->bindings) {
        const MsdBinding *b = &r->bindings[--r->binding_count];
        r->symbols[b->symbol].binding = b->hidden;
    }
}

const char *msd_kind_name(NameKind kind)
{
    static const char *const names[] = { "a FLOAT", "a VECTOR", "a MATRIX",
                                         "an OBJECT", "a CAMERA", "a SURFACE" };
    assert((size_t)kind < sizeof names / sizeof names[0]);
    return names[kind];
}

/* The current token is no name of that kind. */
static bool wrong_name(MsdReader *r, NameKind kind, const MsdBinding *b)
{
    char what[48];

    snprintf(what, sizeof what, "the name of %s", msd_kind_name(kind));
    if (r->token.kind != TOKEN_NAME)
        return msd_expected(r, what);
    const char *text = r->symbols[r->token.symbol].text;
    if (b == NULL)
        return msd_error(r, r->token.place, "found '%.40s', which is not declared, expected %s",
                         text, what);
    return msd_error(r, r->token.place, "found '%.40s', which is %s, expected %s", text,
                     msd_kind_name(b->kind), what);
}

bool msd_named(MsdReader *r, NameKind kind, uint32_t *index)
{
    const MsdBinding *b = r->token.kind == TOKEN_NAME ? msd_lookup(r, r->token.symbol) : NULL;

    if (b == NULL || b->kind != kind)
        return wrong_name(r, kind, b);
    *index = (uint32_t)(b - r->bindings);
    return msd_next(r);
}
