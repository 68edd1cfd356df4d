/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/exchange.h -- heat between grey surfaces: from form factors to net flux.
 *
 * A few surfaces (groups), each diffuse, grey, of one emissivity and one temperature. With
 * J_i = eps_i sigma T_i^4 + (1 - eps_i) sum_j F_ij J_j what leaves surface i,
 *   G_ij   share of what i emits that is absorbed at j, by whatever ways (Gebhart's absorption
 *          factors [gebhart61]): G_ij = eps_j F_ij + sum_k (1 - eps_k) F_ik G_kj
 *   Fs_ij  exchange factor script-F of Hottel [hottel67], eps_i G_ij: the net power from i to j is
 *          A_i Fs_ij sigma (T_i^4 - T_j^4), and A_i Fs_ij = A_j Fs_ji
 * What escapes meets a black surrounding: the last column where there is one.
 * Units    power per area in W/m2 for temperatures in K; areas in any unit.
 * Threads  plain functions of their arguments.
 */
#ifndef RADIOSITY_EXCHANGE_H
#define RADIOSITY_EXCHANGE_H

#include <stddef.h>

#include "base/error.h"

/* W/m2/K4, exact in SI since 2019 to the digits given. */
#define EXCHANGE_STEFAN_BOLTZMANN 5.670374419e-8

typedef struct {
    size_t        count;       /* surfaces */
    const double *factor;      /* [count * count]  F of row to column */
    const double *escape;      /* [count]  share that meets nothing; NULL: none */
    const double *emissivity;  /* [count]  0 < eps <= 1 */
} ExchangeProblem;

/* gebhart and hottel: [count * count]; either may be NULL. With escape the rows of gebhart sum to 1
 * less what goes out, else to 1 as well as the rows of F do.
 * fails  false; ERROR_MEMORY; ERROR_INPUT for values out of range. */
bool exchange_factors(const ExchangeProblem *problem, double *gebhart, double *hottel, Error *err);

/* flux [count]: net power that each surface takes in, per area (absorbed less emitted), W/m2.
 * temperature [count] in K; surroundings: temperature that what escapes meets.
 * fails  as above. */
bool exchange_flux(const ExchangeProblem *problem, const double *temperature, double surroundings,
                   double *flux, Error *err);

#endif
