/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/relight.h -- another light from links that are there already: no ray is cast.
 *
 * Two ways. What changed only in emission is a sum of light groups solved apart, each times its
 * dimmer: light adds up. Anything else is solved for again, from the old solution on, which takes a
 * few passes over the links.
 * Units, bands, residuals as in radiosity/solve.h.
 * Threads  same bytes for any number.
 */
#ifndef RADIOSITY_RELIGHT_H
#define RADIOSITY_RELIGHT_H

#include "radiosity/solve.h"

/* The solution of the new problem, from that of another with the same links and the irradiance
 * `received` from outside [count * bands], or NULL. options: as for solve; its `start` is not
 * looked at. The two-level solver takes the fewest passes and the shortest. The bound on the error
 * is found when `before` has what it needs (it was asked for there): only rows of what reflects
 * otherwise are read for it.
 * owns, fails  as solve. */
Solution *relight(const Links *links, const SolveProblem *problem, const Solution *before,
                  const double *received, const SolveOptions *options, const Monitor *monitor,
                  Error *err);

/* --- light groups ----------------------------------------------------------------------------- */

/* One lamp, or some that are dimmed together. */
typedef struct {
    const double *emission;   /* [count * bands]; NULL: none */
    const double *received;   /* [count * bands]  irradiance from outside; NULL: none */
} LightGroup;

/* Solutions with one group alight at a time. */
typedef struct {
    uint32_t  count, groups;
    unsigned  bands;
    double   *radiosity;      /* [groups * count * bands] */
    double   *irradiance;     /* [groups * count * bands] */
    uint32_t  iterations;     /* of the slowest */
    double    residual;       /* the largest of a group, relative to the group's own power */
    bool      converged;      /* all did */
    double    drift;          /* the largest: see Solution */
    double    seconds;
} LightGroups;

/* Solves for each group, some at a time: all their bands in one pass over the links.
 * reflectance  [count * bands]
 * owns         the caller frees with light_groups_destroy.
 * fails        NULL; as solve. A stop by the monitor: ERROR_STOPPED. */
LightGroups *light_groups_solve(const Links *links, unsigned bands, const double *reflectance,
                                const LightGroup *group, uint32_t groups,
                                const SolveOptions *options, const Monitor *monitor, Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
LightGroups *light_groups_destroy(LightGroups *groups);

/* The groups as bytes, for a checkpoint.
 * owns   the caller frees *bytes with array_free.
 * fails  false; ERROR_MEMORY. */
bool light_groups_pack(const LightGroups *groups, void **bytes, size_t *size, Error *err);
/* And back. fails  NULL: they are no groups of `count` patches; or ERROR_MEMORY. */
LightGroups *light_groups_unpack(const void *bytes, size_t size, uint32_t count, Error *err);

/* *out = the sum of all groups, each times its dimmer [groups * bands] >= 0. out is a solution of
 * that many patches and bands; its residual becomes the groups' own, of which it is a mean; its
 * bound follows where it has `reflected` of the same reflectance. */
void light_groups_mix(const LightGroups *groups, const double *dimmer, unsigned threads,
                      Solution *out);

#endif
