/* SPDX-License-Identifier: BSD-3-Clause */
/* Subtrees are taken out and put where they cost less [bittner13]. In rounds: for each of the
 * largest, all threads look for the best place in the tree as it stands [meister18]; then one by
 * one, those that save most first, they are moved, unless a move before changed what they touch.
 * So the tree does not depend on the number of threads. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "raycast/pairs.h"

/* More rounds, or more pairs in each, gained rays nothing that could be measured. */
#define ROUNDS 2
/* Of all pairs, the share of largest ones that are tried in a round. */
#define TRIED_SHARE 0.1
#define TRY_CHUNK 64u
#define NOWHERE UINT32_MAX
/* Subtrees that wait in a search; where there are more, the rest is not looked at. */
#define SEARCH_STACK 256u

typedef struct {
    float    gain;
    uint32_t pair, to;
} Move;

typedef struct {
    Pair     *pair;
    uint32_t *parent; /* [count]; NOWHERE: the root, or unused */
    uint8_t  *touched;
    Move     *move;   /* [move_count] */
    uint32_t  count, move_count;
} Reinsert;

static inline uint32_t sibling_of(const Reinsert *r, uint32_t i)
{
    const Pair *p = &r->pair[r->parent[i]];
    return p->left == i ? p->right : p->left;
}

/* --- where to -------------------------------------------------------------------------------- */

typedef struct {
    float    saved[SEARCH_STACK]; /* before the pair is joined with what is at the place */
    uint32_t at[SEARCH_STACK], height;
} Search;

/* Looks at a subtree that the pair is not in. */
static void search_below(const Reinsert *r, Search *s, Box box, float area, Move *best)
{
    while (s->height > 0) {
        const uint32_t at = s->at[--s->height];
        const float saved = s->saved[s->height];
        if (saved - area <= best->gain)
            continue;
        const Pair *p = &r->pair[at];
        const Box here = pair_box(p);
        const float gain = saved - box_area(box_join(here, box));
        if (gain > best->gain) {
            best->gain = gain;
            best->to = at;
        }
        const float below = gain + box_area(here);
        if (pair_is_one(p) || below - area <= best->gain || s->height + 2 > SEARCH_STACK)
            continue;
        s->saved[s->height] = s->saved[s->height + 1] = below;
        s->at[s->height++] = p->left;
        s->at[s->height++] = p->right;
    }
}

/* From the pair's parent up, at each step into the other subtree. */
static void search(const Reinsert *r, Move *move)
{
    const uint32_t pair = move->pair, parent = r->parent[pair];
    const Box box = pair_box(&r->pair[pair]);
    const float area = box_area(box);
    float saved = box_area(pair_box(&r->pair[parent]));
    Box without = pair_box(&r->pair[sibling_of(r, pair)]); /* what is left of the pair's parent */
    Search s;
    move->gain = 0;
    move->to = NOWHERE;
    for (uint32_t pivot = parent; r->parent[pivot] != NOWHERE; pivot = r->parent[pivot]) {
        const uint32_t other = sibling_of(r, pivot);
        if (pivot != parent)
            saved += box_area(pair_box(&r->pair[pivot])) - box_area(without);
        s.height = 1;
        s.at[0] = other;
        s.saved[0] = saved;
        search_below(r, &s, box, area, move);
        without = box_join(without, pair_box(&r->pair[other]));
    }
}

static void search_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Reinsert *r = context;
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        search(r, &r->move[i]);
}

/* --- moving ---------------------------------------------------------------------------------- */

/* New boxes from here up, as far as they change. */
static void boxes_up(Reinsert *r, uint32_t i)
{
    for (; i != NOWHERE; i = r->parent[i]) {
        Pair *p = &r->pair[i];
        const Box box = box_join(pair_box(&r->pair[p->left]), pair_box(&r->pair[p->right]));
        const Box was = pair_box(p);
        bool same = true;
        for (int k = 0; k < 3; k++)
            same &= box.lo[k] == was.lo[k] && box.hi[k] == was.hi[k];
        if (same)
            return;
        pair_set_box(p, box);
    }
}

static void child_replace(Reinsert *r, uint32_t parent, uint32_t old, uint32_t new)
{
    Pair *p = &r->pair[parent];
    if (p->left == old)
        p->left = new;
    else
        p->right = new;
    r->parent[new] = parent;
}

static bool move_allowed(const Reinsert *r, const Move *m)
{
    const uint32_t parent = r->parent[m->pair];
    if (r->touched[m->pair] || r->touched[m->to] || r->touched[parent]
        || r->touched[r->parent[m->to]] || r->touched[sibling_of(r, m->pair)]
        || r->touched[r->parent[parent]])
        return false;
    /* A move before may have brought the place below the pair itself, or its parent. */
    for (uint32_t i = m->to; i != NOWHERE; i = r->parent[i])
        if (i == m->pair || i == parent)
            return i == parent && r->parent[m->to] != parent && m->to != parent;
    return true;
}

static void move_carry_out(Reinsert *r, const Move *m)
{
    const uint32_t parent = r->parent[m->pair], sibling = sibling_of(r, m->pair);
    const uint32_t above = r->parent[parent], beside = r->parent[m->to];
    const uint32_t touched[] = { m->pair, m->to, parent, sibling, above, beside };
    for (int i = 0; i < 6; i++)
        r->touched[touched[i]] = 1;
    child_replace(r, above, parent, sibling);
    child_replace(r, beside, m->to, parent);
    Pair *p = &r->pair[parent];
    p->left = m->pair;
    p->right = m->to;
    r->parent[m->to] = parent;
    pair_set_box(p, box_join(pair_box(&r->pair[m->pair]), pair_box(&r->pair[m->to])));
    boxes_up(r, above);
    boxes_up(r, beside);
}

static int by_gain(const void *a, const void *b)
{
    const Move *x = a, *y = b;
    if (x->gain != y->gain)
        return x->gain < y->gain ? 1 : -1;
    return (x->pair > y->pair) - (x->pair < y->pair);
}

/* --- rounds ---------------------------------------------------------------------------------- */

/* The upper half of a surface's bits: floats that are not negative stand in their order. */
static uint32_t size_of(const Reinsert *r, uint32_t i)
{
    const float area = box_area(pair_box(&r->pair[i]));
    uint32_t bits;
    memcpy(&bits, &area, sizeof bits);
    return bits >> 16;
}

static bool may_move(const Reinsert *r, uint32_t i)
{
    return r->parent[i] != NOWHERE && r->parent[r->parent[i]] != NOWHERE;
}

/* The largest ones that may move, about so many: those from a size on. */
static bool moves_choose(Reinsert *r, uint32_t wanted, Error *err)
{
    uint32_t *of_size = array_create(65536, sizeof *of_size, "sizes of pairs", err);
    uint32_t sum = 0, least = 65536;
    if (of_size == NULL)
        return false;
    for (uint32_t i = 0; i < r->count; i++)
        if (may_move(r, i))
            of_size[size_of(r, i)]++;
    while (least > 0 && sum + of_size[least - 1] <= wanted)
        sum += of_size[--least];
    array_free(of_size);
    r->move_count = 0;
    for (uint32_t i = 0; i < r->count; i++)
        if (may_move(r, i) && size_of(r, i) >= least)
            r->move[r->move_count++].pair = i;
    return true;
}

static bool round_run(Reinsert *r, uint32_t wanted, unsigned threads, Error *err)
{
    if (!moves_choose(r, wanted, err))
        return false;
    parallel_for(r->move_count, TRY_CHUNK, threads, search_chunk, r, NULL, NULL);
    uint32_t good = 0;
    for (uint32_t i = 0; i < r->move_count; i++)
        if (r->move[i].to != NOWHERE)
            r->move[good++] = r->move[i];
    qsort(r->move, good, sizeof *r->move, by_gain);
    memset(r->touched, 0, r->count);
    for (uint32_t i = 0; i < good; i++)
        if (move_allowed(r, &r->move[i]))
            move_carry_out(r, &r->move[i]);
    return true;
}

static void parents_fill(Reinsert *r)
{
    memset(r->parent, 0xff, r->count * sizeof *r->parent);
    for (uint32_t i = 0; i < r->count; i++) {
        const Pair *p = &r->pair[i];
        /* Unused ones are all 0. */
        if (!pair_is_one(p) && p->left != p->right)
            r->parent[p->left] = r->parent[p->right] = i;
    }
}

bool pairs_reinsert(Pairs *pairs, unsigned threads, Error *err)
{
    assert(pairs != NULL && pairs->pair != NULL && err != NULL);
    const uint32_t wanted = (uint32_t)(TRIED_SHARE * pairs->refs) * 2;
    Reinsert r = { .pair = pairs->pair, .count = pairs->count };
    r.parent = array_create(r.count, sizeof *r.parent, "pairs of a tree", err);
    r.touched = array_create(r.count, sizeof *r.touched, "pairs of a tree", err);
    r.move = array_create(wanted, sizeof *r.move, "moves in a tree", err);
    bool good = !error_is_set(err);
    if (good)
        parents_fill(&r);
    for (int i = 0; good && i < ROUNDS && wanted > 0; i++)
        good = round_run(&r, wanted, threads, err);
    array_free(r.parent);
    array_free(r.touched);
    array_free(r.move);
    return good;
}
