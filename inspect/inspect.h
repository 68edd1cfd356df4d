/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/inspect.h -- what is wrong with a scene's geometry, beyond what connecting it shows.
 *
 * Adds to the list of defects that surfaces_repair has begun: open edges (joined into rims),
 * faces that pass through each other or overlap in one plane, and parts inside solids.
 *
 * Touching is no defect: a box that stands on a floor, a wall that ends at another. Of two faces in
 * one plane only those count that look the same way with a side in use; back to back they are the
 * contact of two bodies. Curved faces are tested neither for crossings nor for overlaps.
 * Threads  searches run in parallel; the same list for any number.
 */
#ifndef INSPECT_INSPECT_H
#define INSPECT_INSPECT_H

#include "base/monitor.h"
#include "mesh/defects.h"
#include "mesh/surfaces.h"

/* A closed chain of open edges: the border of a hole, or of an open sheet. */
typedef struct {
    uint32_t edges;
    double   length;
    Vec3     lo, hi;      /* its box */
    uint32_t face;        /* polygon at its first edge */
    bool     flat;        /* lies in a plane: a hole that one polygon could fill */
} Rim;

/* An edge of one face only, or the piece of it between two corners of others that lie on it. */
typedef struct {
    uint32_t from, to;    /* vertices of Surfaces, along the front's winding */
    uint32_t triangle;    /* that has it */
} OpenEdge;

/* A connected part. */
typedef struct {
    uint32_t surfaces;
    uint32_t first;       /* its first surface */
    bool     closed;
    bool     seen;        /* some side of it is in use */
    double   area;
    double   volume;      /* signed: positive when fronts look out of it; 0 when it is open */
    Vec3     lo, hi;
} Part;

typedef struct {
    Rim      *rim;        /* [rim_count]  longest first, at most `keep` of them */
    size_t    rim_count;
    uint64_t  rims;       /* all */
    uint64_t  bordered;   /* curved faces that end somewhere: discs, cylinder and cone coats */
    OpenEdge *edge;       /* [open_edges] */
    uint64_t  open_edges;
    Part     *part;       /* [parts] */
    uint32_t  parts, closed_parts;
    uint32_t  hidden;     /* surfaces with no side in use, from `sides` */
    uint32_t  hurried;    /* triangles whose crossings were not all looked for: too many */
    uint32_t  unplaced;   /* parts not told to be inside a solid or not: too much around them */
    double    seconds;
} Inspection;

typedef struct {
    const uint8_t *sides;    /* [surfaces->count] as sides_find gives them; NULL: not known */
    size_t         keep;     /* rims kept; 0: all */
    unsigned       threads;
} InspectOptions;

/* Adds open edges in the order of their surfaces; crossings and overlaps once for each pair of
 * faces, deepest first, with the depth as measure; parts in their order, with the length of their
 * box's diagonal.
 * defects  may be NULL.
 * owns   the caller frees with inspection_clear.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool inspect(const Surfaces *surfaces, const InspectOptions *options, Defects *defects,
             Inspection *inspection, const Monitor *monitor, Error *err);
void inspection_clear(Inspection *inspection);

#endif
