/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint.h -- faces cut along the lines where others stand on them or pass through them.
 *
 * One radiosity per patch means that light which arrives on one side of a wall would leave on the
 * other when a patch lies under both. So each flat face is cut where the edge of another touches
 * it, or another crosses it, before anything is divided: discontinuity meshing of order zero
 * [heckbert92]. What lies inside a solid becomes a face of its own that no ray reaches. Where two
 * faces lie in one plane and look the same way, the larger one gives up the part in common. So it
 * does when they look opposite ways and the smaller one lies on it: as the bottom of an open thing
 * that stands before it, or a sheet that could be seen from nowhere else, as a rug wound downwards;
 * else, and when the corners are the same, they are the sides of a plate. To a sheet of light that
 * is no side of a plate any face that gives none gives way. A body that gives light all round and
 * touches a wall gives way itself: it neither opens the wall nor shines through it; unless it is
 * outside, sunk into the wall of an enclosed place. Of two faces with the same corners, wound
 * alike, the one that gives light stays, else the first.
 *
 * Cuts run on across the whole face where that makes few pieces, so that the pieces of a rectangle
 * are rectangles, edge to edge; otherwise only as far as they must.
 * Not cut: faces so small that millions would come of it. Curved faces, and faces that curved ones
 * meet, stay whole here: their patches are parted, exactly along the curve (imprint_curved).
 */
#ifndef INSPECT_IMPRINT_H
#define INSPECT_IMPRINT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "base/monitor.h"
#include "mesh/defects.h"
#include "mesh/polygons.h"
#include "mesh/surfaces.h"

typedef struct {
    uint32_t most;        /* pieces to be added, all in all; 0: 20,000 */
    bool     keep_whole;  /* faces are cut only for others that lie in their plane */
    bool     keep_covered;/* no face gives way to others in its plane */
    Defects *defects;     /* NULL, or gets what was cut, gave way or was left, face by face, for all
                             but faces that lie exactly on another: surfaces_repair lists those */
} ImprintOptions;

typedef struct {
    Polygons soup;        /* the faces, cut; the first piece of each that is not covered
                             altogether, in their order, then the other pieces. Materials, groups
                             and shapes belong to the original, which must outlive this;
                             soup.contact is filled in */
    uint32_t *face;       /* [soup.polygon_count]  polygon of the original */
    size_t   original;    /* polygons of the original */
    uint32_t cut;         /* faces that were cut */
    uint32_t pieces;      /* that were added */
    uint32_t covered;     /* faces that gave way, in part or wholly, to others in their plane */
    uint32_t overlapped;  /* of these, those that gave way to others than lamps: this is told */
    uint32_t replaced;    /* of these, those exactly on one of another material: told as well */
    double   covered_area;/* of theirs, left out */
    uint32_t left;        /* faces not cut where others touch: there would be too many pieces */
} Imprint;

/* options  NULL: defaults.
 * owns     the caller frees with imprint_clear.
 * fails    false; ERROR_MEMORY, ERROR_STOPPED. */
bool imprint_create(const Polygons *soup, const ImprintOptions *options, Imprint *imprint,
                    const Monitor *monitor, Error *err);
void imprint_clear(Imprint *imprint);

/* Makes surfaces of imprint->soup those of the original: faces get its numbers, and surfaces that
 * go on smoothly below a standing face are no neighbours any more, so that no patch grows and no
 * value is smoothed across. */
void imprint_finish(const Imprint *imprint, Surfaces *surfaces);

/* Finds where curved surfaces meet others: fills in surfaces->slicer, cut and cut_first, once.
 * fails  false; ERROR_MEMORY. */
bool imprint_curved(Surfaces *surfaces, const Monitor *monitor, Error *err);

#endif
