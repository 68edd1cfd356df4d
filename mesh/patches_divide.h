/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/patches_divide.h -- what finding a patch size needs of the surfaces; this folder only. */
#ifndef MESH_PATCHES_DIVIDE_H
#define MESH_PATCHES_DIVIDE_H

#include "mesh/patches_internal.h"

typedef struct {
    double   u, v;             /* lengths to divide */
    uint16_t least_u, least_v;
    uint8_t  sides;            /* sides in use */
    bool     triangle;
} PatchExtent;

typedef struct {
    const Surfaces *surfaces;
    PatchExtent    *extent;        /* [count] */
    uint32_t        count;
    double          size;          /* found */
    uint32_t       *cluster;       /* [2 * count]  at that size, as merge_small says; may be NULL */
    uint32_t        cluster_count;
} Division;

/* How many of a surface's sides in use are cut on the grid. */
static inline uint32_t divide_unmerged(const Division *d, uint32_t surface)
{
    const uint32_t *cluster = d->cluster;
    if (cluster == NULL)
        return d->extent[surface].sides;
    return d->extent[surface].sides - (cluster[2 * surface] != PATCH_NONE)
         - (cluster[2 * surface + 1] != PATCH_NONE);
}

/* patches_divide.c: patches that there are at a size, with the clusters that d holds. A surface
 * with a side in a cluster is not divided on the other. */
double divide_count(const Division *d, double size);

/* patches_size.c: sets size and clusters from what the options ask for. */
bool divide_find_size(Division *d, const PatchOptions *options, Error *err);

#endif
