/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/triangulate.h -- a polygon cut into triangles that fill it exactly.
 *
 * Concave polygons, any number of corners, holes joined to the outline by a bridge (its two corners
 * then come twice), corners in line, corners a little off the plane: all are cut from corner to
 * corner, so neighbours still share whole edges. This folder only.
 * Method   ear clipping [meisters75] in the plane of Newell's normal, fattest ear first; with very
 *          many corners in turn, and a tree of boxes to find what lies in an ear.
 */
#ifndef MESH_TRIANGULATE_H
#define MESH_TRIANGULATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

typedef struct CutCorner CutCorner;

/* The result for one polygon, and room that is used again for the next. Starts as { 0 }. */
typedef struct {
    uint32_t  *triangle;   /* [3 * count]  vertices, wound like the polygon */
    size_t     count, capacity;
    uint32_t   dropped;    /* triangles without area that were left out; all of it: count is 0 */
    bool       quad;       /* count is 2 and they are (a,b,c), (a,c,d) of a convex quad */
    bool       crossing;   /* the outline crosses itself: the triangles are a guess */
    CutCorner *ring;
    size_t     ring_capacity;
} Triangulation;

/* position[corner[i]] are finite.
 * fails  false and ERROR_MEMORY. */
bool triangulate(Triangulation *cut, const Vec3 *position, const uint32_t *corner, uint32_t count,
                 Error *err);
/* Frees everything inside, leaves { 0 }. */
void triangulation_clear(Triangulation *cut);

/* Newell's normal: its length is twice the polygon's area. */
Vec3 triangulate_normal(const Vec3 *position, const uint32_t *corner, uint32_t count);

/* Whether a triangle is thinner than its corners are known (position_tolerance): no area. */
bool triangulate_is_sliver(Vec3 a, Vec3 b, Vec3 c);

#endif
