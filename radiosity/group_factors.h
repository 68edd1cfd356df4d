/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/group_factors.h -- form factors between a few classes of surfaces, each pair by the
 * best estimator, with standard errors.
 *
 * Classes (groups of the scene, materials) are made of sides of surfaces; each pair of sides that
 * are flat and convex is treated on its own:
 *   AWAY     they do not face each other: 0
 *   EXACT    nothing reaches into their hull (shaft culling [haines94]): the integral along their
 *            outlines (math/polygon_factor.h), to about 1e-10
 *   CLIPPED  a few polygons do: points all over the one, and from each of them what is seen of the
 *            other, exactly (math/sight.h); the un-occluded value serves as a control variate
 * and what remains (curved faces, many blockers, too many sides to go through in pairs) together:
 *   RAYS     hemisphere rays from all classes; both directions are combined by their variances
 * Points and rays come from 16 independent scramblings of a net, and what these disagree by is the
 * standard error. Points and rays are doubled where errors are larger than asked for;
 * rays go on with their nets, none is cast anew.
 * A F is symmetric by construction. Units: areas are scene units^2.
 * Threads  made in parallel, the same bytes for any number.
 */
#ifndef RADIOSITY_GROUP_FACTORS_H
#define RADIOSITY_GROUP_FACTORS_H

#include "base/error.h"
#include "base/monitor.h"
#include "radiosity/room.h"

typedef enum { GROUP_AWAY, GROUP_EXACT, GROUP_CLIPPED, GROUP_RAYS, GROUP_KINDS } GroupKind;

/* More classes than this are not done: their sums of 16 scramblings would not fit. */
enum { GROUP_CLASSES_MOST = 512 };

typedef struct {
    uint32_t        count;       /* classes, 1 .. GROUP_CLASSES_MOST */
    const uint32_t *patch_class; /* [patches]  < count */
    double          accuracy;    /* standard error of factors that is asked for, > 0 */
    uint64_t        most_rays;   /* about; at least a first round is cast */
    double          trusted;     /* standard error that is worth more rays than that, up to */
    uint64_t        trusted_rays;/* this many; 0, 0: none */
    uint32_t        seed;
    unsigned        threads;
} GroupOptions;

typedef struct {
    uint32_t count;
    double  *exchange;           /* [count * count]  A_i F_ij, symmetric bit for bit */
    double  *error;              /* [count * count]  its standard error */
    uint8_t *kinds;              /* [count * count]  bit k: pairs of GroupKind k are in it */
    double  *area, *area_error;  /* [count]  visible: outside other solids */
    double  *escape, *escape_error; /* [count]  share that meets nothing */
    uint64_t pairs[GROUP_KINDS]; /* of sides, by estimator; RAYS: those not treated singly */
    uint64_t rays, points;       /* cast; points that looked at a clipped polygon */
    double   asked, reached;     /* accuracy: the greatest standard error of a factor */
    double   seconds;
} GroupFactors;

/* owns   the caller frees with group_factors_destroy.
 * fails  NULL; ERROR_MEMORY, ERROR_STOPPED. */
GroupFactors *group_factors_create(const Room *room, const GroupOptions *options,
                                   const Monitor *monitor, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
GroupFactors *group_factors_destroy(GroupFactors *factors);

/* F from class i to class j, in [0, 1], and its standard error, the rounding to float that factors
 * are stored with included. A class without area has none. */
double group_factor(const GroupFactors *factors, uint32_t i, uint32_t j);
double group_factor_error(const GroupFactors *factors, uint32_t i, uint32_t j);

#endif
