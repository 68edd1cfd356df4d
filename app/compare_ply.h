/* SPDX-License-Identifier: BSD-3-Clause */
/* app/compare_ply.h -- how far one solution is from another on a different division of the scene.
 *
 * Points are spread over the reference by visible area, low-discrepancy; each is looked for on the
 * other mesh: the nearest face of the same group's name and side that looks the same way, no
 * further off than chords of a curved face may lie. At both, irradiance is interpolated between the
 * face's corners by mean value coordinates, or taken from the patch. Errors are root mean squares
 * of the difference in luminance over the points found, relative to the reference's mean there.
 */
#ifndef APP_COMPARE_PLY_H
#define APP_COMPARE_PLY_H

#include <stdbool.h>

#include "app/ply_read.h"

typedef struct {
    uint32_t samples;   /* 0: 100,000 */
    uint32_t seed;
    bool     constant;  /* patches' own values */
} CompareOptions;

typedef struct {
    double share;       /* of the points */
    double matched;     /* share of these that were found on the other mesh */
    double mean, other; /* irradiance, luminance, over the points found */
    double error;       /* root mean square of the difference, over `mean` of all groups */
} CompareRow;

typedef struct {
    CompareRow  all;
    CompareRow *group;  /* [group_count of the reference] */
    uint32_t    samples;
} MeshComparison;

/* owns   the caller frees with mesh_comparison_clear, in any case.
 * fails  false; ERROR_MEMORY; ERROR_INPUT when no point is found or the reference is dark. */
bool mesh_compare(const SolvedMesh *reference, const SolvedMesh *mesh,
                  const CompareOptions *options, MeshComparison *out, Error *err);
void mesh_comparison_clear(MeshComparison *comparison);

#endif
