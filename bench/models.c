/* SPDX-License-Identifier: BSD-3-Clause */
/* Scenes to measure on: files, the Cornell box, the same in 100,000 triangles, and a room full of
 * balls and rings of 1.25 million small triangles, and the same of 12.5 million. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "bench/bench.h"
#include "mesh/surfaces.h"
#include "scenes/scene.h"

static bool model_reserve(Model *m, uint32_t vertices, uint32_t triangles, Error *err)
{
    m->position = array_create(vertices, sizeof *m->position, "vertices", err);
    m->corner = array_create((size_t)3 * triangles, sizeof *m->corner, "triangles", err);
    return !error_is_set(err);
}

static void add_triangle(Model *m, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corner = &m->corner[(size_t)3 * m->triangle_count++];
    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
}

/* nu x nv cells over the vertices that follow row by row. */
static void add_cells(Model *m, uint32_t first, uint32_t nu, uint32_t nv)
{
    for (uint32_t j = 0; j < nv; j++)
        for (uint32_t i = 0; i < nu; i++) {
            const uint32_t a = first + j * (nu + 1) + i, d = a + nu + 1;
            add_triangle(m, a, a + 1, d + 1);
            add_triangle(m, a, d + 1, d);
        }
}

/* --- files ----------------------------------------------------------------------------------- */

static bool read_file(Model *m, const char *path, Error *err)
{
    const SceneReadOptions options = { 0 };
    Scene *scene = scene_read(path, &options, err);
    Surfaces *s = scene != NULL ? surfaces_create(&scene->polygons, NULL, err) : NULL;
    if (s != NULL && model_reserve(m, s->vertex_count, s->triangle_count, err)) {
        m->vertex_count = s->vertex_count;
        m->triangle_count = s->triangle_count;
        memcpy(m->position, s->position, m->vertex_count * sizeof *m->position);
        memcpy(m->corner, s->corner, (size_t)3 * m->triangle_count * sizeof *m->corner);
    }
    if (s != NULL && scene->camera_count > 0) {
        m->eye = scene->cameras[0].eye;
        m->target = scene->cameras[0].target;
        m->fov = scene->cameras[0].vertical_fov;
    }
    surfaces_destroy(s);
    scene_destroy(scene);
    return !error_is_set(err);
}

/* Each triangle into n * n of its own shape. */
static bool subdivide(Model *m, uint32_t n, Error *err)
{
    Model fine = *m;
    const uint32_t corners = (n + 1) * (n + 2) / 2;
    fine.vertex_count = fine.triangle_count = 0;
    if (!model_reserve(&fine, m->triangle_count * corners, m->triangle_count * n * n, err))
        return false;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        const Vec3 *p = m->position;
        const uint32_t *c = &m->corner[3 * t];
        for (uint32_t j = 0; j <= n; j++)
            for (uint32_t i = 0; i + j <= n; i++) {
                const Vec3 q = vec3_mad(vec3_scale(p[c[0]], (double)(n - i - j) / n),
                                        (double)i / n, p[c[1]]);
                const uint32_t at = fine.vertex_count++;
                fine.position[at] = vec3_mad(q, (double)j / n, p[c[2]]);
                if (i + j == n)
                    continue;
                const uint32_t above = at + n + 1 - j;
                add_triangle(&fine, at, at + 1, above);
                if (i + j + 1 < n)
                    add_triangle(&fine, at + 1, above + 1, above);
            }
    }
    model_clear(m);
    *m = fine;
    return true;
}

/* --- the room -------------------------------------------------------------------------------- */

typedef struct {
    uint64_t state;
} Random;

static double unit(Random *r)
{
    uint64_t x = r->state += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static void add_wall(Model *m, Vec3 o, Vec3 u, Vec3 v, double step)
{
    const uint32_t nu = (uint32_t)lround(vec3_length(u) / step);
    const uint32_t nv = (uint32_t)lround(vec3_length(v) / step), first = m->vertex_count;
    for (uint32_t j = 0; j <= nv; j++)
        for (uint32_t i = 0; i <= nu; i++)
            m->position[m->vertex_count++] =
                vec3_mad(vec3_mad(o, (double)i / nu, u), (double)j / nv, v);
    add_cells(m, first, nu, nv);
}

/* A ball (tube 0) or a ring of 2 `along` * `along` squares, turned at random. */
static void add_round(Model *m, Vec3 centre, double radius, double tube, uint32_t along, Random *r)
{
    const uint32_t around = 2 * along;
    const double z = 2 * unit(r) - 1, angle = 2 * M_PI * unit(r), flat = sqrt(1 - z * z);
    const Vec3 n = vec3(flat * cos(angle), flat * sin(angle), z);
    const uint32_t first = m->vertex_count;
    Vec3 s, t;
    vec3_frame(n, &s, &t);
    for (uint32_t j = 0; j <= along; j++)
        for (uint32_t i = 0; i <= around; i++) {
            const double a = 2 * M_PI * i / around;
            const double b = tube > 0 ? 2 * M_PI * j / along : M_PI * j / along - M_PI / 2;
            const double out = tube > 0 ? radius + tube * cos(b) : radius * cos(b);
            const double up = (tube > 0 ? tube : radius) * sin(b);
            const Vec3 p = vec3_mad(vec3_mad(vec3_scale(s, out * cos(a)), out * sin(a), t), up, n);
            m->position[m->vertex_count++] = vec3_add(centre, p);
        }
    add_cells(m, first, around, along);
}

/* The six walls of 0..x, 0..y, 0..z, seen from inside. */
static void add_walls(Model *m, double x, double y, double z, double step)
{
    add_wall(m, vec3(0, 0, 0), vec3(0, 0, z), vec3(x, 0, 0), step);
    add_wall(m, vec3(0, y, 0), vec3(x, 0, 0), vec3(0, 0, z), step);
    add_wall(m, vec3(0, 0, 0), vec3(x, 0, 0), vec3(0, y, 0), step);
    add_wall(m, vec3(0, 0, z), vec3(0, y, 0), vec3(x, 0, 0), step);
    add_wall(m, vec3(0, 0, 0), vec3(0, y, 0), vec3(0, 0, z), step);
    add_wall(m, vec3(x, 0, 0), vec3(0, 0, z), vec3(0, y, 0), step);
}

/* Walls of squares of side `step`, solids as in add_round. Without walls, the same solids. */
static bool make_room(Model *m, double step, uint32_t along, bool walls, Error *err)
{
    const double x = 10, y = 4, z = 8;
    enum { SOLIDS = 120 };
    Random r = { 20 };
    const uint32_t squares = (uint32_t)lround(2 * (x * y + y * z + z * x) / (step * step));
    const uint32_t most = squares + SOLIDS * 2 * along * along;
    if (!model_reserve(m, most + most / 8, 2 * most, err))
        return false;
    if (walls)
        add_walls(m, x, y, z, step);
    for (int i = 0; i < SOLIDS; i++) {
        const double jx = 0.3 * (unit(&r) - 0.5), jy = 0.3 * (unit(&r) - 0.5);
        const double jz = 0.3 * (unit(&r) - 0.5), size = 0.7 + 0.5 * unit(&r);
        const Vec3 at = vec3((i % 6 + 0.5 + jx) * x / 6, (i / 6 % 4 + 0.5 + jy) * y / 4,
                             (i / 24 + 0.5 + jz) * z / 5);
        add_round(m, at, (i & 1 ? 0.28 : 0.35) * size, i & 1 ? 0.1 * size : 0, along, &r);
    }
    m->eye = vec3(0.1, 3.9, 0.1);
    m->target = vec3(6, 1.5, 5);
    m->fov = 60;
    return true;
}

/* --------------------------------------------------------------------------------------------- */

/* From one corner of the box towards the other. */
static void default_view(Model *m)
{
    if (m->fov > 0)
        return;
    m->eye = vec3_lerp(m->lo, m->hi, 0.1);
    m->target = vec3_lerp(m->lo, m->hi, 0.6);
    m->fov = 60;
}

bool model_read(Model *model, const char *name, Error *err)
{
    static const char cornell[] = "scenes/files/cornell.msd";
    *model = (Model){ 0 };
    const char *base = strrchr(name, '/');
    snprintf(model->name, sizeof model->name, "%s", base != NULL ? base + 1 : name);
    if (strcmp(name, "room") == 0)
        make_room(model, 0.1, 50, true, err);
    else if (strcmp(name, "solids") == 0)
        make_room(model, 0.1, 50, false, err);
    else if (strcmp(name, "room12m") == 0)
        make_room(model, 0.05, 160, true, err);
    else if (strcmp(name, "cornell") == 0)
        read_file(model, cornell, err);
    else if (strcmp(name, "cornell100k") != 0)
        read_file(model, name, err);
    else if (read_file(model, cornell, err))
        subdivide(model, 52, err);
    if (error_is_set(err))
        return false;
    model->lo = model->hi = model->position[0];
    for (uint32_t i = 0; i < model->vertex_count; i++) {
        model->lo = vec3_min(model->lo, model->position[i]);
        model->hi = vec3_max(model->hi, model->position[i]);
    }
    default_view(model);
    return true;
}

void model_clear(Model *model)
{
    array_free(model->position);
    array_free(model->corner);
    *model = (Model){ 0 };
}
