/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/room_maker.h -- small rooms for tests: from polygons to a Room in one call. */
#ifndef TESTS_ROOM_MAKER_H
#define TESTS_ROOM_MAKER_H

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "math/tolerance.h"
#include "radiosity/direct.h"
#include "radiosity/links.h"
#include "radiosity/room.h"
#include "radiosity/sides.h"
#include "radiosity/solve.h"

typedef struct {
    Polygons  soup;
    Surfaces *surfaces;
    Bvh      *bvh;
    Patches  *patches;
    uint8_t  *sides, *emitting;
    SidesReport report;
    Room      room;
} TestRoom;

/* Material with grey reflectance and exitance (not radiance). */
static inline uint32_t room_material(TestRoom *r, double reflectance, double exitance)
{
    Error err = { 0 };
    uint32_t index = 0;
    Material m = material_default();
    m.reflectance = rgb(reflectance, reflectance, reflectance);
    m.emission = rgb(exitance / M_PI, exitance / M_PI, exitance / M_PI);
    assert_true(polygons_add_material(&r->soup, &m, &index, &err));
    return index;
}

/* Parallelogram o, o+a, o+a+b, o+b: its front is where a, b, n run right-handed. */
static inline void room_quad(TestRoom *r, Vec3 o, Vec3 a, Vec3 b, uint32_t material,
                             const char *group)
{
    Error err = { 0 };
    const Vec3 p[4] = { o, vec3_add(o, a), vec3_add(vec3_add(o, a), b), vec3_add(o, b) };
    uint32_t corner[4], g = 0;
    for (int k = 0; k < 4; k++)
        assert_true(polygons_add_vertex(&r->soup, p[k], &corner[k], &err));
    assert_true(polygons_add_group(&r->soup, group, &g, &err));
    assert_true(polygons_add_polygon(&r->soup, corner, 4, material, g, &err));
}

enum { BOX_X0 = 1, BOX_X1 = 2, BOX_Y0 = 4, BOX_Y1 = 8, BOX_Z0 = 16, BOX_Z1 = 32, BOX_ALL = 63 };

/* Faces of the box lo..hi named in `faces`, groups x0 x1 y0 y1 z0 z1 with `prefix` before;
 * normals inwards or outwards. */
static inline void room_box(TestRoom *r, Vec3 lo, Vec3 hi, int faces, bool inwards,
                            uint32_t material, const char *prefix)
{
    static const char *const names[6] = { "x0", "x1", "y0", "y1", "z0", "z1" };
    const Vec3 d = vec3_sub(hi, lo), x = vec3(d.x, 0, 0), y = vec3(0, d.y, 0),
               z = vec3(0, 0, d.z);
    const Vec3 o[6] = { lo, vec3_add(lo, x), lo, vec3_add(lo, y), lo, vec3_add(lo, z) };
    const Vec3 a[6] = { y, z, z, x, x, y }, b[6] = { z, y, x, z, y, x }; /* fronts inwards */
    for (int k = 0; k < 6; k++) {
        char name[32];
        snprintf(name, sizeof name, "%s%s", prefix, names[k]);
        if ((faces >> k) & 1)
            room_quad(r, o[k], inwards ? a[k] : b[k], inwards ? b[k] : a[k], material, name);
    }
}

/* Makes all that comes with the surfaces. */
static inline void room_trace(TestRoom *r)
{
    Error err = { 0 };
    const Primitives p = { .position = r->surfaces->position, .corner = r->surfaces->corner,
                           .shape = r->surfaces->shape,
                           .vertex_count = r->surfaces->vertex_count,
                           .triangle_count = r->surfaces->triangle_count,
                           .shape_count = r->surfaces->shape_count };
    r->bvh = bvh_create(&p, 1, &err);
    assert_non_null(r->bvh);
    r->sides = array_create(r->surfaces->count, 1, "sides", &err);
    r->emitting = array_create(r->surfaces->count, 1, "sides", &err);
    assert_non_null(r->sides);
    assert_non_null(r->emitting);
}

static inline void room_connect(TestRoom *r)
{
    Error err = { 0 };
    r->surfaces = surfaces_create(&r->soup, NULL, &err);
    assert_non_null(r->surfaces);
    room_trace(r);
}

/* Divides what takes part into patches no larger than size, or anew. */
static inline void room_divide(TestRoom *r, double size)
{
    Error err = { 0 };
    const PatchOptions patch = { .size = size, .sides = r->sides };
    patches_destroy(r->patches);
    r->room.patches = r->patches = patches_create(r->surfaces, &patch, NULL, &err);
    assert_non_null(r->patches);
}

/* Finds sides and divides into patches no larger than size. */
static inline void room_finish(TestRoom *r, double size, const SidesOptions *options,
                               const Light *lights, size_t light_count, const Monitor *monitor)
{
    Error err = { 0 };
    if (r->surfaces == NULL)
        room_connect(r);
    assert_true(sides_find(r->surfaces, r->bvh, r->soup.materials, lights, light_count, options,
                           r->sides, r->emitting, &r->report, monitor, &err));
    r->room = (Room){ .surfaces = r->surfaces, .bvh = r->bvh,
                      .materials = r->soup.materials, .material_count = r->soup.material_count,
                      .lights = lights, .light_count = light_count,
                      .sides = r->sides, .emitting = r->emitting,
                      .offset = ray_offset(r->surfaces->largest_coordinate) };
    room_divide(r, size);
}

static inline void room_clear(TestRoom *r)
{
    patches_destroy(r->patches);
    bvh_destroy(r->bvh);
    surfaces_destroy(r->surfaces);
    array_free(r->sides);
    array_free(r->emitting);
    polygons_clear(&r->soup);
    memset(r, 0, sizeof *r);
}

/* Index of a group, which must exist. */
static inline uint32_t room_group(const TestRoom *r, const char *name)
{
    for (uint32_t k = 0; k < r->soup.group_count; k++)
        if (strcmp(r->soup.group_name[k], name) == 0)
            return k;
    fail_msg("no group %s", name);
    return 0;
}

static inline uint32_t room_surface(const TestRoom *r, const char *group)
{
    const uint32_t g = room_group(r, group);
    for (uint32_t k = 0; k < r->surfaces->count; k++)
        if (r->surfaces->surface[k].group == g)
            return k;
    fail_msg("no surface of group %s", group);
    return 0;
}

/* F from group a to group b: area-weighted over a's patches, summed over b's. */
static inline double room_factor(const TestRoom *r, const Links *links, const char *a,
                                 const char *b)
{
    const uint32_t ga = room_group(r, a), gb = room_group(r, b);
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < links->count; i++) {
        if (r->patches->group[i] != ga)
            continue;
        area += links->area[i];
        for (uint64_t k = links->first[i]; k < links->first[i + 1]; k++)
            if (r->patches->group[links->source[k]] == gb)
                sum += links->area[i] * links->form_factor[k];
    }
    return area > 0 ? sum / area : 0;
}

/* Emission and reflectance of the room's materials, [patches * ROOM_BANDS] each; freed by
 * caller. */
static inline void room_problem(const TestRoom *r, double **emission, double **reflectance)
{
    Error err = { 0 };
    const size_t n = r->patches->count;
    *emission = array_create(n * ROOM_BANDS, sizeof(double), "E", &err);
    *reflectance = array_create(n * ROOM_BANDS, sizeof(double), "rho", &err);
    for (uint32_t i = 0; i < n; i++) {
        const Rgb e = room_emission(&r->room, i);
        const Rgb rho = r->soup.materials[r->patches->material[i]].reflectance;
        memcpy(&(*emission)[3 * (size_t)i], &e, sizeof e);
        memcpy(&(*reflectance)[3 * (size_t)i], &rho, sizeof rho);
    }
}

static inline Links *room_links(const TestRoom *r, uint32_t rays, Closure closure)
{
    Error err = { 0 };
    Links *raw = links_create(&r->room, &(LinksOptions){ .rays = rays }, NULL, &err);
    assert_non_null(raw);
    assert_true(links_check(raw));
    if (closure == CLOSURE_NONE)
        return raw;
    Links *closed = links_close(raw, r->patches, closure, 0, NULL, &err);
    assert_non_null(closed);
    assert_true(links_check(closed));
    links_destroy(raw);
    return closed;
}

#endif
