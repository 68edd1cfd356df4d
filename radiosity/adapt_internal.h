/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt_internal.h -- direct light at points of a patch; for adapt*.c only. */
#ifndef RADIOSITY_ADAPT_INTERNAL_H
#define RADIOSITY_ADAPT_INTERNAL_H

#include "radiosity/adapt.h"
#include "radiosity/internal.h"

enum { ADAPT_POINTS = 16 }; /* four in each quarter */

/* A point of a patch with its direct irradiance, luminance, estimated twice independently. */
typedef struct {
    uint32_t surface;
    float    s, t, weight;
    float    direct[2];
} AdaptPoint;

/* What one thread needs. */
typedef struct {
    const Room  *room;
    const Links *links;
    uint32_t     seed, rays;  /* rays: per point and half */
    RowCast      cast;        /* tells positions inside solids, where a patch has such */
    PatchPoint   at[ADAPT_POINTS];
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
                          uint32_t rays, uint32_t seed, Error *err);
void adapt_sampler_clear(AdaptSampler *sampler);
/* Fills up to ADAPT_POINTS points, those outside solids; returns how many. */
uint32_t adapt_sample(AdaptSampler *sampler, uint32_t patch, AdaptPoint *point);

#endif
