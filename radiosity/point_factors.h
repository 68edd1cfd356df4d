/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/point_factors.h -- how a point sees its surroundings: form factors from a small plane
 * element to classes of patches (groups, materials).
 *
 * The share of what leaves the element, or as well of what arrives at it from an even
 * surrounding, that is due to each class: cosine-weighted rays on independently scrambled nets,
 * whose spread gives the standard errors.
 */
#ifndef RADIOSITY_POINT_FACTORS_H
#define RADIOSITY_POINT_FACTORS_H

#include "base/error.h"
#include "base/monitor.h"
#include "radiosity/room.h"

typedef struct {
    uint32_t        rays;      /* per point */
    uint32_t        seed;
    unsigned        threads;
    uint32_t        classes;
    const uint32_t *class_of;  /* [patches]  < classes */
} PointFactorsOptions;

/* factor, error [count * (classes + 2)]: a row per point: classes, what meets nothing, what meets
 * sides that take no part. Rows of factor sum to 1; error holds standard errors.
 * fails  false; ERROR_STOPPED, ERROR_MEMORY. */
bool point_factors(const Room *room, const Vec3 *point, const Vec3 *normal, uint32_t count,
                   const PointFactorsOptions *options, double *factor, double *error,
                   const Monitor *monitor, Error *err);

#endif
