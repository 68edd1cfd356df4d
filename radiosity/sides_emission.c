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

/* Steps of a walk that tries whether light can leave where a side of a lamp is, and about as many
 * walks as all surfaces of a lamp share at most: a bulb may have a million triangles. */
enum { STEPS = 8, WALKS = 1 << 14 };

/* A lamp's own case: a box round all that is in it has less than this share of the scene's area,
 * while the lamp has at least that share of the box's. A room is no case: it is larger. */
static const double CASE_SHARE = 1.0 / 20, CASE_LAMP = 1.0 / 5;

/* A closed part of which the lamp has at least this share is a luminaire, however large: of a room
 * with a luminous ceiling it has less. */
static const double LUMINAIRE_LAMP = 1.0 / 3;

/* Walks that may slip out through cracks of a closed lamp. */
static const double LEAK_SHARE = 1.0 / 200;

typedef struct {
    const Surfaces *surfaces;
    const Bvh      *bvh;
    const Material *materials;
    const SidesOptions *options;
    double          offset;
    uint8_t        *seen;    /* [surfaces]  belongs to a lamp looked at already */
    uint32_t       *member;  /* [surfaces]  the lamp being looked at */
    uint32_t        members;
    double          area;    /* of the scene */
    double         *part_area; /* [surfaces->part_count] */
    bool            luminaire; /* all of the lamp's part is its own, lit or not */
} LampSearch;

typedef struct {
    Vec3 lo, hi;
} Bounds;

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

/* Gathers the surfaces of one lamp: neighbours with the same material, wound alike. */
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
                surface[next].material != surface[first].material ||
                !shells_alike(search->surfaces, search->member[k], (unsigned)edge, next))
                continue;
            search->seen[next] = 1;
            search->member[search->members++] = next;
        }
}

static Bounds lamp_bounds(const LampSearch *search)
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
    return (Bounds){ lo, hi };
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

/* The ray from a point of the lamp towards (a, b) of its hemisphere. */
static Ray ray_towards(const LampSearch *search, const SurfacePoint *at, double a, double b)
{
    Vec3 u, v;
    const Vec3 local = sampling_cosine(a, b);
    vec3_frame(at->normal, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(at->normal, local.z), local.x, u), local.y, v);
    return ray_leaving(at->point, at->normal, search->offset, d, INFINITY);
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
            sampling_sobol4(n, k, x);
            lamp_point(search, search->member[k], side, x, &at);
            const Ray ray = ray_towards(search, &at, x[2], x[3]);
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

/* --- lamps shut in ---------------------------------------------------------------------------- */

/* Whether a surface shines to its front as a piece of the lamp's own body, whatever its
 * material; of a luminaire any. */
static bool is_own(const LampSearch *search, uint32_t surface)
{
    const uint32_t *part = search->surfaces->part;
    return part[surface] == part[search->member[0]] && !is_double(search, surface) &&
           (search->luminaire || emits(search, surface, 0));
}

static double lamp_area(const LampSearch *search)
{
    double area = 0;
    for (uint32_t k = 0; k < search->members; k++)
        area += search->surfaces->surface[search->member[k]].area;
    return area;
}

static bool is_luminaire(const LampSearch *search)
{
    const uint32_t part = search->surfaces->part[search->member[0]];
    return search->surfaces->part_closed[part] &&
           lamp_area(search) >= LUMINAIRE_LAMP * search->part_area[part];
}

/* Whether the back sees an eye, or a side of another body that may be lit or shines itself. */
static bool meets_other(const LampSearch *search)
{
    const uint32_t stride = 1 + search->members / WALKS;
    for (uint32_t k = 0; k < search->members; k += stride)
        for (uint32_t n = 0; n < POINTS; n++) {
            float x[4];
            SurfacePoint at;
            Hit hit;
            sampling_sobol4(n, k, x);
            lamp_point(search, search->member[k], 1, x, &at);
            if (n == 0 && sees_eye(search, &at))
                return true;
            const Ray ray = ray_towards(search, &at, x[2], x[3]);
            if (!bvh_nearest(search->bvh, &ray, &hit))
                continue;
            const uint32_t met = surfaces_of_primitive(search->surfaces, hit.primitive);
            const Vec3 front = surfaces_normal(search->surfaces, hit.primitive, hit.u, hit.v);
            const Vec3 d = { ray.dx, ray.dy, ray.dz };
            if (!is_own(search, met) && (!emits(search, met, 0) || vec3_dot(front, d) < 0))
                return true;
        }
    return false;
}

static double bounds_area(const Bounds *b)
{
    const Vec3 d = vec3_sub(b->hi, b->lo);
    return 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
}

static bool is_case(const LampSearch *search, const Bounds *b, double lamp)
{
    const double area = bounds_area(b);
    return area < CASE_SHARE * search->area && lamp >= CASE_LAMP * area;
}

/* One walk from a side of the lamp; returns whether it stays with the lamp and in its case, whose
 * bounds grow. `lamp` is the lamp's area. */
static bool walk_stays(const LampSearch *search, SurfacePoint at, uint32_t seed, double lamp,
                       Bounds *bounds)
{
    for (uint32_t step = 0; step < STEPS; step++) {
        float x[2];
        Hit hit;
        sampling_sobol2(step, seed, x);
        const Ray ray = ray_towards(search, &at, x[0], x[1]);
        const Vec3 d = { ray.dx, ray.dy, ray.dz };
        if (!bvh_nearest(search->bvh, &ray, &hit))
            return false;
        const uint32_t met = surfaces_of_primitive(search->surfaces, hit.primitive);
        double s, t;
        surfaces_parameters(search->surfaces, hit.primitive, hit.u, hit.v, &s, &t);
        surfaces_point(search->surfaces, met, s, t, &at);
        if (vec3_dot(at.normal, d) > 0)
            at.normal = vec3_scale(at.normal, -1);
        if (is_own(search, met))
            continue;
        const Bounds grown = { vec3_min(bounds->lo, at.point), vec3_max(bounds->hi, at.point) };
        if (emits(search, met, 0) || emits(search, met, 1) || !is_case(search, &grown, lamp))
            return false;
        *bounds = grown;
    }
    return true;
}

/* Whether light that leaves this side of the lamp meets nothing but the lamp's own body, or stays
 * in a small case round it. */
static bool is_shut_in(const LampSearch *search, unsigned side, Bounds *bounds)
{
    const uint32_t each = WALKS / search->members;
    const uint32_t walks = each < 1 ? 1 : each > POINTS ? POINTS : each;
    const double bearable = LEAK_SHARE * walks * search->members;
    const double lamp = lamp_area(search);
    double escaped = 0;
    for (uint32_t k = 0; k < search->members; k++)
        for (uint32_t n = 0; n < walks; n++) {
            float x[2];
            SurfacePoint at;
            const uint32_t seed = sampling_seed(search->options->seed, search->member[k],
                                                SEED_SIDES, n);
            sampling_sobol2(n, k, x);
            lamp_point(search, search->member[k], side, x, &at);
            escaped += !walk_stays(search, at, seed, lamp, bounds);
            if (escaped > bearable)
                return false;
        }
    return true;
}

/* Whether an eye inside the bounds sees that side of the lamp. */
static bool seen_within(const LampSearch *search, unsigned side, const Bounds *bounds)
{
    SidesOptions within = { 0 };
    LampSearch one = *search;
    one.options = &within;
    within.eye_count = 1;
    for (size_t e = 0; e < search->options->eye_count; e++) {
        const Vec3 eye = search->options->eye[e];
        if (eye.x < bounds->lo.x || eye.y < bounds->lo.y || eye.z < bounds->lo.z ||
            eye.x > bounds->hi.x || eye.y > bounds->hi.y || eye.z > bounds->hi.z)
            continue;
        within.eye = &search->options->eye[e];
        const uint32_t stride = 1 + search->members / WALKS;
        for (uint32_t k = 0; k < search->members; k += stride) {
            SurfacePoint at;
            lamp_point(search, search->member[k], side, (const float[2]){ 0.4F, 0.4F }, &at);
            if (sees_eye(&one, &at))
                return true;
        }
    }
    return false;
}

/* A lamp whose light stays in it, while its back looks at the scene: a bulb wound inward. A room
 * whose own walls shine is none: there is nothing behind them, or an eye is in it. */
static bool faces_inward(const LampSearch *search)
{
    Bounds bounds = lamp_bounds(search), behind = bounds;
    return is_shut_in(search, 0, &bounds) && meets_other(search) && !is_shut_in(search, 1, &behind)
        && !seen_within(search, 0, &bounds);
}

static bool faces_nothing(const LampSearch *search)
{
    return meeting_share(search, 0, true) == 0 && meeting_share(search, 1, false) > 0.5;
}

/* Decides for the lamp in `member`; returns whether it was turned. */
static bool decide_auto(const LampSearch *search, uint8_t *emitting)
{
    const Bounds bounds = lamp_bounds(search);
    const double reach = HAIR * vec3_length(vec3_sub(bounds.hi, bounds.lo));
    const bool turn = (faces_wall(search, 0, reach) || faces_nothing(search) ||
                       faces_inward(search)) && !faces_wall(search, 1, reach);
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
            search->luminaire = is_luminaire(search);
            if (decide_auto(search, emitting)) {
                name = *turned == 0 && material->name != NULL ? material->name : name;
                *turned += search->members;
            }
        }
    }
    if (*turned > 0)
        monitor_warn(monitor, "lamp-turned", name,
                     "%u lamp surfaces face a wall a hair away, nothing at all, or only the inside "
                     "of their own lamp: their light leaves the back instead (--emit front keeps "
                     "it)", *turned);
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
    search.part_area =
        array_create(surfaces->part_count, sizeof *search.part_area, "the search for lamps", err);
    const bool made = !error_is_set(err);
    for (uint32_t i = 0; made && i < surfaces->count; i++) {
        search.area += surfaces->surface[i].area;
        search.part_area[surfaces->part[i]] += surfaces->surface[i].area;
    }
    *turned = 0;
    if (made)
        decide_all(&search, options->emit, emitting, turned, monitor);
    array_free(search.seen);
    array_free(search.member);
    array_free(search.part_area);
    return made;
}
