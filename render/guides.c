/* SPDX-License-Identifier: BSD-3-Clause */
/* Clusters of receiving points, and what they learn of where their light comes from. */
#include "render/guides.h"

#include <assert.h>

#include "math/sampling.h"
#include "render/wave.h"

/* Normals of one cluster are within 18 degrees. */
static const double CLUSTER_COSINE = 0.95;

/* A guide is learnt with this share of the rays it will serve, within limits: a few rays per cell,
 * and no more than make it better. */
enum {
    TRAIN_SHARE = 8,
    TRAIN_MIN = 2 * GUIDE_SIDE * GUIDE_SIDE,
    TRAIN_MAX = 16 * GUIDE_SIDE * GUIDE_SIDE,
    TRAIN_NEAR = 4 * GUIDE_SIDE * GUIDE_SIDE /* for what is seen close by */
};

/* Of the training rays' ends that are looked at, so many must lie close by on one plane for a guide
 * to be worth it there. */
enum { NEAR_MIN = WAVE_RAYS / 32 };

static bool belongs(const GuideCluster *cluster, const Receiver *at)
{
    const Vec3 d = vec3_sub(at->point, cluster->first.point);
    return vec3_dot(cluster->first.normal, at->normal) > CLUSTER_COSINE &&
           fabs(vec3_dot(d, cluster->first.normal)) < cluster->reach;
}

const Guide *guides_find(const Guides *guides, const Receiver *at)
{
    for (unsigned i = 0; i < guides->count; i++)
        if (guides->cluster[i].trained && belongs(&guides->cluster[i], at))
            return &guides->cluster[i].guide;
    return NULL;
}

/* The cluster a point belongs to, a new one if need be; GUIDES_MAX when there is no room. */
static unsigned cluster_of(Guides *guides, const Receiver *at, double reach)
{
    unsigned i = 0;
    while (i < guides->count && !belongs(&guides->cluster[i], at))
        i++;
    if (i < GUIDES_MAX && i == guides->count) {
        guides->cluster[i].first = *at;
        guides->cluster[i].reach = reach;
        guides->cluster[i].members = 0;
        guides->cluster[i].trained = false;
        guides->count++;
    }
    if (i < GUIDES_MAX)
        guides->cluster[i].members++;
    return i;
}

/* Ends of training rays: light summed by cell, and a sample of those close by. */
typedef struct {
    double    light[GUIDE_SIDE][GUIDE_SIDE];
    uint32_t  number[GUIDE_SIDE][GUIDE_SIDE];
    Receiver *near; /* [WAVE_RAYS] */
    uint32_t  near_count;
} Lesson;

/* Which of the receivers casts ray k of `rays`. */
static size_t who_of(uint32_t k, uint32_t count, uint32_t rays)
{
    return (size_t)((uint64_t)k * count / rays);
}

/* What ray k finds where it ends, mirrors and glass on its way passed: what is reflected there, and
 * light of lamps that no lamp ray finds. */
static Rgb light_along(Wave *wave, const Receiver *at, uint32_t k, uint32_t seed)
{
    const Gatherer *g = wave->gatherer;
    const Room     *room = g->room;
    Rgb             pass = { 1, 1, 1 };
    wave->way[k] = (SpecularWay){ .turned = false };
    if (g->clear && room->mirrors)
        pass = specular_follow(room, g->smooth, sampling_mix(seed + k), &wave->ray[k],
                               &wave->hit[k], &wave->way[k], &wave->rays);
    if (wave->hit[k].primitive == RAY_MISS)
        return rgb(0, 0, 0);
    const WaveEnd end = wave_end(g, &wave->ray[k], &wave->hit[k]);
    Rgb           light = wave_radiosity(g, &end);
    if (wave_lamp_unaimed(wave, at, k) && room->emitting[end.surface] >> end.side & 1)
        light = rgb_mad(light, M_PI, lamps_material(room, end.surface, end.side)->emission);
    return rgb_mul(pass, light);
}

/* Rays begin..begin+n-1 of `rays`, spread over the receivers. */
static void lesson_block(Lesson *lesson, Wave *wave, const Receiver *at, uint32_t count,
                         uint32_t begin, uint32_t n, uint32_t rays, uint32_t seed)
{
    const Gatherer *g = wave->gatherer;
    uint8_t         cell[WAVE_RAYS][2];
    for (uint32_t k = 0; k < n; k++) {
        float u[2];
        sampling_sobol2(begin + k, seed, u);
        cell[k][0] = (uint8_t)(u[0] * GUIDE_SIDE);
        cell[k][1] = (uint8_t)(u[1] * GUIDE_SIDE);
        const WaveFrame frame = wave_frame(g->room, &at[who_of(begin + k, count, rays)]);
        wave->ray[k] = wave_hemisphere(&frame, u);
    }
    bvh_nearest_many(g->room->bvh, wave->ray, wave->hit, n);
    wave->rays += n;
    for (uint32_t k = 0; k < n; k++) {
        lesson->number[cell[k][0]][cell[k][1]]++;
        if (wave->hit[k].primitive == RAY_MISS)
            continue;
        const size_t who = who_of(begin + k, count, rays);
        const Rgb    light = light_along(wave, &at[who], k, seed + begin);
        if (wave->hit[k].primitive == RAY_MISS)
            continue;
        const Ray    *ray = &wave->ray[k];
        const WaveEnd end = wave_end(g, ray, &wave->hit[k]);
        /* A guide is a density: what a fit to vertices takes below 0 somewhere leads nowhere. */
        const double luminance = rgb_luminance(light);
        lesson->light[cell[k][0]][cell[k][1]] += luminance > 0 ? luminance : 0;
        const uint32_t stride = rays / WAVE_RAYS;
        if (lesson->near == NULL || (begin + k) % stride != 0 ||
            lesson->near_count == WAVE_RAYS || !(wave_nearness(g, &end, &wave->hit[k]) > 0))
            continue;
        RoomHit hit;
        room_hit(g->room, &wave->hit[k], vec3(ray->dx, ray->dy, ray->dz), &hit);
        lesson->near[lesson->near_count++] = (Receiver){ hit.point, hit.normal, hit.normal };
    }
}

/* Trains one cluster by `rays` rays from its members. */
static void cluster_train(GuideCluster *cluster, Lesson *lesson, Wave *wave, const Receiver *at,
                          uint32_t count, uint32_t rays, uint32_t seed)
{
    assert(count > 0 && rays >= WAVE_RAYS);
    for (uint32_t begin = 0; begin < rays; begin += WAVE_RAYS)
        lesson_block(lesson, wave, at, count, begin,
                     rays - begin < WAVE_RAYS ? rays - begin : WAVE_RAYS, rays, seed);
    for (int y = 0; y < GUIDE_SIDE; y++)
        for (int x = 0; x < GUIDE_SIDE; x++)
            lesson->light[y][x] /= lesson->number[y][x] > 0 ? lesson->number[y][x] : 1;
    cluster->trained = guide_init(&cluster->guide,
                                  (const double(*)[GUIDE_SIDE])lesson->light);
}

/* Members of cluster c, gathered at the front of `member`; returns how many. */
static uint32_t members_of(const Receiver *at, const uint8_t *owner, uint32_t count, unsigned c,
                           Receiver *member)
{
    uint32_t members = 0;
    for (uint32_t i = 0; i < count; i++)
        if (owner[i] == c)
            member[members++] = at[i];
    return members;
}

/* Guides for points seen close by, where light is received once more. */
static void train_near(Guides *guides, Wave *wave, const Receiver *near, uint32_t count,
                       double reach, uint32_t seed)
{
    Receiver       member[WAVE_RAYS];
    uint8_t        owner[WAVE_RAYS];
    const unsigned known = guides->count;
    for (uint32_t i = 0; i < count; i++)
        owner[i] = (uint8_t)cluster_of(guides, &near[i], reach);
    for (unsigned c = known; c < guides->count; c++) {
        Lesson         lesson = { .near = NULL };
        const uint32_t members = members_of(near, owner, count, c, member);
        if (members >= NEAR_MIN)
            cluster_train(&guides->cluster[c], &lesson, wave, member, members, TRAIN_NEAR,
                          sampling_mix(seed + c));
    }
}

void guides_train(Guides *guides, Wave *wave, const Receiver *at, const double *reach,
                  uint32_t count, uint32_t rays, uint32_t seed)
{
    assert(count <= GUIDES_POINTS);
    Receiver member[GUIDES_POINTS], near[WAVE_RAYS];
    uint8_t  owner[GUIDES_POINTS];
    guides->count = 0;
    for (uint32_t i = 0; i < count; i++)
        owner[i] = (uint8_t)cluster_of(guides, &at[i], reach[i]);
    const unsigned clusters = guides->count;
    for (unsigned c = 0; c < clusters; c++) {
        GuideCluster  *cluster = &guides->cluster[c];
        Lesson         lesson = { .near = near };
        const uint32_t members = members_of(at, owner, count, c, member);
        const uint64_t wanted = (uint64_t)members * rays / TRAIN_SHARE;
        if (wanted < TRAIN_MIN)
            continue;
        cluster_train(cluster, &lesson, wave, member, members,
                      wanted < TRAIN_MAX ? (uint32_t)wanted : TRAIN_MAX, sampling_mix(seed + c));
        train_near(guides, wave, near, lesson.near_count, cluster->reach, seed);
    }
}
