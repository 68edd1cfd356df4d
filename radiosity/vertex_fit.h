/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/vertex_fit.h -- what the value at a vertex is made of; this folder only.
 *
 * A plane is laid through the values at the centres of the patches that share the vertex, by least
 * squares, near ones weighing more: on a grid the mean of four, and with patches of several sizes
 * still exact where the light changes linearly. At rims and creases, and inside merged patches, the
 * patches at the vertex do not surround it: their neighbours on the same smooth side join in, and
 * the plane is followed outwards.
 * Threads  never changes once made.
 */
#ifndef RADIOSITY_VERTEX_FIT_H
#define RADIOSITY_VERTEX_FIT_H

#include "mesh/patches.h"

enum { FIT_MAX = 64 }; /* patches that one vertex looks at */

typedef struct {
    const Patches *patches;
    const double  *area;         /* [patches->count]  visible */
    Vec3          *centre;       /* [patches->count]  centroids */
    double        *extent;       /* [patches->count]  area of a square that reaches as far */
    uint32_t      *first_patch;  /* [vertex_count + 1] */
    uint32_t      *patch;        /* [first_patch[vertex_count]]  that have this vertex, each once */
    uint32_t      *first_near;   /* [patches->count + 1] */
    uint32_t      *near;         /* [first_near[count]]  visible patches with a vertex in common */
} VertexFit;

typedef struct {
    uint32_t count;              /* 0: no visible patch in sight */
    uint32_t patch[FIT_MAX];
    double   weight[FIT_MAX];    /* sum 1; some may be negative */
    bool     inside;             /* the patches surround the vertex: nothing is extrapolated */
} FitRow;

/* area  [patches->count]  visible area of patches; those with 0 are passed over.
 * fails  false and ERROR_MEMORY; vertex_fit_clear is allowed then. */
bool vertex_fit_create(VertexFit *fit, const Patches *patches, const double *area, Error *err);
void vertex_fit_clear(VertexFit *fit);
void vertex_fit_row(const VertexFit *fit, uint32_t vertex, FitRow *row);

/* How many faces a patch has, from face_of on. */
static inline uint32_t vertex_fit_faces(const Patches *p, uint32_t patch)
{
    const uint32_t pieces = p->first_piece[patch + 1] - p->first_piece[patch];
    return pieces > 0 ? pieces : 1;
}

#endif
