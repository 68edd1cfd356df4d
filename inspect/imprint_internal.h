/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_internal.h -- what the steps of imprint_create hand to each other. */
#ifndef INSPECT_IMPRINT_INTERNAL_H
#define INSPECT_IMPRINT_INTERNAL_H

#include "inspect/imprint.h"
#include "inspect/internal.h"
#include "raycast/bvh.h"

/* A flat convex part of a face: the whole of it, or a triangle. */
typedef struct {
    uint32_t face;
    uint32_t first, count; /* its corners in Parts.corner */
    Vec3     normal;       /* unit */
    double   level;        /* normal . p of its points */
    double   tolerance;    /* how far its corners may be off */
    double   area;
    Vec3     lo, hi;
} ImprintPart;

typedef struct {
    ImprintPart    *part;       /* [count]  in the order of faces */
    uint32_t        count;
    uint32_t       *first;      /* [polygons + 1]  parts of a face */
    uint32_t       *corner;     /* indices into soup->position */
    size_t          capacity, corner_count, corner_capacity;
    const Polygons *soup;
    BoxTree         tree;       /* over the parts */
} ImprintParts;

/* imprint_parts.c */
bool imprint_parts_create(ImprintParts *parts, const Polygons *soup, Error *err);
void imprint_parts_clear(ImprintParts *parts);

static inline Vec3 imprint_corner(const ImprintParts *parts, const ImprintPart *part, uint32_t k)
{
    return parts->soup->position[parts->corner[part->first + k % part->count]];
}

/* Where another part meets one. */
typedef struct {
    Vec3     end[2];
    bool     barrier;   /* the other stands there: no part of the same plane */
    bool     inner;     /* not along the border of the part */
    uint32_t face;      /* that meets it there */
    double   length;
} ImprintLine;

/* What a part is as a lamp. */
typedef enum {
    LAMP_UNKNOWN, /* not looked at yet */
    LAMP_SHEET,   /* gives light; nothing is joined to the back of it */
    LAMP_CASED,   /* the lit face of a dark case */
    LAMP_BODY,    /* a side of something that gives light all round */
    LAMP_NONE     /* gives none */
} LampKind;

typedef struct {
    bool         keep_whole, keep_covered; /* as in ImprintOptions */
    ImprintLine *line;
    uint32_t     count;      /* longest first */
    uint32_t     inner;      /* how many of them are inner */
    uint32_t    *cover;      /* [cover_count]  parts that this one gives way to */
    uint32_t     cover_count;
    bool         flush;      /* some other lies on it, or it on that, whichever gives way */
    size_t       capacity, cover_capacity;
    uint32_t    *met;        /* [parts]  entries of the tree; scratch */
    uint8_t     *lamp;       /* [parts]  LampKind */
    uint32_t    *row;        /* [parts]  a lit face, part by part; scratch */
    uint32_t    *beside;     /* [parts]  scratch */
    uint8_t     *body;       /* [parts]  whether its body is closed (imprint_stand.c) */
    Bvh         *bvh;        /* over all parts and shapes; made when first needed */
} ImprintContacts;

/* imprint_contacts.c: whether two parts in one plane have the same corners. */
bool imprint_same_outline(const ImprintParts *parts, const ImprintPart *a, const ImprintPart *b);
/* All lines and covers of one part. */
bool imprint_contacts_find(const ImprintParts *parts, uint32_t part, ImprintContacts *contacts,
                           Error *err);
void imprint_contacts_clear(ImprintContacts *contacts);

/* imprint_lamps.c: fills in contacts->lamp of a part, and of those it goes on in. */
bool imprint_lamp_find(const ImprintParts *parts, uint32_t part, ImprintContacts *contacts,
                       Error *err);
bool imprint_emits(const Polygons *soup, uint32_t face);
/* Whether two parts have an edge in common, whichever way it runs. */
bool imprint_share_edge(const ImprintParts *parts, const ImprintPart *a, const ImprintPart *b);

/* imprint_bodies.c: whether a wall gives way to the face of a body of light in its plane: the body
 * is behind the wall, and the light it sends to the other side arrives in a room. */
bool imprint_body_opens(const ImprintParts *parts, uint32_t lamp, ImprintContacts *contacts,
                        bool *opens, Error *err);
/* Whether less than half of the rays from a part to the side of the unit vector `out` go on to
 * infinity. */
bool imprint_enclosed(const ImprintParts *parts, ImprintContacts *contacts, const ImprintPart *part,
                      Vec3 out, bool *enclosed, Error *err);

/* imprint_stand.c: whether a small unlit part lies on a large one in its plane that looks the other
 * way, and so is to be seen instead: it is the bottom of something open that stands before the
 * large one; or a sheet that shows to no place that can be looked at from, as a rug that is wound
 * downwards. Otherwise they are the sides of one plate. */
bool imprint_carries(const ImprintParts *parts, uint32_t large, uint32_t small,
                     ImprintContacts *contacts, bool *carries, Error *err);
/* Whether a lit part and a dark one, opposite ways in one plane, are the sides of a plate: with the
 * same corners, and the dark one is no piece of a wall. */
bool imprint_is_plate(const ImprintParts *parts, uint32_t lamp, uint32_t dark,
                      ImprintContacts *contacts, bool *plate, Error *err);

/* Convex pieces in a row; corners are indices into position. */
typedef struct {
    uint32_t *first;        /* [count + 1] */
    uint32_t *corner;
    uint8_t  *contact;      /* [first[count]] */
    uint32_t  count;
    size_t    first_capacity, corner_capacity, contact_capacity;
} ImprintPieces;

bool imprint_pieces_add(ImprintPieces *pieces, const uint32_t *corner, const uint8_t *contact,
                        uint32_t count, Error *err);
void imprint_pieces_clear(ImprintPieces *pieces);

/* The stretch of end[0]..end[1] within a convex polygon; false when there is none longer than the
 * tolerance. *border: it runs along an edge. */
bool imprint_clip(const Vec3 *position, const uint32_t *corner, uint32_t count, Vec3 normal,
                  double tolerance, Vec3 end[2], bool *border);
/* Whether p, in its plane, lies in the polygon. */
bool imprint_inside(const Vec3 *position, const uint32_t *corner, uint32_t count, Vec3 normal,
                    double tolerance, Vec3 p);

/* Positions of the original's vertices and of those that cuts made. */
typedef struct {
    Vec3  *position;
    size_t count, capacity;
} ImprintPoints;

/* What cutting one part needs and makes. */
typedef struct {
    const ImprintParts *parts;
    ImprintPoints      *points;
    Error              *err;
    const ImprintPart  *part;     /* being cut */
    ImprintPieces       now, next;/* its pieces; now: the result */
    uint32_t           *known;    /* [known_count]  points of it, to which new ones are drawn */
    double             *height;   /* scratch: corners of a piece above a line */
    uint32_t           *half[2];
    size_t              known_count, known_capacity, height_capacity, half_capacity[2];
    bool                covered;  /* a piece was left out */
    bool                overlapped; /* by what is no lamp */
    double              covered_area;
    uint32_t            cover;    /* part that the first piece left out was under */
    Vec3                covered_at;
} ImprintKnife;

/* What happened to a face, or a part of it. */
typedef struct {
    bool     cut, covered, overlapped;
    bool     flush;         /* some other face lies on it */
    uint32_t by, cover;     /* face that cuts it, part that it is under; both the first one */
    Vec3     cut_at, covered_at;
    double   covered_area;
} ImprintFate;

/* imprint_report.c: what is told of all faces. */
typedef struct {
    Defects *defects;                   /* may be NULL */
    uint32_t first, other;              /* first face that gave way to no lamp, and to what */
    uint32_t first_exact, other_exact;  /* first that lies exactly on one of another material */
} ImprintReport;

/* Counts the face's fate in *out and lists it; pieces: how many it has now, 0: it is gone. */
bool imprint_report(ImprintReport *report, const ImprintParts *parts, uint32_t face,
                    const ImprintFate *fate, uint32_t pieces, Imprint *out, Error *err);
/* The face is left whole though others touch it. */
bool imprint_report_left(ImprintReport *report, const ImprintParts *parts, uint32_t part,
                         const ImprintContacts *contacts, Imprint *out, Error *err);
void imprint_tell(const ImprintReport *report, const Polygons *soup, const Imprint *out,
                  const Monitor *monitor);

/* imprint_cut.c: cuts a part; at most about `most` pieces. */
bool imprint_cut(ImprintKnife *knife, uint32_t part, const ImprintContacts *contacts,
                 uint32_t most);
void imprint_knife_clear(ImprintKnife *knife);

/* imprint_seams.c: lets corners of some pieces into the edges of others they lie on, and marks the
 * edges that lie under a line. */
bool imprint_seams(const ImprintPieces *pieces, const Vec3 *position, const ImprintLine *line,
                   uint32_t lines, double tolerance, ImprintPieces *out, Error *err);

#endif
