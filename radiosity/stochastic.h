/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic.h -- light on very many patches without links: B = E + rho (H0 + F B) by
 * rays that carry power.
 *
 * All patches shoot what they have not shot yet at once, each ray the same share of it, until next
 * to nothing is left: stochastic relaxation [neumann95; bekaert99]. What lamps send straight to the
 * patches is found by visibility rays as well, and the two are weighed by the balance heuristic
 * [veach95]. Then each patch gathers, in rounds, what the others were found to send: rays over its
 * hemisphere, and rays to lamps, more of them where these are near or seen in part; patches that
 * stand together share nets of points. All is done in two halves with points of their own: how far
 * these differ tells the noise. Light is evened out over neighbouring patches, by the linear
 * functions of place that have the least estimated error.
 * Memory   some 300 bytes per patch, whatever the number of rays.
 * Units    E, B exitance; H irradiance; three bands.
 * Balance  each shot's power arrives or escapes; what lacks of the sum is what was never shot. What
 *          is gathered is scaled, by a number near 1 that the report tells, for the same to hold.
 * Threads  made in parallel, same bytes for any number.
 */
#ifndef RADIOSITY_STOCHASTIC_H
#define RADIOSITY_STOCHASTIC_H

#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/solve.h"
#include "radiosity/stochastic_kept.h"

/* Which places of patches are outside solids. */
typedef struct {
    Links    *links;  /* rows without links: visible area, escaped share (by few rays), rays */
    uint64_t *open;   /* [links->count]  bit 8 j + k: places (a, b) in [j, j+1) x [k, k+1) / 8 */
} OpenPlaces;

/* Judges the places of all patches as links are cast: by what rays from there meet.
 * owns   cleared with open_places_clear.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool open_places_find(const Room *room, uint32_t seed, unsigned threads, OpenPlaces *places,
                      const Monitor *monitor, Error *err);
void open_places_clear(OpenPlaces *places);

typedef struct {
    double   tolerance;  /* of the estimated error; 0: 0.02 */
    uint32_t rays;       /* per patch, most in all; 0: 256 */
    uint32_t seed;
    unsigned threads;
    bool     apart;      /* do not even out over neighbours */
    void   (*trace)(void *user, const SolveStep *step); /* after shooting, after each round:
                                                            residual is the estimated error */
    void    *trace_user;
    /* asked before each round for what is wanted by then, in place of tolerance and rays; NULL: it
     * stays */
    void   (*wish)(void *user, double *tolerance, uint32_t *rays);
    void    *wish_user;
    StochasticKept *kept;    /* what the run goes on from, and keeps; NULL: neither */
} StochasticOptions;

typedef struct {
    double   error;      /* estimated: root mean square over areas, relative to the mean of
                            irradiance; noise, and what evening out did to light itself */
    double   scale[ROOM_BANDS]; /* that irradiance was scaled by for power to balance */
    double   escaped[ROOM_BANDS]; /* power, of what patches sent */
    uint64_t rays;       /* cast */
    uint32_t groups;     /* that light was evened out over */
} StochasticReport;

/* The problem's bands are ROOM_BANDS. In the solution iterations are batches and halves of
 * rounds, residual and unshot the power never shot, error_bound NAN; converged: the estimated
 * error is below the tolerance.
 * Where not even one pair of batches may be cast, one is.
 * owns   the caller frees with solution_destroy.
 * fails  NULL; ERROR_MEMORY. A stop by the monitor gives what there is, not converged. */
Solution *stochastic_solve(const Room *room, const OpenPlaces *places, const SolveProblem *problem,
                           const StochasticOptions *options, StochasticReport *report,
                           const Monitor *monitor, Error *err);

#endif
