/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/gather_place.h -- scenes made by code, solved, for tests of the gather; after cmocka.h. */
#ifndef TESTS_GATHER_PLACE_H
#define TESTS_GATHER_PLACE_H

#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "render/gather.h"
#include "render/records.h"

/* --- a scene made by code, solved ------------------------------------------------------------- */

typedef struct {
    Polygons   soup;
    Surfaces  *surfaces;
    Bvh       *bvh;
    Patches   *patches;
    Links     *links;
    Solution  *solution;
    Gatherer  *gatherer;
    uint8_t   *sides, *emitting;
    Light      light[2];
    size_t     light_count;
    Room       room;
    Error      err;
} Place;

static inline uint32_t add_material(Place *p, Rgb reflectance, Rgb radiance)
{
    Material m = material_default();
    uint32_t index = 0;
    m.reflectance = reflectance;
    m.emission = radiance;
    assert_true(polygons_add_material(&p->soup, &m, &index, &p->err));
    return index;
}

static inline uint32_t grey(Place *p, double reflectance, double radiance)
{
    return add_material(p, rgb(reflectance, reflectance, reflectance),
                        rgb(radiance, radiance, radiance));
}

/* Parallelogram o, o+u, o+u+v, o+v: its front is the side of u x v. */
static inline void add_quad(Place *p, Vec3 o, Vec3 u, Vec3 v, uint32_t material)
{
    const Vec3 corner[4] = { o, vec3_add(o, u), vec3_add(vec3_add(o, u), v), vec3_add(o, v) };
    uint32_t   index[4], group;
    for (int i = 0; i < 4; i++)
        assert_true(polygons_add_vertex(&p->soup, corner[i], &index[i], &p->err));
    assert_true(polygons_add_group(&p->soup, "", &group, &p->err));
    assert_true(polygons_add_polygon(&p->soup, index, 4, material, group, &p->err));
}

static inline void add_shape(Place *p, ShapeKind kind, Vec3 at, double size, uint32_t material)
{
    const Affine map = { { size, 0, 0 }, { 0, size, 0 }, { 0, 0, size }, at };
    Shape        shape;
    uint32_t     group;
    assert_true(shape_init(&shape, kind, 1, &map, &p->err));
    assert_true(polygons_add_group(&p->soup, "", &group, &p->err));
    assert_true(polygons_add_shape(&p->soup, &shape, material, group, &p->err));
}

/* A unit cube seen from inside. */
static inline void add_room(Place *p, uint32_t material)
{
    const Vec3 o = vec3(0, 0, 0), x = vec3(1, 0, 0), y = vec3(0, 1, 0), z = vec3(0, 0, 1);
    add_quad(p, o, x, y, material);
    add_quad(p, z, y, x, material);
    add_quad(p, o, y, z, material);
    add_quad(p, x, z, y, material);
    add_quad(p, o, z, x, material);
    add_quad(p, y, x, z, material);
}

static inline void place_trees(Place *p)
{
    p->surfaces = surfaces_create(&p->soup, NULL, &p->err);
    assert_non_null(p->surfaces);
    const Surfaces  *s = p->surfaces;
    const Primitives primitives = { s->position,       s->corner,         s->shape,
                                    s->vertex_count,   s->triangle_count, s->shape_count };
    p->bvh = bvh_create(&primitives, 1, &p->err);
    p->sides = array_create(s->count, 1, "test", &p->err);
    p->emitting = array_create(s->count, 1, "test", &p->err);
    assert_non_null(p->emitting);
}

static inline void place_solve(Place *p)
{
    const uint32_t n = p->patches->count;
    double *emission = array_create((size_t)n * 3, sizeof(double), "test", &p->err);
    double *reflectance = array_create((size_t)n * 3, sizeof(double), "test", &p->err);
    Links *raw = links_create(&p->room, &(LinksOptions){ .rays = 64, .threads = 1 }, NULL, &p->err);
    p->links = links_close(raw, p->patches, CLOSURE_ROWS, 1, NULL, &p->err);
    links_destroy(raw);
    assert_string_equal(p->err.text, "");
    for (uint32_t i = 0; i < n; i++) {
        const Rgb e = room_emission(&p->room, i);
        const Rgb r = p->soup.materials[p->patches->material[i]].reflectance;
        memcpy(emission + 3 * i, &e, sizeof e);
        memcpy(reflectance + 3 * i, &r, sizeof r);
    }
    const SolveProblem problem = { 3, emission, reflectance, NULL };
    p->solution = solve(p->links, &problem, &(SolveOptions){ .tolerance = 1e-9, .threads = 1 },
                        NULL, &p->err);
    assert_non_null(p->solution);
    array_free(emission);
    array_free(reflectance);
}

/* Connects, cuts, solves. `sides`: which sides take part and, where the material emits, emit. */
static inline void place_finish(Place *p, uint8_t sides, uint32_t patches)
{
    place_trees(p);
    for (uint32_t i = 0; i < p->surfaces->count; i++) {
        p->sides[i] = sides;
        if (rgb_max(p->soup.materials[p->surfaces->surface[i].material].emission) > 0)
            p->emitting[i] = sides == 3 ? 1 : sides;
    }
    const PatchOptions options = { .wanted = patches, .sides = p->sides };
    p->patches = patches_create(p->surfaces, &options, NULL, &p->err);
    assert_string_equal(p->err.text, "");
    p->room = (Room){ .surfaces = p->surfaces, .bvh = p->bvh, .patches = p->patches,
                      .materials = p->soup.materials, .material_count = p->soup.material_count,
                      .lights = p->light, .light_count = p->light_count, .sides = p->sides,
                      .emitting = p->emitting,
                      .offset = ray_offset(p->surfaces->largest_coordinate) };
    place_solve(p);
    p->gatherer = gatherer_create(&p->room, p->solution, p->links, &p->err);
    assert_non_null(p->gatherer);
}

static inline void place_free(Place *p)
{
    gatherer_destroy(p->gatherer);
    solution_destroy(p->solution);
    links_destroy(p->links);
    patches_destroy(p->patches);
    bvh_destroy(p->bvh);
    surfaces_destroy(p->surfaces);
    array_free(p->sides);
    array_free(p->emitting);
    polygons_clear(&p->soup);
}

static inline void place_clear(Place *p)
{
    place_free(p);
    assert_int_equal(array_live(), 0);
}

static inline Irradiance measure(const Place *p, Vec3 at, Vec3 normal, uint32_t rays)
{
    Irradiance e;
    gather_irradiance(p->gatherer, at, vec3_unit(normal), rays, 1, &e);
    return e;
}

static inline Image *picture(const Place *p, const Camera *camera, RenderOptions options)
{
    Error        err = { 0 };
    RenderReport report;
    options.seed = 3;
    Image *image = render_gather(p->gatherer, camera, &options, &report, NULL, &err);
    assert_non_null(image);
    assert_true(report.rays > 0);
    return image;
}

#endif
