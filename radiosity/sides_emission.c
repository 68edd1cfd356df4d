/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides_emission.c -- from which side a lamp's light leaves. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "math/sampling.h"
#include "math/tolerance.h"
#include "radiosity/internal.h"

/* A wall is a hair away when it is nearer than this share of the lamp's extent. */
static const double HAIR = 1.0 / 50;

/* Points of each surface of a lamp from which the way to a wall is tried. */
enum { POINTS = 16 };

typedef struct {
    const Surfaces *surfaces;
    const Bvh      *bvh;
    const Material *materials;
    double          offset;
    uint8_t        *seen;    /* [surfaces]  belongs to a lamp looked at already */
    uint32_t       *member;  /* [surfaces]  the lamp being looked at */
    uint32_t        members;
} LampSearch;

static bool emits(const LampSearch *search, uint32_t surface, unsigned side)
{
    const uint32_t material = surfaces_material(search->surfaces, surface, side);
    return rgb_max(search->materials[material].emission) > 0;
}

/* Two faces back to back: each side has a material of its own, and shines or not by itself. */
static bool is_double(const LampSearch *search, uint32_t surface)
{
    return search->surfaces->surface[surface].back != SURFACE_NONE;
}

/* Gathers the surfaces of one lamp: neighbours with the same material. */
static void gather_lamp(LampSearch *search, uint32_t first)
{
    const Surface *surface = search->surfaces->surface;
    search->members = 0;
    search->member[search->members++] = first;
    search->seen[first] = 1;
    for (uint32_t k = 0; k < search->members; k++)
        for (int edge = 0; edge < 4; edge++) {
            const uint32_t next = surface[search->member[k]].neighbour[edge];
            if (next == SURFACE_NONE || search->seen[next] || is_double(search, next) ||
                surface[next].material != surface[first].material)
                continue;
            search->seen[next] = 1;
            search->member[search->members++] = next;
        }
}

static double lamp_extent(const LampSearch *search)
{
    Vec3 lo = vec3(INFINITY, INFINITY, INFINITY), hi = vec3_scale(lo, -1);
    const Surfaces *surfaces = search->surfaces;
    for (uint32_t k = 0; k < search->members; k++) {
        const Surface *s = &surfaces->surface[search->member[k]];
        if (s->kind == SURFACE_SHAPE) {
            Vec3 a, b;
            shape_bounds(&surfaces->shape[s->primitive - surfaces->triangle_count], &a, &b);
            lo = vec3_min(lo, a);
            hi = vec3_max(hi, b);
            continue;
        }
        const uint32_t corners = s->kind == SURFACE_QUAD ? 6 : 3;
        for (uint32_t c = 0; c < corners; c++) {
            const Vec3 p = surfaces->position[surfaces->corner[3 * s->primitive + c]];
            lo = vec3_min(lo, p);
            hi = vec3_max(hi, p);
        }
    }
    return vec3_length(vec3_sub(hi, lo));
}

/* Whether all sample points of the lamp have a wall, no lamp, before them within `reach`. */
static bool faces_wall(const LampSearch *search, unsigned side, double reach)
{
    for (uint32_t k = 0; k < search->members; k++) {
        const uint32_t surface = search->member[k];
        const bool triangle = search->surfaces->surface[surface].kind == SURFACE_TRIANGLE;
        for (uint32_t n = 0; n < POINTS; n++) {
            float x[2];
            SurfacePoint at;
            sampling_sobol2(n, 0, x);
            double s = x[0], t = x[1];
            if (triangle)
                sampling_triangle(x[0], x[1], &s, &t);
            surfaces_point(search->surfaces, surface, s, t, &at);
            const Vec3 out = side == 0 ? at.normal : vec3_scale(at.normal, -1);
            const Ray ray = ray_leaving(at.point, out, search->offset, out, (float)reach);
            Hit hit;
            if (!bvh_nearest(search->bvh, &ray, &hit))
                return false;
            const uint32_t met = surfaces_of_primitive(search->surfaces, hit.primitive);
            if (emits(search, met, 0) || emits(search, met, 1))
                return false;
        }
    }
    return true;
}

/* Decides for the lamp in `member`; returns whether it was turned. */
static bool decide_auto(const LampSearch *search, uint8_t *emitting)
{
    const double reach = HAIR * lamp_extent(search);
    const bool turn = faces_wall(search, 0, reach) && !faces_wall(search, 1, reach);
    for (uint32_t k = 0; k < search->members; k++)
        emitting[search->member[k]] = turn ? 2 : 1;
    return turn;
}

static void decide_all(LampSearch *search, EmitSide emit, uint8_t *emitting, uint32_t *turned,
                       const Monitor *monitor)
{
    static const uint8_t bits[] = { [EMIT_FRONT] = 1, [EMIT_BACK] = 2, [EMIT_BOTH] = 3 };
    const char *name = "";
    for (uint32_t i = 0; i < search->surfaces->count; i++) {
        if (is_double(search, i)) {
            emitting[i] = (uint8_t)(emits(search, i, 0) | emits(search, i, 1) << 1);
            continue;
        }
        if (!emits(search, i, 0)) {
            emitting[i] = 0;
            continue;
        }
        const Material *material = &search->materials[search->surfaces->surface[i].material];
        if (material->emits_both) {
            emitting[i] = 3;
        } else if (emit != EMIT_AUTO) {
            emitting[i] = bits[emit];
        } else if (!search->seen[i]) {
            gather_lamp(search, i);
            if (decide_auto(search, emitting)) {
                name = *turned == 0 && material->name != NULL ? material->name : name;
                *turned += search->members;
            }
        }
    }
    if (*turned > 0)
        monitor_warn(monitor, "lamp-turned", name,
                     "%u lamp surfaces face a wall a hair away: their light leaves the back "
                     "instead (--emit front keeps it)", *turned);
}

bool sides_emission(const Surfaces *surfaces, const Bvh *bvh, const Material *materials,
                    EmitSide emit, uint8_t *emitting, uint32_t *turned, const Monitor *monitor,
                    Error *err)
{
    assert((unsigned)emit <= EMIT_BOTH && turned != NULL);
    LampSearch search = { .surfaces = surfaces, .bvh = bvh, .materials = materials,
                          .offset = ray_offset(surfaces->largest_coordinate) };
    search.seen = array_create(surfaces->count, sizeof *search.seen, "the search for lamps", err);
    search.member =
        array_create(surfaces->count, sizeof *search.member, "the search for lamps", err);
    const bool made = !error_is_set(err);
    *turned = 0;
    if (made)
        decide_all(&search, emit, emitting, turned, monitor);
    array_free(search.seen);
    array_free(search.member);
    return made;
}
