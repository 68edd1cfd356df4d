/* SPDX-License-Identifier: BSD-3-Clause */
/* The window, by GLFW: the only file that knows it. */
#include "viewer/window.h"

#include <GLFW/glfw3.h>
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "base/array.h"
#include "viewer/bindings.h"

_Static_assert(KEY_ESCAPE == GLFW_KEY_ESCAPE && KEY_F1 == GLFW_KEY_F1 && KEY_END == GLFW_KEY_END &&
               KEY_SHIFT == GLFW_KEY_LEFT_SHIFT && KEY_MOST > GLFW_KEY_LAST &&
               MOD_ALT == GLFW_MOD_ALT && BUTTON_MIDDLE == GLFW_MOUSE_BUTTON_MIDDLE,
               "keys are numbered as GLFW numbers them");

struct Window {
    GLFWwindow *handle;
    Event      *queue;     /* [head, count) wait */
    size_t      head, count, capacity;
    double      x, y;      /* pointer */
    double      scale;     /* a script's; 0: the screen's */
    char        title[512];
};

void window_push(Window *window, const Event *event)
{
    Error err = { 0 };
    if (window->head == window->count)
        window->head = window->count = 0;
    if (array_reserve((void **)&window->queue, &window->capacity, window->count + 1,
                      sizeof *window->queue, "events", &err))
        window->queue[window->count++] = *event; /* without memory an event is lost, no more */
}

bool window_next(Window *window, Event *event)
{
    assert(window->head <= window->count && event != NULL);
    if (window->head == window->count)
        return false;
    *event = window->queue[window->head++];
    return true;
}

/* --- callbacks -------------------------------------------------------------------------------- */

static void on_key(GLFWwindow *handle, int key, int code, int action, int mods)
{
    (void)code;
    if (key == GLFW_KEY_RIGHT_SHIFT) /* either does */
        key = KEY_SHIFT;
    if (key >= 0)
        window_push(glfwGetWindowUserPointer(handle),
                    &(Event){ .kind = EVENT_KEY, .code = key, .down = action != GLFW_RELEASE,
                              .mods = (unsigned)mods & 7 });
}

static void on_character(GLFWwindow *handle, unsigned character)
{
    window_push(glfwGetWindowUserPointer(handle),
                &(Event){ .kind = EVENT_CHARACTER, .code = (int)character });
}

static void on_button(GLFWwindow *handle, int button, int action, int mods)
{
    Window *window = glfwGetWindowUserPointer(handle);
    if (button < BUTTON_COUNT)
        window_push(window, &(Event){ .kind = EVENT_BUTTON, .code = button,
                                      .down = action == GLFW_PRESS, .mods = (unsigned)mods & 7,
                                      .x = window->x, .y = window->y });
}

/* GLFW tells places in units of the screen; pixels may be more. */
static void on_move(GLFWwindow *handle, double x, double y)
{
    Window *window = glfwGetWindowUserPointer(handle);
    int across = 0, down = 0, width = 0, height = 0;
    glfwGetWindowSize(handle, &across, &down);
    glfwGetFramebufferSize(handle, &width, &height);
    if (across <= 0 || down <= 0)
        return;
    window->x = x * width / across;
    window->y = y * height / down;
    window_push(window, &(Event){ .kind = EVENT_MOVE, .x = window->x, .y = window->y });
}

static void on_wheel(GLFWwindow *handle, double x, double y)
{
    window_push(glfwGetWindowUserPointer(handle), &(Event){ .kind = EVENT_WHEEL, .x = x, .y = y });
}

static void on_close(GLFWwindow *handle)
{
    window_push(glfwGetWindowUserPointer(handle), &(Event){ .kind = EVENT_CLOSE });
}

/* The window was moved to a screen of another scale, or its screen got another. */
static void on_scale(GLFWwindow *handle, float x, float y)
{
    (void)x, (void)y;
    window_push(glfwGetWindowUserPointer(handle), &(Event){ .kind = EVENT_SCALE });
}

/* --- life ------------------------------------------------------------------------------------- */

static bool fail(const char *what, Error *err)
{
    const char *text = NULL;
    glfwGetError(&text);
    return error_set(err, ERROR_FAILED, "%s%s%.300s", what, text != NULL ? ": " : "",
                     text != NULL ? text : "");
}

/* A window with its context; events come to `window`. */
static bool open_handle(Window *window, int width, int height, Error *err)
{
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    /* So that a context that is lost can be told from one that draws nothing. */
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    window->handle = glfwCreateWindow(width, height, window->title, NULL, NULL);
    if (window->handle == NULL)
        return fail("no window with OpenGL 3.3", err);
    glfwMakeContextCurrent(window->handle);
    glfwSwapInterval(0); /* the loop has its own pace, and the solver needs the processor */
    glfwSetWindowUserPointer(window->handle, window);
    glfwSetKeyCallback(window->handle, on_key);
    glfwSetCharCallback(window->handle, on_character);
    glfwSetMouseButtonCallback(window->handle, on_button);
    glfwSetCursorPosCallback(window->handle, on_move);
    glfwSetScrollCallback(window->handle, on_wheel);
    glfwSetWindowCloseCallback(window->handle, on_close);
    glfwSetWindowContentScaleCallback(window->handle, on_scale);
    return true;
}

Window *window_create(const char *title, int width, int height, Error *err)
{
    assert(title != NULL && width > 0 && height > 0);
    Window *window = array_create(1, sizeof *window, "window", err);
    if (window == NULL)
        return NULL;
    snprintf(window->title, sizeof window->title, "%s", title);
    if (!glfwInit()) {
        fail("no window: no screen to open it on", err);
        return array_free(window);
    }
    return open_handle(window, width, height, err) ? window : window_destroy(window);
}

bool window_renew(Window *window, Error *err)
{
    int width = 0, height = 0, x = 0, y = 0;
    glfwGetWindowSize(window->handle, &width, &height);
    glfwGetWindowPos(window->handle, &x, &y);
    glfwDestroyWindow(window->handle);
    window->handle = NULL;
    if (!open_handle(window, width > 0 ? width : 1, height > 0 ? height : 1, err))
        return false;
    glfwSetWindowPos(window->handle, x, y);
    return true;
}

Window *window_destroy(Window *window)
{
    if (window == NULL)
        return NULL;
    if (window->handle != NULL)
        glfwDestroyWindow(window->handle);
    glfwTerminate();
    array_free(window->queue);
    return array_free(window);
}

void window_wait(Window *window, double seconds)
{
    if (seconds > 0 && window->head == window->count)
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
}

void window_size(const Window *window, int *width, int *height)
{
    *width = *height = 0;
    if (!glfwGetWindowAttrib(window->handle, GLFW_ICONIFIED))
        glfwGetFramebufferSize(window->handle, width, height);
}

void window_resize(Window *window, int width, int height)
{
    glfwSetWindowSize(window->handle, width > 0 ? width : 1, height > 0 ? height : 1);
}

void window_minimise(Window *window, bool away)
{
    if (away)
        glfwIconifyWindow(window->handle);
    else
        glfwRestoreWindow(window->handle);
}

double window_scale(const Window *window)
{
    float x = 1, y = 1;
    glfwGetWindowContentScale(window->handle, &x, &y);
    return fmin(4, fmax(0.5, window->scale > 0 ? window->scale : (double)x));
}

void window_set_scale(Window *window, double scale)
{
    window->scale = scale;
    window_push(window, &(Event){ .kind = EVENT_SCALE });
}

void window_show(Window *window) { glfwSwapBuffers(window->handle); }

double window_time(void) { return glfwGetTime(); }
