/* SPDX-License-Identifier: BSD-3-Clause */
/* Gloss that the eye meets: a shadow ray to a lamp, one to a light, and a ray on. */
#include "render/eye.h"

#include <assert.h>

#include "math/sampling.h"
#include "render/clear.h"
#include "render/split.h"

/* A sample of a lamp or light that the place sends back: light without what stands between. */
static void add_light(Eye *eye, const EyeGloss *place, const LampSample *aim, uint32_t group,
                      Rgb light)
{
    const Gatherer *g = eye->gatherer;
    const Receiver *at = &place->at;
    if (!(rgb_max(light) > 0))
        return;
    const Ray ray = ray_between(at->point, at->face, aim->point, aim->normal,
                                wave_offset(g->room, at->point));
    eye->wave.rays++;
    if (bvh_blocked(g->room->bvh, &ray))
        light = g->clear ? rgb_mul(light, clear_between(g->room, &ray)) : rgb(0, 0, 0);
    place->pixel->radiance = rgb_add(place->pixel->radiance, light);
    if (place->pixel->split != NULL)
        place->pixel->split[group] = rgb_add(place->pixel->split[group], light);
}

static void add_lamp(Eye *eye, const EyeGloss *place, const float u[2])
{
    const Gatherer *g = eye->gatherer;
    LampSample      aim;
    Rgb             radiance;
    double          lamps, own;
    if (!lamps_aim(&g->lamps, &place->at, u[0], u[1], &aim, &radiance, &lamps))
        return;
    const Vec3   way = vec3_unit(vec3_sub(aim.point, place->at.point));
    const double value = gloss_value(&place->gloss, way, &own) / (lamps + own);
    const Lamp  *lamp = &g->lamps.lamp[aim.lamp];
    add_light(eye, place, &aim,
              g->split != NULL ? split_emission(g->split, lamp->surface, lamp->side) : 0,
              rgb_scale(rgb_mul(place->weight, radiance), value));
}

static void add_point_light(Eye *eye, const EyeGloss *place, float u)
{
    const Gatherer *g = eye->gatherer;
    LampSample      aim;
    double          own;
    if (!lamps_sample_light(&g->lamps, &place->at, u, &aim))
        return;
    const Vec3   way = vec3_unit(vec3_sub(aim.point, place->at.point));
    const double cosine = vec3_dot(way, place->at.normal);
    if (cosine > 0)
        add_light(eye, place, &aim, g->split != NULL ? g->split->first_light + aim.lamp : 0,
                  rgb_scale(rgb_mul(place->weight, aim.value),
                            gloss_value(&place->gloss, way, &own) / cosine));
}

bool eye_gloss(Eye *eye, const EyeGloss *place, const float u[2], const float v[3], EyeRay *on)
{
    const Room *room = eye->gatherer->room;
    Vec3        out;
    double      density;
    assert(rgb_max(place->weight) >= 0);
    if (!(rgb_max(place->weight) > 0))
        return false;
    if (eye->gatherer->lamps.count > 0)
        add_lamp(eye, place, v);
    if (room->light_count > 0)
        add_point_light(eye, place, v[2]);
    if (!gloss_sample(&place->gloss, u, &out))
        return false;
    const double value = gloss_value(&place->gloss, out, &density);
    if (!(density > 0))
        return false;
    on->ray = ray_leaving(place->at.point, place->at.face, wave_offset(room, place->at.point),
                          out, INFINITY);
    on->weight = rgb_scale(place->weight, value / density);
    on->from = place->at;
    on->density = density;
    return rgb_max(on->weight) > 0;
}
