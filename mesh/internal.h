/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/internal.h -- what the steps of surfaces_create hand to each other; this folder only. */
#ifndef MESH_INTERNAL_H
#define MESH_INTERNAL_H

#include "mesh/halfedge.h"
#include "mesh/surfaces.h"
#include "mesh/weld.h"

/* How often something was noticed, and the first face (as in Surface.face) where. */
typedef struct {
    uint32_t count, first;
} Note;

static inline void note_face(Note *note, uint32_t face)
{
    if (note->count++ == 0)
        note->first = face;
}

typedef struct {
    Note duplicate, degenerate, crossing, nonmanifold, inconsistent, refused;
} Notes;

#define PIECE_NONE UINT32_MAX

/* The polygons cut into triangles. A use is one edge of one triangle: 3 * triangle + edge. */
typedef struct {
    uint32_t  count;
    uint32_t *corner;    /* [3 * count]  welded vertices */
    uint32_t *face;      /* [count]  polygon */
    uint32_t *back;      /* [count]  polygon that is the other side, or PIECE_NONE */
    uint32_t *diagonal;  /* [count]  the use inside a quad when the triangle is half of one, or
                            PIECE_NONE; the other half has its own for the same edge */
    uint32_t *other;     /* [count]  the other half, or PIECE_NONE */
    size_t    corner_capacity, face_capacity, back_capacity, diagonal_capacity, other_capacity;
} Pieces;

/* surfaces_cut.c: cuts polygons, leaves out what is double or has no area. */
bool pieces_create(Pieces *pieces, const Polygons *soup, const Weld *weld, Notes *notes,
                   Error *err);
void pieces_clear(Pieces *pieces);

/* Which triangles continue each other, as a half-edge mesh. */
typedef struct {
    HalfEdges *mesh;
    uint8_t   *reversed;  /* [pieces->count]  1: wound against the half-edge mesh */
    bool       closed;    /* each edge has exactly two triangles */
} Connection;

/* surfaces_connect.c */
bool connection_create(Connection *connection, const Pieces *pieces, const Polygons *soup,
                       uint32_t vertex_count, Notes *notes, Error *err);
void connection_clear(Connection *connection);
/* The use of the same edge in the triangle on the other side, or PIECE_NONE. */
uint32_t connection_across(const Connection *connection, uint32_t use);

/* surfaces_join.c: pairs triangles that form a parallelogram: sets diagonal and other. */
bool pieces_join(Pieces *pieces, const Connection *connection, const Polygons *soup,
                 const Vec3 *position, Error *err);

/* Whether two triangles have the same material and group on both sides. */
static inline bool pieces_alike(const Pieces *pieces, const Polygons *soup, uint32_t i, uint32_t j)
{
    const uint32_t f = pieces->face[i], g = pieces->face[j];
    const uint32_t a = pieces->back[i], b = pieces->back[j];
    return soup->material[f] == soup->material[g] && soup->group[f] == soup->group[g]
        && (a == b || (a != PIECE_NONE && b != PIECE_NONE
                       && soup->material[a] == soup->material[b]
                       && soup->group[a] == soup->group[b]));
}

/* Edge after edge k of the same triangle. */
static inline uint32_t use_next(uint32_t use) { return use % 3 == 2 ? use - 2 : use + 1; }

#endif
