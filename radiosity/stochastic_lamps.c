/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_lamps.c -- light straight from lamps: visibility rays from all patches and
 * rays from the lamps, weighed by the balance heuristic [veach95]. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/parallel.h"
#include "math/sampling.h"
#include "radiosity/stochastic_internal.h"
#include "radiosity/visible.h"

enum { LIGHT_CHUNK = 4096 };

typedef struct {
    Shooter *shooter;
    uint32_t batch, rays;
    double  *out;
} LightPass;

static double bands_sum(const double *p)
{
    return p[0] + p[1] + p[2];
}

double shooter_share(const Shooter *s, uint32_t lamp, uint32_t patch, double weight,
                     double geometry, uint32_t rays)
{
    const double *emission = &s->problem->emission[(size_t)lamp * ROOM_BANDS];
    const double area = s->places->links->area[patch] * s->room->patches->area[lamp];
    const double by_sight = s->samples * (double)s->lamps.probability[lamp] / (area * weight);
    const double by_rays = rays * bands_sum(emission) / s->lamp_power * geometry / M_PI;
    return by_sight + by_rays > 0 ? by_sight / (by_sight + by_rays) : 0;
}

/* One visibility ray and what it carries, irradiance per exitance; false: turned away. */
static bool aim(const LightPass *pass, uint32_t patch, uint32_t m, uint32_t seed, Ray *ray,
                uint32_t *lamp, float *value)
{
    const Shooter *s = pass->shooter;
    const Room *room = s->room;
    PatchPoint from, to;
    float x[4];
    double rest;
    sampling_sobol4(m, seed, x);
    shooter_place(s, patch, x, &from);
    *lamp = lamp_table_choose(&s->lamps, x[2], &rest);
    patches_point(room->patches, room->surfaces, *lamp, rest, x[3], &to);
    visible_move(room, &to);
    const Vec3 way = vec3_sub(to.point.point, from.point.point);
    const double distance = vec3_length(way);
    const double here = vec3_dot(way, from.point.normal), there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && distance > 2 * room->offset && to.weight > 0
          && from.weight > 0))
        return false;
    const double geometry = here * there / (distance * distance * distance * distance);
    const double share = shooter_share(s, *lamp, patch, from.weight, geometry, pass->rays);
    *ray = ray_between(from.point.point, from.point.normal, to.point.point, to.point.normal,
                       room->offset);
    *value = (float)(share * from.weight * geometry / M_PI * to.weight
                     * room->patches->area[*lamp] / s->lamps.probability[*lamp] / s->samples);
    return true;
}

/* Traces what was aimed and adds it up; c->pending holds the patches. */
static void gather_rays(const LightPass *pass, ShotScratch *c, uint32_t count)
{
    const Shooter *s = pass->shooter;
    bvh_blocked_many(s->room->bvh, c->ray, c->blocked, count);
    c->rays += count;
    for (uint32_t k = 0; k < count; k++) {
        const size_t i = c->pending[k];
        if (c->blocked[k])
            continue;
        const double power = c->value[k] * s->places->links->area[i] *
                             bands_sum(&s->problem->emission[(size_t)c->source[k] * ROOM_BANDS]);
        s->seen[i] += (float)power;
        s->square[i] += (float)(power * power);
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            pass->out[i * ROOM_BANDS + b] += c->value[k] * s->places->links->area[i] *
                s->problem->emission[(size_t)c->source[k] * ROOM_BANDS + b];
    }
}

static void light_chunk(void *context, uint32_t begin, uint32_t end, unsigned worker)
{
    const LightPass *pass = context;
    const Shooter *s = pass->shooter;
    ShotScratch *c = &s->scratch[worker];
    uint32_t count = 0;
    for (uint32_t i = begin; i < end; i++) {
        if (!(s->places->links->area[i] > 0))
            continue;
        const uint32_t seed = sampling_seed(s->seed, room_patch_key(s->room, i), SEED_LAMPS,
                                            pass->batch % 2);
        for (uint32_t k = 0; k < s->samples; k++) {
            c->pending[count] = i;
            count += aim(pass, i, pass->batch / 2 * s->samples + k, seed, &c->ray[count],
                         &c->source[count], &c->value[count]);
            if (count == SHOT_CHUNK) {
                gather_rays(pass, c, count);
                count = 0;
            }
        }
    }
    gather_rays(pass, c, count);
}

/* What escapes is known from the rays of the lamps; all else arrives. */
static void balance(const Shooter *s, const ShotPass *shots, const double *power, double *out,
                    double escaped[ROOM_BANDS])
{
    double arrived[ROOM_BANDS] = { 0 }, scale[ROOM_BANDS];
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            arrived[b] += out[(size_t)i * ROOM_BANDS + b];
    for (unsigned b = 0; b < ROOM_BANDS; b++) {
        escaped[b] = shots->sent[b] > 0 ? power[b] * shots->escaped[b] / shots->sent[b] : 0;
        if (!(arrived[b] > 0))
            escaped[b] = power[b];
        scale[b] = arrived[b] > 0 ? (power[b] - escaped[b]) / arrived[b] : 0;
    }
    for (uint32_t i = 0; i < s->count; i++)
        for (unsigned b = 0; b < ROOM_BANDS; b++)
            out[(size_t)i * ROOM_BANDS + b] *= scale[b];
}

void shooter_light(Shooter *s, uint32_t batch, uint32_t rays, double *emitted, double *out,
                   double escaped[ROOM_BANDS])
{
    double power[ROOM_BANDS] = { 0 };
    memset(out, 0, (size_t)s->count * ROOM_BANDS * sizeof *out);
    memset(escaped, 0, ROOM_BANDS * sizeof *escaped);
    for (size_t k = 0; k < (size_t)s->count * ROOM_BANDS; k++) {
        emitted[k] = s->places->links->area[k / ROOM_BANDS] * s->problem->emission[k];
        power[k % ROOM_BANDS] += emitted[k];
    }
    s->lamp_power = bands_sum(power);
    if (!(s->lamp_power > 0))
        return;
    LightPass pass = { .shooter = s, .batch = batch, .rays = rays, .out = out };
    ShotPass shots = { .shooter = s, .power = emitted, .all = s->lamp_power, .arrived = out,
                       .rays = rays, .lamps = s->lamps.count > 0,
                       .seed = sampling_seed(s->seed, SEED_LAMPS, batch, UINT32_MAX) };
    if (s->lamps.count > 0)
        parallel_for(s->count, LIGHT_CHUNK, s->threads, light_chunk, &pass, NULL, NULL);
    shooter_shoot(&shots);
    balance(s, &shots, power, out, escaped);
}
