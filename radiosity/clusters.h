/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters.h -- hierarchical radiosity without stored factors of patches:
 * B = E + rho (H0 + F B) over links between clusters.
 *
 * A tree whose leaves are the patches, whose inner nodes are pieces of surfaces and clusters of
 * several [hanrahan91; smits94]. Two nodes are joined by a link whose factor a few visibility rays
 * between points of both tell; where light, factor and what the rays leave uncertain amount to too
 * much of the mean irradiance, the link gives way to two between smaller nodes, which keep the rays
 * that fall to them. Links are refined as light comes to where they begin, with a threshold that
 * sinks until the sum of what all leave uncertain is below the tolerance. What rows of links lack
 * of 1 is given to links by their uncertainty.
 * With importance [smits92] links count by how much of the light that they carry ends up on patches
 * that are seen: what each patch means to the picture is sent over the same links backwards.
 * Memory   16 bytes a link (three times that while links are refined), some 200 a patch; rows of
 *          patches are never made.
 * Units    E, B exitance; H irradiance; three bands.
 * Threads  made in parallel, same bytes for any number.
 */
#ifndef RADIOSITY_CLUSTERS_H
#define RADIOSITY_CLUSTERS_H

#include "radiosity/clusters_kept.h"
#include "radiosity/stochastic.h"

typedef struct {
    double   tolerance;  /* of the estimated error; 0: 0.02 */
    uint32_t rays;       /* per patch, most for links; 0: 256 */
    uint32_t gather;     /* hemisphere rays of each patch in the last reflection; 0: none, light
                            stays as links between clusters have it */
    uint32_t sights;     /* rays to lamps of each patch then */
    uint64_t memory;     /* bytes that links may take while they are refined; 0: no limit */
    const double *seen;  /* [patches]  weight of each patch's radiosity in what the camera receives;
                            NULL: all patches count by their areas */
    uint32_t seed;
    unsigned threads;
    void   (*trace)(void *user, const SolveStep *step); /* after each round of refining: residual is
                                                            the estimated error */
    void    *trace_user;
    /* asked before each round for what is wanted by then, in place of tolerance and rays; NULL: it
     * stays */
    void   (*wish)(void *user, double *tolerance, uint32_t *rays);
    void    *wish_user;
    ClustersKept *kept;  /* what the run goes on from, and keeps; NULL: neither */
} ClustersOptions;

typedef struct {
    double   error;      /* estimated: root mean square over areas (or by importance), relative to
                            the mean of irradiance, were links' errors independent */
    double   noise;      /* of the last reflection, in the same measure; then `error` counts what
                            links have wrong as far as it is reflected once more, and this */
    double   scale[ROOM_BANDS]; /* that what patches gathered last was multiplied with, for power to
                            balance; 1 without */
    double   rows;       /* root mean square of what rows and escape lacked of 1 before they were
                            closed */
    double   escaped[ROOM_BANDS]; /* power, of what patches sent */
    double   response[ROOM_BANDS], adjoint[ROOM_BANDS]; /* with importance: sum of seen * B, and of
                            importance * (E + rho H0): the same but for what was not yet spread */
    uint64_t rays, gather_rays, links; /* rays of links, and of the last reflection */
    uint64_t bytes;      /* of links and nodes, the most at a time */
    uint32_t groups;     /* that light was evened out over in the last reflection */
    uint32_t nodes, rounds;
    uint32_t gathered_patches; /* those that took part in it: with importance, what is of some */
    bool     guided;     /* by importance */
    bool     gathered;   /* the last reflection was asked for and done */
    bool     full;       /* no more links fitted into the memory */
} ClustersReport;

/* The problem's bands are ROOM_BANDS. In the solution iterations are sweeps over the links,
 * residual the power that one more would move, error_bound NAN; converged: the estimated error is
 * below the tolerance.
 * owns   the caller frees with solution_destroy.
 * fails  NULL; ERROR_MEMORY. A stop by the monitor gives what there is, not converged. */
Solution *clusters_solve(const Room *room, const OpenPlaces *places, const SolveProblem *problem,
                         const ClustersOptions *options, ClustersReport *report,
                         const Monitor *monitor, Error *err);

#endif
