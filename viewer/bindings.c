/* SPDX-License-Identifier: BSD-3-Clause */
/* Keys and mouse. */
#include "viewer/bindings.h"

#include <assert.h>
#include <ctype.h>
#include <string.h>

#define MOVING "Moving"
#define SOLVER "Solver"
#define LOOKING "Looking"
#define MEASURING "Measuring"
#define WINDOW "Pictures and window"

static const Binding TABLE[] = {
    { MOVING, ACTION_NONE, 0, 0, "left drag", "orbit round the target" },
    { MOVING, ACTION_NONE, 0, 0, "middle drag, Shift-left drag", "move sideways" },
    { MOVING, ACTION_NONE, 0, 0, "wheel", "towards the target and away" },
    { MOVING, ACTION_NONE, 0, 0, "right drag", "look round; W A S D Q E fly meanwhile" },
    { MOVING, ACTION_NONE, 0, 0, "double click", "make that the target" },
    { MOVING, ACTION_FLY, 'V', 0, "V", "fly: W A S D Q E without a button, Shift faster" },
    { MOVING, ACTION_FRAME_ALL, KEY_HOME, 0, "Home", "show all" },
    { MOVING, ACTION_FRAME_PICKED, 'F', 0, "F", "show the picked patch" },
    { MOVING, ACTION_VIEW, '1', 0, "1 .. 9", "go to a stored view" },
    { MOVING, ACTION_STORE_VIEW, '1', MOD_SHIFT, "Shift-1 .. 9", "store this view" },
    { MOVING, ACTION_CAMERA_BEFORE, '[', 0, "[", "the scene's camera before" },
    { MOVING, ACTION_CAMERA_NEXT, ']', 0, "]", "the scene's next camera" },
    { MOVING, ACTION_WIDER, '-', 0, "-", "wider field of view" },
    { MOVING, ACTION_NARROWER, '=', 0, "=", "narrower field of view" },
    { SOLVER, ACTION_PAUSE, KEY_SPACE, 0, "Space", "pause, go on" },
    { SOLVER, ACTION_STEP, '.', 0, ".", "one step, then pause; its patch and rays" },
    { SOLVER, ACTION_RESTART, 'R', MOD_CONTROL, "Ctrl-R", "from the beginning" },
    { SOLVER, ACTION_RELOAD, KEY_F5, 0, "F5", "read the scene again" },
    { LOOKING, ACTION_BRIGHTER, 'E', 0, "E", "brighter by a third of a stop" },
    { LOOKING, ACTION_DARKER, 'E', MOD_SHIFT, "Shift-E", "darker" },
    { LOOKING, ACTION_AUTO_EXPOSURE, 'A', 0, "A", "exposure by itself" },
    { LOOKING, ACTION_TONE, 'T', 0, "T", "next tone curve" },
    { LOOKING, ACTION_LAYER, 'L', 0, "L", "next layer" },
    { LOOKING, ACTION_SHADING, 'P', 0, "P", "smooth, patches, wires" },
    { LOOKING, ACTION_OUTLINES, 'M', 0, "M", "outlines of patches" },
    { LOOKING, ACTION_BACKS, 'N', 0, "N", "back faces hidden, red, grey" },
    { MEASURING, ACTION_NONE, 0, 0, "click", "read the patch there" },
    { MEASURING, ACTION_NONE, 0, 0, "Shift-click", "keep that as a probe" },
    { MEASURING, ACTION_FALSE_COLOUR, 'C', 0, "C", "false colours, and the panel of measuring" },
    { MEASURING, ACTION_FALSE_LAYER, 'C', MOD_SHIFT, "Shift-C", "false colours of the next layer" },
    { MEASURING, ACTION_FALSE_LOG, 'G', 0, "G", "legend linear, logarithmic" },
    { MEASURING, ACTION_ISOLINES, 'I', 0, "I", "isolines along the legend's values" },
    { MEASURING, ACTION_NONE, 0, 0, "drag the legend", "an end moves that end, the middle both" },
    { MEASURING, ACTION_REGION, 'X', 0, "X, then drag", "least, mean, greatest of a region" },
    { MEASURING, ACTION_PLANE, 'K', 0, "K", "work plane: Eav, Emin, U0" },
    { MEASURING, ACTION_SAVE_CSV, 'S', MOD_CONTROL, "Ctrl-S", "probes and work plane to CSV" },
    { WINDOW, ACTION_GATHER, 'R', 0, "R", "gather a picture of this view" },
    { WINDOW, ACTION_SAVE_PNG, 'S', 0, "S", "save it as PNG, or the window" },
    { WINDOW, ACTION_SAVE_EXR, 'S', MOD_SHIFT, "Shift-S", "save the view as EXR" },
    { WINDOW, ACTION_CHANGE, 'U', 0, "U", "lamps and paint: change them" },
    { WINDOW, ACTION_PANELS, KEY_TAB, 0, "Tab", "panels away and back" },
    { WINDOW, ACTION_HELP, KEY_F1, 0, "F1", "these keys" },
    { WINDOW, ACTION_LEAVE, KEY_ESCAPE, 0, "Esc", "leave a mode, drop the picture" },
    { WINDOW, ACTION_QUIT, 'Q', MOD_CONTROL, "Ctrl-Q", "quit" },
};
enum { COUNT = sizeof TABLE / sizeof *TABLE };

const Binding *bindings_table(size_t *count)
{
    assert(count != NULL);
    *count = COUNT;
    return TABLE;
}

Action bindings_find(int key, unsigned mods)
{
    const bool digit = key >= '1' && key <= '9';
    for (size_t i = 0; i < COUNT; i++)
        if (TABLE[i].key == (digit ? '1' : key) && TABLE[i].mods == mods && key != 0)
            return TABLE[i].action;
    return ACTION_NONE;
}

static const struct {
    const char *name;
    int         key;
} NAMED[] = {
    { "Space", KEY_SPACE }, { "Esc", KEY_ESCAPE }, { "Enter", KEY_ENTER }, { "Tab", KEY_TAB },
    { "Backspace", KEY_BACKSPACE }, { "Delete", KEY_DELETE }, { "Left", KEY_LEFT },
    { "Right", KEY_RIGHT }, { "Up", KEY_UP }, { "Down", KEY_DOWN }, { "Home", KEY_HOME },
    { "End", KEY_END }, { "PageUp", KEY_PAGE_UP }, { "PageDown", KEY_PAGE_DOWN },
    { "Shift", KEY_SHIFT },
};

static bool skip_prefix(const char **name, const char *prefix)
{
    const size_t n = strlen(prefix);
    if (strncmp(*name, prefix, n) != 0 || (*name)[n] == '\0')
        return false;
    *name += n;
    return true;
}

bool bindings_key(const char *name, int *key, unsigned *mods)
{
    assert(name != NULL && key != NULL && mods != NULL);
    *mods = 0;
    for (bool more = true; more;) {
        more = false;
        if (skip_prefix(&name, "Shift-"))
            *mods |= MOD_SHIFT, more = true;
        if (skip_prefix(&name, "Ctrl-"))
            *mods |= MOD_CONTROL, more = true;
        if (skip_prefix(&name, "Alt-"))
            *mods |= MOD_ALT, more = true;
    }
    for (size_t i = 0; i < sizeof NAMED / sizeof *NAMED; i++)
        if (strcmp(NAMED[i].name, name) == 0) {
            *key = NAMED[i].key;
            return true;
        }
    if (name[0] == 'F' && name[1] >= '1' && name[1] <= '9' && name[2] == '\0') {
        *key = KEY_F1 + name[1] - '1';
        return true;
    }
    *key = toupper((unsigned char)name[0]);
    return name[0] > ' ' && name[0] < 127 && name[1] == '\0';
}

void bindings_list(FILE *out)
{
    enum { WIDTH = 30 };
    const char *chapter = "";
    for (size_t i = 0; i < COUNT; i++) {
        if (strcmp(chapter, TABLE[i].chapter) != 0)
            fprintf(out, "%s%s\n", i > 0 ? "\n" : "", TABLE[i].chapter);
        chapter = TABLE[i].chapter;
        fprintf(out, "  %-*s%s\n", WIDTH, TABLE[i].name, TABLE[i].text);
    }
}
