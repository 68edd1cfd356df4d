/* SPDX-License-Identifier: BSD-3-Clause */
/* radiosity/stochastic_gather.c -- light that comes to single patches, asked for from there: rays
 * over the hemisphere and to lamps, weighed by the balance heuristic [veach95]. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "math/sampling.h"
#include "radiosity/stochastic_internal.h"
#include "radiosity/visible.h"

/* Share of a visibility ray beside rays over the hemisphere; both per area at the two ends. */
static double sight_share(const Gather *g, uint32_t patch, uint32_t lamp, double lamp_weight,
                          double geometry)
{
    const Shooter *s = g->shooter;
    const double area = s->room->patches->area[lamp] * lamp_weight;
    const double by_sight = g->sights[patch] * (double)s->lamps.probability[lamp] / area;
    const double by_rays = g->rays * geometry / M_PI;
    return by_sight + by_rays > 0 ? by_sight / (by_sight + by_rays) : 0;
}

static void make_ray(const Gather *g, ShotScratch *c, uint32_t k, uint32_t patch, uint32_t index)
{
    float x[4];
    PatchPoint at;
    Vec3 u, v;
    sampling_sobol4(index, g->hemisphere_seed, x);
    shooter_place(g->shooter, patch, x, &at);
    const Vec3 n = at.point.normal, local = sampling_cosine(x[2], x[3]);
    vec3_frame(n, &u, &v);
    const Vec3 d = vec3_mad(vec3_mad(vec3_scale(n, local.z), local.x, u), local.y, v);
    c->ray[k] = ray_leaving(at.point.point, n, g->shooter->room->offset, d, INFINITY);
    c->shot[k].weight = (float)at.weight;
    c->value[k] = (float)local.z;
}

/* What a ray that came to a patch saw there. */
static void see(const Gather *g, const ShotScratch *c, uint32_t k, uint32_t patch,
                const RayEnd *end, Gathered *out)
{
    const Room *room = g->shooter->room;
    const double *e = &g->shooter->problem->emission[(size_t)end->patch * ROOM_BANDS];
    const double *b = &g->reflected[(size_t)end->patch * ROOM_BANDS];
    double share = 0;
    if (e[0] + e[1] + e[2] > 0 && g->sights[patch] > 0) {
        const Ray *ray = &c->ray[k];
        const Hit *hit = &c->hit[k];
        const Vec3 n = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
        const double there = fabs(vec3_dot(n, vec3(ray->dx, ray->dy, ray->dz)));
        const double weight = patches_weight(room->patches, room->surfaces, end->patch,
                                             end->surface, end->s, end->t);
        const double square = (double)hit->t * hit->t;
        if (square > 0)
            share = sight_share(g, patch, end->patch, weight, c->value[k] * there / square);
    }
    for (unsigned band = 0; band < ROOM_BANDS; band++) {
        out->direct[band] += c->shot[k].weight * (1 - share) * e[band];
        out->indirect[band] += c->shot[k].weight * b[band];
    }
}

/* A ray that came to a seam or the inside of a solid tells nothing. */
static void take(const Gather *g, const ShotScratch *c, uint32_t k, uint32_t patch, Gathered *out)
{
    const Room *room = g->shooter->room;
    const Hit *hit = &c->hit[k];
    RayEnd end = { .patch = PATCH_NONE };
    const bool met = hit->primitive != RAY_MISS;
    if (met)
        end.patch = room_patch(room, hit, vec3(c->ray[k].dx, c->ray[k].dy, c->ray[k].dz),
                               &end.surface, &end.s, &end.t);
    if (!met || (end.patch == PATCH_NONE && room->sides_given)) {
        out->rays++;
        out->missed++;
        return;
    }
    if (end.patch == PATCH_NONE || !(g->shooter->places->links->area[end.patch] > 0) ||
        visible_at_seam(room, end.surface, end.s, end.t))
        return;
    out->rays++;
    see(g, c, k, patch, &end, out);
}

static void gather_hemispheres(const Gather *g, ShotScratch *c, uint32_t begin, uint32_t end,
                               Gathered *out)
{
    const uint32_t count = (end - begin) * g->rays;
    assert(count <= SHOT_CHUNK);
    for (uint32_t k = 0; k < count; k++)
        make_ray(g, c, k, g->order[begin + k / g->rays], begin * g->rays + k);
    bvh_nearest_many(g->shooter->room->bvh, c->ray, c->hit, count);
    c->rays += count;
    for (uint32_t k = 0; k < count; k++)
        take(g, c, k, g->order[begin + k / g->rays], &out[k / g->rays]);
    for (uint32_t k = 0; k < end - begin; k++)
        for (unsigned b = 0; b < ROOM_BANDS && out[k].rays > 0; b++) {
            out[k].direct[b] /= out[k].rays;
            out[k].indirect[b] /= out[k].rays;
        }
}

/* One visibility ray and what it carries; false: turned away. */
static bool aim(const Gather *g, ShotScratch *c, uint32_t k, uint32_t patch, uint32_t index)
{
    const Shooter *s = g->shooter;
    const Room *room = s->room;
    PatchPoint from, to;
    float x[4];
    double rest;
    sampling_sobol4(index, g->sight_seed, x);
    shooter_place(s, patch, x, &from);
    const uint32_t lamp = lamp_table_choose(&s->lamps, x[2], &rest);
    patches_point(room->patches, room->surfaces, lamp, rest, x[3], &to);
    visible_move(room, &to);
    const Vec3 way = vec3_sub(to.point.point, from.point.point);
    const double distance = vec3_length(way);
    const double here = vec3_dot(way, from.point.normal), there = -vec3_dot(way, to.point.normal);
    if (!(here > 0 && there > 0 && distance > 2 * room->offset && to.weight > 0))
        return false;
    const double geometry = here * there / (distance * distance * distance * distance);
    c->ray[k] = ray_between(from.point.point, from.point.normal, to.point.point, to.point.normal,
                            room->offset);
    c->source[k] = lamp;
    c->value[k] = (float)(sight_share(g, patch, lamp, to.weight, geometry) * from.weight *
                          geometry / M_PI * to.weight * room->patches->area[lamp] /
                          s->lamps.probability[lamp] / g->sights[patch]);
    return true;
}

/* Traces what was aimed; c->pending tells for whom. */
static void trace_sights(const Gather *g, ShotScratch *c, uint32_t count, Gathered *out)
{
    const Shooter *s = g->shooter;
    bvh_blocked_many(s->room->bvh, c->ray, c->blocked, count);
    c->rays += count;
    for (uint32_t k = 0; k < count; k++)
        for (unsigned b = 0; b < ROOM_BANDS && !c->blocked[k]; b++)
            out[c->pending[k]].direct[b] +=
                c->value[k] * s->problem->emission[(size_t)c->source[k] * ROOM_BANDS + b];
}

static void gather_sights(const Gather *g, ShotScratch *c, uint32_t begin, uint32_t end,
                          Gathered *out)
{
    uint32_t count = 0;
    for (uint32_t k = begin; k < end; k++) {
        const uint32_t patch = g->order[k];
        for (uint32_t m = 0; m < g->sights[patch]; m++) {
            c->pending[count] = k - begin;
            count += aim(g, c, count, patch, g->first_sight[k] + m);
            if (count == SHOT_CHUNK) {
                trace_sights(g, c, count, out);
                count = 0;
            }
        }
    }
    trace_sights(g, c, count, out);
}

void gather_patches(const Gather *g, ShotScratch *c, uint32_t begin, uint32_t end, Gathered *out)
{
    assert(end - begin <= GATHER_CHUNK && g->rays <= GATHER_RAYS);
    memset(out, 0, (end - begin) * sizeof *out);
    gather_hemispheres(g, c, begin, end, out);
    if (g->shooter->lamps.count > 0)
        gather_sights(g, c, begin, end, out);
}
