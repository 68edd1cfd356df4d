/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/gathered.h -- the gathered picture as the window deals with it: over the patches, until
 * the view moves. */
#ifndef VIEWER_GATHERED_H
#define VIEWER_GATHERED_H

#include <stdbool.h>

struct Viewer;

void gathered_ask(struct Viewer *viewer);
void gathered_drop(struct Viewer *viewer);
/* Once a frame, before it is drawn: drops it when the view or the lamps are others, hands new tiles
 * to the card. */
void gathered_work(struct Viewer *viewer);
/* Whether tiles are to come. */
bool gathered_awaited(const struct Viewer *viewer);
/* A bar of what is done, when there is any. */
void gathered_row(struct Viewer *viewer);

#endif
