/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons to triangles: each polygon once, nothing without area. */
#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "mesh/edges.h"
#include "mesh/internal.h"
#include "mesh/triangulate.h"

/* Sets of vertices seen so far, in a hash table with open addressing. */
typedef struct {
    uint32_t *key;      /* sorted vertices of all members */
    uint32_t *start;    /* [count + 1]  first key of a member */
    uint32_t *owner;    /* [count]  what the caller knows a member by */
    uint32_t *slot;     /* [mask + 1]  member + 1, or 0 */
    uint32_t  count, mask;
} VertexSets;

static bool sets_create(VertexSets *sets, uint32_t members, size_t keys, Error *err)
{
    uint32_t slots = 16;
    while (slots / 2 < members && slots < UINT32_C(1) << 31)
        slots *= 2;
    *sets = (VertexSets){ .mask = slots - 1 };
    sets->key = array_create(keys, sizeof *sets->key, "face table", err);
    sets->start = array_create((size_t)members + 1, sizeof *sets->start, "face table", err);
    sets->owner = array_create(members, sizeof *sets->owner, "face table", err);
    sets->slot = array_create(slots, sizeof *sets->slot, "face table", err);
    return !error_is_set(err);
}

static void sets_clear(VertexSets *sets)
{
    array_free(sets->key);
    array_free(sets->start);
    array_free(sets->owner);
    array_free(sets->slot);
    *sets = (VertexSets){ 0 };
}

/* Adds n vertices in any order; when the same set is there, nothing is added and its owner comes
 * back instead of PIECE_NONE. `sorted` is room for n. */
static uint32_t sets_add(VertexSets *sets, const uint32_t *vertex, uint32_t n, uint32_t owner,
                         uint64_t *sorted)
{
    for (uint32_t i = 0; i < n; i++)
        sorted[i] = vertex[i];
    edges_sort_keys(sorted, n);
    uint32_t *key = sets->key + sets->start[sets->count];
    uint64_t hash = n;
    for (uint32_t i = 0; i < n; i++) {
        key[i] = (uint32_t)sorted[i];
        hash = (hash ^ key[i]) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
    }
    uint32_t slot = (uint32_t)(hash >> 32) & sets->mask;
    for (; sets->slot[slot] != 0; slot = (slot + 1) & sets->mask) {
        const uint32_t m = sets->slot[slot] - 1;
        if (sets->start[m + 1] - sets->start[m] == n
            && memcmp(sets->key + sets->start[m], key, n * sizeof *key) == 0)
            return sets->owner[m];
    }
    sets->owner[sets->count] = owner;
    sets->slot[slot] = ++sets->count;
    sets->start[sets->count] = sets->start[sets->count - 1] + n;
    return PIECE_NONE;
}

/* Whether an outline runs round the same corners as another the other way. */
static bool is_reverse(const uint32_t *a, const uint32_t *b, uint32_t n)
{
    uint32_t at = 0;
    while (at < n && b[at] != a[0])
        at++;
    for (uint32_t k = 0; k < n; k++)
        if (at == n || b[(at + n - k) % n] != a[k])
            return false;
    return true;
}

typedef struct {
    const Polygons *soup;
    const Weld     *weld;
    Triangulation   cut;
    VertexSets      sets;
    uint32_t       *corner;  /* welded corners of one polygon */
    uint32_t       *earlier; /* and of another */
    uint64_t       *sorted;  /* room for sorting as many */
    uint32_t       *back;    /* [polygons]  polygon that is its other side, or PIECE_NONE */
} Cutter;

static bool pieces_reserve(Pieces *pieces, size_t count, Error *err)
{
    return array_reserve((void **)&pieces->corner, &pieces->corner_capacity, 3 * count,
                         sizeof *pieces->corner, "triangles", err)
        && array_reserve((void **)&pieces->face, &pieces->face_capacity, count,
                         sizeof *pieces->face, "triangles", err)
        && array_reserve((void **)&pieces->back, &pieces->back_capacity, count,
                         sizeof *pieces->back, "triangles", err)
        && array_reserve((void **)&pieces->diagonal, &pieces->diagonal_capacity, count,
                         sizeof *pieces->diagonal, "triangles", err)
        && array_reserve((void **)&pieces->other, &pieces->other_capacity, count,
                         sizeof *pieces->other, "triangles", err);
}

static bool pieces_append(Pieces *pieces, const Triangulation *cut, uint32_t face, Error *err)
{
    if (!pieces_reserve(pieces, (size_t)pieces->count + cut->count, err))
        return false;
    for (uint32_t k = 0; k < cut->count; k++) {
        const uint32_t i = pieces->count++;
        memcpy(pieces->corner + 3 * (size_t)i, cut->triangle + 3 * (size_t)k,
               3 * sizeof *pieces->corner);
        pieces->face[i] = face;
        pieces->back[i] = PIECE_NONE;
        /* (a,b,c) meets (a,c,d) at its last edge, (a,c,d) at its first */
        pieces->diagonal[i] = cut->quad ? 3 * i + (k == 0 ? 2 : 0) : PIECE_NONE;
        pieces->other[i] = !cut->quad ? PIECE_NONE : k == 0 ? i + 1 : i - 1;
    }
    return true;
}

/* Welded corners of a polygon; false when one is not a finite point. */
static bool face_corners(const Cutter *cutter, uint32_t face, uint32_t *corner, uint32_t *count)
{
    const Polygons *soup = cutter->soup;
    *count = soup->first[face + 1] - soup->first[face];
    bool finite = true;
    for (uint32_t i = 0; i < *count; i++) {
        corner[i] = cutter->weld->vertex[soup->corner[soup->first[face] + i]];
        finite = finite && corner[i] != WELD_NONE;
    }
    return finite;
}

/* A polygon with the corners of an earlier one: its other side, or one too many. */
static void lay_face(Cutter *cutter, uint32_t face, uint32_t earlier, Notes *notes)
{
    uint32_t count;
    face_corners(cutter, earlier, cutter->earlier, &count);
    if (cutter->back[earlier] == PIECE_NONE
        && is_reverse(cutter->corner, cutter->earlier, count))
        cutter->back[earlier] = face;
    else
        note_face(&notes->duplicate, face);
}

static bool cut_face(Cutter *cutter, uint32_t face, Pieces *pieces, Notes *notes, Error *err)
{
    uint32_t count;
    if (!face_corners(cutter, face, cutter->corner, &count)) {
        note_face(&notes->degenerate, face);
        return true;
    }
    /* Triangles are compared when all is cut, with those that polygons were cut into. */
    const uint32_t earlier = count <= 3 ? PIECE_NONE
                                        : sets_add(&cutter->sets, cutter->corner, count, face,
                                                   cutter->sorted);
    if (earlier != PIECE_NONE) {
        lay_face(cutter, face, earlier, notes);
        return true;
    }
    if (!triangulate(&cutter->cut, cutter->weld->position, cutter->corner, count, err))
        return false;
    for (uint32_t k = 0; k < cutter->cut.dropped; k++)
        note_face(&notes->degenerate, face);
    if (cutter->cut.crossing)
        note_face(&notes->crossing, face);
    return pieces_append(pieces, &cutter->cut, face, err);
}

static void piece_move(Pieces *pieces, uint32_t from, uint32_t to)
{
    memmove(pieces->corner + 3 * (size_t)to, pieces->corner + 3 * (size_t)from,
            3 * sizeof *pieces->corner);
    pieces->face[to] = pieces->face[from];
    pieces->back[to] = pieces->back[from];
    const uint32_t other = pieces->other[from], edge = pieces->diagonal[from] % 3;
    pieces->other[to] = other;
    pieces->diagonal[to] = other == PIECE_NONE ? PIECE_NONE : 3 * to + edge;
    if (other != PIECE_NONE)
        pieces->other[other] = to;
}

static void split_quad(Pieces *pieces, uint32_t i)
{
    const uint32_t other = pieces->other[i];
    if (other == PIECE_NONE)
        return;
    pieces->diagonal[other] = pieces->diagonal[i] = PIECE_NONE;
    pieces->other[other] = pieces->other[i] = PIECE_NONE;
}

/* Leaves out triangles that are there already, or makes them the other side of those; the other
 * half of a quad stays as a triangle. */
static bool drop_duplicates(Pieces *pieces, Notes *notes, Error *err)
{
    VertexSets sets;
    const bool ok = sets_create(&sets, pieces->count, 3 * (size_t)pieces->count, err);
    uint32_t kept = 0;
    for (uint32_t i = 0; ok && i < pieces->count; i++) {
        uint64_t sorted[3];
        const uint32_t *corner = pieces->corner + 3 * (size_t)i;
        const uint32_t earlier = sets_add(&sets, corner, 3, kept, sorted);
        if (earlier == PIECE_NONE) {
            piece_move(pieces, i, kept++);
            continue;
        }
        split_quad(pieces, i);
        if (pieces->back[earlier] == PIECE_NONE
            && is_reverse(corner, pieces->corner + 3 * (size_t)earlier, 3))
            pieces->back[earlier] = pieces->face[i];
        else
            note_face(&notes->duplicate, pieces->face[i]);
    }
    if (ok)
        pieces->count = kept;
    sets_clear(&sets);
    return ok;
}

static void cutter_clear(Cutter *cutter)
{
    triangulation_clear(&cutter->cut);
    sets_clear(&cutter->sets);
    array_free(cutter->corner);
    array_free(cutter->earlier);
    array_free(cutter->sorted);
    array_free(cutter->back);
}

static bool cutter_create(Cutter *cutter, uint32_t most, Error *err)
{
    const Polygons *soup = cutter->soup;
    const uint32_t faces = (uint32_t)soup->polygon_count;
    cutter->corner = array_create(most, sizeof *cutter->corner, "polygon corners", err);
    cutter->earlier = array_create(most, sizeof *cutter->earlier, "polygon corners", err);
    cutter->sorted = array_create(most, sizeof *cutter->sorted, "polygon corners", err);
    cutter->back = array_create(faces, sizeof *cutter->back, "polygon backs", err);
    if (!sets_create(&cutter->sets, faces, faces > 0 ? soup->first[faces] : 0, err))
        return false;
    for (uint32_t i = 0; i < faces; i++)
        cutter->back[i] = PIECE_NONE;
    return true;
}

bool pieces_create(Pieces *pieces, const Polygons *soup, const Weld *weld, Notes *notes,
                   Error *err)
{
    assert(pieces != NULL && soup != NULL && weld != NULL && notes != NULL && err != NULL);
    assert(soup->polygon_count < UINT32_MAX / 3);
    *pieces = (Pieces){ 0 };
    const uint32_t faces = (uint32_t)soup->polygon_count;
    uint32_t most = 3;
    for (uint32_t i = 0; i < faces; i++)
        if (soup->first[i + 1] - soup->first[i] > most)
            most = soup->first[i + 1] - soup->first[i];
    Cutter cutter = { .soup = soup, .weld = weld };
    bool ok = cutter_create(&cutter, most, err);
    for (uint32_t i = 0; ok && i < faces; i++)
        ok = cut_face(&cutter, i, pieces, notes, err);
    for (uint32_t i = 0; ok && i < pieces->count; i++)
        pieces->back[i] = cutter.back[pieces->face[i]];
    cutter_clear(&cutter);
    ok = ok && drop_duplicates(pieces, notes, err);
    /* A triangle may be the other side of one half of a quad only. */
    for (uint32_t i = 0; ok && i < pieces->count; i++)
        if (pieces->other[i] != PIECE_NONE && !pieces_alike(pieces, soup, i, pieces->other[i]))
            split_quad(pieces, i);
    if (!ok)
        pieces_clear(pieces);
    return ok;
}

void pieces_clear(Pieces *pieces)
{
    array_free(pieces->corner);
    array_free(pieces->face);
    array_free(pieces->back);
    array_free(pieces->diagonal);
    array_free(pieces->other);
    *pieces = (Pieces){ 0 };
}
