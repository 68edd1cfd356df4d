/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_shoot.c -- rays that carry the power of patches to others, many at once. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/stochastic_internal.h"
#include "radiosity/visible.h"

/* Targets that are no patches. */
static const uint32_t TARGET_LOST = UINT32_MAX, TARGET_OPEN = UINT32_MAX - 1;

/* A ray that came to a seam or the inside of a solid is shot anew, this often: even where half of
 * them do, less than one in 10^3 is left, whose power goes to the others. */
enum { SHOT_TRIES = 10 };

bool shooter_create(Shooter *s, Error *err)
{
    static const char what[] = "the rays of patches";
    s->scratch = array_create(s->threads, sizeof *s->scratch, what, err);
    s->chunk = array_create(SHOT_ROUND, sizeof *s->chunk, what, err);
    s->first_ray = array_create((size_t)s->count + 1, sizeof *s->first_ray, what, err);
    s->seen = array_create(s->count, sizeof *s->seen, what, err);
    s->square = array_create(s->count, sizeof *s->square, what, err);
    s->missed = array_create(s->count, sizeof *s->missed, what, err);
    s->told = array_create(s->count, sizeof *s->told, what, err);
    for (unsigned k = 0; k < s->threads && s->scratch != NULL; k++) {
        ShotScratch *c = &s->scratch[k];
        c->ray = array_create(SHOT_CHUNK, sizeof *c->ray, what, err);
        c->hit = array_create(SHOT_CHUNK, sizeof *c->hit, what, err);
        c->blocked = array_create(SHOT_CHUNK, sizeof *c->blocked, what, err);
        c->pending = array_create(SHOT_CHUNK, sizeof *c->pending, what, err);
        c->source = array_create(SHOT_CHUNK, sizeof *c->source, what, err);
        c->value = array_create(SHOT_CHUNK, sizeof *c->value, what, err);
        c->shot = array_create(SHOT_CHUNK, sizeof *c->shot, what, err);
        c->gathered = array_create(GATHER_CHUNK, sizeof *c->gathered, what, err);
    }
    for (uint32_t k = 0; k < SHOT_ROUND && s->chunk != NULL; k++)
        s->chunk[k].shot = array_create(SHOT_CHUNK, sizeof *s->chunk[k].shot, what, err);
    return !error_is_set(err) && lamp_table_create(s->room, &s->lamps, err);
}

void shooter_clear(Shooter *s)
{
    for (unsigned k = 0; k < s->threads && s->scratch != NULL; k++) {
        ShotScratch *c = &s->scratch[k];
        array_free(c->ray);
        array_free(c->hit);
        array_free(c->blocked);
        array_free(c->pending);
        array_free(c->source);
        array_free(c->value);
        array_free(c->shot);
        array_free(c->gathered);
    }
    for (uint32_t k = 0; k < SHOT_ROUND && s->chunk != NULL; k++)
        array_free(s->chunk[k].shot);
    array_free(s->scratch);
    array_free(s->chunk);
    array_free(s->first_ray);
    array_free(s->seen);
    array_free(s->square);
    array_free(s->missed);
    array_free(s->told);
    lamp_table_clear(&s->lamps);
}

void shooter_place(const Shooter *s, uint32_t patch, const float x[2], PatchPoint *at)
{
    open_cells_place(s->room, s->places->open[patch], patch, x, at);
}

/* --- one chunk -------------------------------------------------------------------------------- */

/* Rays are dealt to patches in proportion to their power, by one comb over all of it. */
static void deal_rays(const ShotPass *pass)
{
    const Shooter *s = pass->shooter;
    float offset[2];
    double before = 0;
    sampling_sobol2(0, sampling_seed(pass->seed, 1, 0, 0), offset);
    s->first_ray[0] = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const double *p = &pass->power[(size_t)i * ROOM_BANDS];
        before += p[0] + p[1] + p[2];
        const double comb = floor(before / pass->all * pass->rays + offset[0]);
        s->first_ray[i + 1] = (uint32_t)fmin(comb, pass->rays);
        assert(s->first_ray[i + 1] >= s->first_ray[i]);
    }
    /* Rounding of the sum may lose the last ray. */
    for (uint32_t i = s->count; i > 0 && s->first_ray[i] < pass->rays; i--) {
        const double *p = &pass->power[(size_t)(i - 1) * ROOM_BANDS];
        s->first_ray[i] = pass->rays;
        if (p[0] + p[1] + p[2] > 0)
            break;
    }
}

static uint32_t patch_of_ray(const Shooter *s, uint32_t ray)
{
    uint32_t low = 0, high = s->count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (s->first_ray[middle] <= ray)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void make_ray(const ShotPass *pass, ShotScratch *c, uint32_t index, uint32_t k,
                     uint32_t seed, Ray *ray)
{
    float x[4];
    PatchPoint at;
    Vec3 u, v;
    sampling_sobol4(index, seed, x);
    shooter_place(pass->shooter, c->source[k], x, &at);
    const Vec3 n = at.point.normal, local = sampling_cosine(x[2], x[3]);
    vec3_frame(n, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, local.z), local.x, u), local.y, v);
    *ray = ray_leaving(at.point.point, n, pass->shooter->room->offset, d, INFINITY);
    c->shot[k] = (Shot){ .target = TARGET_LOST, .source = c->source[k],
                         .weight = (float)at.weight };
    c->value[k] = (float)local.z;
}

/* Share of a ray from a lamp that counts beside visibility rays to it. */
static double hit_share(const ShotPass *pass, const Hit *hit, const Ray *ray, const RayEnd *end,
                        uint32_t source, double cosine)
{
    const Room *room = pass->shooter->room;
    const Vec3 n = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
    const double there = fabs(vec3_dot(n, vec3(ray->dx, ray->dy, ray->dz)));
    const double here = patches_weight(room->patches, room->surfaces, end->patch, end->surface,
                                       end->s, end->t);
    const double square = (double)hit->t * hit->t;
    if (!(square > 0))
        return 1;
    return 1 - shooter_share(pass->shooter, source, end->patch, here, cosine * there / square,
                             pass->rays);
}

/* Whether the ray tells where its power goes. */
static bool resolve(const ShotPass *pass, ShotScratch *c, const Ray *ray, const Hit *hit,
                    uint32_t k)
{
    const Room *room = pass->shooter->room;
    const Vec3 way = vec3(ray->dx, ray->dy, ray->dz);
    RayEnd end;
    if (hit->primitive == RAY_MISS) {
        c->shot[k].target = TARGET_OPEN;
        return true;
    }
    end.patch = room_patch(room, hit, way, &end.surface, &end.s, &end.t);
    if (end.patch == PATCH_NONE && room->sides_given) {
        c->shot[k].target = TARGET_OPEN;
        return true;
    }
    if (end.patch == PATCH_NONE || !(pass->shooter->places->links->area[end.patch] > 0) ||
        visible_at_seam(room, end.surface, end.s, end.t))
        return false;
    c->shot[k].target = end.patch;
    c->value[k] = pass->lamps ? (float)hit_share(pass, hit, ray, &end, c->source[k], c->value[k])
                              : 1;
    return true;
}

/* Sorts the hits by ranges of patches, in the order of the rays, and sums what was sent. */
static void sort_shots(const ShotPass *pass, const ShotScratch *c, uint32_t count,
                       ShotChunk *chunk)
{
    const Shooter *s = pass->shooter;
    uint32_t at[SHOT_BUCKETS + 1] = { 0 };
    memset(chunk->sent, 0, sizeof chunk->sent);
    memset(chunk->escaped, 0, sizeof chunk->escaped);
    for (uint32_t k = 0; k < count; k++) {
        const Shot *shot = &c->shot[k];
        if (shot->target == TARGET_LOST)
            continue;
        const double *p = &pass->power[(size_t)shot->source * ROOM_BANDS];
        const double value = (double)shot->weight / (p[0] + p[1] + p[2]);
        for (unsigned b = 0; b < ROOM_BANDS; b++) {
            chunk->sent[b] += value * p[b];
            chunk->escaped[b] += shot->target == TARGET_OPEN ? value * p[b] : 0;
        }
        if (shot->target != TARGET_OPEN)
            at[(uint64_t)shot->target * SHOT_BUCKETS / s->count + 1]++;
    }
    for (uint32_t k = 0; k < SHOT_BUCKETS; k++)
        at[k + 1] += at[k];
    memcpy(chunk->first, at, sizeof at);
    for (uint32_t k = 0; k < count; k++)
        if (c->shot[k].target < TARGET_OPEN) {
            Shot *out = &chunk->shot[at[(uint64_t)c->shot[k].target * SHOT_BUCKETS / s->count]++];
            *out = c->shot[k];
            out->weight *= c->value[k];
        }
}

static void shoot_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    ShotPass *pass = context;
    Shooter *s = pass->shooter;
    ShotScratch *c = &s->scratch[worker];
    const uint32_t first = pass->round + begin, count = end - begin;
    uint32_t patch = patch_of_ray(s, first), left = count;
    for (uint32_t k = 0; k < count; k++) {
        while (s->first_ray[patch + 1] <= first + k)
            patch++;
        c->source[k] = patch;
        c->pending[k] = k;
    }
    for (uint32_t attempt = 0; attempt < SHOT_TRIES && left > 0; attempt++) {
        const uint32_t seed = sampling_seed(pass->seed, 0, attempt, 0), tried = left;
        for (uint32_t k = 0; k < tried; k++)
            make_ray(pass, c, first + c->pending[k], c->pending[k], seed, &c->ray[k]);
        bvh_nearest_many(s->room->bvh, c->ray, c->hit, tried);
        c->rays += tried;
        left = 0;
        for (uint32_t k = 0; k < tried; k++)
            if (!resolve(pass, c, &c->ray[k], &c->hit[k], c->pending[k]))
                c->pending[left++] = c->pending[k];
    }
    sort_shots(pass, c, count, &s->chunk[begin / SHOT_CHUNK]);
}

static void sum_bucket(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const ShotPass *pass = context;
    const uint32_t left = pass->rays - pass->round;
    (void)worker;
    for (uint32_t bucket = begin; bucket < end; bucket++)
        for (uint32_t c = 0; c < SHOT_ROUND && c * SHOT_CHUNK < left; c++) {
            const ShotChunk *chunk = &pass->shooter->chunk[c];
            for (uint32_t k = chunk->first[bucket]; k < chunk->first[bucket + 1]; k++) {
                const Shot *shot = &chunk->shot[k];
                const double *p = &pass->power[(size_t)shot->source * ROOM_BANDS];
                double *out = &pass->arrived[(size_t)shot->target * ROOM_BANDS];
                const double value = shot->weight / (p[0] + p[1] + p[2]) * pass->all / pass->rays;
                for (unsigned b = 0; b < ROOM_BANDS; b++)
                    out[b] += value * p[b];
            }
        }
}

void shooter_shoot(ShotPass *pass)
{
    Shooter *s = pass->shooter;
    assert(pass->rays > 0 && pass->all > 0);
    memset(pass->sent, 0, sizeof pass->sent);
    memset(pass->escaped, 0, sizeof pass->escaped);
    deal_rays(pass);
    for (pass->round = 0; pass->round < pass->rays;) {
        const uint32_t left = pass->rays - pass->round;
        const uint32_t most = SHOT_ROUND * SHOT_CHUNK, count = left < most ? left : most;
        parallel_for(count, SHOT_CHUNK, s->threads, shoot_chunk, pass, NULL, NULL);
        parallel_for(SHOT_BUCKETS, 1, s->threads, sum_bucket, pass, NULL, NULL);
        for (uint32_t c = 0; c * SHOT_CHUNK < count; c++)
            for (unsigned b = 0; b < ROOM_BANDS; b++) {
                pass->sent[b] += s->chunk[c].sent[b] * pass->all / pass->rays;
                pass->escaped[b] += s->chunk[c].escaped[b] * pass->all / pass->rays;
            }
        pass->round += count;
    }
}
