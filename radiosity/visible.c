/* SPDX-License-Identifier: BSD-3-Clause */
/* Distances from the edges of a surface, and whether it goes on beyond them. */
#include "radiosity/visible.h"

#include <math.h>

#include "math/tolerance.h"

/* Distance from a seam that is safe, in offsets: rounding of where a ray starts and of where it
 * hits is below one each; grazing hits are off by more. */
static const double MARGIN = 4;

/* Seams are never wider than this share of a surface, however small that is. */
static const double SHARE = 1.0 / 64;

static unsigned edges_of(const Surface *f)
{
    return f->kind == SURFACE_TRIANGLE ? 3 : f->kind == SURFACE_QUAD ? 4 : 0;
}

/* Distance of (s, t) from edge k, relative to the surface's height over it. */
static double edge_share(const Surface *f, unsigned k, double s, double t)
{
    if (f->kind == SURFACE_TRIANGLE)
        return k == 0 ? t : k == 1 ? 1 - s - t : s;
    return k == 0 ? t : k == 1 ? 1 - s : k == 2 ? 1 - t : s;
}

static double edge_height(const Surfaces *surfaces, const Surface *f, unsigned k)
{
    const uint32_t *c = surfaces->corner + 3 * (size_t)f->primitive;
    const unsigned next = (k + 1) % edges_of(f);
    const Vec3 a = surfaces->position[k == 3 ? c[5] : c[k]];
    const Vec3 b = surfaces->position[next == 3 ? c[5] : c[next]];
    const double twice = f->kind == SURFACE_TRIANGLE ? 2 * f->area : f->area;
    return twice / vec3_length(vec3_sub(b, a));
}

static Vec3 edge_normal(const Surfaces *surfaces, const Surface *f, unsigned k)
{
    const bool second = f->kind == SURFACE_QUAD && k >= 2;
    return surfaces_normal(surfaces, f->primitive + second, 0, 0);
}

static bool goes_on(const Surfaces *surfaces, const Surface *f, unsigned k, uint32_t other)
{
    if (other == SURFACE_NONE)
        return false;
    const double cosine = vec3_dot(edge_normal(surfaces, f, k),
                                   edge_normal(surfaces, &surfaces->surface[other], 0));
    return fabs(cosine) >= TOLERANCE_CREASE_COSINE;
}

/* Whether the surface ends at edge k, or at a piece of it. */
static bool is_seam(const Surfaces *surfaces, uint32_t surface, unsigned k)
{
    const Surface *f = &surfaces->surface[surface];
    if (!goes_on(surfaces, f, k, f->neighbour[k]))
        return true;
    if (surfaces->stitch_first == NULL)
        return false;
    const uint32_t use = 4 * surface + k;
    for (uint32_t i = surfaces->stitch_first[use]; i < surfaces->stitch_first[use + 1]; i++)
        if (!goes_on(surfaces, f, k, surfaces->stitch[i].neighbour))
            return true;
    return false;
}

bool visible_at_seam(const Room *room, uint32_t surface, double s, double t)
{
    const Surface *f = &room->surfaces->surface[surface];
    const double wide = MARGIN * room->offset;
    for (unsigned k = 0; k < edges_of(f); k++) {
        const double share = edge_share(f, k, s, t);
        if (share < SHARE && share * edge_height(room->surfaces, f, k) < wide
            && is_seam(room->surfaces, surface, k))
            return true;
    }
    return false;
}

bool visible_side_used(const Room *room, const Hit *hit, Vec3 direction)
{
    const Vec3 front = surfaces_normal(room->surfaces, hit->primitive, hit->u, hit->v);
    const unsigned side = vec3_dot(front, direction) > 0 ? 1 : 0;
    const uint32_t surface = surfaces_of_primitive(room->surfaces, hit->primitive);
    return room->patches->first[side][surface] != PATCH_NONE;
}

void visible_move(const Room *room, PatchPoint *at)
{
    const Surface *f = &room->surfaces->surface[at->surface];
    const double wide = MARGIN * room->offset;
    bool moved = false;
    for (unsigned k = 0; k < edges_of(f); k++) {
        const double share = edge_share(f, k, at->s, at->t);
        if (share >= SHARE)
            continue;
        const double least = fmin(wide / edge_height(room->surfaces, f, k), SHARE);
        if (share >= least || !is_seam(room->surfaces, at->surface, k))
            continue;
        const double in = least - share;
        moved = true;
        if (f->kind == SURFACE_TRIANGLE) {
            at->s += k == 2 ? in : k == 1 ? -in / 2 : 0;
            at->t += k == 0 ? in : k == 1 ? -in / 2 : 0;
        } else {
            at->s += k == 3 ? in : k == 1 ? -in : 0;
            at->t += k == 0 ? in : k == 2 ? -in : 0;
        }
    }
    if (!moved)
        return;
    const Vec3 normal = at->point.normal;
    surfaces_point(room->surfaces, at->surface, at->s, at->t, &at->point);
    if (vec3_dot(normal, at->point.normal) < 0)
        at->point.normal = vec3_scale(at->point.normal, -1);
}
