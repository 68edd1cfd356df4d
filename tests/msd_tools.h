/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/msd_tools.h -- MSD text in, scene or message out; measures of what was read. */
#ifndef TESTS_MSD_TOOLS_H
#define TESTS_MSD_TOOLS_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "scenes/internal.h"

#define WHITE "SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1\n"

/* Last warning's code, and how many there were. */
typedef struct {
    int  count;
    char code[64], where[400], text[512];
} Warnings;

static inline void warnings_take(void *user, const char *code, const char *where, const char *text)
{
    Warnings *w = user;
    w->count++;
    snprintf(w->code, sizeof w->code, "%s", code);
    snprintf(w->where, sizeof w->where, "%s", where);
    snprintf(w->text, sizeof w->text, "%s", text);
}

static inline Scene *msd_scene_warned(const char *text, Warnings *warnings, Error *err)
{
    const Monitor          monitor = { .user = warnings, .warn = warnings_take };
    const SceneReadOptions options = { .monitor = &monitor };
    return scene_parse_msd("t.msd", text, strlen(text), &options, err);
}

/* The text must be good. */
static inline Scene *msd_scene(const char *text)
{
    Warnings warnings = { 0 };
    Error    err = { 0 };
    Scene   *scene = msd_scene_warned(text, &warnings, &err);
    if (scene == NULL)
        fail_msg("%s\n in: %s", err.text, text);
    assert_true(scene_check(scene));
    return scene;
}

/* Corner k of polygon i. */
static inline Vec3 corner_of(const Scene *scene, size_t i, unsigned k)
{
    const Polygons *p = &scene->polygons;
    assert_true(i < p->polygon_count && k < p->first[i + 1] - p->first[i]);
    return p->position[p->corner[p->first[i] + k]];
}

static inline void assert_near(double found, double expected, double tolerance, const char *what)
{
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s: found %.17g, expected %.17g +- %g", what, found, expected, tolerance);
}

static inline void assert_point(Vec3 p, double x, double y, double z, double tolerance,
                                const char *what)
{
    assert_near(p.x, x, tolerance, what);
    assert_near(p.y, y, tolerance, what);
    assert_near(p.z, z, tolerance, what);
}

#endif
