/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt.h -- which patches to divide so that the error falls most for the rays it costs.
 *
 * A patch carries one number, and its picture is what its vertices interpolate; what that leaves
 * out is estimated from irradiance at points inside it: direct light from lamps and point lights by
 * visibility rays from its quarters, indirect light from the solution of its neighbours. A shadow's
 * edge inside a patch shows as quarters that differ by more than their own noise.
 * Where a part of a patch lies inside a solid, only the rest counts.
 * Units    an error is a root mean square over the patch, of irradiance, luminance.
 */
#ifndef RADIOSITY_ADAPT_H
#define RADIOSITY_ADAPT_H

#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/solve.h"

typedef struct {
    double   least_size;  /* no patch is divided whose edge is shorter than twice this; 0: none */
    uint32_t rays;        /* visibility rays per patch to lamps; 0: 64 */
    uint32_t row_rays;    /* per row of the links, whose noise is no reason to divide; 0: 256 */
    uint32_t seed;
    unsigned threads;
} AdaptOptions;

/* error [patches->count] gets what dividing the patch would take away, area not weighed in; 0 for
 * patches that cannot be divided.
 * irradiance  [patches->count * ROOM_BANDS]  of the solution so far.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool adapt_errors(const Room *room, const Links *links, const double *irradiance,
                  const AdaptOptions *options, double *error, const Monitor *monitor, Error *err);

/* Marks in split [patches->count] the patches with the largest error^2 * area, so many that about
 * `wanted` patches result; none below `worth` times the mean. *chosen is how many.
 * fails  false and ERROR_MEMORY. */
bool adapt_choose(const Room *room, const double *error, uint32_t wanted, double worth,
                  uint8_t *split, uint32_t *chosen, Error *err);

#endif
