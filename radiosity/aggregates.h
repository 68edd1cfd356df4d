/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/aggregates.h -- neighbouring patches taken together, and roughly how these groups see
 * each other: a small system beside the full one; this folder only.
 */
#ifndef RADIOSITY_AGGREGATES_H
#define RADIOSITY_AGGREGATES_H

#include "radiosity/internal.h"

typedef struct {
    uint32_t  count;      /* aggregates */
    uint32_t *of;         /* [patches]  aggregate of a patch */
    double   *area;       /* [count]  of all its patches */
    float    *factor;     /* [count * count]  share of what leaves one that arrives at another: the
                             mean over some rows */
} Aggregates;

/* At most some 2,000 aggregates: patches in one cell of a grid that face about the same way, or,
 * where the options have no centres and normals, that follow each other. Reads a few rows of each.
 * On failure to be cleared as well.
 * fails  false; ERROR_MEMORY. */
bool aggregates_create(Aggregates *a, const SolveSystem *system, Error *err);
void aggregates_clear(Aggregates *a);

#endif
