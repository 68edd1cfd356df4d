/* SPDX-License-Identifier: BSD-3-Clause */
/* Faces that lie exactly on others: duplicates and the two sides of thin plates. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "mesh/internal.h"

/* --- sets of vertices ------------------------------------------------------------------------- */

bool sets_create(VertexSets *sets, uint32_t members, size_t keys, Error *err)
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

void sets_clear(VertexSets *sets)
{
    array_free(sets->key);
    array_free(sets->start);
    array_free(sets->owner);
    array_free(sets->slot);
    *sets = (VertexSets){ 0 };
}

uint32_t sets_add(VertexSets *sets, const uint32_t *vertex, uint32_t n, uint32_t owner,
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

bool outline_is_same(const uint32_t *a, const uint32_t *b, uint32_t n, bool reverse)
{
    uint32_t at = 0;
    while (at < n && b[at] != a[0])
        at++;
    for (uint32_t k = 0; k < n; k++)
        if (at == n || b[(at + (reverse ? n - k : k)) % n] != a[k])
            return false;
    return true;
}

/* --- triangles -------------------------------------------------------------------------------- */

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

void pieces_split_quad(Pieces *pieces, uint32_t i)
{
    const uint32_t other = pieces->other[i];
    if (other == PIECE_NONE)
        return;
    pieces->diagonal[other] = pieces->diagonal[i] = PIECE_NONE;
    pieces->other[other] = pieces->other[i] = PIECE_NONE;
}

/* A triangle may be the other side of one half of a quad only. */
static void split_unlike_quads(Pieces *pieces, const Polygons *soup)
{
    for (uint32_t i = 0; i < pieces->count; i++)
        if (pieces->other[i] != PIECE_NONE && !pieces_alike(pieces, soup, i, pieces->other[i]))
            pieces_split_quad(pieces, i);
}

static bool emits(const Polygons *soup, uint32_t face)
{
    return rgb_max(soup->materials[soup->material[face]].emission) > 0;
}

/* Face `face`, of the triangle `piece`, lies on face `below`. */
static void report_double(const Pieces *pieces, uint32_t piece, uint32_t below, bool back,
                          bool merged, const Vec3 *position, Repair *repair)
{
    const Vec3 at = position[pieces->corner[3 * (size_t)piece]];
    if (back)
        repair_report(repair, &(Defect){ .kind = DEFECT_BACK_TO_BACK, .repaired = merged,
                                         .face = pieces->face[piece], .other = below, .at = at });
    else
        repair_report_double(repair, pieces->face[piece], below, merged, at);
}

/* Polygons were compared whole before they were cut. */
static bool was_compared(const Polygons *soup, uint32_t face, uint32_t other)
{
    const uint32_t n = soup->first[face + 1] - soup->first[face];
    return n > 3 && soup->first[other + 1] - soup->first[other] == n;
}

/* Piece i has the corners of `earlier`. Returns whether it goes; `told` is the face told last. */
static bool merge_triangle(Pieces *pieces, uint32_t i, uint32_t earlier, uint32_t *told,
                           const Vec3 *position, Repair *repair)
{
    const uint32_t *corner = pieces->corner + 3 * (size_t)i;
    const bool keep = repair->options->keep_duplicates;
    const bool reverse = outline_is_same(corner, pieces->corner + 3 * (size_t)earlier, 3, true);
    /* A plate on something cannot become a side of it: it stays a plate of its own. */
    const bool back = reverse && pieces->back[earlier] == PIECE_NONE;
    uint32_t *below = reverse && !back ? &pieces->back[earlier] : &pieces->face[earlier];
    const uint32_t face = pieces->face[i], other = *below;
    if (*told != face && !(keep && was_compared(repair->soup, face, pieces->face[earlier])))
        report_double(pieces, i, other, back, !keep, position, repair);
    *told = face;
    if (keep)
        return false;
    pieces_split_quad(pieces, i);
    repair->repairs.duplicate += !back;
    if (back)
        pieces->back[earlier] = face;
    else if (emits(repair->soup, face) && !emits(repair->soup, other))
        *below = face;
    return true;
}

bool pieces_merge_triangles(Pieces *pieces, const Vec3 *position, Repair *repair)
{
    VertexSets sets;
    Error *err = repair->err;
    const bool ok = sets_create(&sets, pieces->count, 3 * (size_t)pieces->count, err);
    uint32_t kept = 0, told = PIECE_NONE;
    for (uint32_t i = 0; ok && i < pieces->count; i++) {
        uint64_t sorted[3];
        const uint32_t *corner = pieces->corner + 3 * (size_t)i;
        const uint32_t earlier = sets_add(&sets, corner, 3, kept, sorted);
        if (earlier == PIECE_NONE
            || !merge_triangle(pieces, i, earlier, &told, position, repair))
            piece_move(pieces, i, kept++);
    }
    if (ok) {
        pieces->count = kept;
        split_unlike_quads(pieces, repair->soup);
    }
    sets_clear(&sets);
    return !error_is_set(err);
}

/* --- two triangles cut along the other diagonal ----------------------------------------------- */

static Vec3 piece_normal(const Pieces *pieces, const Vec3 *position, uint32_t i)
{
    const uint32_t *c = pieces->corner + 3 * (size_t)i;
    return vec3_cross(vec3_sub(position[c[1]], position[c[0]]),
                      vec3_sub(position[c[2]], position[c[0]]));
}

static uint32_t use_apex(const Pieces *pieces, uint32_t use)
{
    return pieces->corner[use_next(use_next(use))];
}

/* Whether the triangles at both sides of an edge lie in one plane; *folded: on each other, not side
 * by side. */
static bool in_plane(const Pieces *pieces, const Vec3 *position, uint32_t use, uint32_t other,
                     bool *folded)
{
    const Vec3 p = position[pieces->corner[use]], q = position[pieces->corner[use_next(use)]];
    const Vec3 a = position[use_apex(pieces, use)], b = position[use_apex(pieces, other)];
    const Vec3 normal = vec3_cross(vec3_sub(q, p), vec3_sub(a, p));
    const Vec3 most = vec3_max(vec3_max(vec3_max(p, q), vec3_max(a, b)),
                               vec3_scale(vec3_min(vec3_min(p, q), vec3_min(a, b)), -1));
    const double largest = fmax(most.x, fmax(most.y, most.z));
    *folded = vec3_dot(normal, vec3_cross(vec3_sub(q, p), vec3_sub(b, p))) > 0;
    /* The apex and the plane through three corners: two tolerances. */
    return fabs(vec3_dot(normal, vec3_sub(b, p)))
        <= 2 * position_tolerance(largest) * vec3_length(normal);
}

/* The use of the same edge whose triangle's third corner is `apex`; side by side in one plane. */
static uint32_t find_half(const Pieces *pieces, const Edges *edges, const Vec3 *position,
                          uint32_t use, uint32_t apex)
{
    const uint32_t e = edges->edge[use];
    for (uint32_t k = edges->first[e]; k < edges->first[e + 1]; k++) {
        const uint32_t other = edges->use[k];
        bool folded;
        if (other / 3 != use / 3 && use_apex(pieces, other) == apex
            && in_plane(pieces, position, use, other, &folded) && !folded)
            return other / 3;
    }
    return PIECE_NONE;
}

/* The triangles at `use` and `other` lie on each other and have an edge in common: finds the
 * triangles that make the same quad of both, below and above. */
static bool find_swapped(const Pieces *pieces, const Edges *edges, const Vec3 *position,
                         uint32_t use, uint32_t other, uint32_t below[2], uint32_t above[2])
{
    const uint32_t c = use_apex(pieces, use), d = use_apex(pieces, other);
    below[0] = use / 3;
    above[0] = other / 3;
    for (int end = 0; end < 2; end++) {
        /* The diagonal of one runs from its apex to this end, that of the other to the other. */
        const uint32_t a = pieces->corner[end == 0 ? use : use_next(use)];
        const uint32_t half = end == 0 ? use_next(use_next(use)) : use_next(use);
        const bool same = pieces->corner[other] == a;
        const uint32_t swapped = same ? use_next(other) : use_next(use_next(other));
        below[1] = find_half(pieces, edges, position, half, d);
        above[1] = find_half(pieces, edges, position, swapped, c);
        if (below[1] != PIECE_NONE && above[1] != PIECE_NONE)
            return true;
    }
    return false;
}

/* Lays the pair `above` on the pair `below`; false when their sides do not go together. */
static bool lay_pair(Pieces *pieces, const uint32_t below[2], const uint32_t above[2],
                     uint8_t *gone, const Vec3 *position, Repair *repair)
{
    Vec3 n[4];
    for (int k = 0; k < 2; k++) {
        n[k] = piece_normal(pieces, position, below[k]);
        n[2 + k] = piece_normal(pieces, position, above[k]);
        if (gone[below[k]] || gone[above[k]] || pieces->back[above[k]] != PIECE_NONE)
            return false;
    }
    if (!(vec3_dot(n[0], n[1]) > 0) || !(vec3_dot(n[2], n[3]) > 0))
        return false;
    const bool back = vec3_dot(n[0], n[2]) < 0 && pieces->back[below[0]] == PIECE_NONE
                   && pieces->back[below[1]] == PIECE_NONE;
    if (back && !pieces_alike(pieces, repair->soup, above[0], above[1]))
        return false;
    const bool lit = vec3_dot(n[0], n[2]) > 0 && emits(repair->soup, pieces->face[above[0]])
                  && !emits(repair->soup, pieces->face[below[0]])
                  && pieces_alike(pieces, repair->soup, above[0], above[1]);
    for (int k = 0; k < 2; k++) {
        const bool again = k == 1 && pieces->face[above[0]] == pieces->face[above[1]];
        if (!again)
            report_double(pieces, above[k], pieces->face[below[k]], back,
                          !repair->options->keep_duplicates, position, repair);
        gone[above[k]] = 1;
        if (repair->options->keep_duplicates)
            continue;
        pieces_split_quad(pieces, above[k]);
        repair->repairs.duplicate += !back;
        if (back)
            pieces->back[below[k]] = pieces->face[above[k]];
        else if (lit)
            pieces->face[below[k]] = pieces->face[above[k]];
    }
    return true;
}

static uint32_t least(const uint32_t pair[2]) { return pair[0] < pair[1] ? pair[0] : pair[1]; }

static void merge_at_edge(Pieces *pieces, const Edges *edges, uint32_t e, uint8_t *gone,
                          const Vec3 *position, Repair *repair)
{
    enum { MOST = 32 }; /* of more triangles at one edge no two are compared */
    const uint32_t *use = edges->use + edges->first[e];
    const uint32_t n = edges->first[e + 1] - edges->first[e];
    for (uint32_t i = 0; i < n && n <= MOST; i++)
        for (uint32_t j = i + 1; j < n; j++) {
            uint32_t below[2], above[2];
            bool folded;
            if (gone[use[i] / 3] || gone[use[j] / 3]
                || !in_plane(pieces, position, use[i], use[j], &folded) || !folded
                || !find_swapped(pieces, edges, position, use[i], use[j], below, above))
                continue;
            if (least(below) < least(above))
                lay_pair(pieces, below, above, gone, position, repair);
            else
                lay_pair(pieces, above, below, gone, position, repair);
        }
}

bool pieces_merge_swapped(Pieces *pieces, const Edges *edges, const Vec3 *position, bool *merged,
                          Repair *repair)
{
    assert(pieces != NULL && edges->use_count == 3 * pieces->count && merged != NULL);
    uint8_t *gone = array_create(pieces->count, sizeof *gone, "triangles", repair->err);
    if (gone == NULL)
        return false;
    for (uint32_t e = 0; e < edges->count; e++)
        merge_at_edge(pieces, edges, e, gone, position, repair);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pieces->count; i++)
        if (!gone[i] || repair->options->keep_duplicates)
            piece_move(pieces, i, kept++);
    *merged = kept < pieces->count;
    pieces->count = kept;
    if (*merged)
        split_unlike_quads(pieces, repair->soup);
    array_free(gone);
    return !error_is_set(repair->err);
}

bool pieces_edges(const Pieces *pieces, uint32_t vertex_count, Edges *edges, Error *err)
{
    const uint32_t uses = 3 * pieces->count;
    uint32_t *from = array_create(uses, sizeof *from, "edges", err);
    uint32_t *to = array_create(uses, sizeof *to, "edges", err);
    for (uint32_t use = 0; use < uses && to != NULL; use++) {
        from[use] = pieces->corner[use];
        to[use] = pieces->corner[use_next(use)];
    }
    *edges = (Edges){ 0 };
    const bool ok = !error_is_set(err)
                 && edges_create(edges, from, to, uses, vertex_count, err);
    array_free(from);
    array_free(to);
    return ok;
}
