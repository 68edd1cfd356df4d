/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/clusters_kept.h -- what a run over links between clusters has so far: saved between
 * rounds and during the last reflection, taken up again later.
 *
 * Handed to clusters_solve in ClustersOptions.kept, which copies into it all that the next round
 * depends on after each one, and finished patches of the last reflection. Its monitor's `progress`
 * may save that at any time. A run that is given what another one kept goes on from there, and ends
 * with the same bytes.
 * Memory   16 bytes a link, 24 per patch; 56 more for the last reflection; with importance 64.
 * Threads  only from within `progress` of the call that was given it.
 */
#ifndef RADIOSITY_CLUSTERS_KEPT_H
#define RADIOSITY_CLUSTERS_KEPT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

typedef struct ClustersKept ClustersKept;

/* owns   the caller frees with clusters_kept_destroy.
 * fails  NULL; ERROR_MEMORY. */
ClustersKept *clusters_kept_create(Error *err);
/* Frees; NULL is allowed. Always returns NULL. */
ClustersKept *clusters_kept_destroy(ClustersKept *kept);

/* What was kept, as bytes that stay the kept one's; NULL: nothing yet. */
void *clusters_kept_bytes(ClustersKept *kept, size_t *size);
/* The same bytes for a run over `patches` patches: owned from now on, also after a failure.
 * fails  false when they cannot be of such a run. */
bool clusters_kept_load(ClustersKept *kept, void *bytes, size_t size, uint32_t patches);

#endif
