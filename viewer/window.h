/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/window.h -- a window of the system with a way to draw in it, and what happens to it.
 *
 * Places are in pixels of the picture, from its upper left corner, whatever the screen's scale.
 * Threads  the one that called main.
 */
#ifndef VIEWER_WINDOW_H
#define VIEWER_WINDOW_H

#include <stdbool.h>

#include "base/error.h"

typedef enum {
    EVENT_KEY, EVENT_CHARACTER, EVENT_BUTTON, EVENT_MOVE, EVENT_WHEEL, EVENT_CLOSE,
    EVENT_SCALE /* window_scale is another */
} EventKind;

enum { BUTTON_LEFT, BUTTON_RIGHT, BUTTON_MIDDLE, BUTTON_COUNT };

typedef struct {
    EventKind kind;
    int       code;     /* key, character, button */
    bool      down;
    unsigned  mods;     /* MOD_... */
    double    x, y;     /* pointer; EVENT_WHEEL: steps */
} Event;

typedef struct Window Window;

/* Opens it with an OpenGL 3.3 core context, current in this thread.
 * owns   the caller closes with window_destroy.
 * fails  NULL; ERROR_FAILED with one line when there is no screen or no such OpenGL. */
Window *window_create(const char *title, int width, int height, Error *err);
Window *window_destroy(Window *window);
/* A new window in its place, with a new context that holds nothing yet; events stay.
 * fails  false; ERROR_FAILED. */
bool window_renew(Window *window, Error *err);
/* Collects events, for `seconds` at most when there are none. */
void window_wait(Window *window, double seconds);
/* The next event, in order; false: no more. */
bool window_next(Window *window, Event *event);
/* Adds one as if it had happened. */
void window_push(Window *window, const Event *event);
/* Pixels; 0 x 0 while minimised. */
void window_size(const Window *window, int *width, int *height);
void window_resize(Window *window, int width, int height); /* at least 1 x 1 */
void window_minimise(Window *window, bool away);
/* Pixels of the picture for one of text on a plain screen. */
double window_scale(const Window *window);
/* For scripts: as if the screen's scale were that. */
void window_set_scale(Window *window, double scale);
/* Shows what was drawn. */
void window_show(Window *window);
/* Seconds since the window opened. */
double window_time(void);

#endif
