/* SPDX-License-Identifier: BSD-3-Clause */
/* A line against a torus: the quartic's turning points bracket its roots.
 *
 * With the ring's radius 1, tube radius r and |p|^2 = m^2 + s^2 along the line (origin o nearest
 * to the centre, unit direction d), the surface is
 *
 *     f(s) = (s^2 + m^2 + 1 - r^2)^2 - 4 (x(s)^2 + y(s)^2) = s^4 + p s^2 + q s + c,
 *
 * without a cubic term. Its second derivative has roots in closed form; they bracket those of the
 * first, which bracket those of f. No step divides by what may be small, and none is missed. Signs
 * and roots of f are taken from the squared distance to the ring instead,
 *
 *     g(s) = (sqrt(x^2 + y^2) - 1)^2 + z^2 - r^2,     f = g (g + 4 sqrt(x^2 + y^2)),
 *
 * which has the same sign and does not cancel when the tube is thin. */
#include <assert.h>
#include <float.h>
#include <stddef.h>

#include "math/internal.h"

typedef struct {
    Vec3   origin, direction;
    double tube;
    double p, q; /* of the depressed quartic */
} Line;

/* A function of s and its derivative. */
typedef double (*Curve)(const Line *line, double s, double *slope);

static double quartic_slope(const Line *line, double s, double *slope)
{
    *slope = 12 * s * s + 2 * line->p;
    return (4 * s * s + 2 * line->p) * s + line->q;
}

static double ring_distance(const Line *line, double s, double *slope)
{
    const Vec3 at = vec3_mad(line->origin, s, line->direction);
    const double r = sqrt(at.x * at.x + at.y * at.y);
    const double off = r - 1;

    /* On the axis the derivative of r is undefined; the surface is never there, any value does. */
    const double along = r > 0 ? (at.x * line->direction.x + at.y * line->direction.y) / r : 0;
    *slope = 2 * (off * along + at.z * line->direction.z);
    return (off - line->tube) * (off + line->tube) + at.z * at.z;
}

/* The root between lo and hi, at whose ends `curve` has different signs: Newton's steps while they
 * stay inside and at least halve the last but one, else bisection, so it always ends. */
static double bracket_root(const Line *line, Curve curve, double lo, double hi)
{
    double slope;
    const bool rises = curve(line, lo, &slope) < 0;
    double s = (lo + hi) / 2, step = hi - lo, last = step;

    assert(lo <= hi);
    for (int i = 0; i < 200; i++) { /* 53 halvings of two kinds; never reached */
        const double value = curve(line, s, &slope);
        if ((value < 0) == rises)
            lo = s;
        else
            hi = s;
        double next = s - value / slope;
        if (!(next > lo && next < hi) || fabs(next - s) > last / 2)
            next = (lo + hi) / 2;
        last = step;
        step = fabs(next - s);
        s = next;
        /* s is a length of the order of 1: a shorter step changes only rounding. */
        if (step <= DBL_EPSILON || hi - lo <= DBL_EPSILON)
            break;
    }
    return s;
}

/* Turning points of the quartic between lo and hi, ascending, into out[3]. */
static int turning_points(const Line *line, double lo, double hi, double out[3])
{
    const double w = line->p < 0 ? sqrt(-line->p / 6) : 0; /* f'' vanishes at +-w */
    const double ends[4] = { lo, fmin(fmax(-w, lo), hi), fmin(fmax(w, lo), hi), hi };
    double slope;
    int count = 0;

    for (int i = 0; i < 3; i++) {
        const bool from = quartic_slope(line, ends[i], &slope) < 0;
        const bool to = quartic_slope(line, ends[i + 1], &slope) < 0;
        if (from != to)
            out[count++] = bracket_root(line, quartic_slope, ends[i], ends[i + 1]);
    }
    return count;
}

bool torus_first(const LocalRay *ray, double tube, double *s)
{
    assert(tube > 0 && tube < 1);
    assert(ray->square > 0);
    const double length = sqrt(ray->square);
    const Vec3 o = ray->origin, d = vec3_scale(ray->direction, 1 / length);
    const double square = vec3_dot(o, o);

    if (!(square < (1 + tube) * (1 + tube)))
        return false;
    /* The whole torus lies within 2 of the centre: g > 0 at both ends. */
    const double lo = fmax(-2, (ray->t_min - ray->shift) * length);
    const double hi = fmin(2, (ray->t_max - ray->shift) * length);
    if (!(lo < hi))
        return false;
    const Line line = { o, d, tube,
                        2 * (square + (1 - tube) * (1 + tube)) - 4 * (d.x * d.x + d.y * d.y),
                        -8 * (o.x * d.x + o.y * d.y) };
    double ends[5] = { lo };
    const int turns = turning_points(&line, lo, hi, ends + 1);
    ends[turns + 1] = hi;

    double slope;
    bool inside = ring_distance(&line, lo, &slope) < 0;
    for (int i = 1; i <= turns + 1; i++) {
        const bool next = ring_distance(&line, ends[i], &slope) < 0;
        if (next != inside) {
            *s = bracket_root(&line, ring_distance, ends[i - 1], ends[i]) / length;
            if (local_ray_allows(ray, *s)) /* else it is the crossing that the ray starts from */
                return true;
        }
        inside = next;
    }
    return false;
}
