/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/defects.h -- a list of what is wrong with a scene's faces, and whether it was repaired.
 *
 * The stages that find a defect add it; all are counted, the first of each kind are kept.
 */
#ifndef MESH_DEFECTS_H
#define MESH_DEFECTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

#define DEFECT_NO_FACE UINT32_MAX

typedef enum {
    DEFECT_DEGENERATE,     /* face without area: left out */
    DEFECT_NONFINITE,      /* face with a corner that is not a finite number: left out */
    DEFECT_DUPLICATE,      /* face exactly on another, wound like it: left out when repaired */
    DEFECT_BACK_TO_BACK,   /* face exactly on another, wound the other way: made one two-sided
                              plate; nothing wrong by itself */
    DEFECT_NONPLANAR,      /* corners off the face's plane by more than rounding: cut into
                              triangles, which counts as repaired */
    DEFECT_CROSSING,       /* outline crosses itself */
    DEFECT_NONMANIFOLD,    /* an edge of more than two faces */
    DEFECT_T_JUNCTION,     /* a corner inside another face's edge */
    DEFECT_WINDING,        /* wound against its neighbours */
    DEFECT_UNORIENTABLE,   /* no winding of its part agrees everywhere (a Moebius strip) */
    DEFECT_REFUSED,        /* the half-edge mesh would not take it: kept, unlinked */
    DEFECT_OPEN_EDGE,      /* an edge of one face only: the rim of a hole or of an open sheet */
    DEFECT_INTERSECTION,   /* two faces pass through each other */
    DEFECT_OVERLAP,        /* two faces in one plane cover a common piece */
    DEFECT_INSIDE_SOLID,   /* a part that lies wholly inside a closed part */
    DEFECT_MATERIAL,       /* face exactly on another, wound like it, of another material: of the
                              two the one that gives light stays, else the first of the file */
    DEFECT_CUT,            /* face cut where another stands on it or passes through it; nothing
                              wrong by itself */
    DEFECT_COVERED,        /* face wholly under others in its plane: left out */
    DEFECT_COVERED_PART,   /* face in part under others in its plane: that part is left out */
    DEFECT_CONTACT_LEFT,   /* face not cut where others stand on it: too many pieces */
    DEFECT_KINDS
} DefectKind;

typedef struct {
    DefectKind kind;
    bool       repaired;
    uint32_t   face;       /* polygon of the file; polygon_count + k: shape k */
    uint32_t   other;      /* second face concerned, or DEFECT_NO_FACE */
    Vec3       at;         /* a place of it */
    double     measure;    /* length of an open edge, distance off the plane, ...; 0: none */
} Defect;

typedef struct {
    Defect  *item;                   /* [count]  in the order found */
    size_t   count, capacity;
    size_t   keep;                   /* most of each kind that are kept; 0: all */
    uint64_t found[DEFECT_KINDS];    /* all, kept or not */
    uint64_t repaired[DEFECT_KINDS];
} Defects;

/* An empty list is { 0 }. list may be NULL: nothing happens.
 * fails  false and ERROR_MEMORY. */
bool defects_add(Defects *list, const Defect *defect, Error *err);
/* Counts all of a kind as left as they are. */
void defects_leave(Defects *list, DefectKind kind);
/* Frees everything inside, leaves { 0 }. */
void defects_clear(Defects *list);
/* "t-junction", ...: for reports and JSON keys. */
const char *defect_name(DefectKind kind);

#endif
