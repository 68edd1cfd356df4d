/* SPDX-License-Identifier: BSD-3-Clause */
/* Two triangles: apart, touching, passing through each other, or on top of each other in a plane.
 *
 * Crossing: each has corners well on both sides of the other's plane, and the pieces of the planes'
 * common line inside the two overlap [moller97]. "Well" is more than the tolerance, also across the
 * triangles: a line that runs along an edge within rounding only touches.
 */
#include <assert.h>
#include <math.h>

#include "inspect/internal.h"

/* A triangle cut by three lines has 6 corners; rounding can at most double them each time. */
enum { CLIP_MOST = 24 };

Triangle triangle_get(const Surfaces *surfaces, uint32_t k)
{
    Triangle t = { .corner = surfaces->corner + 3 * (size_t)k };
    double   largest = 0;
    assert(k < surfaces->triangle_count);
    for (int i = 0; i < 3; i++) {
        const Vec3 p = surfaces->position[t.corner[i]];
        t.p[i] = p;
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    t.tolerance = inspect_tolerance(largest);
    return t;
}

bool triangle_plane(Triangle *t)
{
    const Vec3   ab = vec3_sub(t->p[1], t->p[0]), ac = vec3_sub(t->p[2], t->p[0]);
    const Vec3   cross = vec3_cross(ab, ac);
    const double longest = fmax(vec3_length(ab), fmax(vec3_length(ac),
                                vec3_length(vec3_sub(t->p[2], t->p[1]))));
    const double length = vec3_length(cross);
    t->normal = vec3_scale(cross, 1 / length);
    return length > t->tolerance * longest; /* its least height */
}

Box triangle_box(const Triangle *t)
{
    const Vec3 pad = vec3(t->tolerance, t->tolerance, t->tolerance);
    const Vec3 lo = vec3_min(t->p[0], vec3_min(t->p[1], t->p[2]));
    const Vec3 hi = vec3_max(t->p[0], vec3_max(t->p[1], t->p[2]));
    return box_around(vec3_sub(lo, pad), vec3_add(hi, pad));
}

bool triangle_clear(const Triangle *a, const Triangle *b)
{
    const double tolerance = fmax(a->tolerance, b->tolerance);
    const double d[3] = { vec3_dot(a->normal, vec3_sub(b->p[0], a->p[0])),
                          vec3_dot(a->normal, vec3_sub(b->p[1], a->p[0])),
                          vec3_dot(a->normal, vec3_sub(b->p[2], a->p[0])) };
    return (d[0] > tolerance && d[1] > tolerance && d[2] > tolerance) ||
           (d[0] < -tolerance && d[1] < -tolerance && d[2] < -tolerance);
}

/* Distances of a's corners from b's plane; those on it because they are shared: 0. */
static void plane_distances(const Triangle *a, const Triangle *b, double d[3])
{
    for (int i = 0; i < 3; i++) {
        const uint32_t c = a->corner[i];
        const bool shared = c == b->corner[0] || c == b->corner[1] || c == b->corner[2];
        d[i] = shared ? 0 : vec3_dot(b->normal, vec3_sub(a->p[i], b->p[0]));
    }
}

/* How far the corners reach to the side of the plane where they reach less. */
static double reach_less(const double d[3])
{
    const double above = fmax(d[0], fmax(d[1], d[2])), below = fmin(d[0], fmin(d[1], d[2]));
    return fmin(above, -below);
}

static double reach_most(const double d[3])
{
    return fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
}

/* The piece of the line along `axis` (unit) where the plane with distances d cuts the triangle. */
static void plane_cut(const Triangle *a, const double d[3], Vec3 origin, Vec3 axis, Vec3 end[2],
                      double t[2])
{
    t[0] = INFINITY;
    t[1] = -INFINITY;
    for (int i = 0; i < 3; i++) {
        const int  j = (i + 1) % 3;
        const bool between = (d[i] < 0 && d[j] > 0) || (d[i] > 0 && d[j] < 0);
        if (!between && d[i] != 0)
            continue;
        const Vec3 p = d[i] == 0 ? a->p[i] : vec3_lerp(a->p[i], a->p[j], d[i] / (d[i] - d[j]));
        const double at = vec3_dot(axis, vec3_sub(p, origin));
        if (at < t[0]) {
            t[0] = at;
            end[0] = p;
        }
        if (at > t[1]) {
            t[1] = at;
            end[1] = p;
        }
    }
}

/* Least distance of a point in the triangle's plane from its edges; negative outside. */
static double depth_inside(const Triangle *a, Vec3 p)
{
    double least = INFINITY;
    for (int i = 0; i < 3; i++) {
        const Vec3 edge = vec3_unit(vec3_sub(a->p[(i + 1) % 3], a->p[i]));
        const Vec3 inward = vec3_cross(a->normal, edge);
        least = fmin(least, vec3_dot(inward, vec3_sub(p, a->p[i])));
    }
    return least;
}

static Pair find_crossing(const Triangle *a, const Triangle *b, const double da[3],
                          const double db[3], double tolerance)
{
    const Pair apart = { .kind = PAIR_APART };
    const Vec3 cross = vec3_cross(a->normal, b->normal);
    const double sine = vec3_length(cross);
    if (!(sine > 0))
        return apart;
    const Vec3 axis = vec3_scale(cross, 1 / sine), origin = a->p[0];
    Vec3   ends[2] = { origin, origin }, other[2] = { origin, origin };
    double t[2], u[2];
    plane_cut(a, da, origin, axis, ends, t);
    plane_cut(b, db, origin, axis, other, u);
    const double low = fmax(t[0], u[0]), high = fmin(t[1], u[1]);
    /* Moving a plane by the tolerance moves the line by tolerance / sine. */
    if (!(high - low > tolerance / sine))
        return apart;
    const double middle = (low + high) / 2;
    const Vec3   at = vec3_lerp(ends[0], ends[1], (middle - t[0]) / (t[1] - t[0]));
    const double across = fmin(depth_inside(a, at), depth_inside(b, at));
    const double depth = fmin(across, fmin(reach_less(da), reach_less(db)));
    return depth > tolerance ? (Pair){ PAIR_CROSSING, at, depth } : apart;
}

/* --- in one plane ----------------------------------------------------------------------------- */

/* Keeps what lies to the inner side of a line through p [sutherland74]. */
static int clip_left(Vec3 *corner, int count, Vec3 p, Vec3 inward)
{
    Vec3 kept[CLIP_MOST];
    int  n = 0;
    for (int i = 0; i < count; i++) {
        const Vec3   a = corner[i], b = corner[(i + 1) % count];
        const double da = vec3_dot(inward, vec3_sub(a, p)), db = vec3_dot(inward, vec3_sub(b, p));
        if (da >= 0)
            kept[n++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0))
            kept[n++] = vec3_lerp(a, b, da / (da - db));
    }
    for (int i = 0; i < n; i++)
        corner[i] = kept[i];
    return n;
}

static Pair find_overlap(const Triangle *a, const Triangle *b, double tolerance)
{
    Vec3 corner[CLIP_MOST] = { a->p[0], a->p[1], a->p[2] };
    int  count = 3;
    for (int i = 0; i < 3 && count > 0; i++) {
        const Vec3 edge = vec3_unit(vec3_sub(b->p[(i + 1) % 3], b->p[i]));
        count = clip_left(corner, count, b->p[i], vec3_cross(b->normal, edge));
    }
    Vec3   twice = vec3(0, 0, 0), middle = twice;
    double around = 0;
    for (int i = 0; i < count; i++) {
        const Vec3 p = vec3_sub(corner[i], corner[0]);
        const Vec3 q = vec3_sub(corner[(i + 1) % count], corner[0]);
        twice = vec3_add(twice, vec3_cross(p, q));
        around += vec3_length(vec3_sub(q, p));
        middle = vec3_mad(middle, 1.0 / count, corner[i]);
    }
    /* Twice the area over the perimeter: a long strip's width, a round piece's radius. */
    const double width = around > 0 ? vec3_length(twice) / around : 0;
    return width > tolerance ? (Pair){ PAIR_OVERLAP, middle, width }
                             : (Pair){ .kind = PAIR_APART };
}

Pair pair_find(const Triangle *a, const Triangle *b)
{
    const Pair   apart = { .kind = PAIR_APART };
    const double tolerance = fmax(a->tolerance, b->tolerance);
    double       da[3], db[3];
    assert(tolerance >= 0);
    plane_distances(a, b, da);
    if (!(reach_less(da) > tolerance))
        return reach_most(da) > tolerance ? apart : find_overlap(a, b, tolerance);
    plane_distances(b, a, db);
    if (!(reach_less(db) > tolerance))
        return reach_most(db) > tolerance ? apart : find_overlap(a, b, tolerance);
    return find_crossing(a, b, da, db, tolerance);
}
