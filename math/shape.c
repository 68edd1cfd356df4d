/* SPDX-License-Identifier: BSD-3-Clause */
/* Curved shapes: their parameters, points, normals and boxes. */
#include "math/shape.h"

#include <assert.h>
#include <stddef.h>

#include "math/internal.h"
#include "math/tolerance.h"

static bool ratio_valid(ShapeKind kind, double ratio)
{
    if (kind == SHAPE_FRUSTUM)
        return isfinite(ratio) && ratio >= 0;
    if (kind == SHAPE_TORUS)
        return ratio > 0 && ratio < 1;
    return true;
}

bool shape_init(Shape *shape, ShapeKind kind, double ratio, const Affine *to_world, Error *err)
{
    assert(shape != NULL && to_world != NULL && err != NULL);
    assert(kind >= SHAPE_SPHERE && kind <= SHAPE_TORUS);
    static const char *const names[] = { "sphere", "disc", "frustum", "torus" };

    if (error_is_set(err))
        return false;
    if (!ratio_valid(kind, ratio))
        return error_set(err, ERROR_INPUT, "%s: the ratio of its radii, %g, is not %s",
                         names[kind], ratio, kind == SHAPE_TORUS ? "between 0 and 1" : "0 or more");
    Shape made = { .kind = kind, .ratio = ratio, .to_world = *to_world };
    if (!affine_invert(to_world, &made.to_local))
        return error_set(err, ERROR_INPUT,
                         "%s: flattened to nothing, or not finite, by its transformation",
                         names[kind]);
    *shape = made;
    return true;
}

/* --- the unit forms -------------------------------------------------------------------------- */

/* A point of the unit circle. Seams and quarters come out exact, so that neighbours and mirrored
 * halves share their points. */
static void circle_point(double u, double *c, double *s)
{
    static const double exact[5] = { 0, 1, 0, -1, 0 };
    const double quarter = 4 * u;

    if (quarter == floor(quarter) && quarter >= 0 && quarter <= 4) {
        const int k = (int)quarter % 4;
        *s = exact[k];
        *c = exact[k + 1];
    } else {
        *s = sin(2 * M_PI * u);
        *c = cos(2 * M_PI * u);
    }
}

Vec3 shape_local_point(const Shape *shape, double u, double v)
{
    double c, s, ct, st;

    circle_point(u, &c, &s);
    switch (shape->kind) {
    case SHAPE_SPHERE: {
        const double r = 2 * sqrt(fmax(v * (1 - v), 0)); /* sqrt(1 - z^2) */
        return vec3(r * c, r * s, 2 * v - 1);
    }
    case SHAPE_DISC: {
        const double r = sqrt(fmax(v, 0));
        return vec3(r * c, r * s, 0);
    }
    case SHAPE_FRUSTUM: {
        const double r = (1 - v) + shape->ratio * v;
        return vec3(r * c, r * s, v);
    }
    case SHAPE_TORUS:
        break;
    }
    circle_point(v, &ct, &st);
    const double r = 1 + shape->ratio * ct;
    return vec3(r * c, r * s, shape->ratio * st);
}

Vec3 shape_local_normal(const Shape *shape, double u, double v)
{
    double c, s, ct, st;

    switch (shape->kind) {
    case SHAPE_SPHERE:
        return shape_local_point(shape, u, v);
    case SHAPE_DISC:
        return vec3(0, 0, 1);
    case SHAPE_FRUSTUM:
        circle_point(u, &c, &s);
        return vec3(c, s, 1 - shape->ratio);
    case SHAPE_TORUS:
        break;
    }
    circle_point(u, &c, &s);
    circle_point(v, &ct, &st);
    return vec3(ct * c, ct * s, st);
}

double shape_local_weight(const Shape *shape, double v)
{
    double ct, st;

    switch (shape->kind) {
    case SHAPE_SPHERE:
        return 4 * M_PI;
    case SHAPE_DISC:
        return M_PI;
    case SHAPE_FRUSTUM:
        return 2 * M_PI * ((1 - v) + shape->ratio * v);
    case SHAPE_TORUS:
        break;
    }
    circle_point(v, &ct, &st);
    return 4 * M_PI * M_PI * shape->ratio * (1 + shape->ratio * ct);
}

/* Angle of (x, y) as a share of the full turn, in [0, 1). */
static double turn_of(double y, double x)
{
    const double turn = atan2(y, x) / (2 * M_PI);
    const double wrapped = turn < 0 ? turn + 1 : turn;
    return wrapped < 1 ? wrapped : 0; /* -tiny + 1 rounds to 1 */
}

static double clamp_unit(double x)
{
    return fmin(fmax(x, 0), 1);
}

void shape_local_parameters(const Shape *shape, Vec3 p, double *u, double *v)
{
    *u = turn_of(p.y, p.x);
    switch (shape->kind) {
    case SHAPE_SPHERE: {
        const double length = vec3_length(p);
        *v = length > 0 ? clamp_unit((1 + p.z / length) / 2) : 0;
        return;
    }
    case SHAPE_DISC:
        *v = clamp_unit(p.x * p.x + p.y * p.y);
        return;
    case SHAPE_FRUSTUM:
        *v = clamp_unit(p.z);
        return;
    case SHAPE_TORUS:
        break;
    }
    *v = turn_of(p.z, sqrt(p.x * p.x + p.y * p.y) - 1);
}

/* --- in the world ---------------------------------------------------------------------------- */

Vec3 shape_cofactor(const Affine *map, Vec3 n)
{
    const Vec3 yz = vec3_scale(vec3_cross(map->y, map->z), n.x);
    const Vec3 zx = vec3_scale(vec3_cross(map->z, map->x), n.y);
    const Vec3 xy = vec3_scale(vec3_cross(map->x, map->y), n.z);
    return vec3_add(vec3_add(yz, zx), xy);
}

Vec3 shape_point(const Shape *shape, double u, double v)
{
    assert(shape != NULL);
    return affine_point(&shape->to_world, shape_local_point(shape, u, v));
}

Vec3 shape_normal(const Shape *shape, double u, double v)
{
    assert(shape != NULL);
    /* M^-T n . M d = n . d: what points out of the solid still does after a mirroring map. */
    return vec3_unit(affine_normal(&shape->to_local, shape_local_normal(shape, u, v)));
}

double shape_density(const Shape *shape, double u, double v)
{
    assert(shape != NULL);
    const Vec3 n = shape_cofactor(&shape->to_world, shape_local_normal(shape, u, v));
    return shape_local_weight(shape, v) * vec3_length(n);
}

void shape_place_at(const Shape *shape, double u, double v, Vec3 *point, Vec3 *normal)
{
    assert(shape != NULL && point != NULL && normal != NULL);
    const Vec3 p = shape_local_point(shape, u, v);
    const Vec3 n = shape->kind == SHAPE_SPHERE ? p : shape_local_normal(shape, u, v);
    *point = affine_point(&shape->to_world, p);
    *normal = vec3_unit(affine_normal(&shape->to_local, n));
}

void shape_all_at(const Shape *shape, double u, double v, Vec3 *point, Vec3 *normal,
                  double *density)
{
    assert(shape != NULL && point != NULL && normal != NULL && density != NULL);
    const Vec3 p = shape_local_point(shape, u, v);
    const Vec3 n = shape->kind == SHAPE_SPHERE ? p : shape_local_normal(shape, u, v);
    *point = affine_point(&shape->to_world, p);
    *normal = vec3_unit(affine_normal(&shape->to_local, n));
    *density = shape_local_weight(shape, v) * vec3_length(shape_cofactor(&shape->to_world, n));
}

void shape_parameters(const Shape *shape, Vec3 p, double *u, double *v)
{
    assert(shape != NULL && u != NULL && v != NULL);
    shape_local_parameters(shape, affine_point(&shape->to_local, p), u, v);
}

/* Half the extent of the unit form along a world axis whose pulled-back direction is d = M^T e:
 * the support function. The frustum is done by its two rims. */
static double support(const Shape *shape, Vec3 d)
{
    const double flat = sqrt(d.x * d.x + d.y * d.y);

    if (shape->kind == SHAPE_SPHERE)
        return vec3_length(d);
    return shape->kind == SHAPE_TORUS ? flat + shape->ratio * vec3_length(d) : flat;
}

void shape_bounds(const Shape *shape, Vec3 *lo, Vec3 *hi)
{
    assert(shape != NULL && lo != NULL && hi != NULL);
    const Affine *m = &shape->to_world;
    double low[3], high[3];

    for (int i = 0; i < 3; i++) {
        const Vec3 d = vec3(vec3_axis(m->x, i), vec3_axis(m->y, i), vec3_axis(m->z, i));
        const double middle = vec3_axis(m->t, i);
        const double half = support(shape, d);
        low[i] = middle - half;
        high[i] = middle + half;
        if (shape->kind == SHAPE_FRUSTUM) {
            low[i] = fmin(low[i], middle + d.z - shape->ratio * half);
            high[i] = fmax(high[i], middle + d.z + shape->ratio * half);
        }
        /* A point takes up to 8 roundings on its way, of terms no larger than these. */
        const double pad = rounding_bound(8) * (fabs(middle) + (high[i] - low[i]));
        low[i] -= pad;
        high[i] += pad;
    }
    *lo = vec3(low[0], low[1], low[2]);
    *hi = vec3(high[0], high[1], high[2]);
}
