/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh/weld.h -- positions that mean one point become one vertex.
 *
 * Two positions are one point when they are no further apart than the smaller of their tolerances;
 * tolerances differ, so that a huge ground plane does not swallow small things that stand on it.
 * This folder only.
 */
#ifndef MESH_WELD_H
#define MESH_WELD_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "math/vec3.h"

#define WELD_NONE UINT32_MAX

typedef struct {
    uint32_t *vertex;       /* [count]  position's vertex; WELD_NONE: unused or not finite */
    Vec3     *position;     /* [vertex_count]  of the first position that became this vertex */
    uint32_t  vertex_count;
    uint32_t  welded;       /* positions that fell together with an earlier one */
} Weld;

/* tolerance  [count]  scene units, >= 0; < 0: the position is not used.
 * fails      false and ERROR_MEMORY; *weld is then empty. */
bool weld_create(Weld *weld, const Vec3 *position, const double *tolerance, uint32_t count,
                 Error *err);
/* Frees everything inside, leaves { 0 }. */
void weld_clear(Weld *weld);

#endif
