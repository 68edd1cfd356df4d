/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/bindings.h -- which key or mouse movement does what: the one table of it. */
#ifndef VIEWER_BINDINGS_H
#define VIEWER_BINDINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Keys are what they print, in capitals; all others as below (GLFW's numbers). */
enum {
    KEY_SPACE = 32, KEY_ESCAPE = 256, KEY_ENTER = 257, KEY_TAB = 258, KEY_BACKSPACE = 259,
    KEY_DELETE = 261, KEY_RIGHT = 262, KEY_LEFT = 263, KEY_DOWN = 264, KEY_UP = 265,
    KEY_PAGE_UP = 266, KEY_PAGE_DOWN = 267, KEY_HOME = 268, KEY_END = 269, KEY_F1 = 290,
    KEY_F5 = 294, KEY_SHIFT = 340, KEY_CONTROL = 341, KEY_MOST = 349
};
enum { MOD_SHIFT = 1, MOD_CONTROL = 2, MOD_ALT = 4 };

typedef enum {
    ACTION_NONE,           /* rows that only tell, such as mouse drags */
    ACTION_FLY, ACTION_FRAME_ALL, ACTION_FRAME_PICKED,
    ACTION_VIEW,           /* key 1..9: that stored view */
    ACTION_STORE_VIEW, ACTION_CAMERA_BEFORE, ACTION_CAMERA_NEXT, ACTION_WIDER, ACTION_NARROWER,
    ACTION_PAUSE, ACTION_STEP, ACTION_RESTART, ACTION_RELOAD,
    ACTION_BRIGHTER, ACTION_DARKER, ACTION_AUTO_EXPOSURE, ACTION_TONE, ACTION_LAYER,
    ACTION_SHADING, ACTION_OUTLINES, ACTION_BACKS,
    ACTION_FALSE_COLOUR, ACTION_FALSE_LAYER, ACTION_FALSE_LOG, ACTION_ISOLINES, ACTION_REGION,
    ACTION_PLANE, ACTION_SAVE_CSV,
    ACTION_GATHER, ACTION_SAVE_PNG, ACTION_SAVE_EXR, ACTION_CHANGE, ACTION_PANELS,
    ACTION_HELP, ACTION_LEAVE, ACTION_QUIT
} Action;

typedef struct {
    const char *chapter;   /* "Moving", ... */
    Action      action;
    int         key;       /* 0: not a key */
    unsigned    mods;
    const char *name;      /* "Shift-S", "left drag" */
    const char *text;      /* what it does */
} Binding;

const Binding *bindings_table(size_t *count);
/* What a key does; ACTION_NONE: nothing. */
Action bindings_find(int key, unsigned mods);
/* "Shift-S", "Home", "." to key and modifiers; false when there is none of that name. */
bool bindings_key(const char *name, int *key, unsigned *mods);
/* The table, for --list-bindings. */
void bindings_list(FILE *out);

#endif
