/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles to half-edges: whatever a half-edge mesh would refuse is taken apart beforehand.
 *
 * Edges are matched in pairs, and each fan of triangles round a vertex gets a vertex of its own, so
 * that boxes touching at an edge or a corner stay two bodies and keep all their own neighbours.
 * Triangles with stitches go in as the polygons they have become. What still does not fit, OpenMesh
 * refuses and is kept apart.
 */
#include <assert.h>

#include "base/array.h"
#include "mesh/internal.h"

static void find_ends(Pairing *p)
{
    const Stitches *s = p->stitches;
    for (uint32_t use = 0; use < 3 * p->pieces->count; use++) {
        uint32_t from = p->pieces->corner[use];
        const uint32_t end = stitches_link(s, use + 1);
        for (uint32_t link = stitches_link(s, use); link < end; link++) {
            p->from[link] = from;
            p->to[link] = link + 1 == end ? p->pieces->corner[use_next(use)]
                                          : s->stitch[link - use].vertex;
            from = p->to[link];
        }
    }
}

/* Which use each link is a piece of; not needed where nothing is stitched. */
static void number_links(const Pairing *p, uint32_t *use_of)
{
    for (uint32_t use = 0; use_of != NULL && use < 3 * p->pieces->count; use++)
        for (uint32_t link = stitches_link(p->stitches, use);
             link < stitches_link(p->stitches, use + 1); link++)
            use_of[link] = use;
}

static bool pairing_create(Pairing *p, Error *err)
{
    p->from = array_create(p->links, sizeof *p->from, "edges", err);
    p->to = array_create(p->links, sizeof *p->to, "edges", err);
    p->partner = array_create(p->links, sizeof *p->partner, "edges", err);
    p->queue = array_create(p->pieces->count, sizeof *p->queue, "edges", err);
    p->state = array_create(p->pieces->count, sizeof *p->state, "edges", err);
    if (error_is_set(err))
        return false;
    find_ends(p);
    for (uint32_t link = 0; link < p->links; link++)
        p->partner[link] = PIECE_NONE;
    return edges_create(&p->edges, p->from, p->to, p->links, p->weld->vertex_count, err);
}

static void pairing_clear(Pairing *p)
{
    edges_clear(&p->edges);
    array_free(p->from);
    array_free(p->to);
    array_free(p->partner);
    array_free(p->queue);
    array_free(p->state);
}

/* Turns one connected part so that windings agree, for the half-edge mesh alone; cuts it where they
 * cannot. State: 1 when that is done. */
static void orient_part(Pairing *p, uint8_t *reversed, uint32_t seed)
{
    uint32_t head = 0, tail = 0;
    p->queue[tail++] = seed;
    p->state[seed] = 1;
    while (head < tail) {
        const uint32_t i = p->queue[head++];
        for (uint32_t link = pairing_begin(p, i); link < pairing_begin(p, i + 1); link++) {
            const uint32_t other = p->partner[link];
            if (other == PIECE_NONE)
                continue;
            const uint32_t j = pairing_piece(p, other);
            const uint8_t wanted = reversed[i] ^ (p->from[link] == p->from[other]);
            if (p->state[j] != 1) {
                p->state[j] = 1;
                reversed[j] = wanted;
                p->queue[tail++] = j;
            } else if (reversed[j] != wanted) {
                p->partner[link] = p->partner[other] = PIECE_NONE;
            }
        }
    }
}

/* A rim is an edge of an odd number of faces, both sides of a plate counted, unless this triangle
 * has one of its own kind at the other side. */
static void find_rims(const Pairing *p, uint8_t *rim)
{
    for (uint32_t e = 0; e < p->edges.count; e++) {
        const uint32_t begin = p->edges.first[e], end = p->edges.first[e + 1];
        uint32_t faces = 0;
        for (uint32_t k = begin; k < end; k++)
            faces += 1 + (p->pieces->back[pairing_piece(p, p->edges.use[k])] != PIECE_NONE);
        for (uint32_t k = begin; k < end && faces % 2 != 0; k++) {
            const uint32_t link = p->edges.use[k], other = p->partner[link];
            const uint32_t piece = pairing_piece(p, link);
            const bool plate = p->pieces->back[piece] != PIECE_NONE;
            if (other == PIECE_NONE
                ? !plate
                : plate != (p->pieces->back[pairing_piece(p, other)] != PIECE_NONE))
                rim[piece] = 1;
        }
    }
}

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

/* One vertex per fan of triangles round a welded vertex: fan [links]. Returns how many.
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

static void build_mesh(Pairing *p, Connection *out)
{
    Error *err = p->repair->err;
    const uint32_t count = p->pieces->count;
    uint32_t *fan = array_create(p->links, sizeof *fan, "edges", err);
    uint32_t *first = array_create((size_t)count + 1, sizeof *first, "edges", err);
    if (!error_is_set(err)) {
        const uint32_t fans = number_fans(p, p->to, fan);
        uint32_t *corner = p->from; /* no longer needed, nor is p->to */
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t begin = pairing_begin(p, i), n = pairing_begin(p, i + 1) - begin;
            first[i + 1] = begin + n;
            for (uint32_t k = 0; k < n; k++)
                corner[begin + k] = fan[begin + (out->reversed[i] ? (n - k) % n : k)];
        }
        out->mesh = halfedge_create(first, corner, count, fans, p->state, err);
    }
    array_free(fan);
    array_free(first);
    if (out->mesh != NULL)
        report_refused(p);
}

bool connection_create(Connection *connection, Pieces *pieces, Stitches *stitches,
                       const Weld *weld, Repair *repair)
{
    assert(connection != NULL && pieces != NULL && stitches != NULL && repair != NULL);
    Error *err = repair->err;
    const uint32_t links = 3 * pieces->count + stitches->count;
    *connection = (Connection){ .stitches = stitches, .links = links };
    connection->reversed = array_create(pieces->count, sizeof *connection->reversed, "edges", err);
    connection->rim = array_create(pieces->count, sizeof *connection->rim, "edges", err);
    if (stitches->count > 0)
        connection->use = array_create(links, sizeof *connection->use, "edges", err);
    Pairing p = { .pieces = pieces, .stitches = stitches, .weld = weld, .repair = repair,
                  .use = connection->use, .links = links };
    number_links(&p, connection->use);
    if (!error_is_set(err) && pairing_create(&p, err)) {
        pairing_certain(&p);
        if (pairing_wind(&p) && pairing_likely(&p)) {
            number_links(&p, connection->use); /* turned triangles have their edges turned */
            for (uint32_t i = 0; i < pieces->count; i++)
                if (p.state[i] != 1)
                    orient_part(&p, connection->reversed, i);
            find_rims(&p, connection->rim);
            build_mesh(&p, connection);
        }
    }
    pairing_clear(&p);
    if (error_is_set(err))
        connection_clear(connection);
    return !error_is_set(err);
}

void connection_clear(Connection *connection)
{
    halfedge_destroy(connection->mesh);
    array_free(connection->use);
    array_free(connection->reversed);
    array_free(connection->rim);
    *connection = (Connection){ 0 };
}

/* The half-edge mesh has a reversed triangle's links the other way round. */
static uint32_t mesh_link(const Connection *connection, uint32_t link)
{
    const uint32_t piece = connection_use(connection, link) / 3;
    if (!connection->reversed[piece])
        return link;
    return stitches_link(connection->stitches, 3 * piece)
         + stitches_link(connection->stitches, 3 * piece + 3) - 1 - link;
}

uint32_t connection_across(const Connection *connection, uint32_t link)
{
    const uint32_t other = halfedge_across(connection->mesh, mesh_link(connection, link));
    return other == HALFEDGE_NONE ? PIECE_NONE : mesh_link(connection, other);
}
