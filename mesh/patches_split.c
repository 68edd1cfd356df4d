/* SPDX-License-Identifier: BSD-3-Clause */
/* Patches divided further: cells in four with their neighbours in balance, merged ones by place. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "mesh/patches_internal.h"

typedef struct {
    PatchBuilder   b;
    const Patches *old;
    const uint8_t *split;
    PatchForest    forest;
    uint8_t       *sides;          /* [surfaces]  in use */
    uint32_t      *parent;         /* of the new patches, in their order */
    size_t         parent_count, parent_capacity;
    size_t         first_capacity, piece_capacity; /* of the builder's merged patches */
    uint32_t      *part;           /* scratch for merge_split */
    size_t         part_capacity;
} Splitter;

/* --- from the old patches --------------------------------------------------------------------- */

/* Parted cells stand in the tree as the first of their parts, until they are parted again. */
static void join_parts(Splitter *s)
{
    const Patches *old = s->old;
    for (uint32_t k = 0; old->parted_count > 0 && k < old->tree_count; k++) {
        uint32_t *node = &s->b.out->tree[k];
        if ((*node & PATCH_DIVIDED) != 0 || (*node & PATCH_PARTED) == 0)
            continue;
        const uint32_t patch = old->part[old->parted[*node & ~PATCH_PARTED].first_part].patch;
        *node = patch - old->first[old->side[patch]][old->surface[patch]];
    }
}

static bool copy_old(Splitter *s)
{
    PatchBuilder *b = &s->b;
    const Patches *old = s->old;
    const uint32_t n = old->surface_count;
    if (!patches_allocate_surfaces(b))
        return false;
    s->sides = array_create(n, 1, "patches", b->err);
    if (s->sides == NULL
        || !array_reserve((void **)&b->out->tree, &s->forest.tree_capacity,
                          (size_t)old->tree_count + 1, sizeof *old->tree, "patch trees", b->err))
        return false;
    b->sides = s->sides;
    b->out->size = old->size;
    b->out->tree_count = old->tree_count;
    memcpy(b->out->tree, old->tree, old->tree_count * sizeof *old->tree);
    join_parts(s);
    memcpy(b->out->nu, old->nu, n * sizeof *old->nu);
    memcpy(b->out->nv, old->nv, n * sizeof *old->nv);
    for (unsigned side = 0; side < 2; side++) {
        memcpy(b->out->tree_first[side], old->tree_first[side], n * sizeof **old->tree_first);
        for (uint32_t i = 0; i < n; i++)
            s->sides[i] |= (uint8_t)((old->first[side][i] != PATCH_NONE) << side);
    }
    return true;
}

static bool divide_cells(Splitter *s)
{
    s->forest.b = &s->b;
    s->forest.old = s->old;
    for (uint32_t i = 0; i < s->old->count; i++)
        if (s->split[i] && !patches_is_merged(s->old, i)
            && !patches_forest_divide(&s->forest, s->old->surface[i], s->old->side[i],
                                      s->old->cell[i]))
            return false;
    return true;
}

/* --- order ------------------------------------------------------------------------------------ */

static bool add_parent(Splitter *s, uint32_t parent)
{
    if (!array_reserve((void **)&s->parent, &s->parent_capacity, s->parent_count + 1,
                       sizeof *s->parent, "patches", s->b.err))
        return false;
    s->parent[s->parent_count++] = parent;
    return true;
}

static void add_block(PatchBuilder *b, uint32_t surface, unsigned side, uint32_t merged)
{
    b->block[b->block_count] = 2 * surface + side;
    b->block_merged[b->block_count++] = merged;
}

/* Leaves still have the number of the old cell they are (part of): they get their own. */
static bool number_leaves(Splitter *s, uint32_t slot, uint32_t old_first, uint32_t *next)
{
    uint32_t *tree = s->b.out->tree;
    if (tree[slot] & PATCH_DIVIDED) {
        const uint32_t quarter = tree[slot] & ~PATCH_DIVIDED;
        for (uint32_t q = 0; q < 4; q++)
            if (!number_leaves(s, quarter + q, old_first, next))
                return false;
        return true;
    }
    if (!add_parent(s, old_first + tree[slot]))
        return false;
    tree[slot] = (*next)++;
    return true;
}

static bool add_side(Splitter *s, uint32_t surface, unsigned side)
{
    const Patches *out = s->b.out;
    const uint32_t old_first = s->old->first[side][surface];
    const uint32_t base = patches_base_count(out, s->b.surfaces, surface);
    const uint32_t first = out->tree_first[side][surface];
    uint32_t next = 0;
    add_block(&s->b, surface, side, PATCH_NONE);
    for (uint32_t k = 0; k < base; k++)
        if (!(first == PATCH_NONE ? add_parent(s, old_first + k)
                                  : number_leaves(s, first + k, old_first, &next)))
            return false;
    return true;
}

/* Part `number` of a merged patch's pieces; part == NULL: all of them. */
static bool add_merged(Splitter *s, uint32_t patch, const uint32_t *part, uint32_t number)
{
    PatchBuilder *b = &s->b;
    const Patches *old = s->old;
    const uint32_t start = b->merged_first[b->merged_count];
    const uint32_t from = old->first_piece[patch], end = old->first_piece[patch + 1];
    uint32_t at = start;
    if (!array_reserve((void **)&b->merged_piece, &s->piece_capacity, (size_t)start + end - from,
                       sizeof *b->merged_piece, "patches", b->err)
        || !array_reserve((void **)&b->merged_first, &s->first_capacity,
                          (size_t)b->merged_count + 2, sizeof *b->merged_first, "patches", b->err))
        return false;
    for (uint32_t k = from; k < end; k++)
        if (part == NULL || part[k - from] == number)
            b->merged_piece[at++] = old->piece[k];
    assert(at > start);
    /* A piece alone is a cell. */
    if (at == start + 1) {
        add_block(b, b->merged_piece[start], old->side[patch], PATCH_NONE);
    } else {
        add_block(b, b->merged_piece[start], old->side[patch], b->merged_count++);
        b->merged_first[b->merged_count] = at;
    }
    return add_parent(s, patch);
}

static bool add_parts(Splitter *s, uint32_t patch)
{
    const Patches *old = s->old;
    const uint32_t first = old->first_piece[patch], count = old->first_piece[patch + 1] - first;
    uint32_t parts = 0;
    if (!array_reserve((void **)&s->part, &s->part_capacity, count, sizeof *s->part, "patches",
                       s->b.err)
        || !merge_split(s->b.surfaces, old->side[patch], old->piece + first, count, s->part,
                        &parts, s->b.err))
        return false;
    for (uint32_t number = 0; number < parts; number++)
        if (!add_merged(s, patch, s->part, number))
            return false;
    return true;
}

static bool order_blocks(Splitter *s)
{
    const Patches *old = s->old;
    if (!array_reserve((void **)&s->b.merged_first, &s->first_capacity, 1,
                       sizeof *s->b.merged_first, "patches", s->b.err))
        return false;
    s->b.merged_first[0] = 0;
    for (uint32_t i = 0; i < old->count; i++) {
        const uint32_t surface = old->surface[i], side = old->side[i];
        bool ok = true;
        if (patches_is_merged(old, i))
            ok = s->split[i] ? add_parts(s, i) : add_merged(s, i, NULL, 0);
        else if (i == old->first[side][surface])
            ok = add_side(s, surface, side);
        if (!ok)
            return false;
    }
    return true;
}

Patches *patches_split(const Patches *patches, const Surfaces *surfaces, const uint8_t *split,
                       uint32_t **parent, Error *err)
{
    assert(patches != NULL && surfaces != NULL && split != NULL && parent != NULL && err != NULL);
    assert(patches->surface_count == surfaces->count);
    *parent = NULL;
    if (error_is_set(err))
        return NULL;
    Splitter s = { .old = patches, .split = split };
    s.b = (PatchBuilder){ .surfaces = surfaces, .err = err };
    s.b.out = array_create(1, sizeof *s.b.out, "patches", err);
    if (s.b.out == NULL)
        return NULL;
    bool ok = copy_old(&s) && patches_find_edges(&s.b) && divide_cells(&s)
                 && order_blocks(&s) && patches_build(&s.b);
    assert(!ok || s.parent_count == s.b.out->count);
    ok = ok && patches_part(&s.b, patches, &s.parent);
    patches_builder_clear(&s.b);
    array_free(s.forest.wish);
    array_free(s.sides);
    array_free(s.part);
    if (ok) {
        *parent = s.parent;
        return s.b.out;
    }
    array_free(s.parent);
    return patches_destroy(s.b.out);
}
