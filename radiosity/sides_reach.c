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

/* Rays by which a place in reach looks on: in a cell of the size wanted, and in the cells of
 * surfaces smaller than that, whose neighbours look the same way. And places that look on before
 * what they met is entered: a fixed number, so that the order of things does not depend on
 * threads. */
enum { RAYS_ON = 8, RAYS_ON_LEAST = 4, BLOCK = 4096, SIDE_CHUNK = 64 };

/* Rounds of looking back from the sides that are left. All take part in the first ones, which share
 * the rays of a side: most are found with a few, and then find others. What these miss is a few
 * small sides behind others that the same round found: after them look those that have hope, until
 * hardly any turns up. */
enum { ROUNDS_FULL = 3, ROUNDS_MAX = 64, ROUND_RAYS = 4, IDLE_MOST = 3 };
static const double ROUND_SHARE[ROUNDS_FULL] = { 1.0 / 16, 3.0 / 16, 12.0 / 16 };

/* Rays by which one face of a connected part looks back in a round while none of it is in reach:
 * the insides of furniture are many small triangles, and what all of them together do not see, none
 * does.
 * Something seen on more than a thousandth of it is missed once in 60 times. */
enum { PART_RAYS = 4096 };

/* A round is idle when it adds less than this share of what there is. */
static const double IDLE_SHARE = 1e-4;

/* Sides that look back before the caller hears of it. */
enum { BACK_BLOCK = 1 << 15 };

/* --- places ----------------------------------------------------------------------------------- */

static bool is_clear(const Reach *reach, uint32_t surface)
{
    const Surface *f = &reach->surfaces->surface[surface];
    return rgb_max(reach->materials[f->material].transmittance) > 0 ||
           rgb_max(reach->materials[f->back_material].transmittance) > 0;
}

bool reach_create(Reach *reach, const Surfaces *surfaces, const Bvh *bvh,
                  const Material *materials, const SidesOptions *options,
                  const Monitor *monitor, Error *err)
{
    static const char what[] = "the search for sides in sight";
    const size_t count = surfaces->count;
    *reach = (Reach){ .surfaces = surfaces, .bvh = bvh, .materials = materials,
                      .monitor = monitor,
                      .rays = options->rays > 0 ? options->rays : DEFAULT_RAYS,
                      .seed = options->seed, .threads = options->threads,
                      .offset = ray_offset(surfaces->largest_coordinate) };
    reach->first = array_create(2 * count + 1, sizeof *reach->first, what, err);
    reach->grid = array_create(count, sizeof *reach->grid, what, err);
    reach->used = array_create(count, sizeof *reach->used, what, err);
    reach->entered = array_create(surfaces->part_count, sizeof *reach->entered, what, err);
    reach->found = array_create((size_t)BLOCK * RAYS_ON, sizeof *reach->found, what, err);
    if (error_is_set(err) || !shells_find(surfaces, &reach->shell, err))
        return false;
    double area = 0;
    for (size_t i = 0; i < count; i++)
        area += surfaces->surface[i].area;
    for (size_t i = 0; i < count; i++) {
        if (is_clear(reach, (uint32_t)i))
            reach->shell[surfaces->part[i]] = 0; /* sight passes it */
        const double wanted = sqrt(CELLS_WANTED * surfaces->surface[i].area / area);
        reach->grid[i] = (uint16_t)fmax(1, fmin(ceil(wanted), GRID_MAX));
        const uint64_t cells = (uint64_t)reach->grid[i] * reach->grid[i];
        reach->first[2 * i + 1] = reach->first[2 * i] + cells;
        reach->first[2 * i + 2] = reach->first[2 * i + 1] + cells;
    }
    reach->cell_area = area / CELLS_WANTED;
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
    array_free(reach->shell);
    array_free(reach->entered);
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

static uint64_t cell_of(const Reach *reach, Place place)
{
    const int i = cell_along(reach, place.side, place.s);
    const int j = cell_along(reach, place.side, place.t);
    return reach->first[place.side] + (uint64_t)(j * reach->grid[place.side / 2] + i);
}

void reach_add(Reach *reach, Place place)
{
    if (place.side == SIDE_NONE)
        return;
    assert(place.side < 2 * reach->surfaces->count);
    const uint64_t at = cell_of(reach, place);
    if (reach->cell[at].side != SIDE_NONE)
        return;
    reach->cell[at] = place;
    reach->queue[reach->reached++] = (uint32_t)at;
    reach->used[place.side / 2] |= (uint8_t)(1U << (place.side & 1));
    reach->entered[reach->surfaces->part[place.side / 2]] |= (uint8_t)(1U << (place.side & 1));
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

/* Where rays leave a place: just off its surface. */
static Vec3 place_start(const Reach *reach, Place place)
{
    const SurfacePoint at = place_point(reach, place);
    return vec3_mad(at.point, reach->offset, at.normal);
}

static bool is_free(const Reach *reach, Vec3 from, Vec3 to)
{
    const Vec3 d = vec3_sub(to, from);
    const Ray ray = { .ox = (float)from.x, .oy = (float)from.y, .oz = (float)from.z, .t_min = 0,
                      .dx = (float)d.x, .dy = (float)d.y, .dz = (float)d.z, .t_max = 1 };
    return !bvh_blocked(reach->bvh, &ray);
}

/* The place that a ray meets: of glass now the glass, now what stands behind it, straight on; the
 * bits of `turn` decide. *start becomes where the last part of the way begins. */
static Place look_along(const Reach *reach, Ray ray, Vec3 d, uint32_t turn, Vec3 *start)
{
    Hit hit;
    bvh_nearest(reach->bvh, &ray, &hit);
    for (; (turn & 1) != 0 && hit.primitive != RAY_MISS; turn >>= 1) {
        const uint32_t surface = surfaces_of_primitive(reach->surfaces, hit.primitive);
        if (!is_clear(reach, surface))
            break;
        SurfacePoint at;
        double s, t;
        surfaces_parameters(reach->surfaces, hit.primitive, hit.u, hit.v, &s, &t);
        surfaces_point(reach->surfaces, surface, s, t, &at);
        const double over = vec3_dot(at.normal, d) > 0 ? reach->offset : -reach->offset;
        *start = vec3_mad(at.point, over, at.normal);
        ray = ray_leaving(at.point, at.normal, over, d, INFINITY);
        bvh_nearest(reach->bvh, &ray, &hit);
    }
    return place_hit(reach, &hit, d);
}

/* What ray r from a place towards (a, b) of its hemisphere meets, as look_along. */
static Place look_from(const Reach *reach, Place place, double a, double b, uint32_t r,
                       Vec3 *start)
{
    const SurfacePoint at = place_point(reach, place);
    const Vec3 local = sampling_cosine(a, b);
    Vec3 u, v;
    vec3_frame(at.normal, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(at.normal, local.z), local.x, u), local.y, v);
    return look_along(reach, ray_leaving(at.point, at.normal, reach->offset, d, INFINITY), d, r,
                      start);
}

/* A place met from `start`, unless it is known already or lies so close to an edge that what leaves
 * it would start behind the next wall: a thing of a million triangles has such places, and one is
 * enough to let sight into all that is closed. */
static Place only_new(const Reach *reach, Place place, Vec3 start)
{
    const Place none = { .side = SIDE_NONE };
    if (place.side == SIDE_NONE || reach->cell[cell_of(reach, place)].side != SIDE_NONE)
        return none;
    return is_free(reach, place_start(reach, place), start) ? place : none;
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
        Vec3 start = o;
        const Place met = look_along(look->reach, ray, d, k, &start);
        look->reach->found[k] = only_new(look->reach, met, start);
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

static uint32_t rays_on(const Reach *reach, uint32_t side)
{
    const double grid = reach->grid[side / 2];
    const double share = reach->surfaces->surface[side / 2].area / (grid * grid * reach->cell_area);
    const double rays = ceil(RAYS_ON * share);
    return rays >= RAYS_ON ? RAYS_ON : rays <= RAYS_ON_LEAST ? RAYS_ON_LEAST : (uint32_t)rays;
}

static void on_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    Reach *reach = context;
    (void)worker;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t cell = reach->queue[reach->shot + k];
        const uint32_t seed = sampling_seed(reach->seed, cell, SEED_SIDES, 0);
        const Place from = reach->cell[cell];
        const Vec3 start = place_start(reach, from);
        const uint32_t rays = rays_on(reach, from.side);
        for (uint32_t r = 0; r < RAYS_ON; r++) {
            float x[2];
            reach->found[k * RAYS_ON + r].side = SIDE_NONE;
            if (r >= rays)
                continue;
            sampling_sobol2(r, seed, x);
            Vec3 begin_at = start;
            const Place met = look_from(reach, from, x[0], x[1], r, &begin_at);
            reach->found[k * RAYS_ON + r] = only_new(reach, met, begin_at);
        }
    }
}

/* Lets all places that have not yet done so look on. */
bool reach_spread_on(Reach *reach)
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

/* Whether one can go through the air from one place of a side to another nearby: over a flat tent
 * for level sides, over a steep one where the side bulges in between. */
static bool is_joined(const Reach *reach, Place a, Place b)
{
    const bool level = reach->surfaces->surface[a.side / 2].kind != SURFACE_SHAPE;
    const double height = level ? 0.1 : 0.5; /* of the tent, relative to its length */
    const SurfacePoint p = place_point(reach, a), q = place_point(reach, b);
    const Vec3 from = vec3_mad(p.point, reach->offset, p.normal);
    const Vec3 to = vec3_mad(q.point, reach->offset, q.normal);
    const double length = vec3_length(vec3_sub(to, from));
    if (length <= reach->offset)
        return true;
    const Vec3 up = vec3_unit(vec3_add(p.normal, q.normal));
    const Vec3 top = vec3_mad(vec3_lerp(from, to, 0.5), height * length, up);
    return is_free(reach, from, top) && is_free(reach, to, top);
}

/* Whether a place that was met from `start` lies in reach: by the one in reach in its cell, or a
 * few in the cells around. */
static bool is_reached(const Reach *reach, Place place, Vec3 start)
{
    enum { AROUND_MAX = 3 };
    const Place own = reach->cell[cell_of(reach, place)];
    const int grid = reach->grid[place.side / 2];
    if (!is_free(reach, place_start(reach, place), start))
        return false;
    if (own.side != SIDE_NONE)
        return is_joined(reach, place, own);
    const int i = cell_along(reach, place.side, place.s);
    const int j = cell_along(reach, place.side, place.t);
    int tried = 0;
    for (int y = j > 0 ? j - 1 : 0; y <= j + 1 && y < grid; y++)
        for (int x = i > 0 ? i - 1 : 0; x <= i + 1 && x < grid; x++) {
            const Place near = reach->cell[reach->first[place.side] + (uint64_t)(y * grid + x)];
            if (near.side == SIDE_NONE || tried++ >= AROUND_MAX)
                continue;
            if (is_joined(reach, place, near))
                return true;
        }
    return false;
}

/* A place all over a side, but not where its start would lie behind a neighbour's plane: edges keep
 * MARGIN offsets away, or the middle is taken where that leaves nothing. */
static Place inner_place(const Reach *reach, uint32_t side, double a, double b)
{
    static const double MARGIN = 4, SHAPE_MARGIN = 0.01;
    const Surfaces *surfaces = reach->surfaces;
    const Surface *surface = &surfaces->surface[side / 2];
    const double keep = MARGIN * reach->offset;
    if (surface->kind == SURFACE_SHAPE)
        return (Place){ side, (float)(SHAPE_MARGIN + (1 - 2 * SHAPE_MARGIN) * a),
                        (float)(SHAPE_MARGIN + (1 - 2 * SHAPE_MARGIN) * b) };
    Vec3 p[3];
    for (int k = 0; k < 3; k++)
        p[k] = surfaces->position[surfaces->corner[3 * surface->primitive + k]];
    const bool triangle = surface->kind == SURFACE_TRIANGLE;
    const double twice = vec3_length(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
    /* Weight of corner k, relative to its height above the edge across: s and t first. */
    double rim[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        rim[k] = keep * vec3_length(vec3_sub(p[(k + 1) % 3], p[(k + 2) % 3])) / twice;
        sum += rim[k];
    }
    double s = a, t = b;
    if (triangle) {
        sampling_triangle(a, b, &s, &t);
        if (!(sum < 1))
            return (Place){ side, 1.0F / 3, 1.0F / 3 };
        return (Place){ side, (float)(rim[1] + (1 - sum) * s), (float)(rim[2] + (1 - sum) * t) };
    }
    /* a (0,0), b (1,0), c (1,1): the height over ab belongs to t, the one over bc to s. */
    const double over_s = fmin(rim[0], 0.5), over_t = fmin(rim[2], 0.5);
    return (Place){ side, (float)(over_s + (1 - 2 * over_s) * s),
                    (float)(over_t + (1 - 2 * over_t) * t) };
}

/* --- looking for an eye ----------------------------------------------------------------------- */

/* Places of a side from which an eye is looked for. */
enum { AIMS = 8 };

typedef struct {
    Reach   *reach;
    Vec3     eye;
    uint32_t first; /* side of found[0] */
} Aim;

static bool is_seen(const Reach *reach, Place place, Vec3 eye)
{
    const SurfacePoint at = place_point(reach, place);
    return vec3_dot(vec3_sub(eye, at.point), at.normal) > reach->offset &&
           is_free(reach, place_start(reach, place), eye);
}

static void aim_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Aim *aim = context;
    Reach *reach = aim->reach;
    (void)worker;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t side = aim->first + k;
        reach->found[k].side = SIDE_NONE;
        for (uint32_t r = 0; r < AIMS && !is_used(reach, side); r++) {
            float x[2];
            sampling_sobol2(r, sampling_seed(reach->seed, side, SEED_SIDES, UINT32_MAX), x);
            const Place place = inner_place(reach, side, x[0], x[1]);
            if (is_seen(reach, place, aim->eye)) {
                reach->found[k] = place;
                break;
            }
        }
    }
}

/* One place in each cell of a side, where the eye sees it. */
static void add_seen(Reach *reach, uint32_t side, Vec3 eye)
{
    const uint32_t grid = reach->grid[side / 2];
    const bool triangle = reach->surfaces->surface[side / 2].kind == SURFACE_TRIANGLE;
    for (uint32_t j = 0; j < grid; j++)
        for (uint32_t i = 0; i < grid; i++) {
            const double s = (i + 1.0 / 3) / grid, t = (j + 1.0 / 3) / grid;
            const Place place = { side, (float)s, (float)t };
            if ((!triangle || s + t < 1) && is_seen(reach, place, eye))
                reach_add(reach, place);
        }
}

void reach_aim(Reach *reach, Vec3 eye)
{
    const uint32_t sides = 2 * reach->surfaces->count;
    Aim aim = { reach, eye, 0 };
    for (; aim.first < sides; aim.first += BLOCK) {
        const uint32_t count = sides - aim.first < BLOCK ? sides - aim.first : BLOCK;
        parallel_for(count, SIDE_CHUNK, reach->threads, aim_chunk, &aim, NULL, NULL);
        for (uint32_t k = 0; k < count; k++) {
            reach_add(reach, reach->found[k]);
            if (reach->found[k].side != SIDE_NONE)
                add_seen(reach, aim.first + k, eye);
        }
    }
}

/* --- looking back from what is left ----------------------------------------------------------- */

/* How many of the sides it saw in vain a side remembers, to know when it pays to look again. */
enum { MET = 2 };

typedef struct {
    Reach    *reach;
    Place    *seen;      /* [2 * surfaces]  a place of each side that was found to be in reach */
    uint32_t *met;       /* [2 * surfaces * MET]  other sides it saw in vain; SIDE_NONE: none */
    uint8_t  *waits;     /* [2 * surfaces]  others of its part looked for it */
    uint32_t *size;      /* [parts]  surfaces of each */
    uint32_t *rank;      /* [surfaces]  which of its part's */
    uint32_t  before, rays;  /* rays of earlier rounds, of this one */
    uint32_t  round, first;  /* first: side that a block begins with */
} Back;

/* Sight has come to one side of a closed part and not to the other: it never will. */
static bool is_shut(const Reach *reach, uint32_t side)
{
    const uint32_t part = reach->surfaces->part[side / 2];
    return reach->shell[part] && reach->entered[part] == (side & 1 ? 1 : 2);
}

static bool is_entered(const Reach *reach, uint32_t side)
{
    return (reach->entered[reach->surfaces->part[side / 2]] >> (side & 1)) & 1;
}

/* Whether others of a part that is not in reach look back for this one. */
static bool is_looked_for(const Back *back, uint32_t side)
{
    const Reach *reach = back->reach;
    const uint64_t rays = (uint64_t)back->size[reach->surfaces->part[side / 2]] * back->rays;
    const uint64_t each = (rays + PART_RAYS - 1) / PART_RAYS; /* one side in so many looks */
    return back->round < ROUNDS_FULL && back->rank[side / 2] % each != 0 &&
           !is_entered(reach, side);
}

/* After the first rounds only a side that saw one that has come into use since, or a part in doubt
 * of one that was, or one that others looked for, once one of them is in reach. */
static bool is_worth_while(const Back *back, uint32_t side)
{
    bool hope = back->round < ROUNDS_FULL || (back->waits[side] && is_entered(back->reach, side));
    if (is_shut(back->reach, side))
        return false;
    for (uint32_t k = 0; k < MET; k++) {
        const uint32_t other = back->met[side * MET + k];
        hope = hope || (other != SIDE_NONE && is_used(back->reach, other));
    }
    return hope && !is_used(back->reach, side);
}

static void look_back(const Back *back, uint32_t side, uint32_t rays)
{
    const Reach *reach = back->reach;
    /* The first rounds go on with one net. */
    const uint32_t net = back->round < ROUNDS_FULL ? 0 : back->round;
    const uint32_t seed = sampling_seed(reach->seed, side, SEED_SIDES, 1 + net);
    uint32_t *met = &back->met[side * MET];
    for (uint32_t k = 0; k < MET; k++)
        met[k] = SIDE_NONE;
    for (uint32_t r = back->before; r < back->before + rays; r++) {
        float x[4];
        sampling_sobol4(r, seed, x);
        const Place place = inner_place(reach, side, x[0], x[1]);
        Vec3 start = place_start(reach, place);
        const Place other = look_from(reach, place, x[2], x[3], r, &start);
        if (other.side == SIDE_NONE)
            continue;
        if (is_used(reach, other.side) && is_reached(reach, other, start)) {
            back->seen[side] = place;
            return;
        }
        if (other.side != met[0]) {
            met[1] = met[0];
            met[0] = other.side;
        }
    }
}

static void back_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const Back *back = context;
    (void)worker;
    for (uint32_t side = back->first + begin; side < back->first + end; side++) {
        back->seen[side].side = SIDE_NONE;
        if (!is_worth_while(back, side))
            continue;
        if (is_looked_for(back, side)) {
            back->waits[side] = 1;
            continue;
        }
        /* All the rays at once after waiting. */
        const bool late = back->waits[side] && back->round >= ROUNDS_FULL;
        look_back(back, side, late ? back->reach->rays : back->rays);
        back->waits[side] = back->waits[side] && back->round < ROUNDS_FULL - 1;
    }
}

static void tell(const Reach *reach, double done)
{
    monitor_progress(reach->monitor, &(Progress){ .stage = "mesh", .done = done,
                                                  .energy_left = -1 });
}

/* One round of looking back; sides found take part from its end on. */
static bool round_back(Back *back)
{
    Reach *reach = back->reach;
    const uint32_t sides = 2 * reach->surfaces->count;
    for (back->first = 0; back->first < sides; back->first += BACK_BLOCK) {
        const uint32_t left = sides - back->first;
        /* Nearly all the work is in the first rounds. */
        const double share = (double)back->first / sides;
        if (back->round < ROUNDS_FULL)
            tell(reach, (back->round + share) / ROUNDS_FULL);
        if (!parallel_for(left < BACK_BLOCK ? left : BACK_BLOCK, SIDE_CHUNK, reach->threads,
                          back_chunk, back, reach->monitor, NULL))
            return false;
    }
    for (uint32_t k = 0; k < sides; k++)
        reach_add(reach, back->seen[k]);
    return true;
}

/* Rays of the round to come. */
static void begin_round(Back *back)
{
    const uint32_t all = back->reach->rays;
    back->before = back->round > 0 && back->round < ROUNDS_FULL ? back->before + back->rays : 0;
    back->rays = ROUND_RAYS;
    if (back->round < ROUNDS_FULL)
        back->rays = (uint32_t)ceil(ROUND_SHARE[back->round] * all);
}

bool reach_spread(Reach *reach, Error *err)
{
    static const char what[] = "the search for sides in sight";
    const uint32_t sides = 2 * reach->surfaces->count;
    Back back = { .reach = reach };
    back.seen = array_create(sides, sizeof *back.seen, what, err);
    back.met = array_create((size_t)sides * MET, sizeof *back.met, what, err);
    back.waits = array_create(sides, sizeof *back.waits, what, err);
    back.size = array_create(reach->surfaces->part_count, sizeof *back.size, what, err);
    back.rank = array_create(reach->surfaces->count, sizeof *back.rank, what, err);
    const bool made = !error_is_set(err);
    for (uint32_t k = 0; made && k < reach->surfaces->count; k++)
        back.rank[k] = back.size[reach->surfaces->part[k]]++;
    for (size_t k = 0; made && k < (size_t)sides * MET; k++)
        back.met[k] = SIDE_NONE;
    bool done = made;
    for (uint32_t idle = 0; done && back.round < ROUNDS_MAX && idle < IDLE_MOST; back.round++) {
        const uint64_t before = reach->reached;
        begin_round(&back);
        done = reach_spread_on(reach) && round_back(&back);
        const bool quiet = (double)(reach->reached - before) <= IDLE_SHARE * (double)before;
        idle = back.round >= ROUNDS_FULL && quiet ? idle + 1 : 0;
        /* When nothing at all was new, nothing will be. */
        if (back.round >= ROUNDS_FULL && reach->reached == before)
            break;
    }
    done = done && reach_spread_on(reach);
    array_free(back.seen);
    array_free(back.met);
    array_free(back.waits);
    array_free(back.size);
    array_free(back.rank);
    if (made && !done)
        error_set(err, ERROR_STOPPED, "stopped while looking for sides in sight");
    return done;
}
