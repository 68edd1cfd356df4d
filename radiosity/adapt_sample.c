/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/adapt_sample.c -- direct light at points of a patch, by visibility rays to the lamps
 * that its row of links names, each as often as it brings light, and to point lights. */
#include <assert.h>
#include <float.h>
#include <math.h>

#include "base/array.h"
#include "math/sampling.h"
#include "radiosity/adapt_internal.h"

static const char what[] = "light at points of patches";

/* Times as many rays where some are blocked and some are not. */
enum { SHADE_ROUNDS = 4 };

bool adapt_sampler_create(AdaptSampler *s, const Room *room, const Links *links,
                          const float *radius, const AdaptPiece *piece, uint32_t rays,
                          uint32_t seed, Error *err)
{
    const uint32_t half = (rays + 2 * ADAPT_POINTS - 1) / (2 * ADAPT_POINTS);
    *s = (AdaptSampler){ .room = room, .links = links, .radius = radius, .piece = piece,
                         .seed = seed, .rays = half };
    s->capacity = 2 * ADAPT_POINTS * half > ADAPT_POINTS ? 2 * ADAPT_POINTS * half : ADAPT_POINTS;
    s->ray = array_create(s->capacity, sizeof *s->ray, what, err);
    s->blocked = array_create(s->capacity, sizeof *s->blocked, what, err);
    s->value = array_create(s->capacity, sizeof *s->value, what, err);
    s->slot = array_create(s->capacity, sizeof *s->slot, what, err);
    return row_cast_create(&s->cast, ADAPT_POINTS * RAYS_PER_POSITION, 0, err) &&
           !error_is_set(err);
}

void adapt_sampler_clear(AdaptSampler *s)
{
    row_cast_clear(&s->cast);
    array_free(s->lamp);
    array_free(s->cumulative);
    array_free(s->ray);
    array_free(s->blocked);
    array_free(s->value);
    array_free(s->slot);
}

/* Points spread over the patch; where something hides a part of it, those that are not hidden. */
static uint32_t choose_points(AdaptSampler *s, uint32_t patch)
{
    const Room *room = s->room;
    if (s->links->area[patch] < room->patches->area[patch]) {
        row_cast_positions(&s->cast, room, patch, s->seed);
        for (uint32_t k = 0; k < s->cast.valid_count; k++)
            s->at[k] = s->cast.position[s->cast.valid[k]].at;
        return s->cast.valid_count;
    }
    const uint32_t seed = sampling_seed(s->seed, room_patch_key(room, patch), SEED_ADAPT, 0);
    for (uint32_t k = 0; k < ADAPT_POINTS; k++) {
        float x[2];
        sampling_sobol2(k, seed, x);
        patches_point(room->patches, room->surfaces, patch, x[0], x[1], &s->at[k]);
    }
    return ADAPT_POINTS;
}

static bool list_lamps(AdaptSampler *s, uint32_t patch)
{
    const Links *links = s->links;
    double sum = 0;
    s->lamp_count = 0;
    for (uint64_t k = links->first[patch]; k < links->first[patch + 1]; k++) {
        const uint32_t j = links->source[k];
        const double light = rgb_luminance(room_emission(s->room, j)) * links->form_factor[k];
        const size_t n = s->lamp_count + 1;
        if (!(light > 0))
            continue;
        if (!array_reserve((void **)&s->lamp, &s->lamp_capacity, n, sizeof *s->lamp, what,
                           &s->error) ||
            !array_reserve((void **)&s->cumulative, &s->cumulative_capacity, n,
                           sizeof *s->cumulative, what, &s->error))
            return false;
        sum += light;
        s->lamp[s->lamp_count] = j;
        s->cumulative[s->lamp_count++] = sum;
    }
    return sum > 0;
}

/* First lamp whose cumulative light passes u; *rest in [0, 1) is what the choice leaves of u. */
static size_t choose_lamp(const AdaptSampler *s, double u, double *rest)
{
    size_t low = 0, high = s->lamp_count - 1;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (s->cumulative[middle] > u)
            high = middle;
        else
            low = middle + 1;
    }
    const double before = low > 0 ? s->cumulative[low - 1] : 0;
    *rest = fmin(fmax((u - before) / (s->cumulative[low] - before), 0), 1 - 0x1p-53);
    return low;
}

/* Light that comes from where u and v choose a lamp, were nothing in the way, divided by the chance
 * of that choice; *ray asks whether something is. */
static double light_from(const AdaptSampler *s, const PatchPoint *from, double u, double v,
                         Ray *ray)
{
    const Room *room = s->room;
    const double all = s->cumulative[s->lamp_count - 1];
    double rest;
    PatchPoint to;
    const size_t k = choose_lamp(s, u * all, &rest);
    const uint32_t lamp = s->lamp[k];
    const double chance = (s->cumulative[k] - (k > 0 ? s->cumulative[k - 1] : 0)) / all;
    patches_point(room->patches, room->surfaces, lamp, rest, v, &to);
    const Vec3 p = from->point.point, q = to.point.point, way = vec3_sub(q, p);
    const double square = vec3_dot(way, way);
    const double here = vec3_dot(way, from->point.normal), there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && sqrt(square) > 2 * room->offset))
        return 0;
    *ray = ray_between(p, from->point.normal, q, to.point.normal, room->offset);
    return rgb_luminance(room_emission(room, lamp)) * room->patches->area[lamp] * to.weight *
           here * there / (M_PI * square * square * chance);
}

/* Adds what the rays aimed bring; returns how many were blocked. */
static uint32_t flush(AdaptSampler *s, AdaptPoint *point)
{
    uint32_t blocked = 0;
    bvh_blocked_many(s->room->bvh, s->ray, s->blocked, s->aimed);
    for (uint32_t k = 0; k < s->aimed; k++)
        if (s->blocked[k])
            blocked++;
        else
            point[s->slot[k] / 2].direct[s->slot[k] % 2] += s->value[k];
    s->aimed = 0;
    return blocked;
}

/* How much the rays aimed, of `count` that were tried, differ in what they could bring. */
static double spread_of(const AdaptSampler *s, uint32_t count)
{
    double sum = 0, squares = 0;
    for (uint32_t k = 0; k < s->aimed; k++) {
        const double value = (double)s->value[k];
        sum += value;
        squares += value * value;
    }
    return sum > 0 ? fmax(squares * count / (sum * sum) - 1, 0) : 0;
}

/* Where nothing is in the way, how light changes over the patch is seen best when all points look
 * at the same places of the lamps; how much there is in all stays what the rays found. */
static void smooth_open_light(const AdaptSampler *s, uint32_t points, AdaptPoint *point)
{
    enum { PLACES = 4 };
    static const double place[PLACES][2] = {
        { 0.125, 0.375 }, { 0.375, 0.875 }, { 0.625, 0.125 }, { 0.875, 0.625 }
    };
    double light[ADAPT_POINTS], all = 0, found[2] = { 0, 0 };
    for (uint32_t k = 0; k < points; k++) {
        Ray ignored;
        light[k] = 0;
        for (int i = 0; i < PLACES; i++)
            light[k] += light_from(s, &s->at[k], place[i][0], place[i][1], &ignored);
        all += (double)point[k].weight * light[k];
        for (int half = 0; half < 2; half++)
            found[half] += (double)point[k].weight * (double)point[k].direct[half];
    }
    for (uint32_t k = 0; k < points && all > 0; k++)
        for (int half = 0; half < 2; half++)
            point[k].direct[half] = (float)(light[k] * (found[half] / all));
}

/* Aims a round of rays, each half and point `rays` of them. */
static void aim_round(AdaptSampler *s, uint32_t patch, uint32_t round, uint32_t points)
{
    const uint32_t key = room_patch_key(s->room, patch);
    for (uint32_t half = 0; half < 2; half++) {
        const uint32_t seed = sampling_seed(s->seed, key, SEED_ADAPT, 1 + half);
        for (uint32_t k = 0; k < points * s->rays; k++) {
            const uint32_t i = k / s->rays;
            float x[2];
            sampling_sobol2((i * SHADE_ROUNDS + round) * s->rays + k % s->rays, seed, x);
            assert(s->aimed < s->capacity);
            const double light = light_from(s, &s->at[i], x[0], x[1], &s->ray[s->aimed]);
            if (!(light > 0))
                continue;
            s->value[s->aimed] = (float)(light / s->rays);
            s->slot[s->aimed++] = 2 * i + half;
        }
    }
}

/* In half shade, where one ray gets through and the next does not, it takes more of them. */
static void light_from_lamps(AdaptSampler *s, uint32_t patch, uint32_t points, AdaptPoint *point)
{
    aim_round(s, patch, 0, points);
    const uint32_t aimed = s->aimed;
    s->spread = spread_of(s, 2 * points * s->rays);
    const uint32_t blocked = flush(s, point);
    s->open = blocked == 0;
    if (s->open)
        smooth_open_light(s, points, point);
    if (s->open || blocked == aimed)
        return;
    for (uint32_t round = 1; round < SHADE_ROUNDS; round++) {
        aim_round(s, patch, round, points);
        flush(s, point);
    }
    for (uint32_t k = 0; k < points; k++)
        for (int half = 0; half < 2; half++)
            point[k].direct[half] /= SHADE_ROUNDS;
}

/* A point light needs one ray: both halves get the same. */
static void light_from_points(AdaptSampler *s, const Light *light, uint32_t points,
                              AdaptPoint *point)
{
    const double intensity = rgb_luminance(light->intensity);
    for (uint32_t k = 0; k < points; k++) {
        const SurfacePoint *at = &s->at[k].point;
        const double value = light_arriving(light, at->point, at->normal);
        if (!(value > 0))
            continue;
        s->ray[s->aimed] = ray_to_light(s->room, light, at->point, at->normal);
        s->value[s->aimed] = (float)(value * intensity);
        s->slot[s->aimed++] = 2 * k;
    }
    bvh_blocked_many(s->room->bvh, s->ray, s->blocked, s->aimed);
    for (uint32_t k = 0; k < s->aimed; k++)
        for (uint32_t half = 0; half < 2 && !s->blocked[k]; half++)
            point[s->slot[k] / 2].direct[half] += s->value[k];
    s->aimed = 0;
}

/* --- light spread over the points ------------------------------------------------------------- */

/* Sources nearer than so many of their radii are taken in pieces, that many each way: discs for
 * what a patch stands on make light change five times as much as it does. */
static const double NEAR_RADII = 2.5;
enum { PIECES_ACROSS = 2 };

static void set_field(AdaptSampler *s, uint32_t points)
{
    AdaptField *f = &s->field;
    double weights = 0;
    *f = (AdaptField){ .count = points };
    for (uint32_t k = 0; k < points; k++)
        weights += s->at[k].weight;
    for (uint32_t k = 0; k < points && weights > 0; k++) {
        f->origin = s->at[0].point.point;
        const Vec3 p = vec3_sub(s->at[k].point.point, f->origin), n = s->at[k].point.normal;
        f->x[k] = (float)p.x;
        f->y[k] = (float)p.y;
        f->z[k] = (float)p.z;
        f->nx[k] = (float)n.x;
        f->ny[k] = (float)n.y;
        f->nz[k] = (float)n.z;
        f->weight[k] = (float)(s->at[k].weight / weights);
    }
}

/* Adds what a disc of that area in the place of a source sends to the points:
 * cos cos A / (pi d^2 + A) [wallace89]. */
static void add_disc(const AdaptField *f, Vec3 centre, Vec3 normal, double disc, float *kernel)
{
    const Vec3 c = vec3_sub(centre, f->origin);
    const float cx = (float)c.x, cy = (float)c.y, cz = (float)c.z, area = (float)disc;
    const float mx = (float)normal.x, my = (float)normal.y, mz = (float)normal.z;
    const float pi = (float)M_PI;
    for (uint32_t k = 0; k < ADAPT_POINTS; k++) {
        const float dx = cx - f->x[k], dy = cy - f->y[k], dz = cz - f->z[k];
        const float square = dx * dx + dy * dy + dz * dz;
        const float here = dx * f->nx[k] + dy * f->ny[k] + dz * f->nz[k];
        const float there = -(dx * mx + dy * my + dz * mz);
        const float cosines = (here > 0 ? here : 0) * (there > 0 ? there : 0);
        kernel[k] += area * cosines / (square * (pi * square + area) + FLT_MIN);
    }
}

void adapt_spread(AdaptSampler *s, uint32_t patch, uint32_t source, double share, double reflected,
                  double own)
{
    const Patches *patches = s->room->patches;
    AdaptField *f = &s->field;
    float kernel[ADAPT_POINTS] = { 0 }, lit[ADAPT_POINTS] = { 0 }, mean = 0;
    const Vec3 way = vec3_sub(patches->centre[source], f->origin);
    const double reach = NEAR_RADII * (double)s->radius[source];
    const bool near = vec3_dot(way, way) < reach * reach;
    AdaptShares *to = near ? &f->near : &f->far;
    if (near)
        adapt_pieces_seen(&s->piece[(size_t)source * ADAPT_PIECES], s->at, f->count, kernel, lit);
    else
        add_disc(f, patches->centre[source], patches->normal[source], patches->area[source],
                 kernel);
    for (uint32_t k = 0; k < ADAPT_POINTS; k++)
        mean += f->weight[k] * kernel[k];
    /* Over a patch that is small beside the pieces, light changes less than their steps. */
    const double fine = (double)s->radius[patch] * PIECES_ACROSS / (double)s->radius[source];
    const float steps = near && mean > 0 ? (float)fmin(fine, 1) : 0;
    const float scale = mean > 0 ? (float)share / mean : 0;
    for (uint32_t k = 0; k < ADAPT_POINTS; k++) {
        const float part = mean > 0 ? scale * kernel[k] : (float)share;
        to->share[k] += part;
        to->reflected[k] += steps * scale * lit[k] + (1 - steps) * part * (float)reflected;
        to->own[k] += part * (float)own;
    }
}

/* What is near hides what is far: the far sources and the dark share what the near ones leave. */
void adapt_collect(AdaptSampler *s, double escape, double indirect, double total, uint32_t points,
                   AdaptPoint *point)
{
    const AdaptField *f = &s->field;
    double indirects = 0, totals = 0;
    for (uint32_t k = 0; k < points; k++) {
        const double near = fmax((double)f->near.share[k], DBL_MIN), most = fmin(near, 1);
        const double far = (double)f->far.share[k] + escape;
        const double near_part = most / near, far_part = far > 0 ? (1 - most) / far : 0;
        const double light = (double)f->near.reflected[k] * near_part +
                             (double)f->far.reflected[k] * far_part;
        const double own = (double)f->near.own[k] * near_part + (double)f->far.own[k] * far_part;
        point[k].indirect = (float)light;
        point[k].total = (float)(light + own);
        indirects += (double)f->weight[k] * light;
        totals += (double)f->weight[k] * (light + own);
    }
    for (uint32_t k = 0; k < points; k++) {
        point[k].indirect = (float)(indirects > 0 ? point[k].indirect * (indirect / indirects)
                                                  : indirect);
        point[k].total = (float)(totals > 0 ? point[k].total * (total / totals) : total);
    }
}

/* --- all of a patch --------------------------------------------------------------------------- */

uint32_t adapt_sample(AdaptSampler *s, uint32_t patch, AdaptPoint *point)
{
    const uint32_t n = choose_points(s, patch);
    assert(n <= ADAPT_POINTS);
    set_field(s, n);
    s->spread = 0;
    s->open = true;
    for (uint32_t k = 0; k < n; k++)
        point[k] = (AdaptPoint){ .surface = s->at[k].surface, .s = (float)s->at[k].s,
                                 .t = (float)s->at[k].t, .weight = (float)s->at[k].weight };
    if (list_lamps(s, patch))
        light_from_lamps(s, patch, n, point);
    for (size_t k = 0; k < s->room->light_count; k++)
        light_from_points(s, &s->room->lights[k], n, point);
    return n;
}
