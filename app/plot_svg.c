/* SPDX-License-Identifier: BSD-3-Clause */
/* Curves as SVG. */
#include "app/plot_svg.h"

#include <assert.h>
#include <math.h>

/* Pixels. */
enum { PANEL_WIDTH = 470, PANEL_HEIGHT = 330, LEFT = 70, RIGHT = 20, TOP = 36, BOTTOM = 52,
       HEAD = 40, LEGEND = 220, LINE = 22 };

/* Colours that eyes of all kinds tell apart (Okabe and Ito's), then dashes. */
static const char *const colours[] = { "#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                       "#000000", "#e69f00", "#56b4e9", "#7f7f7f" };
enum { COLOURS = sizeof colours / sizeof *colours };

typedef struct {
    double low, high;   /* log10, whole decades */
} Axis;

/* Names come from scenes. */
static void put_text(FILE *out, const char *text)
{
    for (const char *p = text; *p != '\0'; p++) {
        if (*p == '<')
            fputs("&lt;", out);
        else if (*p == '&')
            fputs("&amp;", out);
        else if ((unsigned char)*p >= ' ')
            fputc(*p, out);
    }
}

static void widen(Axis *axis, double value)
{
    axis->low = fmin(axis->low, floor(log10(value)));
    axis->high = fmax(axis->high, ceil(log10(value)));
}

static bool is_shown(const PlotCurve *c, size_t k)
{
    return c->x[k] > 0 && c->y[k] > 0 && isfinite(c->x[k]) && isfinite(c->y[k]);
}

static void find_axes(const PlotPanel *panel, Axis *x, Axis *y)
{
    *x = *y = (Axis){ INFINITY, -INFINITY };
    for (size_t i = 0; i < panel->curves; i++)
        for (size_t k = 0; k < panel->curve[i].count; k++)
            if (is_shown(&panel->curve[i], k)) {
                widen(x, panel->curve[i].x[k]);
                widen(y, panel->curve[i].y[k]);
            }
    for (int k = 0; k < 2; k++) {
        Axis *axis = k == 0 ? x : y;
        if (!(axis->low < axis->high)) /* nothing, or all in one place */
            *axis = (Axis){ isfinite(axis->low) ? axis->low - 1 : 0,
                            isfinite(axis->low) ? axis->low + 1 : 1 };
    }
}

static double at_x(const Axis *axis, double logarithm)
{
    const double share = (logarithm - axis->low) / (axis->high - axis->low);
    return LEFT + share * (PANEL_WIDTH - LEFT - RIGHT);
}

static double at_y(const Axis *axis, double logarithm)
{
    const double share = (logarithm - axis->low) / (axis->high - axis->low);
    return PANEL_HEIGHT - BOTTOM - share * (PANEL_HEIGHT - TOP - BOTTOM);
}

/* A line at each decade, a number at each or, where there are many, each second or third. */
static void put_grid(FILE *out, const Axis *x, const Axis *y)
{
    enum { NUMBERS_MOST = 8 };
    const double left = LEFT, right = PANEL_WIDTH - RIGHT, top = TOP;
    const double bottom = PANEL_HEIGHT - BOTTOM;
    const int y_step = (int)((y->high - y->low - 1) / NUMBERS_MOST) + 1;
    fputs("<g stroke=\"#ddd\" stroke-width=\"1\">\n", out);
    for (double d = x->low; d <= x->high; d++)
        fprintf(out, "<path d=\"M%.1f %.1fV%.1f\"/>\n", at_x(x, d), top, bottom);
    for (double d = y->low; d <= y->high; d += y_step)
        fprintf(out, "<path d=\"M%.1f %.1fH%.1f\"/>\n", left, at_y(y, d), right);
    fputs("</g>\n<g font-size=\"12\">\n", out);
    for (double d = x->low; d <= x->high; d++)
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g</text>\n", at_x(x, d),
                bottom + 16, pow(10, d));
    for (double d = y->low; d <= y->high; d += y_step)
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">1e%+.0f</text>\n", left - 6,
                at_y(y, d) + 4, d);
    fputs("</g>\n", out);
    fprintf(out, "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" fill=\"none\" "
                 "stroke=\"#333\"/>\n", left, top, right - left, bottom - top);
}

static void put_style(FILE *out, size_t curve)
{
    fprintf(out, "fill=\"none\" stroke=\"%s\" stroke-width=\"2\"", colours[curve % COLOURS]);
    if (curve / COLOURS % 2 == 1)
        fputs(" stroke-dasharray=\"6 4\"", out);
}

static void put_curve(FILE *out, const PlotCurve *c, size_t number, const Axis *x, const Axis *y)
{
    size_t shown = 0;
    double end_x = 0, end_y = 0;
    for (size_t k = 0; k < c->count; k++) {
        if (!is_shown(c, k))
            continue;
        end_x = at_x(x, log10(c->x[k]));
        end_y = at_y(y, log10(c->y[k]));
        fprintf(out, "%s%.1f %.1f", shown++ == 0 ? "<path d=\"M" : "L", end_x, end_y);
    }
    if (shown == 0)
        return;
    fputs("\" ", out);
    put_style(out, number);
    fprintf(out, "/>\n<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>\n", end_x, end_y,
            colours[number % COLOURS]);
}

static void put_panel(FILE *out, const PlotPanel *panel, double left, double top)
{
    Axis x, y;
    find_axes(panel, &x, &y);
    fprintf(out, "<g transform=\"translate(%.0f %.0f)\">\n", left, top);
    put_grid(out, &x, &y);
    for (size_t i = 0; i < panel->curves; i++)
        put_curve(out, &panel->curve[i], i, &x, &y);
    fprintf(out, "<text x=\"%d\" y=\"%d\" font-size=\"15\" text-anchor=\"middle\">",
            (LEFT + PANEL_WIDTH - RIGHT) / 2, TOP - 10);
    put_text(out, panel->title);
    fprintf(out, "</text>\n<text x=\"%d\" y=\"%d\" font-size=\"13\" text-anchor=\"middle\">",
            (LEFT + PANEL_WIDTH - RIGHT) / 2, PANEL_HEIGHT - BOTTOM + 38);
    put_text(out, panel->x_label);
    fprintf(out, "</text>\n<text transform=\"translate(16 %d) rotate(-90)\" font-size=\"13\" "
                 "text-anchor=\"middle\">", (TOP + PANEL_HEIGHT - BOTTOM) / 2);
    put_text(out, panel->y_label);
    fputs("</text>\n</g>\n", out);
}

void plot_svg(FILE *out, const char *title, const PlotPanel *panel, size_t panels)
{
    assert(out != NULL && panel != NULL && panels > 0);
    const size_t rows = (panels + 1) / 2;
    const double legend = 2 * PANEL_WIDTH + 10;
    fprintf(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%zu\" "
                 "font-family=\"sans-serif\">\n<rect width=\"100%%\" height=\"100%%\" "
                 "fill=\"#fff\"/>\n<text x=\"%d\" y=\"26\" font-size=\"18\">",
            2 * PANEL_WIDTH + LEGEND, HEAD + rows * PANEL_HEIGHT, LEFT);
    put_text(out, title);
    fputs("</text>\n", out);
    for (size_t k = 0; k < panels; k++)
        put_panel(out, &panel[k], k % 2 == 0 ? 0 : PANEL_WIDTH,
                  HEAD + (double)(k / 2) * PANEL_HEIGHT);
    for (size_t i = 0; i < panel[0].curves; i++) {
        const double y = HEAD + TOP + 8 + (double)i * LINE;
        fprintf(out, "<path d=\"M%.0f %.0fh24\" ", legend, y);
        put_style(out, i);
        fprintf(out, "/>\n<text x=\"%.0f\" y=\"%.0f\" font-size=\"13\">", legend + 30, y + 4);
        put_text(out, panel[0].curve[i].name);
        fputs("</text>\n", out);
    }
    fputs("</svg>\n", out);
}
