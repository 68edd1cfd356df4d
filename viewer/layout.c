/* SPDX-License-Identifier: BSD-3-Clause */
/* Panels in one column or two, folded where these are too short. */
#include "viewer/layout.h"

#include <assert.h>
#include <math.h>

static const double MARGIN = 8, GAP = 6;
/* No panel is narrower, whatever the window is. */
static const double WIDTH_LEAST = 32;

/* Those that are folded first come first. */
static const PanelId fold_order[PANEL_COUNT] = { PANEL_MEASURE, PANEL_VIEW, PANEL_SOLVER,
                                                 PANEL_CHANGE, PANEL_PATCH };

static bool at_right(PanelId id) { return id >= PANEL_MEASURE; }

static double height_of(const LayoutSize *size, const LaidPanel *p)
{
    return p->fold ? size->title : fmax(size->title, p->need);
}

/* Height of those of a column, from one of them on. */
static double sum_of(const LayoutSize *size, const LaidPanel *panel, const bool in[PANEL_COUNT],
                     int from)
{
    double sum = 0;
    for (int k = from; k < PANEL_COUNT; k++)
        if (in[k])
            sum += height_of(size, &panel[k]) + (sum > 0 ? GAP : 0);
    return sum;
}

static void lay_column(const LayoutSize *size, LaidPanel panel[PANEL_COUNT],
                       const bool in[PANEL_COUNT], double x, double width)
{
    const double end = size->height - MARGIN;
    double y = MARGIN;
    int open = 0;
    for (int k = 0; k < PANEL_COUNT; k++)
        open += in[k];
    for (int k = 0; k < PANEL_COUNT && open > 1; k++)
        if (in[fold_order[k]] && sum_of(size, panel, in, 0) > end - MARGIN) {
            panel[fold_order[k]].fold = true;
            open--;
        }
    for (int k = 0; k < PANEL_COUNT; k++) {
        if (!in[k])
            continue;
        const double after = sum_of(size, panel, in, k + 1);
        LaidPanel *p = &panel[k];
        p->x = x;
        p->y = y;
        p->width = width;
        p->room = fmax(2 * size->title, end - y - (after > 0 ? after + GAP : 0));
        y += fmin(height_of(size, p), p->room) + GAP;
    }
}

void layout_panels(const LayoutSize *size, LaidPanel panel[PANEL_COUNT])
{
    bool left[PANEL_COUNT], right[PANEL_COUNT];
    assert(size->title > 0 && size->left > 0 && size->right > 0);
    const double whole = fmax(WIDTH_LEAST, size->width - 2 * MARGIN);
    const bool two = size->width >= size->left + size->right + 2 * MARGIN + GAP;
    for (int k = 0; k < PANEL_COUNT; k++) {
        panel[k].fold = false;
        left[k] = panel[k].there && (!two || !at_right((PanelId)k));
        right[k] = panel[k].there && !left[k];
    }
    lay_column(size, panel, left, MARGIN, fmin(size->left, whole));
    lay_column(size, panel, right, size->width - MARGIN - size->right, size->right);
}
