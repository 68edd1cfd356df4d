/* SPDX-License-Identifier: BSD-3-Clause */
/* app/live_dimming.h -- lamps that are dimmed in the window: light adds up, so that what one knob
 * brings is solved for once, and from then on each turn of it is a sum over patches.
 */
#ifndef APP_LIVE_DIMMING_H
#define APP_LIVE_DIMMING_H

#include "app/live_relight.h"

/* Adds to the pipeline's solution, which is for the knobs as r->setting has them, what lamps bring
 * more or less by `setting`, and turns the scene to it. *could is false, and nothing has changed,
 * where that is no sum: paint was turned, or there are no links.
 * fails  false; ERROR_MEMORY, or as solve. */
bool dimming_follow(Relighting *r, Pipeline *p, const KnobSetting *setting, bool *could,
                    Error *err);
/* What knobs bring is for another paint. */
void dimming_forget(Relighting *r);

#endif
