/* SPDX-License-Identifier: BSD-3-Clause */
/* app/quality.h -- the one knob: what a quality level stands for, finer options laid over it. */
#ifndef APP_QUALITY_H
#define APP_QUALITY_H

#include <stdio.h>

#include "app/options.h"
#include "inspect/imprint.h"
#include "mesh/surfaces.h"
#include "radiosity/links.h"
#include "raycast/bvh.h"
#include "radiosity/solve.h"

typedef struct {
    double   patch_size;     /* scene units; 0: from patches */
    uint32_t patches;
    bool     adapt;          /* divide where light changes, up to `patches` */
    double   least_size;     /* shortest patch edge of adapt; 0: a share of the greatest */
    SurfaceOptions repair;
    ImprintOptions imprint; /* but for the number of pieces and the list */
    BvhQuality tree;
    uint32_t rays, lamp_rays;
    double   accuracy;       /* standard error of factors between groups; of light, 0: not asked */
    Closure  closure;
    Solver   solver;
    bool     stochastic;     /* in its place, without links */
    bool     clusters;       /* instead of that, over links between clusters; then both are true */
    double   tolerance;
    uint32_t max_iterations; /* 0: no limit */
    uint32_t spp;
    uint32_t gather_rays;    /* per camera ray; for measure: per point */
    uint32_t record_rays;    /* per record of indirect light; 0: every camera ray gathers */
    double   error;          /* of pixels; 0: spp for each, whatever their noise */
    unsigned threads;        /* 0: one per core */
    uint32_t seed;
} Settings;

Settings quality_settings(const Options *options);

/* `name value` lines of what the command uses; values read back by the options of those names. */
void quality_print(FILE *out, const Options *options, const Settings *settings);

#endif
