/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs of links to a half-edge mesh: whatever such a mesh refuses is taken apart beforehand.
 *
 * Each fan of triangles round a vertex gets a vertex of its own, so that boxes touching at an edge
 * or a corner stay two bodies and keep all their own neighbours. Two pairs at one edge are told
 * apart by a vertex in its middle. Where very many triangles meet, corners are cut off: each edge
 * ends in a vertex of its own, else each new triangle would be compared with all that are there.
 * Triangles with stitches go in as the polygons they have become. What still does not fit, OpenMesh
 * refuses and is kept apart.
 */
#include <assert.h>

#include "base/array.h"
#include "mesh/internal.h"

/* Triangles round a vertex; models have six, poles of spheres some dozens. */
enum { MOST_IN_FAN = 128 };

typedef struct {
    const Pairing *pairing;
    Connection    *out;
    uint32_t      *fan;         /* [links]  of the corner a link begins at */
    uint32_t      *start, *end; /* [links]  vertices of the mesh, as the triangle is wound */
    uint32_t      *middle;      /* [links]  the one between them, or PIECE_NONE */
    uint32_t      *first;       /* [pieces + 1] */
    uint32_t      *corner;      /* [first[pieces]] */
    uint32_t       vertices;
} Mesher;

static uint32_t corner_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]]; /* halves the path for the next who asks */
        i = parent[i];
    }
    return i;
}

static void corner_unite(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = corner_root(parent, a);
    b = corner_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* Numbers the fans of triangles round welded vertices: fan [links]. Returns how many.
 * parent [links]: union-find over corners. */
static uint32_t number_fans(const Pairing *p, uint32_t *parent, uint32_t *fan)
{
    for (uint32_t link = 0; link < p->links; link++)
        parent[link] = link;
    for (uint32_t link = 0; link < p->links; link++) {
        const uint32_t other = p->partner[link];
        if (other == PIECE_NONE || other < link)
            continue;
        const bool opposite = p->from[link] != p->from[other];
        corner_unite(parent, link, opposite ? pairing_next(p, other) : other);
        corner_unite(parent, pairing_next(p, link), opposite ? other : pairing_next(p, other));
    }
    uint32_t fans = 0;
    /* Roots are the least corner of their fan, so they come before all others of it. */
    for (uint32_t i = 0; i < p->links; i++)
        fan[i] = parent[i] == i ? fans++ : fan[corner_root(parent, i)];
    return fans;
}

/* Gives a link its vertices; those of its partner are there already when that comes first. */
static void place_link(Mesher *m, uint32_t link, const uint32_t *fan_size)
{
    const Pairing *p = m->pairing;
    const uint32_t other = p->partner[link];
    if (other != PIECE_NONE && other < link) {
        const bool opposite = p->from[link] != p->from[other];
        m->start[link] = opposite ? m->end[other] : m->start[other];
        m->end[link] = opposite ? m->start[other] : m->end[other];
        m->middle[link] = m->middle[other];
        return;
    }
    const uint32_t from = m->fan[link], to = m->fan[pairing_next(p, link)];
    m->start[link] = fan_size[from] > MOST_IN_FAN ? m->vertices++ : from;
    m->end[link] = fan_size[to] > MOST_IN_FAN ? m->vertices++ : to;
    if (m->middle[link] != PIECE_NONE)
        m->middle[link] = m->vertices++;
}

static bool place_links(Mesher *m)
{
    const Pairing *p = m->pairing;
    /* The parents of the union-find need no room of their own yet. */
    m->vertices = number_fans(p, m->start, m->fan);
    uint32_t *size = array_create(m->vertices, sizeof *size, "edges", p->repair->err);
    if (size == NULL)
        return false;
    for (uint32_t link = 0; link < p->links; link++) {
        size[m->fan[link]]++;
        m->middle[link] = PIECE_NONE;
    }
    for (uint32_t e = 0; e < p->edges.count; e++)
        for (uint32_t k = p->edges.first[e];
             p->edges.first[e + 1] - p->edges.first[e] > 2 && k < p->edges.first[e + 1]; k++)
            m->middle[p->edges.use[k]] = 0; /* wants one */
    for (uint32_t link = 0; link < p->links; link++)
        place_link(m, link, size);
    array_free(size);
    return true;
}

static void add_corner(Mesher *m, uint32_t *at, uint32_t vertex, uint32_t link)
{
    m->out->mesh_link[*at] = link;
    m->corner[(*at)++] = vertex;
}

/* The outline of a piece in the mesh; a reversed one is run through backwards. */
static uint32_t add_piece(Mesher *m, uint32_t piece, uint32_t at)
{
    const Pairing *p = m->pairing;
    const uint32_t begin = pairing_begin(p, piece), n = pairing_begin(p, piece + 1) - begin;
    const bool reversed = m->out->reversed[piece];
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t link = begin + (reversed ? n - 1 - k : k);
        const uint32_t after = begin + (reversed ? (2 * n - 2 - k) % n : (k + 1) % n);
        const uint32_t end = reversed ? m->start[link] : m->end[link];
        m->out->mesh_use[link] = at;
        add_corner(m, &at, reversed ? m->end[link] : m->start[link], link);
        if (m->middle[link] != PIECE_NONE)
            add_corner(m, &at, m->middle[link], link);
        if (end != (reversed ? m->end[after] : m->start[after]))
            add_corner(m, &at, end, PIECE_NONE); /* the cut off corner */
    }
    return at;
}

static bool report_refused(const Pairing *p)
{
    for (uint32_t i = 0; i < p->pieces->count; i++) {
        p->repair->repairs.refused += p->state[i];
        if (p->state[i]
            && !repair_report(p->repair, &(Defect){
                    .kind = DEFECT_REFUSED, .face = p->pieces->face[i], .other = DEFECT_NO_FACE,
                    .at = p->weld->position[p->pieces->corner[3 * (size_t)i]] }))
            return false;
    }
    return true;
}

static bool mesher_create(Mesher *m)
{
    const Pairing *p = m->pairing;
    Error *err = p->repair->err;
    const size_t most = 3 * (size_t)p->links; /* a link, its middle, a corner cut off */
    m->fan = array_create(p->links, sizeof *m->fan, "edges", err);
    m->start = array_create(p->links, sizeof *m->start, "edges", err);
    m->end = array_create(p->links, sizeof *m->end, "edges", err);
    m->middle = array_create(p->links, sizeof *m->middle, "edges", err);
    m->first = array_create((size_t)p->pieces->count + 1, sizeof *m->first, "edges", err);
    m->corner = array_create(most, sizeof *m->corner, "edges", err);
    m->out->mesh_use = array_create(p->links, sizeof *m->out->mesh_use, "edges", err);
    m->out->mesh_link = array_create(most, sizeof *m->out->mesh_link, "edges", err);
    return !error_is_set(err);
}

static void mesher_clear(Mesher *m)
{
    m->fan = array_free(m->fan);
    m->start = array_free(m->start);
    m->end = array_free(m->end);
    m->middle = array_free(m->middle);
}

bool pairing_mesh(Pairing *p, Connection *out)
{
    assert(p != NULL && out != NULL && out->mesh == NULL);
    Mesher m = { .pairing = p, .out = out };
    if (mesher_create(&m) && place_links(&m)) {
        for (uint32_t i = 0; i < p->pieces->count; i++)
            m.first[i + 1] = add_piece(&m, i, m.first[i]);
        mesher_clear(&m); /* room for OpenMesh */
        out->mesh = halfedge_create(m.first, m.corner, p->pieces->count, m.vertices, p->state,
                                    p->repair->err);
    }
    mesher_clear(&m);
    array_free(m.first);
    array_free(m.corner);
    return out->mesh != NULL && report_refused(p);
}
