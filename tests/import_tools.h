/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/import_tools.h -- foreign files made on the spot, and what reading them gave. */
#ifndef TESTS_IMPORT_TOOLS_H
#define TESTS_IMPORT_TOOLS_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "scenes/internal.h"

/* A folder of this test's own, and the last warning in it. */
typedef struct {
    char folder[200];
    int  warnings;
    char code[64], where[300], text[512];
    int  named[2];          /* warnings "material-missing"; "textures-ignored" or "image-missing" */
} Bench;

static inline int bench_open(void **state)
{
    Bench *bench = calloc(1, sizeof *bench);
    const char *base = getenv("TMPDIR");
    snprintf(bench->folder, sizeof bench->folder, "%.150s/isolux-import-XXXXXX",
             base != NULL ? base : "/tmp");
    *state = bench;
    return mkdtemp(bench->folder) == NULL;
}

static inline int bench_close(void **state)
{
    Bench *bench = *state;
    char command[300];
    snprintf(command, sizeof command, "rm -rf '%s'", bench->folder);
    const int result = system(command);
    free(bench);
    return result;
}

static inline const char *bench_path(const Bench *bench, const char *name)
{
    static char path[2][300];
    static int turn;
    turn = !turn;
    snprintf(path[turn], sizeof path[turn], "%s/%s", bench->folder, name);
    return path[turn];
}

static inline void bench_bytes(const Bench *bench, const char *name, const void *bytes,
                               size_t size)
{
    FILE *file = fopen(bench_path(bench, name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static inline void bench_text(const Bench *bench, const char *name, const char *text)
{
    bench_bytes(bench, name, text, strlen(text));
}

static inline void bench_warn(void *user, const char *code, const char *where, const char *text)
{
    Bench *bench = user;
    bench->warnings++;
    bench->named[0] += strcmp(code, "material-missing") == 0;
    bench->named[1] += strcmp(code, "textures-ignored") == 0 ||
                       strcmp(code, "image-missing") == 0;
    snprintf(bench->code, sizeof bench->code, "%s", code);
    snprintf(bench->where, sizeof bench->where, "%s", where);
    snprintf(bench->text, sizeof bench->text, "%s", text);
}

static inline Scene *bench_read(Bench *bench, const char *name, Error *err)
{
    const Monitor monitor = { .user = bench, .warn = bench_warn };
    const SceneReadOptions options = { .monitor = &monitor, .import_seconds = 30 };
    bench->warnings = bench->named[0] = bench->named[1] = 0;
    bench->code[0] = 0;
    return scene_read(bench_path(bench, name), &options, err);
}

/* The file must be good. */
static inline Scene *bench_scene(Bench *bench, const char *name)
{
    Error err = { 0 };
    Scene *scene = bench_read(bench, name, &err);
    if (scene == NULL)
        fail_msg("%s", err.text);
    assert_true(scene_check(scene));
    return scene;
}

/* The file must be refused with ERROR_INPUT in one line that holds its name and `part`. */
static inline void bench_refused(Bench *bench, const char *name, const char *part)
{
    Error err = { 0 };
    Scene *scene = bench_read(bench, name, &err);
    if (scene != NULL || err.code != ERROR_INPUT)
        fail_msg("%s: %s, but it should say: %s", name,
                 scene != NULL ? "was read" : err.text, part);
    if (strstr(err.text, part) == NULL || strstr(err.text, name) == NULL ||
        strchr(err.text, '\n') != NULL)
        fail_msg("%s: says \"%s\", but should say: %s", name, err.text, part);
}

/* Corner k of polygon i. */
static inline Vec3 bench_corner(const Scene *scene, size_t i, size_t k)
{
    const Polygons *p = &scene->polygons;
    assert_true(i < p->polygon_count && k < p->first[i + 1] - p->first[i]);
    return p->position[p->corner[p->first[i] + k]];
}

static inline size_t bench_corners(const Scene *scene, size_t i)
{
    assert_true(i < scene->polygons.polygon_count);
    return scene->polygons.first[i + 1] - scene->polygons.first[i];
}

static inline const char *bench_group(const Scene *scene, size_t i)
{
    return scene->polygons.group_name[scene->polygons.group[i]];
}

static inline const Material *bench_material(const Scene *scene, size_t i)
{
    return &scene->polygons.materials[scene->polygons.material[i]];
}

/* Twice the area with direction, by Newell's formula. */
static inline Vec3 bench_normal(const Scene *scene, size_t i)
{
    Vec3 sum = vec3(0, 0, 0);
    const size_t count = bench_corners(scene, i);
    for (size_t k = 0; k < count; k++)
        sum = vec3_add(sum, vec3_cross(bench_corner(scene, i, k),
                                       bench_corner(scene, i, (k + 1) % count)));
    return sum;
}

/* Normal of corner k of polygon i that the file gives; 0 0 0: none. */
static inline Vec3 bench_shading(const Scene *scene, size_t i, size_t k)
{
    const size_t at = scene->polygons.first[i] + k;
    const float *n = scene->polygons.normal + 3 * at;
    return at < scene->polygons.normal_count ? vec3(n[0], n[1], n[2]) : vec3(0, 0, 0);
}

static inline void assert_close(double found, double expected, double tolerance, const char *what)
{
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s: found %.17g, expected %.17g +- %g", what, found, expected, tolerance);
}

static inline void assert_vec3(Vec3 p, double x, double y, double z, double tolerance,
                               const char *what)
{
    assert_close(p.x, x, tolerance, what);
    assert_close(p.y, y, tolerance, what);
    assert_close(p.z, z, tolerance, what);
}

static inline void assert_rgb(Rgb c, double r, double g, double b, double tolerance,
                              const char *what)
{
    assert_vec3(vec3(c.r, c.g, c.b), r, g, b, tolerance, what);
}

#endif
