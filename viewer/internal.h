/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/internal.h -- the window's state, shared by the files of this folder. */
#ifndef VIEWER_INTERNAL_H
#define VIEWER_INTERNAL_H

#include "viewer/bindings.h"
#include "viewer/gl.h"
#include "viewer/layout.h"
#include "viewer/measuring.h"
#include "viewer/script.h"
#include "viewer/viewer.h"
#include "viewer/window.h"

enum { STORED_VIEWS = 9 };

typedef struct {
    bool   down[BUTTON_COUNT];
    bool   key[KEY_MOST];
    bool   over_panel;     /* where the button went down: the movement belongs to it */
    double x, y;           /* pointer */
    double press_x, press_y, press_time;
    double click_time, click_x, click_y; /* of the last click, for double ones */
    bool   flying;         /* without a button */
} Pointer;

typedef struct Viewer {
    const ViewerOptions *options;
    Mailbox    *mailbox;
    Control    *control;
    Pace       *pace;
    Window     *window;
    Gl         *gl;
    Script     *script;        /* NULL: none */
    Snapshot   *shown;         /* NULL: nothing yet */
    GlView      view;
    bool        automatic;     /* exposure follows what is seen */
    bool        exposure_due;  /* it must be found again */
    bool        panels, help;
    LaidPanel   panel[PANEL_COUNT];
    bool        folded[PANEL_COUNT]; /* as laid last */
    bool        changing;      /* lamps and paint are open */
    bool        has_gui;
    bool        rescaled;      /* the screen's scale is another */
    bool        lose_context;  /* a script wants it lost */
    bool        close, dirty;  /* dirty: the picture is not what it should be any more */
    bool        at_home;       /* the camera was never set */
    uint32_t    camera_number;
    Camera      stored[STORED_VIEWS];
    bool        is_stored[STORED_VIEWS];
    Pointer     pointer;
    Vec3        picked_at;
    Measuring   measuring;
    unsigned    picture_seen;   /* changes of the easel that the card holds */
    unsigned    picture_knobs;  /* version of the knobs when it was asked for */
    Report      report;
    bool        restarted;     /* what is shown is from before the solver began anew */
    bool        settled;       /* what is shown is solved for the knobs as they stand */
    unsigned    sayings;       /* of the solver's that were heard */
    char        notice[256];
    double      notice_until;
    double      last_frame, frame_seconds; /* the latter a running mean */
    uint32_t    frame;
    char        screenshot[4096]; /* to be made of this frame; "": none */
    bool        by_key;           /* and it is to be told */
} Viewer;

/* --- input.c ---------------------------------------------------------------------------------- */
void input_event(Viewer *viewer, const Event *event);
/* Flying, once a frame. */
void input_fly(Viewer *viewer, double seconds);
void viewer_act(Viewer *viewer, Action action, int key);
void viewer_say(Viewer *viewer, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* --- pick.c ----------------------------------------------------------------------------------- */

/* The patch whose lit side is seen at a pixel; PATCH_NONE: none. *at: the place. */
uint32_t pick(const Viewer *viewer, double x, double y, Vec3 *at);
/* The same, and the triangle: hit->primitive. */
uint32_t pick_hit(const Viewer *viewer, double x, double y, Hit *hit, Vec3 *at);
/* Exposure (EV) that puts what is seen at mid grey, lamps left out. */
double pick_exposure(const Viewer *viewer);

/* --- renew.c ---------------------------------------------------------------------------------- */

/* What lives on the card: programs, buffers, the panels' font. fails  false; ERROR_FAILED,
 * ERROR_MEMORY; renew_leave is due all the same. */
bool renew_open(Viewer *viewer, Error *err);
void renew_leave(Viewer *viewer);
/* Before each frame: makes all of it anew when the context is lost, in a new window; and the panels
 * for a screen of another scale. fails  false; as renew_open. */
bool renew_if_lost(Viewer *viewer, Error *err);

/* --- panels.c --------------------------------------------------------------------------------- */
void panels_draw(Viewer *viewer);
/* A panel where it was laid; between them its rows, if the first says true. Returns the y below. */
bool panel_begin(Viewer *viewer, PanelId id, const char *title);
double panel_end(Viewer *viewer, PanelId id);
/* marks_shot.c: the patch that shot last. */
void marks_shot(const Viewer *viewer);
/* panels_change.c: lamps and paint, at the right. */
void panels_change(Viewer *viewer);

#endif
