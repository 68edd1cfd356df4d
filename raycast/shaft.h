/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/shaft.h -- what a tree holds within a convex body: shaft culling [haines94].
 *
 * A body is what lies on the inner side of all of its planes.
 */
#ifndef RAYCAST_SHAFT_H
#define RAYCAST_SHAFT_H

#include "raycast/bvh.h"

/* Points p with dot(normal, p) >= offset are inside; normal is a unit vector. */
typedef struct {
    Vec3   normal;
    double offset;
} Plane;

/* Called with each primitive whose box may reach into the body; false ends the search. */
typedef bool (*ShaftVisit)(void *user, uint32_t primitive);

/* Visits, once each (in a tree of BVH_HIGH perhaps more often), all primitives with area that reach
 * into the body by more than `slack` from every one of its planes, and perhaps others near it. The
 * order is that of the tree.
 * returns false when a visit ended the search. */
bool bvh_shaft(const Bvh *bvh, const Plane *plane, uint32_t planes, double slack,
               ShaftVisit visit, void *user);

#endif
