/* SPDX-License-Identifier: BSD-3-Clause */
/* render/caustics_internal.h -- photons between those that trace and those that find them. */
#ifndef RENDER_CAUSTICS_INTERNAL_H
#define RENDER_CAUSTICS_INTERNAL_H

#include "render/caustics.h"

typedef struct {
    float    at[3], face[3]; /* where; unit, to the side that it came to */
    float    flux[3];
    uint32_t group;          /* of lights (render/split.h); 0: they are not told apart */
} Photon;

struct Caustics {
    Photon  *photon; /* [count]  a tree: the middle of a range splits it */
    uint8_t *axis;   /* [count]  along this axis */
    uint32_t count;
    double   reach;  /* no photon farther than this counts */
};

/* Brings the photons into the order of the tree. */
void caustics_sort(Caustics *caustics);

#endif
