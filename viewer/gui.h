/* SPDX-License-Identifier: BSD-3-Clause */
/* viewer/gui.h -- panels with text, buttons and sliders: Dear ImGui behind plain C.
 *
 * Panels are described anew each frame, between gui_begin and gui_end. The window's events are
 * handed over first. Threads: the one whose window is current.
 */
#ifndef VIEWER_GUI_H
#define VIEWER_GUI_H

#include <stdbool.h>

#include "viewer/window.h"

#ifdef __cplusplus
extern "C" {
#endif

/* False when it cannot be had (the context is missing something). scale: of window_scale. */
bool gui_create(double scale);
void gui_destroy(void);

void gui_event(const Event *event);
/* Whether the pointer is over a panel, and whether keys go into one. */
bool gui_has_mouse(void);
bool gui_has_keys(void);

void gui_begin(int width, int height, double seconds);
/* Draws all panels over the picture. */
void gui_end(void);

/* --- panels ----------------------------------------------------------------------------------- */

/* Places in pixels; one higher than `room` scrolls. False: nothing of it is seen but the title;
 * gui_panel_end is due all the same. */
bool gui_panel(const char *title, double x, double y, double width, double room);
/* Returns the y below it. need: the height that all of it takes, left as it is when it is folded;
 * NULL: not asked. */
double gui_panel_end(double *need);
/* Folds the next panel to its title, or opens it. */
void gui_fold(bool fold);
/* Height of a panel that is folded. */
double gui_title_height(void);
/* A panel in the middle of the picture. */
bool gui_overlay(const char *title, double width, double height);
/* A line of text at the lower end of the picture. */
void gui_notice(const char *text);

void gui_text(const char *text);
void gui_dim(const char *text);
void gui_heading(const char *text);
/* A name and what it is, in two columns. `column`: where the second begins, in letters. */
void gui_row(const char *name, double column, const char *text);
/* What follows stands in so many columns; 1 ends that. */
void gui_columns(int count);
void gui_next_column(void);
void gui_bar(double share, const char *text);
void gui_same_line(void);
bool gui_button(const char *name);
bool gui_check(const char *name, bool *value);
/* One of `count` names. */
bool gui_choice(const char *name, int *chosen, const char *const *names, int count);
/* format: of one double as printf takes it. */
bool gui_slider(const char *name, double *value, double low, double high, const char *format,
                bool logarithmic);
/* A square that opens a picker; 0..1 as the screen shows them. */
bool gui_colour(const char *name, double rgb[3]);

/* --- marks over the picture and below the panels, in pixels ---------------------------------- */

typedef struct {
    unsigned char r, g, b, a;
} GuiInk;
/* Where a text stands: its side at x, its middle height at y. */
typedef enum { GUI_LEFT, GUI_MIDDLE, GUI_RIGHT } GuiSide;

void gui_mark_box(double x0, double y0, double x1, double y1, GuiInk ink, bool filled);
void gui_mark_line(double x0, double y0, double x1, double y1, GuiInk ink);
void gui_mark_dot(double x, double y, double radius, GuiInk ink);
void gui_mark_text(double x, double y, GuiSide side, const char *text, GuiInk ink);

#ifdef __cplusplus
}
#endif

#endif
