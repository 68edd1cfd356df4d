/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies of light that touch a wall with a whole face: before it, as a lamp under a ceiling, or
 * behind it, as one sunk into the ceiling. Before it, the wall goes on behind the lamp; behind it,
 * the lamp shines through. Neither winding tells, for both may be wound wrong; but rooms are
 * enclosed, and what lies behind their walls mostly is not: rays tell. */
#include <assert.h>
#include <math.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"
#include "math/sampling.h"
#include "math/tolerance.h"

/* Rays to each side; of an enclosed place fewer than half of them escape: a room may want a wall to
 * be seen through, and half of the rays from a lone wall's side go towards nothing. */
enum { RAYS = 64 };

/* Rays start within the face, this share of the way from its middle to its corners. */
static const double INNER_SHARE = 0.7;

static bool build_bvh(const ImprintParts *parts, ImprintContacts *c, Error *err)
{
    static const char what[] = "face contacts";
    const Polygons *soup = parts->soup;
    Vec3 *position = array_create(parts->corner_count, sizeof *position, what, err);
    uint32_t *corner = array_create(3 * parts->corner_count, sizeof *corner, what, err);
    Shape *shape = array_create(soup->shape_count, sizeof *shape, what, err);
    uint32_t triangles = 0;
    if (!error_is_set(err)) {
        for (size_t i = 0; i < parts->corner_count; i++)
            position[i] = soup->position[parts->corner[i]];
        for (uint32_t k = 0; k < parts->count; k++)
            for (uint32_t i = 1; i + 1 < parts->part[k].count; i++, triangles++) {
                uint32_t *t = corner + 3 * (size_t)triangles;
                t[0] = parts->part[k].first;
                t[1] = t[0] + i;
                t[2] = t[1] + 1;
            }
        for (size_t i = 0; i < soup->shape_count; i++)
            shape[i] = soup->shape[i].shape;
        c->bvh = bvh_create(&(Primitives){ .position = position, .corner = corner, .shape = shape,
                                           .vertex_count = (uint32_t)parts->corner_count,
                                           .triangle_count = triangles,
                                           .shape_count = (uint32_t)soup->shape_count }, 1, err);
    }
    array_free(position);
    array_free(corner);
    array_free(shape);
    return c->bvh != NULL;
}

/* How far the body reaches off the plane of one of its faces: the most of its lit neighbours; less
 * than 0 behind the front. */
static double body_depth(const ImprintParts *parts, const ImprintPart *face, uint32_t *met)
{
    const Vec3 rim = vec3(face->tolerance, face->tolerance, face->tolerance);
    const Box box = box_around(vec3_sub(face->lo, rim), vec3_add(face->hi, rim));
    const uint32_t count = box_tree_meet(&parts->tree, &box, 0, met, parts->count);
    double depth = 0;
    for (uint32_t k = 0; k < count; k++) {
        const ImprintPart *other = &parts->part[parts->tree.entry[met[k]].item];
        if (!imprint_emits(parts->soup, other->face) || !imprint_share_edge(parts, face, other))
            continue;
        for (uint32_t i = 0; i < other->count; i++) {
            const double h = vec3_dot(face->normal, imprint_corner(parts, other, i)) - face->level;
            depth = fabs(h) > fabs(depth) ? h : depth;
        }
    }
    return depth;
}

/* Whether less than half of the rays from over the face, `height` along the unit vector `out`, go
 * on to infinity. */
static bool is_enclosed(const ImprintParts *parts, const Bvh *bvh, const ImprintPart *face,
                        Vec3 out, double height)
{
    Vec3 middle = { 0 }, u, v;
    uint32_t escaped = 0;
    for (uint32_t i = 0; i < face->count; i++)
        middle = vec3_mad(middle, 1.0 / face->count, imprint_corner(parts, face, i));
    vec3_frame(out, &u, &v);
    for (uint32_t n = 0; n < RAYS; n++) {
        float x[4];
        sampling_sobol4(n, 0, x);
        const Vec3 corner = imprint_corner(parts, face, n);
        const Vec3 from = vec3_mad(vec3_lerp(middle, corner, INNER_SHARE * (double)x[2]), height,
                                   out);
        const Vec3 w = sampling_cosine((double)x[0], (double)x[1]);
        const Vec3 d = vec3_mad(vec3_mad(vec3_scale(out, w.z), w.x, u), w.y, v);
        const Vec3 far = vec3_max(vec3_max(from, face->hi), vec3_scale(face->lo, -1));
        const Ray ray = ray_leaving(from, out, ray_offset(vec3_length(far)), d, INFINITY);
        escaped += !bvh_blocked(bvh, &ray);
    }
    return 2 * escaped < RAYS;
}

bool imprint_enclosed(const ImprintParts *parts, ImprintContacts *c, const ImprintPart *part,
                      Vec3 out, bool *enclosed, Error *err)
{
    assert(part != NULL && enclosed != NULL);
    if (c->bvh == NULL && !build_bvh(parts, c, err))
        return false;
    *enclosed = is_enclosed(parts, c->bvh, part, out, 0);
    return true;
}

bool imprint_body_opens(const ImprintParts *parts, uint32_t lamp, ImprintContacts *c, bool *opens,
                        Error *err)
{
    assert(lamp < parts->count && opens != NULL);
    const ImprintPart *face = &parts->part[lamp];
    *opens = false;
    if (c->beside == NULL)
        c->beside = array_create(parts->count, sizeof *c->beside, "face contacts", err);
    if (c->beside == NULL || (c->bvh == NULL && !build_bvh(parts, c, err)))
        return false;
    const double depth = body_depth(parts, face, c->beside);
    const Vec3 in = vec3_scale(face->normal, depth < 0 ? -1 : 1), out = vec3_scale(in, -1);
    const bool here = is_enclosed(parts, c->bvh, face, in, fabs(depth));
    const bool there = is_enclosed(parts, c->bvh, face, out, 0);
    /* Between two rooms the wall stays, and where there is none at all. */
    *opens = there && !here;
    return true;
}
