/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/light_check.h -- how far light on patches is off, found by paths of its own.
 *
 * Patches are chosen evenly over area. To each, light is followed back in two independent halves:
 * rays over the hemisphere and to lamps, weighed by the balance heuristic [veach95], on from where
 * they came to, ended by roulette. Nothing of what the solver found is used. The product of what
 * the solution differs by from both halves is the square of its error on average, without their
 * own noise; its scatter over patches tells how well that is known.
 * Light    of surfaces that emit. What point lights bring is taken as the problem has it.
 *          Paths leave from the place a ray came to: what coarse patches do to light is an error.
 * Threads  same figures for any number.
 */
#ifndef RADIOSITY_LIGHT_CHECK_H
#define RADIOSITY_LIGHT_CHECK_H

#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/solve.h"

typedef struct {
    uint32_t patches;    /* > 0, chosen; large patches more than once */
    uint32_t rays;       /* > 0, paths from each of them in each half */
    uint32_t seed;
    unsigned threads;
} LightCheckOptions;

/* Root mean square over area of irradiance's error (luminance), over the mean of all irradiance. */
typedef struct {
    double found;          /* 0 where the mean of the products is not positive */
    double standard_error; /* how much larger it is where the mean square is by one of its own */
} LightError;

typedef struct {
    LightError all, direct, reflected;
    bool     apart;      /* direct and reflected are known: the solution has them, or links do */
    double   worst;      /* share in the mean square of the patches, one in a hundred, that have the
                            most of it; near 1: few patches decide, and may be missed */
    double   mean;       /* irradiance of what was chosen */
    uint32_t patches, rays;
    uint64_t cast;
} LightCheck;

/* links: of the patches, with their visible areas; their rows may be empty. The problem's bands are
 * ROOM_BANDS. room->mirrors must not be set: paths do not go on at mirrors.
 * fails  false; ERROR_MEMORY, ERROR_STOPPED. */
bool light_check(const Room *room, const Links *links, const SolveProblem *problem,
                 const Solution *solution, const LightCheckOptions *options, LightCheck *check,
                 const Monitor *monitor, Error *err);

#endif
