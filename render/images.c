/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat mirrors: which planes they lie on, and light of lamps by way of them. */
#include "render/images.h"

#include <assert.h>
#include <string.h>

#include "base/array.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "render/clear.h"
#include "render/wave.h"

/* Planes looked at before the largest are chosen: a ball of small mirrors has more than one could
 * use, and each surface is compared with all. */
enum { CANDIDATES = 64 };
/* Of all area that mirrors, a plane with less is left to hemisphere rays: what it throws is little,
 * and of a ball of mirrors none of the hundreds is worth rays of its own. */
static const double SHARE_LEAST = 1.0 / 32;
/* 1 - cosine of a thousandth of a radian: turned by no more, two mirrors count as one plane, and
 * show a lamp off its place by 2/1000 of its distance at most. */
static const double TURN_MOST = 5e-7;

typedef struct {
    const Room  *room;
    const float *smooth;
    ImagePlane   plane[CANDIDATES];
    uint32_t     count;
} Search;

static bool is_mirror(const Room *room, uint32_t surface, unsigned side)
{
    const Material *m = lamps_material(room, surface, side);
    return mirrors_is(m) && rgb_max(m->specular) > 0 && isinf(m->exponent) &&
           !(rgb_max(m->transmittance) > 0) && !m->cut_out;
}

/* Whether triangle t lies on a plane, and is shown flat. */
static bool lies_on(const Search *s, uint32_t t, const ImagePlane *plane)
{
    const Surfaces *surfaces = s->room->surfaces;
    for (unsigned k = 0; k < 3; k++) {
        const Vec3 p = surfaces->position[surfaces->corner[3 * (size_t)t + k]];
        if (fabs(vec3_dot(p, plane->normal) - plane->height) > s->room->offset)
            return false;
        if (s->smooth == NULL)
            continue;
        const float *n = s->smooth + 9 * (size_t)t + 3 * (size_t)k;
        if (fabs(vec3_dot(vec3(n[0], n[1], n[2]), plane->normal)) < 1 - TURN_MOST)
            return false;
    }
    return true;
}

/* The plane of a side that is a flat mirror; its area is the side's own. */
static bool plane_of(const Search *s, uint32_t surface, unsigned side, ImagePlane *plane)
{
    const Surfaces *surfaces = s->room->surfaces;
    const Surface  *f = &surfaces->surface[surface];
    if (f->kind == SURFACE_SHAPE || !is_mirror(s->room, surface, side))
        return false;
    const uint32_t t = f->primitive;
    const Vec3     a = surfaces->position[surfaces->corner[3 * (size_t)t]];
    const Vec3     n = surfaces_normal(surfaces, t, 0, 0);
    plane->normal = side == 0 ? n : vec3_scale(n, -1);
    plane->height = vec3_dot(a, plane->normal);
    plane->area = 0;
    for (uint32_t k = 0; k < (f->kind == SURFACE_QUAD ? 2 : 1); k++) {
        const uint32_t *c = surfaces->corner + 3 * (size_t)(t + k);
        const Vec3      o = surfaces->position[c[0]];
        plane->area += vec3_length(vec3_cross(vec3_sub(surfaces->position[c[1]], o),
                                              vec3_sub(surfaces->position[c[2]], o))) / 2;
        if (!lies_on(s, t + k, plane))
            return false;
    }
    return true;
}

/* Index of a candidate that is the same plane; s->count: none. */
static uint32_t find(const Search *s, const ImagePlane *plane)
{
    uint32_t k = 0;
    while (k < s->count &&
           !(vec3_dot(plane->normal, s->plane[k].normal) >= 1 - TURN_MOST &&
             fabs(plane->height - s->plane[k].height) <= s->room->offset))
        k++;
    return k;
}

/* Moves the largest to the front; returns how many are worth it. */
static uint32_t choose(Search *s, double all)
{
    uint32_t chosen = 0;
    for (; chosen < IMAGES_MOST && chosen < s->count; chosen++) {
        uint32_t best = chosen;
        for (uint32_t k = chosen + 1; k < s->count; k++)
            if (s->plane[k].area > s->plane[best].area)
                best = k;
        if (!(s->plane[best].area >= SHARE_LEAST * all))
            break;
        const ImagePlane plane = s->plane[best];
        s->plane[best] = s->plane[chosen];
        s->plane[chosen] = plane;
    }
    return chosen;
}

bool images_init(Images *images, const Room *room, const float *smooth, Error *err)
{
    Search     s = { .room = room, .smooth = smooth };
    ImagePlane plane;
    double     all = 0;
    assert(images != NULL && room != NULL && err != NULL);
    *images = (Images){ 0 };
    const size_t sides = 2 * (size_t)room->surfaces->count;
    for (size_t i = 0; i < sides; i++) {
        if (!plane_of(&s, (uint32_t)(i / 2), i % 2, &plane))
            continue;
        const uint32_t k = find(&s, &plane);
        all += plane.area;
        if (k < s.count)
            s.plane[k].area += plane.area;
        else if (s.count < CANDIDATES)
            s.plane[s.count++] = plane;
    }
    s.count = choose(&s, all);
    if (s.count == 0)
        return true;
    images->of_side = array_create(sides, 1, "mirrors", err);
    if (error_is_set(err))
        return false;
    memcpy(images->plane, s.plane, s.count * sizeof *s.plane);
    images->count = s.count;
    for (size_t i = 0; i < sides; i++) {
        const bool     flat = plane_of(&s, (uint32_t)(i / 2), i % 2, &plane);
        const uint32_t k = flat ? find(&s, &plane) : s.count;
        images->of_side[i] = (uint8_t)(k < s.count ? k + 1 : 0);
    }
    return true;
}

void images_clear(Images *images)
{
    array_free(images->of_side);
    *images = (Images){ 0 };
}

uint32_t images_of(const Images *images, uint32_t surface, unsigned side)
{
    assert(side < 2);
    const uint8_t k = images->of_side != NULL ? images->of_side[2 * (size_t)surface + side] : 0;
    return k > 0 ? k - 1U : IMAGES_MOST;
}

static Vec3 turned(Vec3 v, Vec3 n) { return vec3_mad(v, -2 * vec3_dot(v, n), n); }

bool images_receiver(const Room *room, const ImagePlane *plane, const Receiver *at, Receiver *image)
{
    const double height = vec3_dot(at->point, plane->normal) - plane->height;
    assert(plane->area > 0 && isfinite(height));
    if (!(height > 2 * wave_offset(room, at->point)))
        return false;
    *image = (Receiver){ vec3_mad(at->point, -2 * height, plane->normal),
                         turned(at->normal, plane->normal), turned(at->face, plane->normal) };
    return true;
}

Rgb images_pass(const Images *images, const Room *room, uint32_t plane, const Receiver *at,
                const LampSample *sample, bool clear, uint64_t *rays)
{
    const ImagePlane *p = &images->plane[plane];
    const Rgb         none = { 0, 0, 0 };
    Hit               hit;
    RoomHit           place;
    Material          scratch;
    assert(plane < images->count);
    const double beyond = vec3_dot(sample->point, p->normal) - p->height;
    if (!(beyond > room->offset))
        return none;
    /* Towards the lamp's image; the mirror itself ends the ray. */
    const Vec3 image = vec3_mad(sample->point, -2 * beyond, p->normal);
    const Vec3 way = vec3_unit(vec3_sub(image, at->point));
    const Ray  first = ray_leaving(at->point, at->face, wave_offset(room, at->point), way,
                                   INFINITY);
    ++*rays;
    if (!bvh_nearest(room->bvh, &first, &hit))
        return none;
    room_hit(room, &hit, way, &place);
    if (images_of(images, place.surface, place.side) != plane)
        return none;
    const Rgb share = places_hit(room, &place, &scratch)->specular;
    const Ray on = ray_between(place.point, place.normal, sample->point, sample->normal,
                               room->offset);
    ++*rays;
    if (!bvh_blocked(room->bvh, &on))
        return share;
    return clear ? rgb_mul(share, clear_between(room, &on)) : none;
}
