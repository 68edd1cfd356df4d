/* SPDX-License-Identifier: BSD-3-Clause */
/* Normals at corners: the file's, or shared across edges that are not creases. */
#include "render/normals.h"

#include <assert.h>

#include "base/array.h"
#include "math/tolerance.h"

static Vec3 corner_at(const Surfaces *s, uint32_t triangle, unsigned k)
{
    return s->position[s->corner[3 * (size_t)triangle + k]];
}

/* Angle of the triangle at its corner k. */
static double angle_at(const Surfaces *s, uint32_t triangle, unsigned k)
{
    const Vec3 p = corner_at(s, triangle, k);
    const Vec3 a = vec3_sub(corner_at(s, triangle, (k + 1) % 3), p);
    const Vec3 b = vec3_sub(corner_at(s, triangle, (k + 2) % 3), p);
    return atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}

/* The triangles around each vertex: corner indices, vertex by vertex. */
typedef struct {
    uint32_t *first;  /* [vertex_count + 1] */
    uint32_t *corner; /* [3 * triangle_count] */
} Fans;

static bool fans_init(Fans *fans, const Surfaces *s, Error *err)
{
    const size_t corners = 3 * (size_t)s->triangle_count;
    fans->first = array_create((size_t)s->vertex_count + 2, sizeof *fans->first, "normals", err);
    fans->corner = array_create(corners, sizeof *fans->corner, "normals", err);
    if (error_is_set(err))
        return false;
    /* Counted two places on, so that filling moves the starts to where they belong. */
    uint32_t *next = fans->first + 1;
    for (size_t i = 0; i < corners; i++)
        next[s->corner[i] + 1]++;
    for (uint32_t v = 0; v < s->vertex_count; v++)
        next[v + 1] += next[v];
    for (size_t i = 0; i < corners; i++)
        fans->corner[next[s->corner[i]]++] = (uint32_t)i;
    return true;
}

static Vec3 smooth_normal(const Surfaces *s, const Fans *fans, const Vec3 *flat, uint32_t corner)
{
    const uint32_t v = s->corner[corner], own = corner / 3;
    Vec3 sum = { 0, 0, 0 };
    for (uint32_t i = fans->first[v]; i < fans->first[v + 1]; i++) {
        const uint32_t other = fans->corner[i] / 3;
        if (vec3_dot(flat[own], flat[other]) >= TOLERANCE_CREASE_COSINE)
            sum = vec3_mad(sum, angle_at(s, other, fans->corner[i] % 3), flat[other]);
    }
    return vec3_length(sum) > 0 ? vec3_unit(sum) : flat[own];
}

/* Normals further than this from their triangle's tell of no surface that it could stand for: the
 * corner of a cube whose sides share normals lies at 54.7 degrees, that of a tetrahedron at 70. */
static const double GIVEN_COSINE = 0.5;

/* Those of the file at a triangle's corners, 0 0 0 where there is none of use. Files wind faces one
 * way and give normals of the other: on which side they are is the triangle's matter. */
static void given_normals(const Room *room, uint32_t triangle, Vec3 flat, Vec3 out[3])
{
    const Surfaces *s = room->surfaces;
    const bool      any = room->soup != NULL && room->soup->normal_count > 0 &&
                          s->triangle_face != NULL;
    Vec3            sum = { 0, 0, 0 };
    for (unsigned k = 0; k < 3; k++) {
        if (!any || !polygons_normal_at(room->soup, s->triangle_face[triangle],
                                        corner_at(s, triangle, k), &out[k]))
            out[k] = vec3(0, 0, 0);
        sum = vec3_add(sum, out[k]);
    }
    const double front = vec3_dot(sum, flat) < 0 ? -1 : 1;
    for (unsigned k = 0; k < 3; k++) {
        out[k] = vec3_scale(out[k], front);
        if (!(vec3_dot(out[k], flat) >= GIVEN_COSINE))
            out[k] = vec3(0, 0, 0);
    }
}

/* Normals that differ by less than 0.1 degrees are one: more than rounding does to flat faces, less
 * than shows. */
static const double SAME_COSINE = 1 - 1e-6;

static bool fill_triangle(const Room *room, const Fans *fans, const Vec3 *flat, uint32_t triangle,
                          float *smooth)
{
    Vec3 given[3];
    bool bent = false;
    given_normals(room, triangle, flat[triangle], given);
    for (uint32_t k = 0; k < 3; k++) {
        const Vec3 n = vec3_length(given[k]) > 0
                     ? given[k] : smooth_normal(room->surfaces, fans, flat, 3 * triangle + k);
        float     *out = smooth + 9 * (size_t)triangle + 3 * k;
        bent = bent || vec3_dot(n, flat[triangle]) < SAME_COSINE;
        out[0] = (float)n.x;
        out[1] = (float)n.y;
        out[2] = (float)n.z;
    }
    return bent;
}

float *normals_create(const Room *room, Error *err)
{
    assert(room != NULL && err != NULL);
    const Surfaces *s = room->surfaces;
    bool   bent = false;
    Fans   fans = { 0 };
    Vec3  *flat = array_create(s->triangle_count, sizeof *flat, "normals", err);
    float *smooth = array_create(9 * (size_t)s->triangle_count, sizeof *smooth, "normals", err);
    if (!error_is_set(err) && fans_init(&fans, s, err)) {
        for (uint32_t i = 0; i < s->triangle_count; i++)
            flat[i] = surfaces_normal(s, i, 0, 0);
        for (uint32_t i = 0; i < s->triangle_count; i++)
            bent = fill_triangle(room, &fans, flat, i, smooth) || bent;
    }
    array_free(fans.first);
    array_free(fans.corner);
    array_free(flat);
    return error_is_set(err) || !bent ? array_free(smooth) : smooth;
}

/* Where a hit lies on a triangle. */
typedef struct {
    uint32_t triangle;
    double   weight[3]; /* of its corners */
} Place;

/* The weights of corners 1 and 2 follow from where (s, t) puts them (mesh/surfaces.h). */
static Place place_of(const Surface *surface, const RoomHit *hit)
{
    const bool   quad = surface->kind == SURFACE_QUAD;
    const bool   second = quad && hit->t > hit->s;
    const double u = !quad || second ? hit->s : hit->s - hit->t;
    const double v = !quad || !second ? hit->t : hit->t - hit->s;
    return (Place){ surface->primitive + (second ? 1 : 0), { 1 - u - v, u, v } };
}

static Vec3 corner_normal(const float *smooth, const Place *place, unsigned k, unsigned side)
{
    const float *n = smooth + 9 * (size_t)place->triangle + 3 * k;
    return side == 0 ? vec3(n[0], n[1], n[2]) : vec3(-n[0], -n[1], -n[2]);
}

static Vec3 blended(const float *smooth, const Place *place, unsigned side)
{
    Vec3 sum = { 0, 0, 0 };
    for (unsigned k = 0; k < 3; k++)
        sum = vec3_mad(sum, place->weight[k], corner_normal(smooth, place, k, side));
    return vec3_unit(sum);
}

Vec3 normals_at(const float *smooth, const Room *room, const RoomHit *hit, Vec3 in)
{
    const Surface *surface = &room->surfaces->surface[hit->surface];
    if (smooth == NULL || surface->kind == SURFACE_SHAPE)
        return hit->normal;
    const Place place = place_of(surface, hit);
    const Vec3  normal = blended(smooth, &place, hit->side);
    return vec3_dot(normal, in) < 0 ? normal : hit->normal;
}

/* Corners may stand over each other's tangent planes by this share of an edge and still count as
 * flat: more than normals in float are off, less than the sagitta of an arc of 0.1 degrees. */
static const double BULGE_SLACK = 1e-4;

/* From a point of a triangle to the curved body: its projections on the corners' tangent planes,
 * blended. false: the triangle does not bulge there. */
static bool lift_of(const float *smooth, const Surfaces *s, const Place *place, const RoomHit *hit,
                    Vec3 *lift)
{
    *lift = vec3(0, 0, 0);
    for (unsigned k = 0; k < 3; k++) {
        const Vec3 p = corner_at(s, place->triangle, k);
        const Vec3 n = corner_normal(smooth, place, k, hit->side);
        for (unsigned i = 1; i < 3; i++) {
            const Vec3 edge = vec3_sub(corner_at(s, place->triangle, (k + i) % 3), p);
            if (vec3_dot(edge, n) > BULGE_SLACK * vec3_length(edge))
                return false;
        }
        const double below = fmax(vec3_dot(vec3_sub(p, hit->point), n), 0);
        *lift = vec3_mad(*lift, place->weight[k] * below, n);
    }
    return true;
}

Receiver normals_receive(const float *smooth, const Room *room, const RoomHit *hit)
{
    const Surface *surface = &room->surfaces->surface[hit->surface];
    Receiver       at = { hit->point, hit->normal, hit->normal };
    if (smooth == NULL || surface->kind == SURFACE_SHAPE)
        return at;
    const Place place = place_of(surface, hit);
    const Vec3  normal = blended(smooth, &place, hit->side);
    Vec3        lift;
    if (!(vec3_dot(normal, hit->normal) > 0))
        return at;
    at.normal = normal;
    if (!lift_of(smooth, room->surfaces, &place, hit, &lift))
        return at;
    const double height = vec3_length(lift);
    if (height > room->offset) {
        /* Nothing may stand between. */
        const Ray ray = ray_leaving(hit->point, hit->normal, room->offset,
                                    vec3_scale(lift, 1 / height), (float)height);
        if (bvh_blocked(room->bvh, &ray))
            return at;
        at.point = vec3_add(hit->point, lift);
    }
    at.face = normal;
    return at;
}

double normals_share(Vec3 way, Vec3 normal, Vec3 face)
{
    const double low = vec3_dot(way, face), high = vec3_dot(way, normal);
    if (normal.x == face.x && normal.y == face.y && normal.z == face.z)
        return 1;
    if (!(low > 0) || !(high > 0))
        return 0;
    const double g = fmin(low / (high * vec3_dot(normal, face)), 1);
    return g * (1 + g - g * g);
}
