/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_part.h -- what the steps of patches_part hand to each other; its files only.
 */
#ifndef MESH_PATCHES_PART_H
#define MESH_PATCHES_PART_H

#include "mesh/patches_internal.h"

/* A patch to be: a cell, or a part of one. */
typedef struct {
    uint32_t cell, part; /* part PATCH_NONE: the whole cell */
    uint32_t parent, order;
} PatchRow;

typedef struct {
    PatchBuilder  *b;
    const Patches *old;          /* what was divided, or NULL */
    uint32_t      *parent;       /* [cells.count]  of the cells; NULL without old */
    Patches        cells;        /* as they were: arrays that are made anew */
    PartedCell     cell;         /* the one at hand */
    uint32_t       part_parent[PARTS_ROOM]; /* of its parts */
    uint32_t      *parted_of;    /* [cells.count]  index into parted, or PATCH_NONE */
    uint32_t      *number;       /* [cells.count]  new number of a cell, or of one of its parts */
    double        *area;         /* of parts */
    PatchRow      *row;          /* [rows] */
    uint32_t       rows, slicers;/* slicers: in out->part_slicer */
    size_t         row_capacity, parted_capacity, part_capacity, area_capacity, slicer_capacity;
} PatchParter;

/* patches_part_face.c: faces of all patches: of whole cells as they were, of parts what lies on
 * their own side of everything. */
bool patches_part_faces(PatchParter *p);

#endif
