/* SPDX-License-Identifier: BSD-3-Clause */
/* Where rays end, no more of it than recursive ray tracing needs. */
#include "render/whitted_spot.h"

#include <assert.h>
#include <math.h>

#include "radiosity/places.h"
#include "render/gloss.h"
#include "render/normals.h"
#include "render/path_internal.h"
#include "render/specular.h"

unsigned whitted_spot_kind(const Material *material)
{
    unsigned kind = rgb_max(material->reflectance) > 0 ? SPOT_DIFFUSE : 0;
    if (rgb_max(material->transmittance) > 0)
        return kind | SPOT_CLEAR; /* what it reflects is Fresnel's */
    if (rgb_max(material->specular) > 0)
        kind |= isinf(specular_exponent(material)) ? SPOT_MIRROR : SPOT_LOBE;
    return kind;
}

void whitted_spot_init(WhittedSpot *spot, const Room *room, const uint8_t *kind,
                       const float *smooth, const Hit *hit, Vec3 in, Material *made)
{
    path_hit(room, hit, in, &spot->hit);
    const RoomHit  *at = &spot->hit;
    const Material *m = places_hit(room, at, made);
    spot->material = m;
    spot->in = in;
    spot->kind = m == made ? whitted_spot_kind(m)
                           : kind[surfaces_material(room->surfaces, at->surface, at->side)];
    assert(vec3_dot(at->normal, in) <= 0);
    spot->at = (Receiver){ at->point, at->normal, at->normal };
    spot->normal = at->normal;
    if (smooth == NULL)
        return;
    if (spot->kind & (SPOT_DIFFUSE | SPOT_LOBE))
        spot->at = normals_receive(smooth, room, at);
    if (spot->kind & (SPOT_LOBE | SPOT_MIRROR | SPOT_CLEAR))
        spot->normal = normals_at(smooth, room, at, in);
}

Rgb whitted_spot_value(const WhittedSpot *spot, Vec3 out)
{
    const Material *m = spot->material;
    const double    high = vec3_dot(out, spot->at.normal);
    Rgb             value = { 0, 0, 0 };
    double          density;
    if (!(vec3_dot(out, spot->at.face) > 0))
        return value;
    if (high > 0)
        value = rgb_scale(m->reflectance,
                          high / M_PI * normals_share(out, spot->at.normal, spot->at.face));
    if (spot->kind & SPOT_LOBE) {
        Gloss gloss;
        gloss_init(&gloss, m, spot->at.face, spot->normal, spot->in);
        value = rgb_mad(value, gloss_value(&gloss, out, &density), m->specular);
    }
    return value;
}
