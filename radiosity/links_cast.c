/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/links_cast.c -- one row of form factors by rays from points all over a patch. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/internal.h"
#include "radiosity/mirrors.h"
#include "radiosity/visible.h"

/* Cells of a grid with RAYS_PER_POSITION points of the net in each, if rays are a power of two. */
static uint32_t cells_of(uint32_t rays)
{
    uint32_t cells = 1;
    while (2 * cells <= rays / RAYS_PER_POSITION)
        cells *= 2;
    return cells;
}

bool row_cast_create(RowCast *row, uint32_t rays, uint32_t lamp_rays, Error *err)
{
    return row_cast_allocate(row, rays, lamp_rays, 1, err);
}

bool row_cast_allocate(RowCast *row, uint32_t rays, uint32_t lamp_rays, uint32_t patches,
                       Error *err)
{
    assert(rays > 0 && patches > 0);
    const size_t all = (size_t)rays + lamp_rays, n = patches;
    static const char what[] = "the rays of a patch";
    *row = (RowCast){ .rays = rays, .lamp_rays = lamp_rays,
                      .positions = cells_of(rays) };
    row->position = array_create(n * row->positions, sizeof *row->position, what, err);
    row->valid = array_create(n * row->positions, sizeof *row->valid, what, err);
    row->ray = array_create(n * rays, sizeof *row->ray, what, err);
    row->end = array_create(n * rays, sizeof *row->end, what, err);
    row->hit = array_create(n * rays, sizeof *row->hit, what, err);
    row->cosine = array_create(n * rays, sizeof *row->cosine, what, err);
    row->turned = array_create(n * rays, sizeof *row->turned, what, err);
    row->cell = array_create(n * rays, sizeof *row->cell, what, err);
    row->start = array_create(n * rays, sizeof *row->start, what, err);
    row->weight = array_create(n * rays, sizeof *row->weight, what, err);
    row->place = array_create(n * rays, sizeof *row->place, what, err);
    row->sample = array_create(n * lamp_rays, sizeof *row->sample, what, err);
    row->lamp_ray = array_create(n * lamp_rays, sizeof *row->lamp_ray, what, err);
    row->blocked = array_create(n * lamp_rays, sizeof *row->blocked, what, err);
    row->value = array_create(all, sizeof *row->value, what, err);
    row->key = array_create(all, sizeof *row->key, what, err);
    row->other = array_create(all, sizeof *row->other, what, err);
    row->source = array_create(all, sizeof *row->source, what, err);
    row->form_factor = array_create(all, sizeof *row->form_factor, what, err);
    return !error_is_set(err);
}

void row_cast_clear(RowCast *row)
{
    array_free(row->position);
    array_free(row->valid);
    array_free(row->end);
    array_free(row->ray);
    array_free(row->hit);
    array_free(row->sample);
    array_free(row->lamp_ray);
    array_free(row->blocked);
    array_free(row->cosine);
    array_free(row->turned);
    array_free(row->cell);
    array_free(row->start);
    array_free(row->weight);
    array_free(row->place);
    array_free(row->value);
    array_free(row->key);
    array_free(row->other);
    array_free(row->source);
    array_free(row->form_factor);
    *row = (RowCast){ 0 };
}

/* The net's elementary intervals of twice as many columns as rows, or as many, hold the same number
 * of its points each. */
static uint32_t cell_at(const RowCast *row, float a, float b)
{
    uint32_t columns = 1;
    while (columns * columns < row->positions)
        columns *= 2;
    return (uint32_t)(a * (float)columns) * (row->positions / columns) +
           (uint32_t)(b * (float)(row->positions / columns));
}

static void place_at(const Room *room, uint32_t patch, const float x[2], PatchPoint *at)
{
    patches_point(room->patches, room->surfaces, patch, x[0], x[1], at);
    visible_move(room, at);
}

/* All four coordinates of a ray are those of one point of the net: a place of its own and a
 * direction. Rays of places in the same cell stand together. */
static void make_rays(RowCast *row, const Room *room, uint32_t patch, uint32_t seed)
{
    for (uint32_t p = 0; p < row->positions; p++)
        row->position[p] = (CastPosition){ .good = 0 };
    row->patch = patch;
    row->seed = seed;
    for (uint32_t k = 0; k < row->rays; k++) {
        float x[4];
        PatchPoint at;
        sampling_sobol4(row->begin + k, seed, x);
        place_at(room, patch, x, &at);
        row->place[k][0] = x[0];
        row->place[k][1] = x[1];
        row->cell[k] = cell_at(row, x[0], x[1]);
        row->start[k] = at.surface;
        row->weight[k] = at.weight;
        CastPosition *p = &row->position[row->cell[k]];
        if (p->rays++ == 0) {
            p->at = at;
            p->first = k;
        }
        p->weight += (at.weight - p->weight) / p->rays;
        const Vec3 n = at.point.normal, local = sampling_cosine(x[2], x[3]);
        Vec3 u, v;
        vec3_frame(n, &u, &v);
        const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, local.z), local.x, u), local.y, v);
        row->cosine[k] = local.z;
        row->ray[k] = ray_leaving(at.point.point, n, room->offset, d, INFINITY);
    }
}

static Vec3 ray_direction(const Ray *ray)
{
    return vec3(ray->dx, ray->dy, ray->dz);
}

/* Ray k from the mirror that it met on, until it ends. Its way so far stays part of the hit's t
 * when it was straight: seen from the patch, that is how far the end lies. */
static void follow_ray(RowCast *row, const Room *room, uint32_t k)
{
    double far = 0;
    bool   straight = true;
    assert(k < row->rays);
    for (uint32_t step = 0; step < MIRRORS_MOST && row->hit[k].primitive != RAY_MISS; step++) {
        float x[2];
        const float way = row->hit[k].t;
        sampling_sobol2(k, sampling_seed(row->seed, step, SEED_MIRRORS, 0), x);
        if (!mirrors_step(room, &row->hit[k], x[0], &row->ray[k], &straight))
            break;
        far += way;
        row->cast++;
        bvh_nearest(room->bvh, &row->ray[k], &row->hit[k]);
    }
    row->turned[k] = !straight;
    if (straight)
        row->hit[k].t += (float)far;
}

/* Under water so many rays at least meet its surface from below, and more than meet one from above,
 * which only those do that slip through a crack. */
static const double INSIDE_LEAST = 0.125;

void row_cast_follow(RowCast *row, const Room *room)
{
    uint32_t inside = 0, outside = 0;
    double   sum = 0;
    for (uint32_t k = 0; k < row->rays; k++) {
        row->turned[k] = false;
        if (!room->mirrors || row->hit[k].primitive == RAY_MISS)
            continue;
        const double n = mirrors_medium(room, &row->hit[k], ray_direction(&row->ray[k]));
        inside += n > 1;
        outside += n == 0;
        sum += n > 1 ? n * n : 0;
        follow_ray(row, room, k);
    }
    const bool under = inside > outside && inside >= INSIDE_LEAST * row->rays;
    row->medium = under ? sum / inside : 1;
}

/* Whether a ray that went as far as t ended in the gap that it began in: nearer than the edge of
 * the larger of both patches, and no light comes from there. */
static bool ends_in_pocket(const RowCast *row, const Room *room, const RayEnd *end, double t)
{
    const Patches *patches = room->patches;
    if (!(t < room->pocket) || room->emitting[end->surface] != 0 ||
        room->emitting[patches->surface[row->patch]] != 0)
        return false;
    return t * t < fmax(patches->area[row->patch], patches->area[end->patch]);
}

/* Rays more that must all end near before a place counts as one in a gap. Close to the corner of
 * three walls, which is none, 3/4 of all rays end near: with the 4 of its cell all do at one place
 * in three, with 16 at one in a hundred; where two walls meet, at one in 65,000. */
enum { POCKET_RAYS = 16 - RAYS_PER_POSITION };

/* Whether the cell, whose own rays all ended near, lies in a gap. What meets a mirror sees more
 * than the gap. */
static bool is_pocket(RowCast *row, const Room *room, uint32_t cell)
{
    const PatchPoint *at = &row->position[cell].at;
    const Vec3        n = at->point.normal;
    const uint32_t    seed = sampling_seed(row->seed, row->begin, cell, SEED_POCKETS);
    Vec3              u, v;
    vec3_frame(n, &u, &v);
    for (uint32_t k = 0; k < POCKET_RAYS; k++) {
        float  x[2];
        bool   straight = true;
        Hit    hit;
        RayEnd end;
        sampling_sobol2(k, seed, x);
        const Vec3 to = sampling_cosine(x[0], x[1]);
        const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, to.z), to.x, u), to.y, v);
        Ray ray = ray_leaving(at->point.point, n, room->offset, d, INFINITY);
        row->cast++;
        if (!bvh_nearest(room->bvh, &ray, &hit))
            return false;
        const double t = hit.t;
        if (room->mirrors && mirrors_step(room, &hit, 0, &ray, &straight))
            return false;
        end.patch = room_patch(room, &hit, ray_direction(&ray), &end.surface, &end.s, &end.t);
        if (end.patch != PATCH_NONE && !ends_in_pocket(row, room, &end, t))
            return false;
    }
    return true;
}

/* Resolves all hits, counts each position's good and bad rays, and returns how many rays stay. A
 * position half or more of whose rays meet sides that take no part lies inside a solid: one ray
 * alone may have slipped through a crack. Half, not all: where solids run into each other, some
 * rays from inside the one end on the hidden part of the other, which does take part elsewhere. */
void row_cast_judge(RowCast *row, const Room *room)
{
    for (uint32_t k = 0; k < row->rays; k++) {
        CastPosition *p = &row->position[row->cell[k]];
        RayEnd *end = &row->end[k];
        end->escaped = row->hit[k].primitive == RAY_MISS;
        end->patch = end->escaped ? PATCH_NONE
                                  : room_patch(room, &row->hit[k], ray_direction(&row->ray[k]),
                                               &end->surface, &end->s, &end->t);
        end->escaped = end->escaped || (room->sides_given && end->patch == PATCH_NONE);
        if (!end->escaped && end->patch == PATCH_NONE) {
            p->bad += !visible_side_used(room, &row->hit[k], ray_direction(&row->ray[k]));
        } else if (end->escaped || !visible_at_seam(room, end->surface, end->s, end->t)) {
            if (p->good++ == 0 && p->first != k)
                place_at(room, row->patch, row->place[k], &p->at);
            p->good_weight += row->weight[k];
            p->near += !end->escaped && ends_in_pocket(row, room, end, row->hit[k].t);
        } else {
            end->patch = PATCH_NONE;
        }
    }
    row->good_rays = row->valid_count = 0;
    for (uint32_t k = 0; k < row->positions; k++) {
        CastPosition *p = &row->position[k];
        if (p->bad < p->good && (p->near < p->good || !is_pocket(row, room, k))) {
            row->valid[row->valid_count++] = k;
            row->good_rays += p->good;
        } else {
            p->good = 0;
        }
    }
}

/* How much a ray of the hemisphere counts where the lamp's own samples could have found the same:
 * the power heuristic [veach95] over solid angle. The balance heuristic would take the error of a
 * sample for that of a random one, but on a net the smooth integrand of visibility rays converges
 * faster than the edges that rays of the hemisphere hit or miss. Cornell box, 256 rays: factors to
 * the lamp 1.5 % off (rms over patches), 2.5 % with the balance heuristic. */
static double hemisphere_weight(const RowCast *row, const Room *room, const LampTable *lamps,
                                uint32_t k, uint32_t rays)
{
    const RayEnd *end = &row->end[k];
    if (row->lamp_rays == 0 || !(lamps->probability[end->patch] > 0) || row->turned[k])
        return 1;
    assert(row->cosine[k] > 0);
    const Hit *hit = &row->hit[k];
    const Vec3 n = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
    const double cosine = fabs(vec3_dot(n, ray_direction(&row->ray[k])));
    const double here = rays * row->cosine[k] / M_PI;
    const double there = row->lamp_rays * lamp_density(room, lamps, end, hit->t, cosine);
    return here * here / (here * here + there * there);
}

void row_cast_add(RowCast *row, uint32_t patch, double share)
{
    row->key[row->keys] = (uint64_t)patch << 32 | row->keys;
    row->value[row->keys++] = (float)share;
}

static void add_hemisphere(RowCast *row, const Room *room, const LampTable *lamps, double kept)
{
    const uint32_t rays = row->good_rays;
    double weights = 0;
    for (uint32_t v = 0; v < row->valid_count; v++)
        weights += row->position[row->valid[v]].weight;
    for (uint32_t k = 0; k < row->rays; k++) {
        const CastPosition *p = &row->position[row->cell[k]];
        const RayEnd *end = &row->end[k];
        if (p->good == 0 || (end->patch == PATCH_NONE && !end->escaped))
            continue;
        const double share = row->weight[k] / p->good_weight * p->weight / weights *
                             mirrors_weight(room, row->patch, kept, row->cosine[k]);
        if (end->escaped)
            row->escape += share;
        else
            row_cast_add(row, end->patch, share * hemisphere_weight(row, room, lamps, k, rays));
    }
}

/* Share of the patch that lies outside solids. */
static double visible_share(const RowCast *row)
{
    double all = 0, good = 0;
    for (uint32_t p = 0; p < row->positions; p++) {
        all += row->position[p].weight;
        good += row->position[p].good > 0 ? row->position[p].weight : 0;
    }
    return all > 0 ? good / all : 0;
}

/* Sorts the keys: runs of 8 by insertion, then merged. A row has a few hundred. */
static void sort_keys(RowCast *row)
{
    enum { RUN = 8 };
    uint64_t *from = row->key, *to = row->other;
    const uint32_t n = row->keys;
    for (uint32_t k = 0; k < n; k++) {
        const uint64_t key = from[k];
        uint32_t at = k;
        for (; at % RUN != 0 && from[at - 1] > key; at--)
            from[at] = from[at - 1];
        from[at] = key;
    }
    for (uint32_t run = RUN; run < n; run *= 2) {
        for (uint32_t begin = 0; begin < n; begin += 2 * run) {
            const uint32_t middle = n - begin < run ? n : begin + run;
            const uint32_t end = n - begin < 2 * run ? n : begin + 2 * run;
            uint32_t a = begin, b = middle;
            for (uint32_t k = begin; k < end; k++)
                to[k] = b == end || (a < middle && from[a] < from[b]) ? from[a++] : from[b++];
        }
        uint64_t *const swap = from;
        from = to;
        to = swap;
    }
    row->key = from;
    row->other = to;
}

/* Sums the shares of each patch, in the order of the rays. */
static void gather_row(RowCast *row)
{
    sort_keys(row);
    row->links = 0;
    for (uint32_t k = 0; k < row->keys;) {
        const uint32_t patch = (uint32_t)(row->key[k] >> 32);
        double sum = 0;
        for (; k < row->keys && (uint32_t)(row->key[k] >> 32) == patch; k++)
            sum += row->value[(uint32_t)row->key[k]];
        if (!(sum > 0))
            continue;
        row->clamped += sum > 1;
        row->source[row->links] = patch;
        row->form_factor[row->links++] = (float)fmin(sum, 1);
    }
}

void row_cast_rays(RowCast *row, const Room *room, uint32_t patch, uint32_t seed)
{
    assert(patch < room->patches->count && row->rays > 0);
    make_rays(row, room, patch, sampling_seed(seed, room_patch_key(room, patch), SEED_ROWS, 0));
    row->cast += row->rays;
}

uint32_t row_cast_positions(RowCast *row, const Room *room, uint32_t patch, uint32_t seed)
{
    row_cast_rays(row, room, patch, seed);
    bvh_nearest_many(room->bvh, row->ray, row->hit, row->rays);
    row_cast_follow(row, room);
    row_cast_judge(row, room);
    return row->good_rays;
}

void row_cast_finish(RowCast *row, const Room *room, const LampTable *lamps, uint32_t patch)
{
    row->keys = 0;
    row->escape = 0;
    const double kept = mirrors_kept(room, patch);
    row->area = room->patches->area[patch] * visible_share(row) * kept * row->medium;
    if (row->good_rays > 0 && kept > 0) {
        add_hemisphere(row, room, lamps, kept);
        row_cast_lamps(row, room);
    }
    row->escape = fmin(row->escape, 1);
    gather_row(row);
}
