/* SPDX-License-Identifier: BSD-3-Clause */
/* Convex polygons cut by planes, shadows of one on the other, and the sum along edges. */
#include "math/sight.h"

#include <assert.h>
#include <string.h>

/* The parts of a polygon on both sides of a plane; either may be NULL. False: too many corners. */
static bool split(const ConvexPolygon *p, Vec3 normal, double offset, ConvexPolygon *inside,
                  ConvexPolygon *outside)
{
    size_t in = 0, out = 0;
    assert(p->count <= SIGHT_CORNERS);
    for (size_t i = 0; i < p->count; i++) {
        const Vec3 a = p->corner[i], b = p->corner[i + 1 < p->count ? i + 1 : 0];
        const double ha = vec3_dot(normal, a) - offset, hb = vec3_dot(normal, b) - offset;
        if (in + 2 > SIGHT_CORNERS || out + 2 > SIGHT_CORNERS)
            return false;
        if (ha >= 0 && inside != NULL)
            inside->corner[in++] = a;
        if (ha <= 0 && outside != NULL)
            outside->corner[out++] = a;
        if (ha * hb < 0) {
            const Vec3 cut = vec3_lerp(a, b, ha / (ha - hb));
            if (inside != NULL)
                inside->corner[in++] = cut;
            if (outside != NULL)
                outside->corner[out++] = cut;
        }
    }
    if (inside != NULL)
        inside->count = in >= 3 ? in : 0;
    if (outside != NULL)
        outside->count = out >= 3 ? out : 0;
    return true;
}

bool convex_polygon_cut(ConvexPolygon *polygon, Vec3 normal, double offset)
{
    ConvexPolygon inside = { .count = 0 };
    if (!split(polygon, normal, offset, &inside, NULL))
        return false;
    *polygon = inside;
    return true;
}

double sight_factor(Vec3 point, Vec3 n, const ConvexPolygon *polygon)
{
    double sum = 0;
    if (polygon->count < 3)
        return 0;
    Vec3 a = vec3_sub(polygon->corner[polygon->count - 1], point);
    for (size_t i = 0; i < polygon->count; i++) {
        const Vec3 b = vec3_sub(polygon->corner[i], point), across = vec3_cross(a, b);
        const double length = vec3_length(across);
        if (length > 0)
            sum += atan2(length, vec3_dot(a, b)) * vec3_dot(across, n) / length;
        a = b;
    }
    return fmin(fabs(sum) / (2 * M_PI), 1);
}

/* A plane through the point and edge i of the blocker, which lies on its inner side; false when
 * the blocker is seen edge on. */
static bool shadow_plane(Vec3 point, const ConvexPolygon *blocker, size_t i, Vec3 middle,
                         Vec3 *normal)
{
    const Vec3 a = vec3_sub(blocker->corner[i], point);
    const Vec3 b = vec3_sub(blocker->corner[i + 1 < blocker->count ? i + 1 : 0], point);
    *normal = vec3_cross(a, b);
    const double side = vec3_dot(*normal, middle);
    if (side < 0)
        *normal = vec3_scale(*normal, -1);
    return side != 0;
}

/* Takes the blocker's shadow out of one piece; what is left goes to out[*count ...]. */
static bool shade(Vec3 point, const ConvexPolygon *blocker, const ConvexPolygon *piece,
                  ConvexPolygon *out, size_t *count)
{
    const size_t begin = *count;
    ConvexPolygon rest = *piece, inside;
    Vec3 middle = vec3(0, 0, 0), normal;
    bool edge_on = false;
    for (size_t i = 0; i < blocker->count; i++)
        middle = vec3_mad(middle, 1.0 / (double)blocker->count,
                          vec3_sub(blocker->corner[i], point));
    for (size_t i = 0; i < blocker->count && rest.count > 0 && !edge_on; i++) {
        edge_on = !shadow_plane(point, blocker, i, middle, &normal);
        if (edge_on)
            break;
        if (*count == SIGHT_PIECES ||
            !split(&rest, normal, vec3_dot(normal, point), &inside, &out[*count]))
            return false;
        *count += out[*count].count > 0;
        rest = inside;
    }
    if (edge_on || rest.count == 0) { /* no shadow falls on it: it is not to be cut up */
        if (begin == SIGHT_PIECES)
            return false;
        out[begin] = *piece;
        *count = begin + 1;
    }
    return true;
}

double sight_past(Vec3 point, Vec3 n, const ConvexPolygon *polygon, const ConvexPolygon *blocker,
                  size_t blockers, SightScratch *scratch)
{
    ConvexPolygon *from = scratch->piece, *to = scratch->next;
    size_t count = 1;
    from[0] = *polygon;
    for (size_t k = 0; k < blockers && count > 0; k++) {
        size_t left = 0;
        for (size_t i = 0; i < count; i++)
            if (!shade(point, &blocker[k], &from[i], to, &left))
                return NAN;
        ConvexPolygon *const swap = from;
        from = to;
        to = swap;
        count = left;
    }
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += sight_factor(point, n, &from[i]);
    return sum;
}
