/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_relight.h -- light that follows the window's knobs: by links that are there, or solved
 * for anew where the solver has none.
 *
 * What is turned is changed in the scene itself, so that pictures gathered later see it. Lamps of a
 * group get materials of their own for that; of point lights those that are turned are cast once
 * more by themselves.
 */
#ifndef APP_LIVE_RELIGHT_H
#define APP_LIVE_RELIGHT_H

#include "app/live.h"

/* The scene before any knob was turned. */
typedef struct {
    unsigned  version;      /* of the knobs that the solution is for */
    Knob     *knob;         /* [knob_count] */
    uint32_t  knob_count;
    uint32_t  materials;    /* with those that groups have for themselves */
    Rgb      *emission, *reflectance;  /* [materials] */
    uint32_t *lamp, *paint; /* [materials]  knob, or UINT32_MAX */
    Rgb      *intensity;    /* [lights] */
    uint32_t *light;        /* [lights]  knob, or UINT32_MAX */
    double   *direct;       /* [3 * patches]  what arrives from point lights; NULL: nothing */
    bool      moving;       /* the solution is rough: a knob was turned lately, at `turned` */
    double    turned;
    double  **alone;        /* [knob_count]  from those of one knob; NULL: not cast yet */
    KnobSetting setting;    /* that the solution is for */
    Solution **brings;      /* [knob_count]  light of one knob; NULL: not solved for yet */
} Relighting;

/* Once the pipeline is solved. fails  false; ERROR_MEMORY. */
bool relighting_begin(Relighting *relighting, Live *live, Error *err);
void relighting_end(Relighting *relighting);
/* Solves anew when a knob was turned since, and publishes; *done tells whether there was any. Saves
 * what was turned when that was asked for, and tells the window how it went.
 * fails  false; as relight. */
bool relighting_follow(Relighting *relighting, Live *live, bool *done, Error *err);
/* When there is nothing to follow: solves further for another tolerance, estimates errors; *done
 * tells whether there was any. fails  false; as relight. */
bool relighting_rest(Relighting *relighting, Live *live, bool *done, Error *err);
/* Turns the scene, and what patches emit, reflect and receive from point lights, to `setting`.
 * fails  false; ERROR_MEMORY. */
bool relighting_turn(Relighting *relighting, Pipeline *pipeline, const KnobSetting *setting,
                     Error *err);

#endif
