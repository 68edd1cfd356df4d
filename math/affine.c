/* SPDX-License-Identifier: BSD-3-Clause */
/* Affine maps: composition, rotation, inverse. */
#include "math/affine.h"

#include <assert.h>
#include <stddef.h>

#include "math/tolerance.h"

Affine affine_then(const Affine *first, const Affine *second)
{
    assert(first != NULL && second != NULL);
    return (Affine){ affine_vector(second, first->x), affine_vector(second, first->y),
                     affine_vector(second, first->z), affine_point(second, first->t) };
}

/* Cosine and sine of an angle in degrees; exact at multiples of 90, so that a box turned by them
 * keeps axis-parallel faces. */
static void circle_degrees(double degrees, double *c, double *s)
{
    static const double exact[5] = { 0, 1, 0, -1, 0 };
    const double turn = fmod(degrees, 360);
    const double quarter = turn / 90;

    if (quarter == floor(quarter)) {
        const int k = ((int)quarter + 4) % 4;
        *s = exact[k];
        *c = exact[k + 1];
    } else {
        *s = sin(turn * (M_PI / 180));
        *c = cos(turn * (M_PI / 180));
    }
}

Affine affine_rotation(int axis, double degrees)
{
    assert(axis >= 0 && axis <= 2);
    Affine a = affine_identity();
    double c, s;

    circle_degrees(degrees, &c, &s);
    if (axis == 0) {
        a.y = vec3(0, c, s);
        a.z = vec3(0, -s, c);
    } else if (axis == 1) {
        a.z = vec3(s, 0, c);
        a.x = vec3(c, 0, -s);
    } else {
        a.x = vec3(c, s, 0);
        a.y = vec3(-s, c, 0);
    }
    return a;
}

double affine_determinant(const Affine *a)
{
    assert(a != NULL);
    return vec3_dot(a->x, vec3_cross(a->y, a->z));
}

/* Root of the greatest eigenvalue of M^T M, by the cosines of the characteristic cubic's angle
 * [smith61]. Where two eigenvalues meet, an arc cosine near pi loses half of the digits. */
double affine_stretch(const Affine *a)
{
    assert(a != NULL);
    const double xx = vec3_dot(a->x, a->x), yy = vec3_dot(a->y, a->y), zz = vec3_dot(a->z, a->z);
    const double xy = vec3_dot(a->x, a->y), yz = vec3_dot(a->y, a->z), zx = vec3_dot(a->z, a->x);
    const double mean = (xx + yy + zz) / 3, dx = xx - mean, dy = yy - mean, dz = zz - mean;
    const double p = sqrt((dx * dx + dy * dy + dz * dz +
                           2 * (xy * xy + yz * yz + zx * zx)) / 6);
    const double more = 1 + sqrt(rounding_bound(32));
    if (!(p > 0))
        return sqrt(mean) * more;
    const double det = dx * (dy * dz - yz * yz) - xy * (xy * dz - yz * zx) +
                       zx * (xy * yz - dy * zx);
    const double half = fmin(fmax(det / (p * p * p) / 2, -1), 1);
    return sqrt(mean + 2 * p * cos(acos(half) / 3)) * more;
}

/* Divides a column by the power of two nearest below its length, so that products of columns
 * neither overflow nor underflow; exact. *scale is what it was divided by. */
static bool column_normalise(Vec3 *column, double *scale)
{
    const double largest = fmax(fabs(column->x), fmax(fabs(column->y), fabs(column->z)));
    int exponent;

    if (!(largest > 0) || !vec3_finite(*column))
        return false;
    frexp(largest, &exponent);
    *column = vec3(ldexp(column->x, -exponent), ldexp(column->y, -exponent),
                   ldexp(column->z, -exponent));
    *scale = ldexp(1, exponent);
    return isfinite(*scale);
}

bool affine_invert(const Affine *a, Affine *out)
{
    assert(a != NULL && out != NULL);
    Affine m = *a;
    double sx, sy, sz;

    if (!column_normalise(&m.x, &sx) || !column_normalise(&m.y, &sy) ||
        !column_normalise(&m.z, &sz) || !vec3_finite(m.t))
        return false;
    const double det = affine_determinant(&m);
    /* Entries are at most 1: the six products of three are each off by 5 roundings at most. */
    if (!(fabs(det) > 6 * rounding_bound(5)))
        return false;
    const Vec3 row_x = vec3_scale(vec3_cross(m.y, m.z), 1 / (det * sx));
    const Vec3 row_y = vec3_scale(vec3_cross(m.z, m.x), 1 / (det * sy));
    const Vec3 row_z = vec3_scale(vec3_cross(m.x, m.y), 1 / (det * sz));
    Affine inverse = { vec3(row_x.x, row_y.x, row_z.x), vec3(row_x.y, row_y.y, row_z.y),
                       vec3(row_x.z, row_y.z, row_z.z), vec3(0, 0, 0) };
    inverse.t = vec3_scale(affine_vector(&inverse, m.t), -1);
    if (!vec3_finite(inverse.x) || !vec3_finite(inverse.y) || !vec3_finite(inverse.z) ||
        !vec3_finite(inverse.t))
        return false;
    *out = inverse;
    return true;
}
