/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/layout.h -- where panels stand, however small the window is.
 *
 * What the solver does, the view and the picked patch stand in a column at the left, one below the
 * other; measuring, or lamps and paint, at the right, or at the end of the same column where the
 * window has no width for two. Where a column is too short, panels are folded to their titles, the
 * picked patch and what was opened by a key last; one that is too long by itself scrolls.
 * Knows no window: sizes in, places out, all in pixels.
 */
#ifndef VIEWER_LAYOUT_H
#define VIEWER_LAYOUT_H

#include <stdbool.h>

typedef enum { PANEL_SOLVER, PANEL_VIEW, PANEL_PATCH, PANEL_MEASURE, PANEL_CHANGE, PANEL_COUNT }
    PanelId;

typedef struct {
    bool   there;
    double need;            /* height that all of it takes; 0: not known yet */
    /* found */
    double x, y, width;
    double room;            /* height that it may take */
    bool   fold;
} LaidPanel;

/* Measures of one screen. */
typedef struct {
    double width, height;   /* of the window */
    double title;           /* height of a panel that is folded */
    double left, right;     /* widths of the columns */
} LayoutSize;

/* Fills what is found of all panels that are there. */
void layout_panels(const LayoutSize *size, LaidPanel panel[PANEL_COUNT]);

#endif
