/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles to half-edges: whatever a half-edge mesh would refuse is taken apart beforehand.
 *
 * Edges are matched in pairs, triangles turned to agree, and each fan of triangles round a vertex
 * gets a vertex of its own, so that boxes touching at an edge or a corner stay two bodies and keep
 * all their own neighbours. What still does not fit, OpenMesh refuses and is kept apart.
 */
#include <assert.h>

#include "base/array.h"
#include "mesh/edges.h"
#include "mesh/internal.h"

/* An edge of more triangles than this belongs to nobody: all of them end there. */
enum { MOST_AT_EDGE = 32 };

typedef struct {
    const Pieces   *pieces;
    const Polygons *soup;
    Edges           edges;
    uint32_t       *from, *to;   /* [3 * count]  ends of each use */
    uint32_t       *partner;     /* [3 * count]  use on the other side or PIECE_NONE */
    uint32_t       *parent;      /* [3 * count]  union-find over triangle corners */
    uint32_t       *queue;       /* [count] */
    uint8_t        *state;       /* [count]  1: turned as it stays; 2: noted as nonmanifold */
} Connector;

static bool connector_create(Connector *c, uint32_t vertex_count, Error *err)
{
    const size_t count = c->pieces->count;
    c->from = array_create(3 * count, sizeof *c->from, "edges", err);
    c->to = array_create(3 * count, sizeof *c->to, "edges", err);
    c->partner = array_create(3 * count, sizeof *c->partner, "edges", err);
    c->parent = array_create(3 * count, sizeof *c->parent, "edges", err);
    c->queue = array_create(count, sizeof *c->queue, "edges", err);
    c->state = array_create(count, sizeof *c->state, "edges", err);
    if (error_is_set(err))
        return false;
    for (uint32_t use = 0; use < 3 * count; use++) {
        c->from[use] = c->pieces->corner[use];
        c->to[use] = c->pieces->corner[use_next(use)];
        c->partner[use] = PIECE_NONE;
        c->parent[use] = use;
    }
    return edges_create(&c->edges, c->from, c->to, (uint32_t)(3 * count), vertex_count, err);
}

static void connector_clear(Connector *c)
{
    edges_clear(&c->edges);
    array_free(c->from);
    array_free(c->to);
    array_free(c->partner);
    array_free(c->parent);
    array_free(c->queue);
    array_free(c->state);
}

/* How much two triangles at an edge look like one surface. */
static int pair_grade(const Connector *c, uint32_t use, uint32_t other)
{
    const uint32_t f = c->pieces->face[use / 3], g = c->pieces->face[other / 3];
    const int polygon = f == g ? 8 : 0;
    const int winding = c->from[use] != c->from[other] ? 4 : 0;
    const int group = c->soup->group[f] == c->soup->group[g] ? 2 : 0;
    const int material = c->soup->material[f] == c->soup->material[g] ? 1 : 0;
    return polygon + winding + group + material;
}

/* Pairs the uses of an edge with more than two, most alike first. */
static void pair_many(Connector *c, const uint32_t *use, uint32_t n)
{
    for (int grade = 15; grade >= 0; grade--)
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = i + 1; j < n && c->partner[use[i]] == PIECE_NONE; j++)
                if (c->partner[use[j]] == PIECE_NONE && use[i] / 3 != use[j] / 3
                    && pair_grade(c, use[i], use[j]) == grade) {
                    c->partner[use[i]] = use[j];
                    c->partner[use[j]] = use[i];
                }
}

static void pair_edges(Connector *c, bool *closed, Notes *notes)
{
    *closed = c->edges.count > 0;
    for (uint32_t e = 0; e < c->edges.count; e++) {
        const uint32_t *use = c->edges.use + c->edges.first[e];
        const uint32_t n = c->edges.first[e + 1] - c->edges.first[e];
        uint32_t faces = n;
        for (uint32_t k = 0; k < n; k++)
            faces += c->pieces->back[use[k] / 3] != PIECE_NONE;
        /* Two, or two sheets of two. */
        *closed = *closed && (faces == 2 || (n == 2 && faces == 4));
        if (n == 2) {
            c->partner[use[0]] = use[1];
            c->partner[use[1]] = use[0];
        } else if (n > 2 && n <= MOST_AT_EDGE) {
            pair_many(c, use, n);
        }
        for (uint32_t k = 2; k < n; k++)
            if (c->state[use[k] / 3] != 2) {
                c->state[use[k] / 3] = 2;
                note_face(&notes->nonmanifold, c->pieces->face[use[k] / 3]);
            }
    }
}

/* Turns one connected part so that windings agree; cuts it where they cannot (a Moebius strip). */
static void orient_part(Connector *c, uint8_t *reversed, uint32_t seed, Notes *notes)
{
    uint32_t head = 0, tail = 0, turned = 0;
    c->queue[tail++] = seed;
    c->state[seed] = 1;
    while (head < tail) {
        const uint32_t i = c->queue[head++];
        turned += reversed[i];
        for (uint32_t use = 3 * i; use < 3 * i + 3; use++) {
            const uint32_t other = c->partner[use];
            if (other == PIECE_NONE)
                continue;
            const uint8_t wanted = reversed[i] ^ (c->from[use] == c->from[other]);
            if (c->state[other / 3] != 1) {
                c->state[other / 3] = 1;
                reversed[other / 3] = wanted;
                c->queue[tail++] = other / 3;
            } else if (reversed[other / 3] != wanted) {
                c->partner[use] = c->partner[other] = PIECE_NONE;
            }
        }
    }
    const bool most = turned > tail - turned;
    for (uint32_t k = 0; k < tail; k++)
        if ((reversed[c->queue[k]] != 0) != most)
            note_face(&notes->inconsistent, c->pieces->face[c->queue[k]]);
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

/* One vertex per fan of triangles round a welded vertex: fan [3 * count]. Returns how many. */
static uint32_t number_fans(Connector *c, uint32_t *fan)
{
    const uint32_t uses = 3 * c->pieces->count;
    for (uint32_t use = 0; use < uses; use++) {
        const uint32_t other = c->partner[use];
        if (other == PIECE_NONE || other < use)
            continue;
        const bool opposite = c->from[use] != c->from[other];
        corner_unite(c->parent, use, opposite ? use_next(other) : other);
        corner_unite(c->parent, use_next(use), opposite ? other : use_next(other));
    }
    uint32_t fans = 0;
    /* Roots are the least corner of their fan, so they come before all others of it. */
    for (uint32_t i = 0; i < uses; i++)
        fan[i] = c->parent[i] == i ? fans++ : fan[corner_root(c->parent, i)];
    return fans;
}

static void build_mesh(Connector *c, Connection *out, Notes *notes, Error *err)
{
    const uint32_t count = c->pieces->count;
    uint32_t *fan = array_create(3 * (size_t)count, sizeof *fan, "edges", err);
    if (fan == NULL)
        return;
    const uint32_t fans = number_fans(c, fan);
    uint32_t *corner = c->from; /* no longer needed */
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++)
            corner[3 * i + k] = fan[3 * i + (out->reversed[i] ? (3 - k) % 3 : k)];
    out->mesh = halfedge_create(corner, count, fans, c->state, err);
    for (uint32_t i = 0; out->mesh != NULL && i < count; i++)
        if (c->state[i])
            note_face(&notes->refused, c->pieces->face[i]);
    array_free(fan);
}

bool connection_create(Connection *connection, const Pieces *pieces, const Polygons *soup,
                       uint32_t vertex_count, Notes *notes, Error *err)
{
    assert(connection != NULL && pieces != NULL && soup != NULL && notes != NULL && err != NULL);
    *connection = (Connection){ 0 };
    Connector c = { .pieces = pieces, .soup = soup };
    connection->reversed = array_create(pieces->count, sizeof *connection->reversed, "edges", err);
    if (connector_create(&c, vertex_count, err)) {
        pair_edges(&c, &connection->closed, notes);
        for (uint32_t i = 0; i < pieces->count; i++)
            if (c.state[i] != 1)
                orient_part(&c, connection->reversed, i, notes);
        build_mesh(&c, connection, notes, err);
    }
    connector_clear(&c);
    if (error_is_set(err))
        connection_clear(connection);
    return !error_is_set(err);
}

void connection_clear(Connection *connection)
{
    halfedge_destroy(connection->mesh);
    array_free(connection->reversed);
    *connection = (Connection){ 0 };
}

uint32_t connection_across(const Connection *connection, uint32_t use)
{
    /* The half-edge mesh has (c0, c2, c1) for a reversed triangle: edges 0 and 2 change places. */
    const uint32_t i = use / 3, k = use % 3;
    unsigned edge = 0;
    const uint32_t j = halfedge_across(connection->mesh, i, connection->reversed[i] ? 2 - k : k,
                                       &edge);
    if (j == HALFEDGE_NONE)
        return PIECE_NONE;
    return 3 * j + (connection->reversed[j] ? 2 - edge : edge);
}
