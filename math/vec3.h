/* SPDX-License-Identifier: BSD-3-Clause */
/* math/vec3.h -- three doubles, by value. */
#ifndef MATH_VEC3_H
#define MATH_VEC3_H

#include <math.h>
#include <stdbool.h>

typedef struct {
    double x, y, z;
} Vec3;

static inline Vec3 vec3(double x, double y, double z) { return (Vec3){ x, y, z }; }
static inline Vec3 vec3_add(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec3 vec3_sub(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec3 vec3_scale(Vec3 a, double s) { return vec3(a.x * s, a.y * s, a.z * s); }
/* a + s b */
static inline Vec3 vec3_mad(Vec3 a, double s, Vec3 b)
{
    return vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double vec3_dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec3 vec3_cross(Vec3 a, Vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double vec3_length(Vec3 a) { return sqrt(vec3_dot(a, a)); }
/* Unit vector along a; the zero vector stays zero. */
static inline Vec3 vec3_unit(Vec3 a)
{
    const double length = vec3_length(a);
    return length > 0 ? vec3_scale(a, 1 / length) : a;
}
static inline Vec3 vec3_lerp(Vec3 a, Vec3 b, double t) { return vec3_mad(a, t, vec3_sub(b, a)); }
static inline Vec3 vec3_min(Vec3 a, Vec3 b)
{
    return vec3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}
static inline Vec3 vec3_max(Vec3 a, Vec3 b)
{
    return vec3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}
static inline bool vec3_finite(Vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
static inline double vec3_axis(Vec3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/* Two unit vectors that make a right-handed frame (*s, *t, n) with the unit vector n, without a
 * branch that would make neighbouring normals jump except at n.z = 0 [duff17]. */
static inline void vec3_frame(Vec3 n, Vec3 *s, Vec3 *t)
{
    const double sign = copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    *s = vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *t = vec3(b, sign + n.y * n.y * a, -n.y);
}

#endif
