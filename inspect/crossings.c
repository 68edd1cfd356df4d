/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces that pass through each other, and faces that lie on each other in one plane.
 *
 * Each triangle looks in the tree for those at least as large as itself: a floor is found by each
 * blade of grass on it, not the other way round, so that what one triangle may look at can be
 * limited without losing anything but in heaps of triangles that all meet each other.
 */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/parallel.h"
#include "inspect/internal.h"

enum {
    CHUNK = 512,
    LOOK_MOST = 512,  /* neighbours that a triangle is compared with */
    FOUND_MOST = 16   /* pairs found for a triangle, then the next one's turn */
};

typedef struct {
    uint32_t face, other; /* face < other */
    float    depth, at[3];
    uint8_t  kind;        /* DefectKind */
} Meeting;

typedef struct {
    Meeting *item;        /* [count] */
    size_t   count, capacity;
    uint32_t hurried;
    Error    err;
} Meetings;

typedef struct {
    const Inspector *in;
    Meetings        *chunk;
} Search;

static uint8_t sides_of(const Inspector *in, uint32_t surface)
{
    return in->options->sides != NULL ? in->options->sides[surface] : 3;
}

/* Faces on each other are a defect when both are used from the same side: light and eye cannot tell
 * which is in front. Where sight is unknown, fronts that look the same way say so. */
static bool overlap_counts(const Inspector *in, uint32_t a, uint32_t b, bool alike)
{
    const unsigned sa = sides_of(in, a), sb = sides_of(in, b);
    if (!in->sighted)
        return alike;
    return (sa & (alike ? sb : (sb >> 1 | (sb & 1) << 1))) != 0;
}

static bool add_meeting(Meetings *list, const Pair *pair, uint32_t f, uint32_t g)
{
    assert(f != g);
    if (!array_reserve((void **)&list->item, &list->capacity, list->count + 1, sizeof *list->item,
                       "crossing faces", &list->err))
        return false;
    list->item[list->count++] = (Meeting){
        .face = f < g ? f : g, .other = f < g ? g : f, .depth = (float)pair->depth,
        .at = { (float)pair->at.x, (float)pair->at.y, (float)pair->at.z },
        .kind = pair->kind == PAIR_CROSSING ? DEFECT_INTERSECTION : DEFECT_OVERLAP };
    return true;
}

/* Whether entry `other` is compared when it is the turn of `entry`. */
static bool is_turn(const Surfaces *s, const BoxEntry *entry, const BoxEntry *other, float size)
{
    const float    larger = box_size(&other->box);
    const uint32_t k = entry->item, n = other->item;
    return (larger > size || (larger == size && n < k)) &&
           s->triangle_surface[k] != s->triangle_surface[n] &&
           s->triangle_face[k] != s->triangle_face[n];
}

/* Triangle k with one of the larger ones; *found counts what counts. */
static bool search_pair(const Inspector *in, const Triangle *a, uint32_t k, uint32_t other,
                        Meetings *list, uint32_t *found)
{
    const Surfaces *s = in->surfaces;
    Triangle        b = triangle_get(s, other);
    if (triangle_clear(a, &b) || !triangle_plane(&b))
        return true;
    const Pair pair = pair_find(a, &b);
    const bool alike = vec3_dot(a->normal, b.normal) > 0;
    if (pair.kind == PAIR_APART ||
        (pair.kind == PAIR_OVERLAP &&
         !overlap_counts(in, s->triangle_surface[k], s->triangle_surface[other], alike)))
        return true;
    ++*found;
    return add_meeting(list, &pair, s->triangle_face[k], s->triangle_face[other]);
}

/* All pairs of an entry's triangle with larger ones. */
static bool search_triangle(const Inspector *in, const BoxEntry *entry, Meetings *list)
{
    const Surfaces *s = in->surfaces;
    const float     size = box_size(&entry->box);
    uint32_t        near[LOOK_MOST], found = 0;
    Triangle        a = triangle_get(s, entry->item);
    if (!triangle_plane(&a))
        return true;
    const uint32_t count = box_tree_meet(&in->tree, &entry->box, size, near, LOOK_MOST);
    const bool     hurried = count > LOOK_MOST;
    for (uint32_t i = 0; i < count - hurried && found < FOUND_MOST; i++) {
        const BoxEntry *other = &in->tree.entry[near[i]];
        if (is_turn(s, entry, other, size) &&
            !search_pair(in, &a, entry->item, other->item, list, &found))
            return false;
    }
    list->hurried += hurried || found == FOUND_MOST;
    return true;
}

static void search_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Search *search = context;
    Meetings     *list = &search->chunk[begin / CHUNK];
    (void)worker;
    for (uint32_t i = begin; i < end; i++)
        if (!search_triangle(search->in, &search->in->tree.entry[i], list))
            return;
}

/* --- one list of all -------------------------------------------------------------------------- */

static int order_u32(uint32_t a, uint32_t b) { return (a > b) - (a < b); }
static int order_float(float a, float b) { return (a > b) - (a < b); }

/* By kind and faces, of the same two the deepest first. */
static int by_faces(const void *a, const void *b)
{
    const Meeting *p = a, *q = b;
    int            order = order_u32(p->kind, q->kind);
    order = order != 0 ? order : order_u32(p->face, q->face);
    order = order != 0 ? order : order_u32(p->other, q->other);
    order = order != 0 ? order : order_float(q->depth, p->depth);
    for (int k = 0; k < 3; k++)
        order = order != 0 ? order : order_float(p->at[k], q->at[k]);
    return order;
}

static int by_depth(const void *a, const void *b)
{
    const Meeting *p = a, *q = b;
    int            order = order_u32(p->kind, q->kind);
    order = order != 0 ? order : order_float(q->depth, p->depth);
    return order != 0 ? order : by_faces(a, b);
}

/* One list of all chunks', each pair of faces once. */
static bool gather_meetings(const Meetings *chunk, uint32_t chunks, Meetings *all, Error *err)
{
    for (uint32_t i = 0; i < chunks; i++) {
        if (error_is_set(&chunk[i].err))
            return error_set(err, chunk[i].err.code, "%s", chunk[i].err.text);
        if (!array_reserve((void **)&all->item, &all->capacity, all->count + chunk[i].count,
                           sizeof *all->item, "crossing faces", err))
            return false;
        for (size_t k = 0; k < chunk[i].count; k++)
            all->item[all->count++] = chunk[i].item[k];
        all->hurried += chunk[i].hurried;
    }
    if (all->count == 0)
        return true;
    qsort(all->item, all->count, sizeof *all->item, by_faces);
    size_t kept = 1;
    for (size_t i = 1; i < all->count; i++) {
        const Meeting *last = &all->item[kept - 1], *next = &all->item[i];
        if (next->kind != last->kind || next->face != last->face || next->other != last->other)
            all->item[kept++] = *next;
    }
    all->count = kept;
    qsort(all->item, all->count, sizeof *all->item, by_depth);
    return true;
}

static bool tell_meetings(Inspector *in, const Meetings *all)
{
    in->out->hurried = all->hurried;
    for (size_t i = 0; i < all->count; i++) {
        const Meeting *m = &all->item[i];
        const Defect   defect = { .kind = (DefectKind)m->kind, .face = m->face, .other = m->other,
                                  .at = { m->at[0], m->at[1], m->at[2] }, .measure = m->depth };
        if (!defects_add(in->defects, &defect, in->err))
            return false;
    }
    return true;
}

static bool build_tree(Inspector *in)
{
    const uint32_t count = in->surfaces->triangle_count;
    BoxEntry      *entry = array_create(count, sizeof *entry, "box tree", in->err);
    for (uint32_t k = 0; entry != NULL && k < count; k++) {
        const Triangle t = triangle_get(in->surfaces, k);
        entry[k].box = triangle_box(&t);
    }
    return box_tree_create(&in->tree, entry, count, in->err);
}

bool inspect_crossings(Inspector *in)
{
    assert(in->surfaces != NULL);
    if (!build_tree(in))
        return false;
    const uint32_t count = in->surfaces->triangle_count, chunks = (count + CHUNK - 1) / CHUNK;
    Search         search = { .in = in };
    const Progress base = { .stage = "mesh", .done = 1, .energy_left = -1 };
    search.chunk = array_create(chunks, sizeof *search.chunk, "crossing faces", in->err);
    bool ok = search.chunk != NULL;
    if (ok && !parallel_for(count, CHUNK, in->options->threads, search_chunk, &search, in->monitor,
                            &base))
        ok = error_set(in->err, ERROR_STOPPED, "stopped while looking for crossing faces");
    Meetings all = { 0 };
    ok = ok && gather_meetings(search.chunk, chunks, &all, in->err) && tell_meetings(in, &all);
    for (uint32_t i = 0; search.chunk != NULL && i < chunks; i++)
        array_free(search.chunk[i].item);
    array_free(search.chunk);
    array_free(all.item);
    return ok;
}
