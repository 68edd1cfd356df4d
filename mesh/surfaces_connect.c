/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles that continue each other: from edges and stitches to pairs, from pairs to a mesh. */
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
            pairing_mesh(&p, connection);
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
    array_free(connection->mesh_use);
    array_free(connection->mesh_link);
    array_free(connection->reversed);
    array_free(connection->rim);
    *connection = (Connection){ 0 };
}

uint32_t connection_across(const Connection *connection, uint32_t link)
{
    const uint32_t other = halfedge_across(connection->mesh, connection->mesh_use[link]);
    return other == HALFEDGE_NONE ? PIECE_NONE : connection->mesh_link[other];
}
