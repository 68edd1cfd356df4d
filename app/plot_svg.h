/* SPDX-License-Identifier: BSD-3-Clause */
/* app/plot_svg.h -- a few curves as a picture: logarithmic axes, labels, a legend. */
#ifndef APP_PLOT_SVG_H
#define APP_PLOT_SVG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct {
    const char   *name;
    size_t        count;
    const double *x, *y;   /* [count]  points with a value that is not above 0 are left out */
} PlotCurve;

typedef struct {
    const char *title, *x_label, *y_label;
    PlotCurve  *curve;     /* [curves] */
    size_t      curves;    /* the same in all panels: one legend tells them */
} PlotPanel;

/* Panels two to a row. An error of the stream is the caller's to see. */
void plot_svg(FILE *out, const char *title, const PlotPanel *panel, size_t panels);

#endif
