/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/internal.h -- what the steps of surfaces_repair hand to each other; this folder only. */
#ifndef MESH_INTERNAL_H
#define MESH_INTERNAL_H

#include "mesh/edges.h"
#include "mesh/halfedge.h"
#include "mesh/surfaces.h"
#include "mesh/weld.h"

#define PIECE_NONE UINT32_MAX

/* --- what is to be repaired and what was found ------------------------------------------------ */

/* How often something was noticed, and the first face where. */
typedef struct {
    uint32_t count;
    uint32_t first;       /* number of the face in the file */
    uint32_t face, other; /* in the soup: it, and the second one concerned or DEFECT_NO_FACE */
} Note;

typedef struct {
    const Polygons       *soup;
    const SurfaceOptions *options;
    Defects              *defects;          /* may be NULL */
    Repairs               repairs;
    Note                  note[DEFECT_KINDS][2]; /* left as it is, repaired */
    Note                  lamp;            /* faces that give light and were left out for their
                                              shape */
    bool                  many_junctions;  /* the search for them was given up */
    Error                *err;
} Repair;

/* surfaces_report.c: notes a defect and puts it on the list; its position in scene units. */
bool repair_report(Repair *repair, const Defect *defect);
/* Whether the later of two faces that lie on each other, wound alike, takes the place of the first:
 * it gives light and the other does not. Notes which of them is left out; `merged`: it is. */
bool repair_report_double(Repair *repair, uint32_t later, uint32_t first, bool merged, Vec3 at);
/* Warns of what a user should know. */
void repair_tell(const Repair *repair, const Monitor *monitor);
/* How far a corner may be off an edge from p to q that it is meant to lie on. */
double repair_reach(const Repair *repair, Vec3 p, Vec3 q);

/* --- triangles -------------------------------------------------------------------------------- */

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
bool pieces_create(Pieces *pieces, const Weld *weld, Repair *repair);
void pieces_clear(Pieces *pieces);

/* surfaces_double.c */
typedef struct {
    uint32_t *key;      /* sorted vertices of all members */
    uint32_t *start;    /* [count + 1]  first key of a member */
    uint32_t *owner;    /* [count]  what the caller knows a member by */
    uint32_t *slot;     /* [mask + 1]  member + 1, or 0 */
    uint32_t  count, mask;
} VertexSets;           /* sets of vertices seen so far, in a hash table with open addressing */

bool sets_create(VertexSets *sets, uint32_t members, size_t keys, Error *err);
void sets_clear(VertexSets *sets);
/* Adds n vertices in any order; when the same set is there, nothing is added and its owner comes
 * back instead of PIECE_NONE. `sorted` is room for n. */
uint32_t sets_add(VertexSets *sets, const uint32_t *vertex, uint32_t n, uint32_t owner,
                  uint64_t *sorted);
/* Whether an outline runs round the same corners as another, or so the other way. */
bool outline_is_same(const uint32_t *a, const uint32_t *b, uint32_t n, bool reverse);
/* Leaves out triangles that are there already, or makes them the other side of those. */
bool pieces_merge_triangles(Pieces *pieces, const Vec3 *position, Repair *repair);
/* The same for two triangles that are another two cut along the other diagonal. */
bool pieces_merge_swapped(Pieces *pieces, const Edges *edges, const Vec3 *position, bool *merged,
                          Repair *repair);
/* Makes both halves of a quad triangles of their own. */
void pieces_split_quad(Pieces *pieces, uint32_t piece);

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

/* The edges between the triangles. */
bool pieces_edges(const Pieces *pieces, uint32_t vertex_count, Edges *edges, Error *err);

/* --- T-junctions ------------------------------------------------------------------------------ */

/* Corners let into the edges of triangles. With them a triangle is a loop of shorter edges, its
 * links: those of use u are numbered from u + first[u] on. */
typedef struct {
    uint32_t *first;   /* [3 * pieces + 1]  stitches of each use; NULL: there is none at all */
    Stitch   *stitch;  /* [count]  fractions rising along the use */
    uint32_t  count;
} Stitches;

/* surfaces_stitch.c */
bool stitches_create(Stitches *stitches, const Pieces *pieces, const Edges *edges,
                     const Weld *weld, Repair *repair);
void stitches_clear(Stitches *stitches);

static inline uint32_t stitches_link(const Stitches *stitches, uint32_t use)
{
    return stitches->first == NULL ? use : use + stitches->first[use];
}

/* --- connections ------------------------------------------------------------------------------ */

/* Which triangles continue each other, as a half-edge mesh. */
typedef struct {
    HalfEdges      *mesh;
    const Stitches *stitches;
    uint32_t       *use;       /* [links]  use a link is a piece of; NULL: of the same number */
    uint32_t        links;
    uint32_t       *mesh_use;  /* [links]  use of the half-edge mesh */
    uint32_t       *mesh_link; /* and back; PIECE_NONE: of no edge */
    uint8_t        *reversed;  /* [pieces]  1: wound against the half-edge mesh */
    uint8_t        *rim;       /* [pieces]  1: one of its edges has no face at the other side */
} Connection;

/* surfaces_connect.c: turns pieces as well, and stitches with them. */
bool connection_create(Connection *connection, Pieces *pieces, Stitches *stitches,
                       const Weld *weld, Repair *repair);
void connection_clear(Connection *connection);
/* The link of the same edge in the triangle on the other side, or PIECE_NONE. */
uint32_t connection_across(const Connection *connection, uint32_t link);

static inline uint32_t connection_use(const Connection *connection, uint32_t link)
{
    return connection->use == NULL ? link : connection->use[link];
}

/* Links in pairs, while a Connection is made. */
typedef struct {
    Pieces         *pieces;
    Stitches       *stitches;
    const Weld     *weld;
    Repair         *repair;
    const uint32_t *use;       /* as in Connection */
    uint32_t        links;
    Edges           edges;     /* of links */
    uint32_t       *from, *to; /* [links]  ends */
    uint32_t       *partner;   /* [links]  link on the other side or PIECE_NONE */
    uint32_t       *queue;     /* [pieces] */
    uint8_t        *state;     /* [pieces] */
} Pairing;

/* surfaces_pair.c: pairs what belongs together whatever the windings: the two faces of an edge that
 * has two, and parts of one polygon; */
void pairing_certain(Pairing *pairing);
/* and of the rest those whose windings agree, most alike first. */
bool pairing_likely(Pairing *pairing);
/* surfaces_mesh.c: makes the half-edge mesh of pairs whose windings agree but for reversed[]. */
bool pairing_mesh(Pairing *pairing, Connection *out);
/* surfaces_wind.c: turns triangles so that pairs agree. */
bool pairing_wind(Pairing *pairing);

static inline uint32_t pairing_piece(const Pairing *p, uint32_t link)
{
    return (p->use == NULL ? link : p->use[link]) / 3;
}
static inline uint32_t pairing_begin(const Pairing *p, uint32_t piece)
{
    return stitches_link(p->stitches, 3 * piece);
}
/* Link after another round the same triangle. */
static inline uint32_t pairing_next(const Pairing *p, uint32_t link)
{
    const uint32_t piece = pairing_piece(p, link);
    return link + 1 == pairing_begin(p, piece + 1) ? pairing_begin(p, piece) : link + 1;
}

/* surfaces_join.c: whether another face stands on the edge of a face from p to q, as the soup says:
 * light on one side of it is none of the other's. */
bool soup_contact(const Polygons *soup, uint32_t face, Vec3 p, Vec3 q);
/* surfaces_join.c: pairs triangles that form a parallelogram: sets diagonal and other. */
bool pieces_join(Pieces *pieces, const Connection *connection, const Polygons *soup,
                 const Vec3 *position, Error *err);

/* surfaces_emit.c: everything of *out but its position array, which is there already. */
bool surfaces_emit(Surfaces *out, const Pieces *pieces, const Connection *connection,
                   Repair *repair);

/* polygons_normals.c: part of polygons_check. */
bool polygons_normals_check(const Polygons *soup);

#endif
