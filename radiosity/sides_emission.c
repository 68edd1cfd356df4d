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
    const SidesOptions *options;
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

static void lamp_point(const LampSearch *search, uint32_t surface, unsigned side, const float x[2],
                       SurfacePoint *at)
{
    double s = x[0], t = x[1];
    if (search->surfaces->surface[surface].kind == SURFACE_TRIANGLE)
        sampling_triangle(x[0], x[1], &s, &t);
    surfaces_point(search->surfaces, surface, s, t, at);
    at->normal = side == 0 ? at->normal : vec3_scale(at->normal, -1);
}

/* Whether all sample points of the lamp have a wall, no lamp, before them within `reach`. */
static bool faces_wall(const LampSearch *search, unsigned side, double reach)
{
    for (uint32_t k = 0; k < search->members; k++) {
        const uint32_t surface = search->member[k];
        for (uint32_t n = 0; n < POINTS; n++) {
            float x[2];
            SurfacePoint at;
            sampling_sobol2(n, 0, x);
            lamp_point(search, surface, side, x, &at);
            const Ray ray = ray_leaving(at.point, at.normal, search->offset, at.normal,
                                        (float)reach);
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

/* A lamp in the plane of a ceiling, wound to face what is above it: nothing. Of the two sides of a
 * lamp only one is meant then, unless an eye looks at the other. */
static bool sees_eye(const LampSearch *search, const SurfacePoint *at)
{
    const SidesOptions *options = search->options;
    const Vec3 from = vec3_mad(at->point, search->offset, at->normal);
    for (size_t k = 0; k < options->eye_count; k++) {
        const Vec3 way = vec3_sub(options->eye[k], from);
        const Ray ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z,
                          .dx = (float)way.x, .dy = (float)way.y, .dz = (float)way.z, .t_max = 1 };
        if (vec3_dot(way, at->normal) > 0 && !bvh_blocked(search->bvh, &ray))
            return true;
    }
    return false;
}

/* Share of rays from a side of the lamp that meet something that is no lamp; 1 when an eye sees
 * that side. Rays that are enough to tell are not cast. */
static double meeting_share(const LampSearch *search, unsigned side, bool any)
{
    uint32_t met = 0;
    for (uint32_t k = 0; k < search->members; k++)
        for (uint32_t n = 0; n < POINTS; n++) {
            float x[4];
            SurfacePoint at;
            Vec3 u, v;
            sampling_sobol4(n, k, x);
            lamp_point(search, search->member[k], side, x, &at);
            const Vec3 local = sampling_cosine(x[2], x[3]);
            vec3_frame(at.normal, &u, &v);
            const Vec3 d = vec3_mad(vec3_mad(vec3_scale(at.normal, local.z), local.x, u),
                                    local.y, v);
            const Ray ray = ray_leaving(at.point, at.normal, search->offset, d, INFINITY);
            Hit hit;
            if (any && sees_eye(search, &at))
                return 1;
            if (!bvh_nearest(search->bvh, &ray, &hit))
                continue;
            if (any)
                return 1;
            const uint32_t other = surfaces_of_primitive(search->surfaces, hit.primitive);
            met += !emits(search, other, 0) && !emits(search, other, 1);
        }
    return (double)met / (POINTS * search->members);
}

static bool faces_nothing(const LampSearch *search)
{
    return meeting_share(search, 0, true) == 0 && meeting_share(search, 1, false) > 0.5;
}

/* Decides for the lamp in `member`; returns whether it was turned. */
static bool decide_auto(const LampSearch *search, uint8_t *emitting)
{
    const double reach = HAIR * lamp_extent(search);
    const bool turn = (faces_wall(search, 0, reach) || faces_nothing(search))
                   && !faces_wall(search, 1, reach);
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
                     "%u lamp surfaces face a wall a hair away, or nothing at all: their light "
                     "leaves the back instead (--emit front keeps it)", *turned);
}

bool sides_emission(const Surfaces *surfaces, const Bvh *bvh, const Material *materials,
                    const SidesOptions *options, uint8_t *emitting, uint32_t *turned,
                    const Monitor *monitor, Error *err)
{
    assert((unsigned)options->emit <= EMIT_BOTH && turned != NULL);
    LampSearch search = { .surfaces = surfaces, .bvh = bvh, .materials = materials,
                          .options = options,
                          .offset = ray_offset(surfaces->largest_coordinate) };
    search.seen = array_create(surfaces->count, sizeof *search.seen, "the search for lamps", err);
    search.member =
        array_create(surfaces->count, sizeof *search.member, "the search for lamps", err);
    const bool made = !error_is_set(err);
    *turned = 0;
    if (made)
        decide_all(&search, options->emit, emitting, turned, monitor);
    array_free(search.seen);
    array_free(search.member);
    return made;
}
