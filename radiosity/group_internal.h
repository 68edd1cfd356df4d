/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_internal.h -- what the files of group factors share. */
#ifndef RADIOSITY_GROUP_INTERNAL_H
#define RADIOSITY_GROUP_INTERNAL_H

#include "math/sight.h"
#include "radiosity/group_factors.h"
#include "radiosity/internal.h"
#include "raycast/shaft.h"

/* Independent scramblings; a Student distribution of 15 degrees of freedom has 67 % within one and
 * 99.1 % within three. */
enum { GROUP_SCRAMBLES = 16 };

/* One side of a surface. */
typedef struct {
    uint32_t      surface, class;
    bool          flat;     /* convex and flat: `polygon` and what follows are filled */
    ConvexPolygon polygon;  /* counter-clockwise seen from the side */
    Vec3          normal;
    double        offset, area;
} GroupSide;

/* Polygons between two sides: what of them lies before both. */
enum { GROUP_BLOCKERS = 24 };

/* Points of each scrambling that look at a clipped polygon at first. */
enum { GROUP_POINTS_FIRST = 32 };

/* Rays of each patch and scrambling in the first round; four positions at least. */
enum { GROUP_RAYS_FIRST = 16 };

/* What a point takes, in rays. */
static inline double group_point_cost(uint32_t blockers) { return 1 + 0.5 * blockers; }

/* A pair of sides with blockers. */
typedef struct {
    uint32_t i, j, blockers;             /* sides; polygons between them */
    double   open;                       /* A F if nothing were between them */
    double   exchange[GROUP_SCRAMBLES];  /* A F */
    double   least_error;                /* no estimate is known better */
    uint32_t points;                     /* of each scrambling */
    bool     given_up;                   /* left to rays */
} ClippedPair;

typedef struct {
    const Room         *room;
    const GroupOptions *options;
    const Monitor      *monitor;
    unsigned            threads;
    double              slack;      /* lengths below are taken for 0 */
    GroupSide          *side;       /* [sides] */
    uint32_t            sides;
    uint32_t           *side_of;    /* [2 * surfaces]  number of surface's front, back */
    uint8_t            *kind;       /* [sides * sides] of GroupKind, or NULL: all by rays */
    double             *value;      /* [sides * sides]  A F if nothing were between */
    uint8_t            *between;    /* [sides * sides]  blockers of CLIPPED */
    ClippedPair        *clipped;    /* [clipped_count] */
    uint32_t            clipped_count;
    uint32_t           *crowd;      /* [classes * classes]  clipped pairs in it */
    double             *class_area; /* [classes]  whole */
    double             *fixed;      /* [classes * classes]  sum of what is exact */
    double             *sum;        /* [SCRAMBLES * classes^2]  by rays, from row to column */
    double             *away;       /* [SCRAMBLES * classes]  escape * area */
    double             *seen;       /* [SCRAMBLES * classes]  visible area */
    uint32_t           *rays;       /* [classes]  per patch and scrambling */
    uint64_t           *cast;       /* [classes]  rays of all patches and scramblings */
    uint8_t            *again;      /* [classes]  to be cast with more rays */
    GroupFactors       *out;
} Grouping;

/* group_sides.c: which sides there are, and their polygons. */
bool group_sides_create(Grouping *g, Error *err);
/* Polygon of a surface, counter-clockwise from its front; false: not flat or not convex. */
bool group_polygon(const Surfaces *surfaces, uint32_t surface, double slack, ConvexPolygon *out);

/* group_pairs.c: what is exact, what is clipped. */
bool group_pairs_find(Grouping *g, Error *err);
/* Blockers of a pair of sides: false when there are too many, or curved ones. */
bool group_blockers(const Grouping *g, const GroupSide *p, const GroupSide *q,
                    ConvexPolygon blocker[GROUP_BLOCKERS], uint32_t *count);
/* What of p lies before q's plane. */
ConvexPolygon group_before(const GroupSide *p, const GroupSide *q);

/* group_clipped.c: points and what they see. */
bool group_clipped_run(Grouping *g, Error *err);

/* group_rays.c: casts the classes marked `again`. */
bool group_rays_run(Grouping *g, Error *err);

#endif
