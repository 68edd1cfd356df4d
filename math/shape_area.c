/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of parts of curved shapes: adaptive Gauss-Legendre quadrature, one integral in the other.
 *
 * An ellipsoid's density has a square root at its poles in v; it is integrated over the polar
 * angle instead, where it is smooth. */
#include <assert.h>
#include <stddef.h>

#include "math/internal.h"
#include "math/shape.h"

/* Two rules in a row that agree to this share of the result end the refinement. What is returned
 * is the finer one, whose 16th-order error is smaller by far, so the promise of 1e-9 is kept with
 * room; the inner integral is ten times better, lest the outer one chase its error. */
static const double outer_agreement = 1e-10;
static const double inner_agreement = 1e-11;

/* Halving an interval 50 times leaves the last bits of its ends. */
enum { DEPTH_MAX = 50 };

typedef struct {
    double (*f)(const void *context, double x);
    const void *context;
} Integrand;

/* The 8-point Gauss-Legendre rule. */
static double gauss(const Integrand *g, double a, double b)
{
    static const double node[4] = { 0.18343464249564980494, 0.52553240991632898582,
                                    0.79666647741362673959, 0.96028985649753623168 };
    static const double weight[4] = { 0.36268378337836198297, 0.31370664587788728734,
                                      0.22238103445337447054, 0.10122853629037625915 };
    const double middle = (a + b) / 2, half = (b - a) / 2;
    double sum = 0;

    for (int i = 0; i < 4; i++)
        sum += weight[i] * (g->f(g->context, middle - half * node[i]) +
                            g->f(g->context, middle + half * node[i]));
    return half * sum;
}

/* `whole` is what one rule over a..b gives. */
static double integral(const Integrand *g, double a, double b, double whole, double tolerance,
                       int depth)
{
    const double middle = (a + b) / 2;
    const double left = gauss(g, a, middle);
    const double right = gauss(g, middle, b);

    if (!(fabs(left + right - whole) > tolerance) || depth == 0)
        return left + right;
    return integral(g, a, middle, left, tolerance, depth - 1) +
           integral(g, middle, b, right, tolerance, depth - 1);
}

typedef struct {
    const Shape *shape;
    double       u0, u1;
    double       v;
    double       inner_tolerance; /* < 0: one rule, for the first estimate */
} Part;

/* Length of the area vector at (u, part->v), without the weight that depends on v alone. */
static double stretch(const void *context, double u)
{
    const Part *part = context;
    const Vec3 n = shape_local_normal(part->shape, u, part->v);
    return vec3_length(shape_cofactor(&part->shape->to_world, n));
}

/* Integral over u at one place of the outer variable: polar angle of a sphere, else v. */
static double strip(const void *context, double w)
{
    Part part = *(const Part *)context;
    double jacobian = 1;

    part.v = w;
    if (part.shape->kind == SHAPE_SPHERE) { /* v = (1 - cos w) / 2 */
        const double s = sin(w / 2);
        part.v = s * s;
        jacobian = sin(w) / 2;
    }
    const Integrand along = { stretch, &part };
    double value = gauss(&along, part.u0, part.u1);
    if (part.inner_tolerance >= 0)
        value = integral(&along, part.u0, part.u1, value, part.inner_tolerance, DEPTH_MAX);
    return jacobian * shape_local_weight(part.shape, part.v) * value;
}

double shape_area(const Shape *shape, double u0, double u1, double v0, double v1)
{
    assert(shape != NULL);
    assert(u0 <= u1 && v0 <= v1);
    if (shape->kind == SHAPE_DISC) /* the same density everywhere */
        return shape_density(shape, u0, v0) * (u1 - u0) * (v1 - v0);
    double w0 = v0, w1 = v1, weight = shape_local_weight(shape, (v0 + v1) / 2) * (v1 - v0);
    if (shape->kind == SHAPE_SPHERE) {
        assert(v0 >= 0 && v1 <= 1);
        w0 = 2 * asin(sqrt(v0));
        w1 = 2 * asin(sqrt(v1));
    }
    Part part = { .shape = shape, .u0 = u0, .u1 = u1, .inner_tolerance = -1 };
    const Integrand strips = { strip, &part };
    const double estimate = gauss(&strips, w0, w1);
    if (!(estimate > 0))
        return 0;
    part.inner_tolerance = inner_agreement * estimate / weight;
    const double whole = gauss(&strips, w0, w1);
    return integral(&strips, w0, w1, whole, outer_agreement * estimate, DEPTH_MAX);
}
