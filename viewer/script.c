/* SPDX-License-Identifier: BSD-3-Clause */
/* A script: read whole, then carried out a frame at a time. */
#include "viewer/script.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "viewer/bindings.h"

enum { NUMBERS = 4, WORD = 1024, LINE = 2048, DRAG_FRAMES = 8 };
/* What is said follows what was done within a second or so of frames; no line stays that long. */
static const double SAID_FRAMES = 1000;

typedef enum {
    DO_KEY, DO_HOLD, DO_MOVE, DO_CLICK, DO_DOUBLE, DO_DRAG, DO_WHEEL, DO_RESIZE, DO_SCALE,
    DO_MINIMISE, DO_RESTORE, DO_LOSE_CONTEXT, DO_WAIT_FRAMES,
    DO_WAIT_STEP, DO_WAIT_PICTURE, DO_WAIT_TILES, DO_WAIT_SETTLED,
    DO_WAIT_SECONDS, DO_WAIT_SAID, DO_SCREENSHOT
} What;

typedef struct {
    What     what;
    int      code;             /* key, button, ShownStep */
    unsigned mods;
    double   number[NUMBERS];
    char    *text;             /* owned, or NULL */
    unsigned line;
} Step;

struct Script {
    char  *path;
    Step  *step;               /* [count] */
    size_t count, capacity, at;
    double frame;              /* of a step that takes several */
};

/* --- reading ---------------------------------------------------------------------------------- */

/* Words of a command after its name: K key, B button, S step, F file, n number. */
static const struct {
    const char *name, *words;
    What        what;
} COMMANDS[] = {
    { "key", "K", DO_KEY }, { "hold", "Kn", DO_HOLD }, { "move", "nn", DO_MOVE },
    { "click", "Bnn", DO_CLICK }, { "double", "Bnn", DO_DOUBLE }, { "drag", "Bnnnn", DO_DRAG },
    { "wheel", "n", DO_WHEEL }, { "resize", "nn", DO_RESIZE }, { "wait", "S", DO_WAIT_STEP },
    { "screenshot", "F", DO_SCREENSHOT }, { "scale", "n", DO_SCALE },
    { "minimise", "", DO_MINIMISE }, { "restore", "", DO_RESTORE },
    { "lose-context", "", DO_LOSE_CONTEXT },
};

static int index_of(const char *word, const char *const *names, int count)
{
    for (int i = 0; i < count; i++)
        if (strcmp(word, names[i]) == 0)
            return i;
    return -1;
}

/* The rest of the line, for "said". */
static bool take_text(Step *step, char **rest, Error *err)
{
    char *begin = *rest + strspn(*rest, " \t");
    size_t length = strlen(begin);
    while (length > 0 && (begin[length - 1] == ' ' || begin[length - 1] == '\t'))
        length--;
    begin[length] = '\0';
    *rest = begin + length;
    step->what = DO_WAIT_SAID;
    step->text = length > 0 ? array_string(begin, err) : NULL;
    return step->text != NULL;
}

static bool take_number(Step *step, What what, double least, double most, char **rest)
{
    char *end;
    step->what = what;
    step->number[0] = strtod(*rest, &end);
    const bool found = end != *rest && step->number[0] >= least && step->number[0] <= most;
    *rest = end;
    return found;
}

/* What follows "wait" makes commands of their own. */
static bool take_wait(Step *step, const char *word, char **rest, Error *err)
{
    static const char *const steps[] = { "reading", "lit", "shot", "linked", "solved" };
    if (strcmp(word, "frames") == 0)
        return take_number(step, DO_WAIT_FRAMES, 1, INFINITY, rest);
    if (strcmp(word, "seconds") == 0)
        return take_number(step, DO_WAIT_SECONDS, 0, INFINITY, rest);
    if (strcmp(word, "tiles") == 0)
        return take_number(step, DO_WAIT_TILES, 0, 1, rest);
    if (strcmp(word, "said") == 0)
        return take_text(step, rest, err);
    if (strcmp(word, "picture") == 0 || strcmp(word, "settled") == 0) {
        step->what = word[0] == 'p' ? DO_WAIT_PICTURE : DO_WAIT_SETTLED;
        return true;
    }
    step->code = index_of(word, steps, (int)(sizeof steps / sizeof *steps));
    return step->code > 0;
}

static bool take_word(Step *step, char kind, int *numbers, char **rest, Error *err)
{
    static const char *const buttons[] = { "left", "right", "middle" };
    char word[WORD], *end;
    int used = 0;
    if (sscanf(*rest, " %1023s%n", word, &used) != 1)
        return false;
    *rest += used;
    switch (kind) {
    case 'K':
        return bindings_key(word, &step->code, &step->mods);
    case 'B':
        step->mods = strncmp(word, "Shift-", 6) == 0 ? MOD_SHIFT : 0;
        step->code = index_of(word + (step->mods != 0 ? 6 : 0), buttons, BUTTON_COUNT);
        return step->code >= 0;
    case 'S':
        return take_wait(step, word, rest, err);
    case 'F':
        step->text = array_string(word, err);
        return step->text != NULL;
    default:
        assert(*numbers < NUMBERS);
        step->number[(*numbers)++] = strtod(word, &end);
        return *end == '\0';
    }
}

static bool parse_line(Script *script, char *line, unsigned number, Error *err)
{
    char name[WORD], *rest = line;
    int used = 0, numbers = 0;
    line[strcspn(line, "#\r\n")] = '\0';
    if (sscanf(line, " %1023s%n", name, &used) != 1)
        return true;
    rest += used;
    if (!array_reserve((void **)&script->step, &script->capacity, script->count + 1,
                       sizeof *script->step, "script", err))
        return false;
    for (size_t i = 0; i < sizeof COMMANDS / sizeof *COMMANDS; i++) {
        if (strcmp(COMMANDS[i].name, name) != 0)
            continue;
        Step *step = &script->step[script->count++];
        *step = (Step){ .what = COMMANDS[i].what, .line = number };
        bool good = true;
        for (const char *kind = COMMANDS[i].words; good && *kind != '\0'; kind++)
            good = take_word(step, *kind, &numbers, &rest, err);
        if (!good || rest[strspn(rest, " \t")] != '\0')
            return error_at(err, ERROR_INPUT, script->path, number, "what is '%.60s'?", line);
        return true;
    }
    return error_at(err, ERROR_INPUT, script->path, number, "what is '%.60s'?", line);
}

Script *script_read(const char *path, Error *err)
{
    char line[LINE];
    Script *script = array_create(1, sizeof *script, "script", err);
    if (script == NULL)
        return NULL;
    script->path = array_string(path, err);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        error_set(err, ERROR_INPUT, "%s: cannot be read", path);
    for (unsigned n = 1; !error_is_set(err) && fgets(line, LINE, file) != NULL; n++)
        parse_line(script, line, n, err);
    if (file != NULL)
        fclose(file);
    return error_is_set(err) ? script_destroy(script) : script;
}

Script *script_destroy(Script *script)
{
    if (script == NULL)
        return NULL;
    for (size_t i = 0; i < script->count; i++)
        array_free(script->step[i].text);
    array_free(script->step);
    array_free(script->path);
    return array_free(script);
}

/* --- carrying it out -------------------------------------------------------------------------- */

static void push_move(Window *window, double x, double y)
{
    window_push(window, &(Event){ .kind = EVENT_MOVE, .x = x, .y = y });
}

static void push_button(Window *window, const Step *step, double x, double y, bool down)
{
    push_move(window, x, y);
    window_push(window, &(Event){ .kind = EVENT_BUTTON, .code = step->code, .mods = step->mods,
                                  .down = down, .x = x, .y = y });
}

static void push_key(Window *window, const Step *step, bool down)
{
    window_push(window, &(Event){ .kind = EVENT_KEY, .code = step->code, .mods = step->mods,
                                  .down = down });
}

/* The pointer is there a frame before the button goes down, or panels would not know it; a click is
 * down in one frame and up in the next; twice for two. */
static bool click(const Step *step, double frame, Window *window)
{
    const double last = step->what == DO_DOUBLE ? 4 : 2;
    if (frame == 0)
        push_move(window, step->number[0], step->number[1]);
    else
        push_button(window, step, step->number[0], step->number[1], (int)frame % 2 == 1);
    return frame >= last;
}

static bool drag(const Step *step, double frame, Window *window)
{
    const double *n = step->number, t = fmax(0, frame - 1) / DRAG_FRAMES;
    const double x = n[0] + t * (n[2] - n[0]), y = n[1] + t * (n[3] - n[1]);
    if (frame == 1 || t >= 1)
        push_button(window, step, x, y, frame == 1);
    else
        push_move(window, x, y);
    return t >= 1;
}

/* The step's share of this frame; whether it is through, and the next may follow. */
static bool carry_out(const Step *step, double frame, const ScriptState *state, Window *window)
{
    switch (step->what) {
    case DO_KEY:
        push_key(window, step, frame == 0);
        return frame >= 1;
    case DO_HOLD:
        if (frame == 0 || frame >= step->number[0])
            push_key(window, step, frame == 0);
        return frame >= step->number[0];
    case DO_MOVE:
        push_move(window, step->number[0], step->number[1]);
        return true;
    case DO_CLICK:
    case DO_DOUBLE:
        return click(step, frame, window);
    case DO_DRAG:
        return drag(step, frame, window);
    case DO_WHEEL:
        window_push(window, &(Event){ .kind = EVENT_WHEEL, .y = step->number[0] });
        return true;
    case DO_RESIZE:
        window_resize(window, (int)step->number[0], (int)step->number[1]);
        return true;
    case DO_SCALE:
        window_set_scale(window, step->number[0]);
        return true;
    case DO_MINIMISE:
    case DO_RESTORE:
        window_minimise(window, step->what == DO_MINIMISE);
        return true;
    case DO_LOSE_CONTEXT:
        return frame >= 1;
    case DO_WAIT_FRAMES:
        return frame >= step->number[0];
    case DO_WAIT_STEP:
        return (int)state->step >= step->code;
    case DO_WAIT_SAID:
        return strstr(state->notice, step->text) != NULL;
    case DO_WAIT_TILES:
        return state->picture == EASEL_DONE || state->tiles >= step->number[0];
    case DO_WAIT_SETTLED:
        return state->settled;
    case DO_WAIT_SECONDS:
        return state->seconds >= step->number[0];
    case DO_WAIT_PICTURE:
        return state->picture == EASEL_DONE;
    case DO_SCREENSHOT:
        return frame >= 1;
    }
    return true;
}

static bool never_comes(const Step *step, double frame, const ScriptState *state)
{
    if (step->what == DO_WAIT_SAID)
        return frame > SAID_FRAMES;
    if (step->what == DO_WAIT_PICTURE || step->what == DO_WAIT_TILES)
        return state->picture == EASEL_EMPTY || state->picture == EASEL_FAILED;
    return step->what == DO_WAIT_STEP && state->finished && (int)state->step < step->code;
}

bool script_moves(const Script *script)
{
    if (script->at == script->count)
        return false;
    switch (script->step[script->at].what) {
    case DO_KEY:
    case DO_HOLD:
    case DO_MOVE:
    case DO_CLICK:
    case DO_DOUBLE:
    case DO_DRAG:
    case DO_WHEEL:
        return true;
    default:
        return false;
    }
}

bool script_loses_context(const Script *script)
{
    return script->at < script->count && script->step[script->at].what == DO_LOSE_CONTEXT;
}

bool script_advance(Script *script, const ScriptState *state, Window *window,
                    const char **screenshot, Error *err)
{
    assert(script != NULL && state != NULL && window != NULL);
    *screenshot = NULL;
    while (script->at < script->count) {
        const Step *step = &script->step[script->at];
        if (never_comes(step, script->frame, state))
            return error_at(err, ERROR_FAILED, script->path, step->line,
                            "what it waits for does not come");
        if (step->what == DO_SCREENSHOT && script->frame == 0)
            *screenshot = step->text;
        if (!carry_out(step, script->frame++, state, window))
            return true;
        script->at++;
        script->frame = 0;
    }
    return false;
}
