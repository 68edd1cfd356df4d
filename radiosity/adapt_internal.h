/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt_internal.h -- direct light at points of a patch; for adapt*.c only. */
#ifndef RADIOSITY_ADAPT_INTERNAL_H
#define RADIOSITY_ADAPT_INTERNAL_H

#include "radiosity/adapt.h"
#include "radiosity/internal.h"

enum { ADAPT_POINTS = 16,    /* four in each quarter */
       ADAPT_PIECES = 4 };   /* of a source that is near for its size */

/* A point of a patch with its direct irradiance, luminance, estimated twice independently. */
typedef struct {
    uint32_t surface;
    float    s, t, weight;
    float    direct[2];
    float    indirect, total; /* by the patch's row, see adapt_spread; total: with direct light */
} AdaptPoint;

/* A flat piece of a patch as a source. */
typedef struct {
    Vec3   corner[4];
    int    corners;           /* 3 or 4 */
    double reflected;         /* light it sends on, luminance of B - E */
} AdaptPiece;

/* A patch's quarters; of a merged or parted patch, squares spread over it. reflected [vertices] is
 * what the vertices of patches send on. */
void adapt_pieces(const Room *room, const double *reflected, uint32_t patch, AdaptPiece *piece);

/* Share of the view from points that a source takes up by its pieces, added to kernel [count], and
 * that times the light of each piece, added to lit [count]. */
void adapt_pieces_seen(const AdaptPiece *piece, const PatchPoint *at, uint32_t count,
                       float *kernel, float *lit);

/* Share of the hemisphere that sources take up at each point, the light they reflect from there,
 * and what they emit. */
typedef struct {
    float share[ADAPT_POINTS], reflected[ADAPT_POINTS], own[ADAPT_POINTS];
} AdaptShares;

/* The points of a patch once more, coordinate by coordinate, and the light that sources bring. */
typedef struct {
    uint32_t count;
    Vec3     origin;          /* the first point; coordinates are relative to it */
    float    x[ADAPT_POINTS], y[ADAPT_POINTS], z[ADAPT_POINTS];
    float    nx[ADAPT_POINTS], ny[ADAPT_POINTS], nz[ADAPT_POINTS];
    float    weight[ADAPT_POINTS]; /* sum 1; 0 past count */
    AdaptShares near, far;    /* of sources near for their size, and of all others */
} AdaptField;

/* What one thread needs. */
typedef struct {
    const Room  *room;
    const Links *links;
    const float *radius;      /* [patches]  greatest distance of a corner from the centre */
    const AdaptPiece *piece;  /* [patches * ADAPT_PIECES] */
    uint32_t     seed, rays;  /* rays: per point and half */
    RowCast      cast;        /* tells positions inside solids, where a patch has such */
    PatchPoint   at[ADAPT_POINTS];
    AdaptField   field;
    uint32_t    *lamp;        /* [lamp_count]  lamps that the patch's row names */
    double      *cumulative;  /* [lamp_count]  and how much of its light comes from them */
    size_t       lamp_capacity, cumulative_capacity, lamp_count;
    Ray         *ray;         /* [capacity] */
    bool        *blocked;
    float       *value;
    uint32_t    *slot;        /* 2 * point + half that a ray adds to */
    uint32_t     aimed, capacity;
    double       spread;      /* of the last patch: variance of what single rays could bring,
                                 over their mean squared */
    bool         open;        /* none of its rays was blocked */
    Error        error;
} AdaptSampler;

/* rays  per patch, for both halves. */
bool adapt_sampler_create(AdaptSampler *sampler, const Room *room, const Links *links,
                          const float *radius, const AdaptPiece *piece, uint32_t rays,
                          uint32_t seed, Error *err);
void adapt_sampler_clear(AdaptSampler *sampler);
/* Fills up to ADAPT_POINTS points, those outside solids; returns how many. */
uint32_t adapt_sample(AdaptSampler *sampler, uint32_t patch, AdaptPoint *point);

/* Spreads a source that takes up `share` of the patch's view, with the light it reflects and emits,
 * over the points of `patch`, which adapt_sample chose last. */
void adapt_spread(AdaptSampler *sampler, uint32_t patch, uint32_t source, double share,
                  double reflected, double own);
/* Puts the light of all sources into the points, with `escape` of the view dark. The means shall be
 * those given. */
void adapt_collect(AdaptSampler *sampler, double escape, double indirect, double total,
                   uint32_t points, AdaptPoint *point);

#endif
