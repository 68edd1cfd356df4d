/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays that go on at mirrors and glass. */
#include "radiosity/mirrors.h"

#include <assert.h>

#include "base/array.h"
#include "math/fresnel.h"
#include "math/tolerance.h"
#include "radiosity/places.h"

/* A patch that keeps less than this is a perfect mirror: it takes part with no area at all. What it
 * would have kept is far below what hundreds of rays per patch can tell. */
static const double KEPT_LEAST = 1e-3;

bool mirrors_exist(const Material *materials, size_t count)
{
    assert(materials != NULL || count == 0);
    for (size_t i = 0; i < count; i++)
        if (mirrors_is(&materials[i]))
            return true;
    return false;
}

static bool is_clear(const Surfaces *s, const Material *materials, uint32_t surface)
{
    return rgb_max(materials[surfaces_material(s, surface, 0)].transmittance) > 0 ||
           rgb_max(materials[surfaces_material(s, surface, 1)].transmittance) > 0;
}

static int edges_of(const Surface *surface)
{
    return surface->kind == SURFACE_SHAPE ? 0 : surface->kind == SURFACE_QUAD ? 4 : 3;
}

/* Whether all edges lead on to clear surfaces. */
static bool is_inner(const Surfaces *s, const Material *materials, uint32_t surface)
{
    const Surface *f = &s->surface[surface];
    for (int i = 0; i < edges_of(f); i++)
        if (f->neighbour[i] == SURFACE_NONE || !is_clear(s, materials, f->neighbour[i]))
            return false;
    return true;
}

/* From the surfaces with a rim on, over all clear ones that hang together with them. */
static void spread_rims(const Surfaces *s, uint8_t *skin, uint32_t *stack, uint32_t count)
{
    while (count > 0) {
        const Surface *f = &s->surface[stack[--count]];
        for (int i = 0; i < edges_of(f); i++) {
            const uint32_t next = f->neighbour[i];
            if (next == SURFACE_NONE || skin[next] == 0)
                continue;
            skin[next] = 0;
            stack[count++] = next;
        }
    }
}

uint8_t *mirrors_skins(const Surfaces *s, const Material *materials, Error *err)
{
    assert(s != NULL && materials != NULL && err != NULL);
    uint8_t  *skin = array_create(s->count, 1, "clear surfaces", err);
    uint32_t *stack = array_create(s->count, sizeof *stack, "clear surfaces", err);
    uint32_t  count = 0;
    if (!error_is_set(err)) {
        for (uint32_t i = 0; i < s->count; i++) {
            const bool clear = is_clear(s, materials, i);
            skin[i] = clear && is_inner(s, materials, i);
            if (clear && skin[i] == 0)
                stack[count++] = i;
        }
        spread_rims(s, skin, stack, count);
    }
    array_free(stack);
    return error_is_set(err) ? array_free(skin) : skin;
}

bool mirrors_is_skin(const Room *room, uint32_t surface)
{
    assert(surface < room->surfaces->count);
    return room->skin != NULL ? room->skin[surface]
                              : is_inner(room->surfaces, room->materials, surface);
}

static double grey(Rgb colour) { return fmin(fmax(rgb_luminance(colour), 0), 1); }

MirrorShare mirrors_share(const Material *m, bool skin, unsigned side, double cosine)
{
    MirrorShare share = { .eta = 1 };
    assert(m != NULL && side < 2 && cosine >= 0 && cosine <= 1);
    if (rgb_max(m->transmittance) > 0) {
        const double ior = m->ior > 0 ? m->ior : 1;
        if (skin && ior != 1)
            share.eta = side == 1 ? 1 / ior : ior;
        share.back = share.eta != 1 ? fresnel(cosine, share.eta) : fresnel_pane(cosine, ior);
        share.through = (1 - share.back) * grey(m->transmittance);
    } else if (mirrors_is(m)) {
        share.back = grey(m->specular);
    }
    return share;
}

static const Material *material_of(const Room *room, uint32_t surface, unsigned side)
{
    return &room->materials[surfaces_material(room->surfaces, surface, side)];
}

static double kept_at(const Room *room, uint32_t patch, const Material *m, double cosine)
{
    const bool skin = mirrors_is_skin(room, room->patches->surface[patch]);
    const MirrorShare share = mirrors_share(m, skin, room->patches->side[patch], cosine);
    return fmax(1 - share.back - share.through, 0);
}

/* Mean over the hemisphere, weighted by the cosine: the midpoint rule over its square, in which
 * light arrives evenly. Total reflection makes a kink; 64 points are off by less than 1 %. */
double mirrors_kept(const Room *room, uint32_t patch)
{
    enum { POINTS = 64 };
    const Material *m = &room->materials[room->patches->material[patch]];
    double          sum = 0, opaque;
    assert(patch < room->patches->count);
    if (!room->mirrors || !mirrors_is(m))
        return 1;
    if (m->cut_out) {
        places_reflectance(room, patch, &opaque);
        return opaque >= KEPT_LEAST ? opaque : 0;
    }
    for (int k = 0; k < POINTS; k++)
        sum += kept_at(room, patch, m, sqrt((k + 0.5) / POINTS)) / POINTS;
    return sum >= KEPT_LEAST ? sum : 0;
}

double mirrors_weight(const Room *room, uint32_t patch, double kept, double cosine)
{
    const Material *m = &room->materials[room->patches->material[patch]];
    assert(patch < room->patches->count);
    if (!room->mirrors || !(rgb_max(m->transmittance) > 0))
        return 1;
    cosine = fmin(fmax(cosine, 0), 1);
    return kept > 0 ? kept_at(room, patch, m, cosine) / kept : 0;
}

/* What microfacets of width 0, 1/8 .. 1 send back of even light that they do not absorb: integrals
 * of render/gloss.h's model, each by 2 10^5 random samples; tests/test_gloss.c has them by a
 * rule. */
static const double facets_back[] = { 1, 0.960, 0.882, 0.793, 0.701, 0.613, 0.536, 0.468, 0.409 };

double mirrors_gloss_back(const Material *m)
{
    enum { STEPS = sizeof facets_back / sizeof facets_back[0] - 1 };
    if (!(m->roughness > 0))
        return 2.0 / 3; /* a sharp lobe: the mean cosine of even light */
    const double x = m->roughness * m->roughness * STEPS;
    const int    k = (int)fmin(x, STEPS - 1);
    return facets_back[k] + (x - k) * (facets_back[k + 1] - facets_back[k]);
}

Rgb mirrors_scattered(const Material *m, Rgb diffuse)
{
    const double most = TOLERANCE_REFLECTANCE_MAX;
    if (!(rgb_max(m->specular) > 0) || rgb_max(m->transmittance) > 0 || isinf(m->exponent))
        return diffuse;
    const Rgb all = rgb_mad(diffuse, mirrors_gloss_back(m), m->specular);
    return rgb(fmin(all.r, most), fmin(all.g, most), fmin(all.b, most));
}

void mirrors_problem(const Room *room, uint32_t patch, Rgb *emission, Rgb *reflectance)
{
    const double most = TOLERANCE_REFLECTANCE_MAX;
    *emission = room_emission(room, patch);
    *reflectance = mirrors_scattered(&room->materials[room->patches->material[patch]],
                                     places_reflectance(room, patch, NULL));
    const double kept = mirrors_kept(room, patch);
    /* Of what is cut out it is that of what is there. */
    if (kept == 1 || room->materials[room->patches->material[patch]].cut_out)
        return;
    const double scale = kept > 0 ? 1 / kept : 0;
    *emission = rgb_scale(*emission, scale);
    /* A file's mirror and diffuse shares may be more than 1 together. */
    *reflectance = rgb(fmin(reflectance->r * scale, most), fmin(reflectance->g * scale, most),
                       fmin(reflectance->b * scale, most));
}

static Vec3 mirrored(Vec3 in, Vec3 n) { return vec3_mad(in, -2 * vec3_dot(in, n), n); }

bool mirrors_step(const Room *room, const Hit *hit, double choice, Ray *ray, bool *straight)
{
    const Surfaces *s = room->surfaces;
    assert(hit->primitive < surfaces_primitive_count(s) && choice >= 0 && choice < 1);
    const uint32_t  surface = surfaces_of_primitive(s, hit->primitive);
    if (!mirrors_is(material_of(room, surface, 0)) && !mirrors_is(material_of(room, surface, 1)))
        return false;
    const Vec3 in = vec3_unit(vec3(ray->dx, ray->dy, ray->dz));
    SurfacePoint at;
    double       u, v;
    surfaces_parameters(s, hit->primitive, hit->u, hit->v, &u, &v);
    surfaces_point(s, surface, u, v, &at);
    const unsigned side = vec3_dot(at.normal, in) > 0 ? 1 : 0;
    const Vec3     n = side == 0 ? at.normal : vec3_scale(at.normal, -1);
    const double   cosine = fmin(fmax(-vec3_dot(in, n), 0), 1);
    Material       scratch;
    const Material *m = places_material(room, hit->primitive, side, at.point, &scratch);
    const MirrorShare share = mirrors_share(m, mirrors_is_skin(room, surface), side,
                                            cosine);
    if (!(choice < share.back + share.through))
        return false;
    Vec3 way = in;
    if (choice < share.back) {
        way = vec3_unit(mirrored(in, n));
    } else if (share.eta != 1) {
        const double square = 1 - (1 - cosine * cosine) / (share.eta * share.eta);
        way = vec3_unit(vec3_mad(vec3_scale(in, 1 / share.eta),
                                 cosine / share.eta - sqrt(fmax(square, 0)), n));
    }
    *straight = *straight && choice >= share.back && share.eta == 1;
    *ray = ray_leaving(at.point, n, choice < share.back ? room->offset : -room->offset, way,
                       INFINITY);
    return true;
}

double mirrors_medium(const Room *room, const Hit *hit, Vec3 way)
{
    assert(hit->primitive < surfaces_primitive_count(room->surfaces));
    const uint32_t surface = surfaces_of_primitive(room->surfaces, hit->primitive);
    const Vec3     n = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
    const unsigned side = vec3_dot(n, way) > 0 ? 1 : 0;
    const Material *m = material_of(room, surface, side);
    if (!(rgb_max(m->transmittance) > 0) || !(m->ior > 0) || m->ior == 1 ||
        !mirrors_is_skin(room, surface))
        return 1;
    return side == 1 ? m->ior : 0;
}

double mirrors_between(const Room *room, Ray ray)
{
    const Surfaces *s = room->surfaces;
    const Vec3      way = vec3(ray.dx, ray.dy, ray.dz), in = vec3_unit(way);
    const double    length = vec3_length(way);
    double          pass = 1;
    assert(length > 0 && isfinite(ray.t_max));
    for (int k = 0; k < MIRRORS_MOST; k++) {
        Hit hit;
        if (!bvh_nearest(room->bvh, &ray, &hit))
            return pass;
        const uint32_t surface = surfaces_of_primitive(s, hit.primitive);
        const Vec3     n = surfaces_normal(s, hit.primitive, hit.u, hit.v);
        const double   along = vec3_dot(in, n);
        const unsigned side = along > 0 ? 1 : 0;
        const Vec3 at = vec3_mad(vec3(ray.ox, ray.oy, ray.oz), (double)hit.t, way);
        Material   scratch;
        const Material   *m = places_material(room, hit.primitive, side, at, &scratch);
        const MirrorShare share = mirrors_share(m, mirrors_is_skin(room, surface), side,
                                                fmin(fabs(along), 1));
        if (share.eta != 1 || !(share.through > 0))
            return 0;
        pass *= share.through;
        /* On from behind the pane: along the same line, as far as its offset reaches. */
        const double slack = room->offset / (length * fmax(fabs(along), 1.0 / 64));
        ray.t_min = (float)fmax(hit.t + slack, nextafterf(hit.t, INFINITY));
        if (!(ray.t_min < ray.t_max))
            return pass;
    }
    return 0;
}
