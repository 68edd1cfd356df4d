/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_relight.h -- light that follows the window's knobs, by links that are there. */
#ifndef APP_LIVE_RELIGHT_H
#define APP_LIVE_RELIGHT_H

#include "app/live.h"

/* What the problem was before any knob was turned, and what it is with them. */
typedef struct {
    unsigned version;      /* of the knobs that the solution is for */
    double  *emission, *reflectance, *direct; /* [3 * patches]  the scene's own */
    Knob    *knob;
    uint32_t knob_count;
} Relighting;

/* Once the pipeline is solved. fails  false; ERROR_MEMORY. */
bool relighting_begin(Relighting *relighting, Live *live, Error *err);
void relighting_end(Relighting *relighting);
/* Solves anew when a knob was turned since, and publishes; *done tells whether there was any.
 * fails  false; as relight. */
bool relighting_follow(Relighting *relighting, Live *live, bool *done, Error *err);

#endif
