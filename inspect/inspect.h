/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/inspect.h -- what is wrong with a scene's geometry, beyond what connecting it shows.
 *
 * Adds to the list of defects that surfaces_repair has begun: open edges (joined into rims),
 * faces that pass through each other or overlap in one plane, and parts inside solids.
 * Threads  searches run in parallel; the same list for any number.
 */
#ifndef INSPECT_INSPECT_H
#define INSPECT_INSPECT_H

#include "base/monitor.h"
#include "mesh/defects.h"
#include "mesh/surfaces.h"
#include "raycast/bvh.h"

/* A closed chain of open edges: the border of a hole, or of an open sheet. */
typedef struct {
    uint32_t edges;
    double   length;
    Vec3     lo, hi;      /* its box */
    uint32_t face;        /* polygon at its first edge */
    bool     flat;        /* lies in a plane: a hole that one polygon could fill */
} Rim;

typedef struct {
    Rim     *rim;         /* [rim_count]  longest first, at most `keep` of them */
    size_t   rim_count;
    uint64_t rims;        /* all */
    uint64_t open_edges;
    uint32_t parts, closed_parts;
    uint32_t hidden;      /* surfaces with no side in use, from `sides` */
    double   seconds;
} Inspection;

typedef struct {
    const uint8_t *sides;    /* [surfaces->count] as sides_find gives them; NULL: not known */
    size_t         keep;     /* rims kept; 0: all */
    unsigned       threads;
} InspectOptions;

/* owns   the caller frees with inspection_clear.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool inspect(const Surfaces *surfaces, const Polygons *soup, const Bvh *bvh,
             const InspectOptions *options, Defects *defects, Inspection *inspection,
             const Monitor *monitor, Error *err);
void inspection_clear(Inspection *inspection);

#endif
