/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat lamps: Lambert's formula against closed forms, samples against the formula. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "math/sampling.h"
#include "render/facet.h"

static const double PI = 3.14159265358979323846;

static Facet facet_of(const Vec3 *corner, int count)
{
    Facet f;
    facet_init(&f, corner, count);
    return f;
}

/* A rectangle a x b at height c over the receiver, corner over it, shining down: receiver parallel
 * [howell, C-4 "differential element to parallel rectangle"]:
 *   F = 1/(2 pi) [A/sqrt(1+A^2) atan(B/sqrt(1+A^2)) + B/sqrt(1+B^2) atan(A/sqrt(1+B^2))],
 * A = a/c, B = b/c. */
static double corner_parallel(double a, double b, double c)
{
    const double A = a / c, B = b / c, p = sqrt(1 + A * A), q = sqrt(1 + B * B);
    return (A / p * atan(B / p) + B / q * atan(A / q)) / (2 * PI);
}

/* The same rectangle for a receiver at right angles to it, facing along side a [howell, C-5]:
 *   F = 1/(2 pi) [atan(1/Y) - Y/sqrt(X^2+Y^2) atan(1/sqrt(X^2+Y^2))], X = a/b, Y = c/b. */
static double corner_upright(double a, double b, double c)
{
    const double X = a / b, Y = c / b, r = sqrt(X * X + Y * Y);
    return (atan(1 / Y) - Y / r * atan(1 / r)) / (2 * PI);
}

static Facet ceiling(double a, double b, double c)
{
    const Vec3 corner[4] = { { 0, 0, c }, { 0, b, c }, { a, b, c }, { a, 0, c } };
    return facet_of(corner, 4);
}

static void irradiance_of_rectangles(void **state)
{
    (void)state;
    static const double size[][3] = { { 1, 1, 1 },     { 2, 0.5, 0.1 }, { 0.01, 0.01, 1 },
                                      { 100, 3, 1e-3 }, { 1, 1, 1e3 },  { 1e-3, 5, 0.2 } };
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        const double a = size[i][0], b = size[i][1], c = size[i][2];
        const Facet  f = ceiling(a, b, c);
        assert_true(f.normal.z == -1 && f.rectangle);
        const double parallel = facet_irradiance(&f, vec3(0, 0, 0), vec3(0, 0, 1)) / PI;
        const double upright = facet_irradiance(&f, vec3(0, 0, 0), vec3(1, 0, 0)) / PI;
        /* Angles of some 1e-3 and more leave of double's 1e-16 at least 1e-10. */
        assert_true(fabs(parallel / corner_parallel(a, b, c) - 1) < 1e-9);
        assert_true(fabs(upright / corner_upright(a, b, c) - 1) < 1e-9);
    }
}

/* A receiver at right angles to a lamp that spans -1..1 across its horizon sees the upper half
 * only: clipping must give what the half alone gives. */
static void horizon_is_cut_away(void **state)
{
    (void)state;
    const Vec3 whole[4] = { { -1, 0, 2 }, { -1, 3, 2 }, { 1, 3, 2 }, { 1, 0, 2 } };
    const Vec3 half[4] = { { 0, 0, 2 }, { 0, 3, 2 }, { 1, 3, 2 }, { 1, 0, 2 } };
    const Facet a = facet_of(whole, 4), b = facet_of(half, 4);
    const Vec3  p = vec3(0, 1, 0.5), n = vec3(1, 0, 0);
    assert_true(fabs(facet_irradiance(&a, p, n) - facet_irradiance(&b, p, n)) < 1e-14);
    assert_true(facet_irradiance(&a, p, vec3(0, 0, -1)) == 0);
    /* A triangle of which one corner, then two, are above. */
    const Vec3   t[3] = { { -1, 0, 2 }, { 1, 3, 2 }, { 1, 0, 2 } };
    const Vec3   cut1[3] = { { 1, 3, 2 }, { 1, 0, 2 }, { 0, 0, 2 } };
    const Vec3   cut2[3] = { { 0, 0, 2 }, { 0, 1.5, 2 }, { 1, 3, 2 } };
    const Facet  ft = facet_of(t, 3), f1 = facet_of(cut1, 3), f2 = facet_of(cut2, 3);
    const double sum = facet_irradiance(&f1, p, n) + facet_irradiance(&f2, p, n);
    assert_true(fabs(facet_irradiance(&ft, p, n) - sum) < 1e-14);
}

/* Means over a net of samples: of the spread, the solid angle; of cosine times spread, Lambert's
 * formula. Samples lie on the facet, and facet_spread says the same of them. */
static void check_samples(const Facet *f, Vec3 p, Vec3 n, double tolerance)
{
    enum { COUNT = 1 << 14 };
    double sum = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        float u[2];
        Vec3  q;
        sampling_sobol2(i, 7, u);
        const double spread = facet_sample(f, p, u[0], u[1], &q);
        const double cosine = vec3_dot(vec3_unit(vec3_sub(q, p)), n);
        assert_true(spread > 0 && isfinite(spread) && vec3_finite(q));
        assert_true(fabs(facet_spread(f, p, q) / spread - 1) < 1e-9);
        const double size = f->width + f->height;
        assert_true(fabs(facet_height(f, q)) < 1e-9 * (size + vec3_length(vec3_sub(p, q))));
        assert_true(vec3_length(vec3_sub(q, f->corner[0])) < size * (1 + 1e-6));
        sum += fmax(cosine, 0) * spread / COUNT;
    }
    const double exact = facet_irradiance(f, p, n);
    assert_true(fabs(sum - exact) < tolerance * exact);
}

/* The error of a scrambled net of 2^14 points on functions of bounded variation is below some
 * 1e-4 of their mean; where the horizon cuts the lamp, below 1e-3. */
static void samples_mean_the_formula(void **state)
{
    (void)state;
    static const Vec3 square[4] = { { -1, -1, 2 }, { -1, 1, 2 }, { 1, 1, 2 }, { 1, -1, 2 } };
    static const Vec3 skewed[4] = { { -1, -1, 2 }, { 0, 1, 2 }, { 1.5, 1, 2.5 }, { 0.5, -1, 2.5 } };
    static const Vec3 thin[4] = { { -5, 0, 2 }, { -5, 0.01, 2 }, { 5, 0.01, 2 }, { 5, 0, 2 } };
    static const Vec3 triangle[3] = { { -1, -1, 2 }, { -1, 1, 2 }, { 1, -1, 2.5 } };
    static const Vec3 at[] = { { 0, 0, 0 }, { 0.9, 0.9, 1.95 }, { 20, 3, -4 }, { 300, 200, -400 },
                               { -0.5, 0.3, 1.999 } };
    const Facet facets[] = { facet_of(square, 4), facet_of(skewed, 4), facet_of(thin, 4),
                             facet_of(triangle, 3) };
    for (size_t i = 0; i < sizeof facets / sizeof facets[0]; i++)
        for (size_t k = 0; k < sizeof at / sizeof at[0]; k++) {
            if (!(facet_height(&facets[i], at[k]) > 0))
                continue;
            const Vec3 to = vec3_unit(vec3_sub(facets[i].corner[0], at[k]));
            check_samples(&facets[i], at[k], to, 1e-3);
            check_samples(&facets[i], at[k], vec3_unit(vec3_add(to, vec3(0.3, 1, 0.2))), 1e-2);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(irradiance_of_rectangles),
        cmocka_unit_test(horizon_is_cut_away),
        cmocka_unit_test(samples_mean_the_formula),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
