/* SPDX-License-Identifier: BSD-3-Clause */
/* Mirrors and glass: one ray on from each hit. */
#include "render/specular.h"

#include <assert.h>

#include "math/fresnel.h"
#include "math/sampling.h"
#include "radiosity/mirrors.h"
#include "radiosity/places.h"
#include "render/lamps.h"
#include "render/normals.h"

/* A material that has a specular colour but no exponent: a soft gloss. */
static const double EXPONENT_DEFAULT = 20;

bool specular_exists(const Material *material)
{
    return rgb_max(material->specular) > 0 || rgb_max(material->transmittance) > 0;
}

double specular_exponent(const Material *material)
{
    return material->exponent > 0 ? material->exponent : EXPONENT_DEFAULT;
}

bool specular_is_sharp(const Material *material)
{
    return rgb_max(material->transmittance) > 0 || isinf(specular_exponent(material));
}

static Vec3 mirrored(Vec3 in, Vec3 n) { return vec3_mad(in, -2 * vec3_dot(in, n), n); }

/* Reflected by the smooth normal, but never into the surface itself. */
static Vec3 reflected(Vec3 in, Vec3 smooth, const RoomHit *hit)
{
    const Vec3   d = mirrored(in, smooth);
    const double height = vec3_dot(d, hit->normal);
    return height > 0 ? d : mirrored(d, hit->normal);
}

/* Glass: the share that goes back; *eta: index beyond over that here, 1 for a pane. */
static double glass_back(const Room *room, const Material *material, const RoomHit *hit,
                         double cosine, double *eta)
{
    const double ior = material->ior > 0 ? material->ior : 1;
    const bool   skin = ior != 1 && mirrors_is_skin(room, hit->surface);
    *eta = !skin ? 1 : hit->side == 1 ? 1 / ior : ior;
    return skin ? fresnel(cosine, *eta) : fresnel_pane(cosine, ior);
}

static Ray back_from(const Room *room, const RoomHit *hit, Vec3 normal, Vec3 in)
{
    return ray_leaving(hit->point, hit->normal, room->offset, reflected(in, normal, hit), INFINITY);
}

static Ray across_to(const Room *room, const RoomHit *hit, Vec3 normal, Vec3 in, double cosine,
                     double eta)
{
    Vec3 d = in;
    if (eta != 1) {
        const double square = 1 - (1 - cosine * cosine) / (eta * eta);
        d = vec3_mad(vec3_scale(in, 1 / eta), cosine / eta - sqrt(fmax(square, 0)), normal);
        if (vec3_dot(d, hit->normal) > 0) /* the smooth normal bent it back out */
            d = mirrored(d, hit->normal);
    }
    return ray_leaving(hit->point, hit->normal, -room->offset, vec3_unit(d), INFINITY);
}

static double cosine_in(Vec3 in, Vec3 normal) { return fmin(fmax(-vec3_dot(in, normal), 0), 1); }

/* Glass: one of the two ways, by what each carries. */
static bool glass(const Room *room, const Material *material, const RoomHit *hit, Vec3 normal,
                  Vec3 in, double choice, Ray *ray, Rgb *weight)
{
    double       eta;
    const double cosine = cosine_in(in, normal);
    const double f = glass_back(room, material, hit, cosine, &eta);
    const double through = (1 - f) * rgb_max(material->transmittance);
    const double chance = f / (f + through);
    if (choice < chance) {
        const double w = f / chance;
        *weight = rgb(w, w, w);
        *ray = back_from(room, hit, normal, in);
        return true;
    }
    *weight = rgb_scale(material->transmittance, (1 - f) / (1 - chance));
    *ray = across_to(room, hit, normal, in, cosine, eta);
    return rgb_max(*weight) > 0;
}

unsigned specular_ways(const Room *room, const Material *m, const RoomHit *hit, Vec3 normal,
                       Vec3 in, Ray ray[2], Rgb weight[2])
{
    assert(mirrors_is(m));
    const bool clear = rgb_max(m->transmittance) > 0;
    ray[0] = back_from(room, hit, normal, in);
    weight[0] = m->specular;
    if (!clear)
        return 1;
    double       eta;
    const double cosine = cosine_in(in, normal);
    const double f = glass_back(room, m, hit, cosine, &eta);
    weight[0] = rgb(f, f, f);
    if (!(f < 1))
        return 1; /* total reflection */
    weight[1] = rgb_scale(m->transmittance, 1 - f);
    ray[1] = across_to(room, hit, normal, in, cosine, eta);
    return 2;
}

bool specular_continue(const Room *room, const RoomHit *hit, Vec3 normal, Vec3 in,
                       float u, Ray *ray, Rgb *weight)
{
    Material        scratch;
    const Material *material = places_hit(room, hit, &scratch);
    assert(specular_exists(material) && specular_is_sharp(material));
    if (rgb_max(material->transmittance) > 0)
        return glass(room, material, hit, normal, in, u, ray, weight);
    *weight = material->specular;
    *ray = back_from(room, hit, normal, in);
    return true;
}

/* --- rays that gather ------------------------------------------------------------------------ */

/* Steps before roulette begins, and those at which a ray between perfect mirrors is given up: the
 * chance to get so far is nil where anything is lost at each. */
enum { FOLLOW_FREE = 4, FOLLOW_MOST = 256 };
/* Chance to go on after the free steps even where nothing is lost: in a ball of glass made of
 * triangles with smooth normals rays are caught for good by total reflection, and one in a hundred
 * took as many steps as all others. 1 / (1 - 7/8) = 8 steps more in the mean. */
static const double SURVIVAL_MOST = 7.0 / 8;

/* Chance that a ray ends at a mirror which is diffuse, or shines, as well. */
static double end_chance(const Room *room, const RoomHit *hit, const Material *m)
{
    const bool   emits = room->emitting[hit->surface] >> hit->side & 1;
    const double own = emits ? 1 : rgb_max(m->reflectance);
    const double on = rgb_max(m->transmittance) > 0 ? 1 : rgb_max(m->specular);
    return own / (own + on);
}

bool specular_is_straight(const Room *room, const RoomHit *hit, const Material *m, const Ray *on)
{
    const bool bends = m->ior > 0 && m->ior != 1 &&
                       mirrors_is_skin(room, hit->surface);
    return !bends && vec3_dot(vec3(on->dx, on->dy, on->dz), hit->normal) < 0;
}

/* A number in [0, 1) for purpose k of a step. */
static float luck(uint32_t seed, unsigned step, unsigned k)
{
    return (float)(sampling_mix(seed ^ sampling_mix(4 * step + k)) >> 8) * 0x1p-24F;
}

Rgb specular_follow(const Room *room, const float *smooth, uint32_t seed, Ray *ray, Hit *hit,
                    SpecularWay *met, uint64_t *rays)
{
    Rgb   weight = { 1, 1, 1 };
    float far = 0;
    *met = (SpecularWay){ .turned = false };
    for (unsigned step = 0; hit->primitive != RAY_MISS; step++) {
        const Vec3 way = vec3(ray->dx, ray->dy, ray->dz), in = vec3_unit(way);
        RoomHit at;
        Material scratch;
        room_hit(room, hit, in, &at);
        const Material *m = places_hit(room, &at, &scratch);
        if (!mirrors_is(m))
            break;
        assert(specular_exists(m));
        const double end = end_chance(room, &at, m), go = luck(seed, step, 3);
        if (go < end) {
            weight = rgb_scale(weight, 1 / end);
            break;
        }
        const float u = luck(seed, step, 2);
        const float length = hit->t * (float)vec3_length(way);
        Rgb         share;
        hit->primitive = RAY_MISS;
        if (step == FOLLOW_MOST ||
            !specular_continue(room, &at, normals_at(smooth, room, &at, in), in, u, ray, &share))
            break;
        weight = rgb_scale(rgb_mul(weight, share), 1 / (1 - end));
        const double survival = step < FOLLOW_FREE ? 1 : fmin(rgb_max(weight), SURVIVAL_MOST);
        if (!(luck(seed, step + FOLLOW_MOST + 1, 0) < survival))
            break;
        weight = rgb_scale(weight, 1 / survival);
        if (!specular_is_straight(room, &at, m, ray)) {
            met->by_mirror = step == 0 && !(rgb_max(m->transmittance) > 0);
            met->turned = true;
            met->surface = at.surface;
            met->side = at.side;
        }
        far += length;
        ++*rays;
        bvh_nearest(room->bvh, ray, hit);
    }
    hit->t += far;
    return weight;
}
