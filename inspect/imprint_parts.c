/* SPDX-License-Identifier: BSD-3-Clause */
/* inspect/imprint_parts.c -- faces as flat convex parts, and a tree over them. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "inspect/imprint_internal.h"
#include "math/tolerance.h"
#include "mesh/triangulate.h"

static double largest_coordinate(Vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* Plane, box and area of a part whose corners are there. */
static void measure_part(const ImprintParts *parts, ImprintPart *part)
{
    const Vec3 *position = parts->soup->position;
    const uint32_t *corner = parts->corner + part->first;
    const Vec3 normal = triangulate_normal(position, corner, part->count);
    part->area = vec3_length(normal) / 2;
    part->normal = vec3_unit(normal);
    part->lo = part->hi = position[corner[0]];
    double level = 0;
    for (uint32_t k = 0; k < part->count; k++) {
        const Vec3 p = position[corner[k]];
        part->lo = vec3_min(part->lo, p);
        part->hi = vec3_max(part->hi, p);
        level += vec3_dot(part->normal, p) / part->count;
    }
    part->level = level;
    part->tolerance = polygons_tolerance(parts->soup, fmax(largest_coordinate(part->lo),
                                                           largest_coordinate(part->hi)));
}

/* Flat, turning one way at each corner, and once round in all. */
static bool is_convex(const ImprintParts *parts, const ImprintPart *part)
{
    double turned = 0;
    for (uint32_t k = 0; k < part->count; k++) {
        const Vec3 p = imprint_corner(parts, part, k), q = imprint_corner(parts, part, k + 1);
        const Vec3 r = imprint_corner(parts, part, k + 2);
        const Vec3 a = vec3_sub(q, p), b = vec3_sub(r, q);
        const double sine = vec3_dot(vec3_cross(a, b), part->normal);
        if (fabs(vec3_dot(part->normal, p) - part->level) > part->tolerance
            || sine < -part->tolerance * vec3_length(a))
            return false;
        turned += atan2(sine, vec3_dot(a, b));
    }
    return turned < 3 * M_PI; /* 2 pi, or 4 pi and more when it winds twice */
}

static bool add_part(ImprintParts *parts, uint32_t face, const uint32_t *corner, uint32_t count,
                     Error *err)
{
    if (!array_reserve((void **)&parts->part, &parts->capacity, (size_t)parts->count + 1,
                       sizeof *parts->part, "face contacts", err)
        || !array_reserve((void **)&parts->corner, &parts->corner_capacity,
                          parts->corner_count + count, sizeof *parts->corner, "face contacts",
                          err))
        return false;
    ImprintPart *part = &parts->part[parts->count++];
    *part = (ImprintPart){ .face = face, .first = (uint32_t)parts->corner_count, .count = count };
    memcpy(parts->corner + part->first, corner, count * sizeof *corner);
    parts->corner_count += count;
    measure_part(parts, part);
    return true;
}

static void drop_part(ImprintParts *parts)
{
    parts->corner_count = parts->part[--parts->count].first;
}

static bool add_face(ImprintParts *parts, uint32_t face, Triangulation *cut, Error *err)
{
    const Polygons *soup = parts->soup;
    const uint32_t *corner = soup->corner + soup->first[face];
    const uint32_t count = soup->first[face + 1] - soup->first[face];
    for (uint32_t k = 0; k < count; k++)
        if (!vec3_finite(soup->position[corner[k]]))
            return true;
    if (!add_part(parts, face, corner, count, err))
        return false;
    const ImprintPart *whole = &parts->part[parts->count - 1];
    if (whole->area > 0 && (count == 3 || is_convex(parts, whole)))
        return true;
    drop_part(parts);
    if (!triangulate(cut, soup->position, corner, count, err))
        return false;
    for (size_t k = 0; k < cut->count; k++) {
        if (!add_part(parts, face, cut->triangle + 3 * k, 3, err))
            return false;
        if (!(parts->part[parts->count - 1].area > 0))
            drop_part(parts);
    }
    return true;
}

static bool build_tree(ImprintParts *parts, Error *err)
{
    BoxEntry *entry = array_create(parts->count, sizeof *entry, "face contacts", err);
    for (uint32_t k = 0; entry != NULL && k < parts->count; k++) {
        const ImprintPart *p = &parts->part[k];
        const Vec3 rim = vec3(p->tolerance, p->tolerance, p->tolerance);
        entry[k].box = box_around(vec3_sub(p->lo, rim), vec3_add(p->hi, rim));
    }
    return entry != NULL && box_tree_create(&parts->tree, entry, parts->count, err);
}

bool imprint_parts_create(ImprintParts *parts, const Polygons *soup, Error *err)
{
    assert(parts != NULL && soup != NULL && err != NULL);
    *parts = (ImprintParts){ .soup = soup };
    Triangulation cut = { 0 };
    parts->first = array_create(soup->polygon_count + 1, sizeof *parts->first, "face contacts",
                                err);
    bool ok = parts->first != NULL;
    for (uint32_t i = 0; ok && i < soup->polygon_count; i++) {
        ok = add_face(parts, i, &cut, err);
        parts->first[i + 1] = parts->count;
    }
    triangulation_clear(&cut);
    return ok && build_tree(parts, err);
}

void imprint_parts_clear(ImprintParts *parts)
{
    box_tree_clear(&parts->tree);
    array_free(parts->part);
    array_free(parts->first);
    array_free(parts->corner);
    *parts = (ImprintParts){ 0 };
}
