/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/script.h -- keys and mouse from a file, so that tests and pictures drive the real window.
 *
 * One command a line; # begins a comment:
 *   key NAME                 press and let go: key Shift-S
 *   hold NAME N              hold a key for N frames
 *   move X Y                 the pointer, in pixels from the upper left corner
 *   click BUTTON X Y         left, right or middle, or Shift-left ...; double BUTTON X Y
 *   drag BUTTON X Y X2 Y2    over some frames
 *   wheel N                  steps, away from you
 *   resize W H
 *   scale X                  as if the screen's scale were that: 1, 1.5, 2
 *   minimise | restore
 *   lose-context             as if the graphics card had lost all it held
 *   wait frames N | wait lit | wait shot | wait linked | wait solved
 *   wait seconds X           until so many have passed since the window was opened
 *   wait picture             until the one that R asked for is finished
 *   wait tiles X             until that share of it is, 0..1
 *   wait settled             until light has followed all that was changed, its error estimated
 *   wait said TEXT           until the window says a line with that in it
 *   screenshot FILE          PNG of the next frame
 */
#ifndef VIEWER_SCRIPT_H
#define VIEWER_SCRIPT_H

#include "viewer/easel.h"
#include "viewer/snapshot.h"
#include "viewer/window.h"

typedef struct Script Script;

/* fails  NULL; ERROR_INPUT with file and line. */
Script *script_read(const char *path, Error *err);
Script *script_destroy(Script *script);

/* What the window knows at the beginning of a frame. */
typedef struct {
    ShownStep step;         /* of what is shown */
    bool      finished;     /* the solver has ended: nothing more is to come */
    bool      settled;      /* light is solved for as lamps and paint are now */
    EaselState picture;
    double    tiles;        /* share of it that is finished */
    double    seconds;      /* since the window was opened */
    const char *notice;     /* the line that is shown last; "": none */
} ScriptState;

/* Does what is due before this frame. *screenshot: the name of a PNG to make of it, or NULL.
 * Returns false when the script is through. fails  false; a step that will never come. */
bool script_advance(Script *script, const ScriptState *state, Window *window,
                    const char **screenshot, Error *err);

/* Whether hands are at work: keys, buttons, the mouse. */
bool script_moves(const Script *script);
/* Whether the context is to be lost in this frame. */
bool script_loses_context(const Script *script);

#endif
