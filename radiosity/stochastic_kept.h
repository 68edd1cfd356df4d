/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_kept.h -- what a stochastic run has gathered so far: saved between rounds,
 * taken up again later.
 *
 * Handed to stochastic_solve in StochasticOptions.kept, which copies into it all that the next
 * round depends on, after shooting and after each round. Its monitor's `progress` may save that at
 * any time. A run that is given what another one kept goes on with the round after it, and ends
 * with the same bytes.
 * Memory   106 bytes per patch.
 * Threads  only from within `progress` of the call that was given it.
 */
#ifndef RADIOSITY_STOCHASTIC_KEPT_H
#define RADIOSITY_STOCHASTIC_KEPT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "radiosity/room.h"

typedef struct StochasticKept StochasticKept;

/* owns   the caller frees with stochastic_kept_destroy.
 * fails  NULL; ERROR_MEMORY. */
StochasticKept *stochastic_kept_create(Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
StochasticKept *stochastic_kept_destroy(StochasticKept *kept);

/* What was kept, as bytes that stay the kept one's; NULL: nothing yet. */
void *stochastic_kept_bytes(const StochasticKept *kept, size_t *size);
/* The same bytes for a run over `count` patches: owned from now on, also after a failure.
 * fails  false when they cannot be of such a run. */
bool stochastic_kept_load(StochasticKept *kept, void *bytes, size_t size, uint32_t count);

/* --- for stochastic_solve --------------------------------------------------------------------- */

enum { STOCHASTIC_SERIES = 4 };

/* What the next round depends on. */
typedef struct {
    uint64_t rays;                       /* cast */
    double   escaped[ROOM_BANDS];
    double   unshot, quantum;
    uint32_t count, batches, rounds;
    uint32_t round_rays;                 /* of half a round; 0: there are none */
} StochasticHead;

/* Where a run has the rest: light in its halves, direct and indirect [count * bands]; rays that met
 * nothing, that told something, and are to be cast to lamps [count]. */
typedef struct {
    double   *power[STOCHASTIC_SERIES];
    float    *missed, *told;
    uint16_t *sights;
} StochasticPlaces;

/* Makes room, so that putting cannot fail.
 * fails  false; ERROR_MEMORY. */
bool stochastic_kept_begin(StochasticKept *kept, uint32_t count, Error *err);
void stochastic_kept_put(StochasticKept *kept, const StochasticHead *head,
                         const StochasticPlaces *from);
/* Copies back what was loaded or put; false: there is nothing. */
bool stochastic_kept_get(const StochasticKept *kept, StochasticHead *head,
                         const StochasticPlaces *to);

#endif
