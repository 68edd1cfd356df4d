/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/sides_reach.c -- follows sight from place to place, not from surface to surface: the
 * floor under a closed box belongs to a floor in plain sight, and yet the inside of that box, which
 * looks at it, is out of reach. So each side keeps places known to be in reach, one per cell of a
 * grid, and only these see on. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "math/tolerance.h"
#include "radiosity/internal.h"

static const uint32_t DEFAULT_RAYS = 32;

/* Cells that all surfaces share by area; each has one at least. */
static const double CELLS_WANTED = 16384;
enum { GRID_MAX = 64 };

/* Rays by which a place in reach looks on, and places that look on before what they met is entered:
 * a fixed number, so that the order of things does not depend on threads. */
enum { RAYS_ON = 8, BLOCK = 4096, SIDE_CHUNK = 64 };

/* Rounds of looking back from the sides that are left, with half the rays each time: what the first
 * rounds miss is a few small sides behind others that the same round found. */
enum { ROUNDS_MAX = 64, ROUND_RAYS_MIN = 4 };

/* --- places ----------------------------------------------------------------------------------- */

bool reach_create(Reach *reach, const Surfaces *surfaces, const Bvh *bvh,
                  const SidesOptions *options, const Monitor *monitor, Error *err)
{
    static const char what[] = "the search for sides in sight";
    const size_t count = surfaces->count;
    *reach = (Reach){ .surfaces = surfaces, .bvh = bvh, .monitor = monitor,
                      .rays = options->rays > 0 ? options->rays : DEFAULT_RAYS,
                      .seed = options->seed, .threads = options->threads,
                      .offset = ray_offset(surfaces->largest_coordinate) };
    reach->first = array_create(2 * count + 1, sizeof *reach->first, what, err);
    reach->grid = array_create(count, sizeof *reach->grid, what, err);
    reach->used = array_create(count, sizeof *reach->used, what, err);
    reach->found = array_create((size_t)BLOCK * RAYS_ON, sizeof *reach->found, what, err);
    if (error_is_set(err))
        return false;
    double area = 0;
    for (size_t i = 0; i < count; i++)
        area += surfaces->surface[i].area;
    for (size_t i = 0; i < count; i++) {
        const double wanted = sqrt(CELLS_WANTED * surfaces->surface[i].area / area);
        reach->grid[i] = (uint16_t)fmax(1, fmin(ceil(wanted), GRID_MAX));
        const uint64_t cells = (uint64_t)reach->grid[i] * reach->grid[i];
        reach->first[2 * i + 1] = reach->first[2 * i] + cells;
        reach->first[2 * i + 2] = reach->first[2 * i + 1] + cells;
    }
    const uint64_t cells = reach->first[2 * count];
    if (cells > UINT32_MAX)
        return error_set(err, ERROR_MEMORY, "%zu surfaces are too many", count);
    reach->cell = array_create(cells, sizeof *reach->cell, what, err);
    reach->queue = array_create(cells, sizeof *reach->queue, what, err);
    if (error_is_set(err))
        return false;
    for (uint64_t k = 0; k < cells; k++)
        reach->cell[k].side = SIDE_NONE;
    return true;
}

void reach_clear(Reach *reach)
{
    array_free(reach->first);
    array_free(reach->grid);
    array_free(reach->cell);
    array_free(reach->queue);
    array_free(reach->used);
    array_free(reach->found);
    *reach = (Reach){ 0 };
}

static bool is_used(const Reach *reach, uint32_t side)
{
    return (reach->used[side / 2] >> (side & 1)) & 1;
}

static int cell_along(const Reach *reach, uint32_t side, double x)
{
    const int grid = reach->grid[side / 2];
    const int k = (int)(x * grid);
    return k < 0 ? 0 : k < grid ? k : grid - 1;
}

void reach_add(Reach *reach, Place place)
{
    if (place.side == SIDE_NONE)
        return;
    assert(place.side < 2 * reach->surfaces->count);
    const int i = cell_along(reach, place.side, place.s);
    const int j = cell_along(reach, place.side, place.t);
    const uint64_t at = reach->first[place.side] + (uint64_t)j * reach->grid[place.side / 2] +
                        (uint64_t)i;
    if (reach->cell[at].side != SIDE_NONE)
        return;
    reach->cell[at] = place;
    reach->queue[reach->reached++] = (uint32_t)at;
    reach->used[place.side / 2] |= (uint8_t)(1U << (place.side & 1));
}

void reach_add_side(Reach *reach, uint32_t side)
{
    const uint32_t grid = reach->grid[side / 2];
    const bool triangle = reach->surfaces->surface[side / 2].kind == SURFACE_TRIANGLE;
    /* A third of the cell in: inside the triangle even where there is one cell only. */
    for (uint32_t j = 0; j < grid; j++)
        for (uint32_t i = 0; i < grid; i++) {
            const double s = (i + 1.0 / 3) / grid, t = (j + 1.0 / 3) / grid;
            if (!triangle || s + t < 1)
                reach_add(reach, (Place){ side, (float)s, (float)t });
        }
}

/* Point and normal out of the side. */
static SurfacePoint place_point(const Reach *reach, Place place)
{
    SurfacePoint at;
    surfaces_point(reach->surfaces, place.side / 2, place.s, place.t, &at);
    if (place.side & 1)
        at.normal = vec3_scale(at.normal, -1);
    return at;
}

static Place place_hit(const Reach *reach, const Hit *hit, Vec3 direction)
{
    if (hit->primitive == RAY_MISS)
        return (Place){ .side = SIDE_NONE };
    double s, t;
    const Surfaces *surfaces = reach->surfaces;
    const Vec3 front = surfaces_normal(surfaces, hit->primitive, hit->u, hit->v);
    surfaces_parameters(surfaces, hit->primitive, hit->u, hit->v, &s, &t);
    const uint32_t surface = surfaces_of_primitive(surfaces, hit->primitive);
    return (Place){ 2 * surface + (vec3_dot(front, direction) > 0), (float)s, (float)t };
}

/* What a ray from a place towards (a, b) of its hemisphere meets. */
static Place look_from(const Reach *reach, Place place, double a, double b)
{
    const SurfacePoint at = place_point(reach, place);
    const Vec3 local = sampling_cosine(a, b);
    Vec3 u, v;
    vec3_frame(at.normal, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(at.normal, local.z), local.x, u), local.y, v);
    const Ray ray = ray_leaving(at.point, at.normal, reach->offset, d, INFINITY);
    Hit hit;
    bvh_nearest(reach->bvh, &ray, &hit);
    return place_hit(reach, &hit, d);
}

/* --- looking on ------------------------------------------------------------------------------- */

typedef struct {
    Reach   *reach;
    Vec3     eye;
    uint32_t seed, rays;
} Look;

static void look_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Look *look = context;
    const Vec3 o = look->eye;
    (void)worker;
    for (uint32_t k = begin; k < end; k++) {
        float x[2];
        sampling_sobol2(k, look->seed, x);
        const Vec3 d = sampling_sphere(x[0], x[1]);
        const Ray ray = { .ox = (float)o.x, .oy = (float)o.y, .oz = (float)o.z,
                          .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z,
                          .t_max = INFINITY };
        Hit hit;
        bvh_nearest(look->reach->bvh, &ray, &hit);
        look->reach->found[k] = place_hit(look->reach, &hit, d);
    }
}

void reach_look(Reach *reach, Vec3 eye, uint32_t rays, uint32_t seed)
{
    assert(rays <= BLOCK * RAYS_ON);
    Look look = { reach, eye, seed, rays };
    parallel_for(rays, SIDE_CHUNK, reach->threads, look_chunk, &look, NULL, NULL);
    for (uint32_t k = 0; k < rays; k++)
        reach_add(reach, reach->found[k]);
}

static void on_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Reach *reach = context;
    (void)worker;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t cell = reach->queue[reach->shot + k];
        const uint32_t seed = sampling_seed(reach->seed, cell, SEED_SIDES, 0);
        for (uint32_t r = 0; r < RAYS_ON; r++) {
            float x[2];
            sampling_sobol2(r, seed, x);
            reach->found[k * RAYS_ON + r] = look_from(reach, reach->cell[cell], x[0], x[1]);
        }
    }
}

/* Lets all places that have not yet done so look on. */
static bool spread_on(Reach *reach)
{
    while (reach->shot < reach->reached) {
        const uint64_t waiting = reach->reached - reach->shot;
        const uint32_t count = waiting < BLOCK ? (uint32_t)waiting : BLOCK;
        if (!parallel_for(count, SIDE_CHUNK, reach->threads, on_chunk, reach, reach->monitor, NULL))
            return false;
        reach->shot += count;
        for (uint32_t k = 0; k < count * RAYS_ON; k++)
            reach_add(reach, reach->found[k]);
    }
    return true;
}

/* --- looking back ----------------------------------------------------------------------------- */

static bool is_free(const Reach *reach, Vec3 from, Vec3 to)
{
    const Vec3 d = vec3_sub(to, from);
    const Ray ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z, .t_min = 0,
                      .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = 1 };
    return !bvh_blocked(reach->bvh, &ray);
}

/* Whether one can go through the air from one place of a side to another nearby: over a flat tent
 * for level sides, over a steep one where the side bulges in between. */
static bool is_joined(const Reach *reach, Place a, Place b)
{
    static const double heights[] = { 0.1, 0.5 }; /* of the tent, relative to its length */
    const SurfacePoint p = place_point(reach, a), q = place_point(reach, b);
    const Vec3 from = vec3_mad(p.point, reach->offset, p.normal);
    const Vec3 to = vec3_mad(q.point, reach->offset, q.normal);
    const double length = vec3_length(vec3_sub(to, from));
    if (length <= reach->offset)
        return true;
    const Vec3 up = vec3_unit(vec3_add(p.normal, q.normal));
    for (int k = 0; k < 2; k++) {
        const Vec3 top = vec3_mad(vec3_lerp(from, to, 0.5), heights[k] * length, up);
        if (is_free(reach, from, top) && is_free(reach, to, top))
            return true;
    }
    return false;
}

/* Whether a place lies in reach, by the places in reach in its cell and those around. */
static bool is_reached(const Reach *reach, Place place)
{
    if (place.side == SIDE_NONE || !is_used(reach, place.side))
        return false;
    const int grid = reach->grid[place.side / 2];
    const int i = cell_along(reach, place.side, place.s);
    const int j = cell_along(reach, place.side, place.t);
    for (int y = j > 0 ? j - 1 : 0; y <= j + 1 && y < grid; y++)
        for (int x = i > 0 ? i - 1 : 0; x <= i + 1 && x < grid; x++) {
            const Place near = reach->cell[reach->first[place.side] + (uint64_t)(y * grid + x)];
            if (near.side != SIDE_NONE && is_joined(reach, place, near))
                return true;
        }
    return false;
}

typedef struct {
    Reach   *reach;
    Place   *seen;      /* [2 * surfaces]  a place of each side that was found to be in reach */
    uint32_t rays, round;
} Back;

static void back_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Back *back = context;
    const Reach *reach = back->reach;
    (void)worker;
    for (uint32_t side = begin; side < end; side++) {
        back->seen[side].side = SIDE_NONE;
        if (is_used(reach, side))
            continue;
        const uint32_t seed = sampling_seed(reach->seed, side, SEED_SIDES, 1 + back->round);
        const bool triangle = reach->surfaces->surface[side / 2].kind == SURFACE_TRIANGLE;
        for (uint32_t r = 0; r < back->rays && back->seen[side].side == SIDE_NONE; r++) {
            float x[4];
            double s, t;
            sampling_sobol4(r, seed, x);
            s = x[0];
            t = x[1];
            if (triangle)
                sampling_triangle(x[0], x[1], &s, &t);
            const Place place = { side, (float)s, (float)t };
            if (is_reached(reach, look_from(reach, place, x[2], x[3])))
                back->seen[side] = place;
        }
    }
}

bool reach_spread(Reach *reach, Error *err)
{
    const uint32_t sides = 2 * reach->surfaces->count;
    Back back = { .reach = reach, .rays = reach->rays };
    back.seen = array_create(sides, sizeof *back.seen, "the search for sides in sight", err);
    bool done = back.seen != NULL;
    uint64_t before = UINT64_MAX;
    for (; done && back.round < ROUNDS_MAX && reach->reached != before; back.round++) {
        done = spread_on(reach);
        before = reach->reached;
        done = done && parallel_for(sides, SIDE_CHUNK, reach->threads, back_chunk, &back,
                                    reach->monitor, NULL);
        for (uint32_t k = 0; done && k < sides; k++)
            reach_add(reach, back.seen[k]);
        if (back.rays / 2 >= ROUND_RAYS_MIN)
            back.rays /= 2;
    }
    array_free(back.seen);
    return done || error_set(err, ERROR_STOPPED, "stopped while looking for sides in sight");
}
