/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/viewer.h -- the window: shows what the solver publishes until somebody closes it. */
#ifndef VIEWER_VIEWER_H
#define VIEWER_VIEWER_H

#include "render/image.h"
#include "viewer/control.h"
#include "viewer/pace.h"
#include "viewer/snapshot.h"

typedef struct {
    const char *scene;          /* name, for the title and for files that are saved */
    const char *command;        /* line that began it, for those files */
    int         width, height;  /* pixels */
    const char *script;         /* file, or NULL */
    const char *screenshot;     /* PNG of the last frame, or NULL */
    uint32_t    frames;         /* close after so many; 0: not by that */
    double      rate;           /* frames a second at all times; 0: when something changes */
    bool        no_panels;
    bool        solved;         /* out of a file: there is no solver */
    bool        exposure_set;
    double      exposure;       /* EV */
    ToneCurve   tone;
    bool        photometric;    /* lux and cd/m2, else W */
    double      unit_m;         /* metres of one scene unit */
    unsigned    threads;        /* for what is measured; 0: one per core */
} ViewerOptions;

/* Runs in the thread that called main until the window is closed, the script or the frames are
 * through, or control->failed. control->quit is set when it returns. pace: of pace_init; filled.
 * fails  false; ERROR_FAILED without a screen or OpenGL, ERROR_INPUT for the script. */
bool viewer_run(const ViewerOptions *options, Mailbox *mailbox, Control *control, Pace *pace,
                Error *err);

#endif
