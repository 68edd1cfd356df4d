/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat lamps: Lambert's formula, and samples uniform in the solid angle they fill. */
#include "render/facet.h"

#include <assert.h>

#include "math/sampling.h"

static const double PI = 3.14159265358979323846;

/* Facets that fill less solid angle (sr) than this are sampled by area: across one that is 0.01 rad
 * wide the density per solid angle varies by about as much, 1 %, and the angles' cancellation, some
 * 1e-15 of 1, would begin to count only at 1e-10. */
static const double SMALL_SOLID_ANGLE = 1e-4;

/* Corners of a parallelogram meet at a right angle when the cosine is below this: what float
 * coordinates can say of a right angle. */
static const double RIGHT_COSINE = 1e-6;

void facet_init(Facet *facet, const Vec3 *corner, int count)
{
    assert(count == 3 || count == 4);
    *facet = (Facet){ .count = count };
    for (int i = 0; i < count; i++)
        facet->corner[i] = corner[i];
    const Vec3   e = vec3_sub(corner[1], corner[0]);
    const Vec3   f = vec3_sub(corner[count - 1], corner[0]);
    const Vec3   c = vec3_cross(e, f);
    const double parallelogram = vec3_length(c);
    facet->normal = vec3_unit(c);
    facet->area = count == 4 ? parallelogram : parallelogram / 2;
    facet->width = vec3_length(e);
    facet->height = vec3_length(f);
    facet->x = vec3_unit(e);
    facet->y = vec3_unit(f);
    facet->rectangle = count == 4 && fabs(vec3_dot(facet->x, facet->y)) < RIGHT_COSINE;
}

/* --- Lambert's formula ----------------------------------------------------------------------- */

/* Cuts away what is below the horizon; v has room for one more corner. Returns how many there are
 * then. */
static int clip_to_horizon(Vec3 *v, int count, Vec3 n)
{
    Vec3 out[5];
    int  left = 0;
    for (int i = 0; i < count; i++) {
        const Vec3   a = v[i], b = v[i + 1 == count ? 0 : i + 1];
        const double ha = vec3_dot(a, n), hb = vec3_dot(b, n);
        if (ha >= 0)
            out[left++] = a;
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0))
            out[left++] = vec3_lerp(a, b, ha / (ha - hb));
        assert(left <= 5);
        if (left == 5) /* a convex polygon of four corners gains at most one */
            break;
    }
    for (int i = 0; i < left; i++)
        v[i] = out[i];
    return left;
}

/* atan2(sine, cosine) for sine >= 0, several times as fast: the tangent is turned back by the
 * nearest of nine angles, and what is left, below 1/15, put into the series, whose first term left
 * out is below 2e-15. */
static double angle_of(double sine, double cosine)
{
    static const double angle[] = { 0, 0.12435499454676144, 0.24497866312686414,
                                    0.35877067027057225, 0.4636476090008061, 0.5585993153435624,
                                    0.6435011087932844, 0.7188299996216245, 0.7853981633974483 };
    const double side = fabs(cosine);
    const bool   steep = sine > side;
    const double top = steep ? side : sine, bottom = steep ? sine : side;
    if (!(bottom > 0))
        return 0;
    const int    nearest = (int)(8 * top / bottom + 0.5);
    const double tangent = nearest / 8.0;
    const double x = (top - tangent * bottom) / (bottom + tangent * top), xx = x * x;
    const double rest = x * (1 + xx * (-1.0 / 3 + xx * (1.0 / 5 + xx * (-1.0 / 7 + xx *
                        (1.0 / 9 + xx * (-1.0 / 11))))));
    const double small = angle[nearest] + rest;
    const double acute = steep ? PI / 2 - small : small;
    return cosine < 0 ? PI - acute : acute;
}

double facet_irradiance(const Facet *facet, Vec3 p, Vec3 n)
{
    Vec3 v[5];
    int  count = facet->count, below = 0;
    for (int i = 0; i < count; i++) {
        v[i] = vec3_sub(facet->corner[i], p);
        below += vec3_dot(v[i], n) < 0;
    }
    if (below == count)
        return 0;
    if (below > 0)
        count = clip_to_horizon(v, count, n);
    /* Half the sum over the edges of the angle seen times the cosine between the receiver's normal
     * and that of the plane through edge and receiver. */
    double sum = 0;
    for (int i = 0; i < count; i++) {
        const Vec3   a = v[i], b = v[i + 1 == count ? 0 : i + 1];
        const Vec3   c = vec3_cross(a, b);
        const double length = vec3_length(c);
        if (length > 0)
            sum += angle_of(length, vec3_dot(a, b)) * vec3_dot(c, n) / length;
    }
    return fabs(sum) / 2;
}

/* --- triangles ------------------------------------------------------------------------------- */

/* Solid angle of the triangle of directions a, b, c (any lengths) [vanoosterom83]. */
static double triangle_solid_angle(Vec3 a, Vec3 b, Vec3 c)
{
    const double la = vec3_length(a), lb = vec3_length(b), lc = vec3_length(c);
    const double top = fabs(vec3_dot(a, vec3_cross(b, c)));
    const double bottom = la * lb * lc + vec3_dot(a, b) * lc + vec3_dot(b, c) * la +
                          vec3_dot(c, a) * lb;
    return 2 * angle_of(top, bottom);
}

static double clamp_cosine(double c) { return c < -1 ? -1 : c > 1 ? 1 : c; }

/* Unit part of b at right angles to the unit vector a. */
static Vec3 across(Vec3 a, Vec3 b) { return vec3_unit(vec3_mad(b, -vec3_dot(a, b), a)); }

/* Direction uniform in the spherical triangle a, b, c (unit vectors), whose solid angle is given:
 * s picks the sub-triangle with corners a, b and a point of the arc a-c, t a point of the arc from
 * b to that point [arvo95]. */
static Vec3 triangle_direction(Vec3 a, Vec3 b, Vec3 c, double solid_angle, double s, double t)
{
    const Vec3   ab = across(a, b), ac = across(a, c);
    const double cos_alpha = clamp_cosine(vec3_dot(ab, ac));
    const double alpha = acos(cos_alpha), sin_alpha = sin(alpha);
    const double cos_c = vec3_dot(a, b); /* the side opposite to c */
    const double phi = s * solid_angle - alpha;
    const double sin_phi = sin(phi), cos_phi = cos(phi);
    const double u = cos_phi - cos_alpha, v = sin_phi + sin_alpha * cos_c;
    const double bottom = (v * sin_phi + u * cos_phi) * sin_alpha;
    const double q = bottom != 0 ? ((v * cos_phi - u * sin_phi) * cos_alpha - v) / bottom : 1;
    const double cos_b = clamp_cosine(q);
    const Vec3   point = vec3_mad(vec3_scale(a, cos_b), sqrt(1 - cos_b * cos_b), ac);
    const double z = 1 - t * (1 - vec3_dot(point, b));
    return vec3_mad(vec3_scale(b, z), sqrt(fmax(1 - z * z, 0)), across(b, point));
}

/* Where the ray from p along d meets the facet's plane. */
static Vec3 plane_point(const Facet *facet, Vec3 p, Vec3 d)
{
    const double speed = vec3_dot(facet->normal, d);
    if (!(speed < 0)) /* rounding at a grazing view */
        return facet->corner[0];
    return vec3_mad(p, -facet_height(facet, p) / speed, d);
}

/* Triangle 0 (corners 0 1 2) and, of a parallelogram, triangle 1 (corners 2 3 0). */
static double part_solid_angle(const Facet *facet, Vec3 p, int part)
{
    return triangle_solid_angle(vec3_sub(facet->corner[2 * part], p),
                                vec3_sub(facet->corner[2 * part + 1], p),
                                vec3_sub(facet->corner[part ? 0 : 2], p));
}

static Vec3 part_sample(const Facet *facet, Vec3 p, int part, double solid_angle, double a,
                        double b)
{
    const Vec3 x = vec3_unit(vec3_sub(facet->corner[2 * part], p));
    const Vec3 y = vec3_unit(vec3_sub(facet->corner[2 * part + 1], p));
    const Vec3 z = vec3_unit(vec3_sub(facet->corner[part ? 0 : 2], p));
    return plane_point(facet, p, triangle_direction(x, y, z, solid_angle, a, b));
}

/* --- rectangles ------------------------------------------------------------------------------ */

/* The rectangle from a point, in the frame of its edges: x0..x1, y0..y1 at height z < 0. */
typedef struct {
    double x0, x1, y0, y1, z;
    double b0, b1, k, solid_angle;
} View;

static void view_init(View *view, const Facet *facet, Vec3 p)
{
    const Vec3 d = vec3_sub(facet->corner[0], p);
    view->x0 = vec3_dot(d, facet->x);
    view->y0 = vec3_dot(d, facet->y);
    view->z = vec3_dot(d, facet->normal);
    view->x1 = view->x0 + facet->width;
    view->y1 = view->y0 + facet->height;
    /* Normals of the planes through p and the edges are (0, z, -y0), (-z, 0, x1), (0, -z, y1) and
     * (z, 0, -x0), normalised; inner angles follow from their products. */
    const double zz = view->z * view->z;
    const double hx0 = 1 / sqrt(zz + view->x0 * view->x0), hx1 = 1 / sqrt(zz + view->x1 * view->x1);
    const double hy0 = 1 / sqrt(zz + view->y0 * view->y0), hy1 = 1 / sqrt(zz + view->y1 * view->y1);
    const double g0 = acos(clamp_cosine(view->y0 * view->x1 * hy0 * hx1));
    const double g1 = acos(clamp_cosine(-view->x1 * view->y1 * hx1 * hy1));
    const double g2 = acos(clamp_cosine(view->y1 * view->x0 * hy1 * hx0));
    const double g3 = acos(clamp_cosine(-view->x0 * view->y0 * hx0 * hy0));
    view->b0 = -view->y0 * hy0;
    view->b1 = view->y1 * hy1;
    view->k = 2 * PI - g2 - g3;
    view->solid_angle = g0 + g1 - view->k;
}

static double clamp_between(double v, double lo, double hi) { return fmin(fmax(v, lo), hi); }

static Vec3 view_sample(const View *view, const Facet *facet, double a, double b)
{
    const double au = a * view->solid_angle + view->k;
    const double fu = (cos(au) * view->b0 - view->b1) / sin(au);
    const double cu = clamp_cosine(copysign(1 / sqrt(fu * fu + view->b0 * view->b0), fu));
    const double side = sqrt(fmax(1 - cu * cu, 0));
    const double x = side > 0 ? clamp_between(-(cu * view->z) / side, view->x0, view->x1)
                              : view->x0;
    const double dd = x * x + view->z * view->z;
    const double h0 = view->y0 / sqrt(dd + view->y0 * view->y0);
    const double h1 = view->y1 / sqrt(dd + view->y1 * view->y1);
    const double h = h0 + b * (h1 - h0);
    const double y = h * h < 1 ? clamp_between(h * sqrt(dd / (1 - h * h)), view->y0, view->y1)
                               : view->y1;
    return vec3_mad(vec3_mad(facet->corner[0], x - view->x0, facet->x), y - view->y0, facet->y);
}

/* --- any facet ------------------------------------------------------------------------------- */

static Vec3 area_sample(const Facet *facet, double a, double b)
{
    const Vec3 e = vec3_sub(facet->corner[1], facet->corner[0]);
    const Vec3 f = vec3_sub(facet->corner[facet->count - 1], facet->corner[0]);
    if (facet->count == 3)
        sampling_triangle(a, b, &a, &b);
    return vec3_mad(vec3_mad(facet->corner[0], a, e), b, f);
}

/* area * cosine / distance^2: what uniform area is per solid angle. */
static double area_spread(const Facet *facet, Vec3 p, Vec3 point)
{
    const Vec3   d = vec3_sub(point, p);
    const double dd = vec3_dot(d, d);
    return facet->area * facet_height(facet, p) / (dd * sqrt(dd));
}

/* Not seen small, by a bound that needs no angles: solid angle <= area / (nearest distance)^2. */
static bool seen_large(const Facet *facet, Vec3 p)
{
    const double radius = facet->width + facet->height;
    const double d = vec3_length(vec3_sub(facet->corner[0], p)) - radius;
    return d <= 0 || facet->area > SMALL_SOLID_ANGLE * d * d;
}

double facet_sample(const Facet *facet, Vec3 p, double a, double b, Vec3 *point)
{
    assert(facet->count == 3 || facet->count == 4);
    if (!seen_large(facet, p)) {
        *point = area_sample(facet, a, b);
        return area_spread(facet, p, *point);
    }
    if (facet->rectangle) {
        View view;
        view_init(&view, facet, p);
        if (view.solid_angle > SMALL_SOLID_ANGLE) {
            *point = view_sample(&view, facet, a, b);
            return view.solid_angle;
        }
    } else {
        const double first = part_solid_angle(facet, p, 0);
        const double all = first + (facet->count == 4 ? part_solid_angle(facet, p, 1) : 0);
        if (all > SMALL_SOLID_ANGLE) {
            const double share = first / all;
            *point = a < share ? part_sample(facet, p, 0, first, a / share, b)
                               : part_sample(facet, p, 1, all - first,
                                             (a - share) / (1 - share), b);
            return all;
        }
    }
    *point = area_sample(facet, a, b);
    return area_spread(facet, p, *point);
}

double facet_spread(const Facet *facet, Vec3 p, Vec3 point)
{
    if (seen_large(facet, p)) {
        double solid_angle;
        if (facet->rectangle) {
            View view;
            view_init(&view, facet, p);
            solid_angle = view.solid_angle;
        } else {
            solid_angle = part_solid_angle(facet, p, 0) +
                          (facet->count == 4 ? part_solid_angle(facet, p, 1) : 0);
        }
        if (solid_angle > SMALL_SOLID_ANGLE)
            return solid_angle;
    }
    return area_spread(facet, p, point);
}
