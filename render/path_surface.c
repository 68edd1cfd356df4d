/* SPDX-License-Identifier: BSD-3-Clause */
/* Scattering of the path tracer: diffuse, gloss, mirrors, glass. */
#include <assert.h>

#include "math/fresnel.h"
#include "math/sampling.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "render/gloss.h"
#include "render/normals.h"
#include "render/path_internal.h"
#include "render/specular.h"

void path_hit(const Room *room, const Hit *hit, Vec3 direction, RoomHit *out)
{
    const Surfaces *s = room->surfaces;
    Vec3            normal;
    assert(hit->primitive < surfaces_primitive_count(s));
    *out = (RoomHit){ .surface = surfaces_of_primitive(s, hit->primitive), .patch = PATCH_NONE,
                      .primitive = hit->primitive };
    surfaces_parameters(s, hit->primitive, hit->u, hit->v, &out->s, &out->t);
    surfaces_place(s, out->surface, out->s, out->t, &out->point, &normal);
    out->side = vec3_dot(normal, direction) > 0 ? 1 : 0;
    out->normal = out->side == 0 ? normal : vec3_scale(normal, -1);
}

static double index_of(const Material *material)
{
    return material->ior > 0 ? material->ior : 1;
}

static bool bends(const Room *room, const RoomHit *hit, const Material *material)
{
    return index_of(material) != 1 &&
           mirrors_is_skin(room, hit->surface);
}

static Vec3 mirrored(Vec3 in, Vec3 n) { return vec3_mad(in, -2 * vec3_dot(in, n), n); }

/* The mirror direction of the smooth normal, unless that leads into the surface. */
static Vec3 mirror_way(const PathSurface *surface)
{
    const Vec3 face = surface->hit.normal;
    const Vec3 d = mirrored(surface->in, surface->normal);
    return vec3_unit(vec3_dot(d, face) > 0 ? d : mirrored(d, face));
}

static bool is_lobe(const Material *material)
{
    return rgb_max(material->specular) > 0 && isfinite(specular_exponent(material));
}

/* Reflected share of what arrives at glass; *eta: index of what lies beyond over that here, 1 for a
 * pane. */
static double glass_share(const PathSurface *surface, double *eta)
{
    const Material *m = surface->material;
    const double    cosine = fmin(fmax(-vec3_dot(surface->in, surface->normal), 0), 1);
    *eta = 1;
    if (!bends(surface->room, &surface->hit, m))
        return fresnel_pane(cosine, index_of(m));
    *eta = surface->hit.side == 1 ? 1 / index_of(m) : index_of(m);
    return fresnel(cosine, *eta);
}

/* Smooth unless seen from behind along `in`. */
static Vec3 normal_at(const PathScene *scene, const Room *room, const InstanceHit *found,
                      const RoomHit *hit, Vec3 in)
{
    return room == scene->room ? normals_at(scene->smooth, room, hit, in)
                               : copies_normal(scene->copies, found, hit, in);
}

void path_surface_init(PathSurface *surface, const PathScene *scene, const Room *room,
                       const InstanceHit *found, const RoomHit *hit, Vec3 in, bool sharp)
{
    Material        scratch;
    const Material *m = places_hit(room, hit, &scratch);
    double          eta;
    assert(m->ior >= 0 && rgb_max(m->reflectance) < 1);
    *surface = (PathSurface){ .room = room, .material = m, .hit = *hit, .normal = hit->normal,
                              .at = { hit->point, hit->normal, hit->normal }, .in = in,
                              .diffuse = rgb_max(m->reflectance) };
    if (m == &scratch) {
        surface->made = scratch;
        surface->material = m = &surface->made;
    }
    if (sharp && room == scene->room)
        surface->at = normals_receive(scene->smooth, room, hit);
    else if (sharp)
        surface->at = copies_receive(scene->copies, found, hit);
    if (!scene->options->diffuse_only && specular_exists(m)) {
        surface->normal = normal_at(scene, room, found, hit, in);
        if (rgb_max(m->transmittance) > 0) {
            const double back = glass_share(surface, &eta);
            surface->clear = back + (1 - back) * rgb_max(m->transmittance);
        } else {
            surface->gloss = rgb_max(m->specular);
        }
    }
    const double all = surface->diffuse + surface->gloss + surface->clear;
    if (all > 0) {
        surface->diffuse /= all;
        surface->gloss /= all;
        surface->clear /= all;
    }
}

Rgb path_surface_diffuse(const PathSurface *surface, Vec3 out)
{
    const double cosine = fmax(vec3_dot(out, surface->at.normal), 0) / M_PI;
    return rgb_scale(surface->material->reflectance,
                     cosine * normals_share(out, surface->at.normal, surface->at.face));
}

static Gloss gloss_of(const PathSurface *surface)
{
    Gloss gloss;
    gloss_init(&gloss, surface->material, surface->at.face, surface->normal, surface->in);
    return gloss;
}

Rgb path_surface_value(const PathSurface *surface, Vec3 out, double *density)
{
    const Material *m = surface->material;
    const double    cosine = vec3_dot(out, surface->at.face);
    *density = 0;
    if (!(cosine > 0))
        return rgb(0, 0, 0);
    Rgb value = path_surface_diffuse(surface, out);
    *density = surface->diffuse * fmax(vec3_dot(out, surface->at.normal), 0) / M_PI;
    if (surface->gloss > 0 && is_lobe(m)) {
        double      own;
        const Gloss gloss = gloss_of(surface);
        value = rgb_mad(value, gloss_value(&gloss, out, &own), m->specular);
        *density += surface->gloss * own;
    }
    return value;
}

/* Glass: choice in [0,1) decides between its two ways. Radiance is not scaled by the square of the
 * index on its way in, nor back on its way out: for an eye and lamps outside it is the same. */
static bool glass_next(const PathSurface *surface, double choice, PathNext *next)
{
    const Material *m = surface->material;
    double          eta;
    const double    back = glass_share(surface, &eta);
    const double    through = (1 - back) * rgb_max(m->transmittance);
    assert(back + through > 0 && surface->clear > 0);
    const double    chance = back / (back + through);
    if (choice < chance) {
        const double w = back / (chance * surface->clear);
        *next = (PathNext){ .out = mirror_way(surface), .weight = rgb(w, w, w) };
        return true;
    }
    *next = (PathNext){ .out = surface->in, .across = true, .straight = true };
    next->weight = rgb_scale(m->transmittance, (1 - back) / ((1 - chance) * surface->clear));
    if (bends(surface->room, &surface->hit, m)) {
        const double cosine = fmin(fmax(-vec3_dot(surface->in, surface->normal), 0), 1);
        const double square = 1 - (1 - cosine * cosine) / (eta * eta);
        Vec3 d = vec3_mad(vec3_scale(surface->in, 1 / eta),
                          cosine / eta - sqrt(fmax(square, 0)), surface->normal);
        if (vec3_dot(d, surface->hit.normal) > 0) /* the smooth normal bent it back out */
            d = mirrored(d, surface->hit.normal);
        next->out = vec3_unit(d);
        next->straight = false;
    }
    return rgb_max(next->weight) > 0;
}

bool path_surface_next(const PathSurface *surface, const float u[3], PathNext *next)
{
    const Material *m = surface->material;
    assert(u[0] >= 0 && u[0] < 1 && u[1] < 1 && u[2] < 1);
    const double    specular = surface->diffuse + surface->gloss;
    if (!(specular + surface->clear > 0))
        return false;
    if (u[2] >= specular && surface->clear > 0)
        return glass_next(surface, fmin((u[2] - specular) / surface->clear, 1), next);
    *next = (PathNext){ .out = mirror_way(surface) };
    if (u[2] < surface->diffuse || !(surface->gloss > 0)) {
        const Vec3 w = sampling_cosine(u[0], u[1]);
        Vec3       s, t;
        vec3_frame(surface->at.normal, &s, &t);
        next->out = vec3_unit(vec3_mad(vec3_mad(vec3_scale(s, w.x), w.y, t), w.z,
                                       surface->at.normal));
    } else if (!is_lobe(m)) {
        next->weight = rgb_scale(m->specular, 1 / surface->gloss);
        return true;
    } else {
        const Gloss gloss = gloss_of(surface);
        if (!gloss_sample(&gloss, u, &next->out))
            return false;
    }
    const Rgb value = path_surface_value(surface, next->out, &next->density);
    if (!(next->density > 0))
        return false;
    next->weight = rgb_scale(value, 1 / next->density);
    return rgb_max(next->weight) > 0;
}

Rgb path_surface_pane(const Room *room, const RoomHit *hit, Vec3 in)
{
    Material        scratch;
    const Material *m = places_hit(room, hit, &scratch);
    if (!(rgb_max(m->transmittance) > 0) || bends(room, hit, m))
        return rgb(0, 0, 0);
    const double cosine = fmin(fabs(vec3_dot(in, hit->normal)), 1);
    return rgb_scale(m->transmittance, 1 - fresnel_pane(cosine, index_of(m)));
}
