/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/layers.h -- what false colour can show: one number for each patch.
 *
 * Units    as their labels say; luminous values: weights of BT.709. NAN: nothing to show there.
 */
#ifndef VIEWER_LAYERS_H
#define VIEWER_LAYERS_H

#include "viewer/snapshot.h"

typedef enum {
    SHOWN_RADIOSITY,
    SHOWN_IRRADIANCE,
    SHOWN_DIRECT,
    SHOWN_INDIRECT,    /* irradiance less what comes straight from lamps and lights */
    SHOWN_UNSHOT,
    SHOWN_RESIDUAL,    /* |B - rho H|: how far a patch is from balance; not known of lamps */
    SHOWN_ERROR,
    SHOWN_REFLECTANCE,
    SHOWN_FACTORS,     /* from the picked patch to each */
    SHOWN_COUNT
} ShownLayer;

/* "radiosity", ... */
const char *layer_name(ShownLayer layer);
/* "lm/m2", or its radiometric name; "" for shares of 1. */
const char *layer_unit(ShownLayer layer, bool lux);
/* Whether the snapshot has what it is made from; SHOWN_FACTORS: whether a patch is picked. */
bool layer_known(const Snapshot *snapshot, ShownLayer layer, bool picked);
/* Of one patch; not of SHOWN_FACTORS. The layer must be known. */
double layer_value(const Snapshot *snapshot, ShownLayer layer, uint32_t patch);
/* out [mesh->patch_count]; factors: [patch_count] of layer_factors, for SHOWN_FACTORS alone. The
 * layer must be known. */
void layer_fill(const Snapshot *snapshot, ShownLayer layer, const float *factors, float *out);

/* Form factors from a patch to all others into out [mesh->patch_count], by cosine-weighted rays
 * from all over it, a share of 1 each; their sum is 1 less what escapes.
 * fails  false; ERROR_MEMORY. */
bool layer_factors(const ShownMesh *mesh, uint32_t patch, uint32_t rays, float *out, Error *err);

#endif
