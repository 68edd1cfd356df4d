/* SPDX-License-Identifier: BSD-3-Clause */
/* Normals at corners, shared across edges that are not creases. */
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

float *normals_create(const Surfaces *s, Error *err)
{
    Fans   fans = { 0 };
    Vec3  *flat = array_create(s->triangle_count, sizeof *flat, "normals", err);
    float *smooth = array_create(9 * (size_t)s->triangle_count, sizeof *smooth, "normals", err);
    if (!error_is_set(err) && fans_init(&fans, s, err)) {
        for (uint32_t i = 0; i < s->triangle_count; i++)
            flat[i] = surfaces_normal(s, i, 0, 0);
        for (uint32_t i = 0; i < 3 * s->triangle_count; i++) {
            const Vec3 n = smooth_normal(s, &fans, flat, i);
            smooth[3 * (size_t)i] = (float)n.x;
            smooth[3 * (size_t)i + 1] = (float)n.y;
            smooth[3 * (size_t)i + 2] = (float)n.z;
        }
    }
    array_free(fans.first);
    array_free(fans.corner);
    array_free(flat);
    return error_is_set(err) ? array_free(smooth) : smooth;
}

Vec3 normals_at(const float *smooth, const Room *room, const RoomHit *hit, Vec3 in)
{
    const Surface *surface = &room->surfaces->surface[hit->surface];
    if (smooth == NULL || surface->kind == SURFACE_SHAPE)
        return hit->normal;
    /* The weights of corners 1 and 2, from where (s, t) puts them (mesh/surfaces.h). */
    const bool quad = surface->kind == SURFACE_QUAD;
    const bool second = quad && hit->t > hit->s;
    const double u = !quad || second ? hit->s : hit->s - hit->t;
    const double v = !quad || !second ? hit->t : hit->t - hit->s;
    const double w[3] = { 1 - u - v, u, v };
    const float *n = smooth + 9 * (size_t)(surface->primitive + (second ? 1 : 0));
    Vec3 sum = { 0, 0, 0 };
    for (unsigned k = 0; k < 3; k++)
        sum = vec3_mad(sum, w[k], vec3(n[3 * k], n[3 * k + 1], n[3 * k + 2]));
    sum = vec3_unit(hit->side == 0 ? sum : vec3_scale(sum, -1));
    return vec3_dot(sum, in) < 0 ? sum : hit->normal;
}
