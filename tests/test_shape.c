/* SPDX-License-Identifier: BSD-3-Clause */
/* math/shape: parameters, areas against closed forms, boxes. Rays are in test_shape_hit.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#include "math/sampling.h"
#include "math/shape.h"

static Shape shape_scaled(ShapeKind kind, double ratio, double x, double y, double z)
{
    const Affine map = { { x, 0, 0 }, { 0, y, 0 }, { 0, 0, z }, { 7, -8, 9 } };
    Shape shape;
    Error err = { 0 };
    assert_true(shape_init(&shape, kind, ratio, &map, &err));
    return shape;
}

/* -1 .. 1 */
static double random_signed(uint32_t seed, uint32_t i)
{
    return sampling_seed(seed, i, 77, 0) * 0x1p-31 - 1;
}

/* Maps without much flattening: identity plus noise, every other one mirrored. */
static Shape shape_random(uint32_t seed)
{
    static const double ratios[] = { 0, 0.5, 1, 1.7 };
    const ShapeKind kind = (ShapeKind)(seed % 4);
    const double ratio = kind == SHAPE_TORUS ? 0.05 + 0.45 * (1 + random_signed(seed, 20))
                                             : ratios[seed / 4 % 4];
    double e[12];
    for (uint32_t i = 0; i < 12; i++)
        e[i] = 0.5 * random_signed(seed, i);
    const Affine map = { { (seed & 16 ? -1 : 1) + e[0], e[1], e[2] },
                         { e[3], 1 + e[4], e[5] },
                         { e[6], e[7], 1 + e[8] },
                         { 5 * e[9], 5 * e[10], 5 * e[11] } };
    Shape shape;
    Error err = { 0 };
    assert_true(shape_init(&shape, kind, ratio, &map, &err));
    return shape;
}

/* --- making ---------------------------------------------------------------------------------- */

static void shape_refuses_bad_input(void **state)
{
    (void)state;
    Affine flat = affine_identity(), wild = affine_identity();
    const Affine good = affine_identity();
    flat.z = vec3(1, 1, 0);
    wild.t.y = INFINITY;
    const struct { ShapeKind kind; double ratio; const Affine *map; } table[] = {
        { SHAPE_SPHERE, 0, &flat },     { SHAPE_DISC, 0, &wild },
        { SHAPE_FRUSTUM, -1, &good },   { SHAPE_FRUSTUM, NAN, &good },
        { SHAPE_FRUSTUM, INFINITY, &good },
        { SHAPE_TORUS, 0, &good },      { SHAPE_TORUS, 1, &good },
        { SHAPE_TORUS, -0.5, &good },   { SHAPE_TORUS, NAN, &good },
    };
    for (int i = 0; i < 9; i++) {
        Error err = { 0 };
        Shape shape;
        memset(&shape, 0, sizeof shape);
        assert_false(shape_init(&shape, table[i].kind, table[i].ratio, table[i].map, &err));
        assert_int_equal(err.code, ERROR_INPUT);
        assert_true(strlen(err.text) > 10);
        assert_true(shape.to_world.x.x == 0);
    }
}

/* --- parameters ------------------------------------------------------------------------------ */

static void shape_landmarks(void **state)
{
    (void)state;
    static const struct { ShapeKind kind; double ratio, u, v; Vec3 at; } table[] = {
        { SHAPE_SPHERE, 0, 0, 0.5, { 1, 0, 0 } },     { SHAPE_SPHERE, 0, 0.25, 0.5, { 0, 1, 0 } },
        { SHAPE_SPHERE, 0, 0.3, 1, { 0, 0, 1 } },     { SHAPE_SPHERE, 0, 0.7, 0, { 0, 0, -1 } },
        { SHAPE_DISC, 0, 0.5, 1, { -1, 0, 0 } },      { SHAPE_DISC, 0, 0.75, 0.25, { 0, -0.5, 0 } },
        { SHAPE_FRUSTUM, 0.5, 0.25, 1, { 0, 0.5, 1 } }, { SHAPE_FRUSTUM, 0, 0.1, 1, { 0, 0, 1 } },
        { SHAPE_FRUSTUM, 3, 0, 0.5, { 2, 0, 0.5 } },  { SHAPE_TORUS, 0.25, 0, 0, { 1.25, 0, 0 } },
        { SHAPE_TORUS, 0.25, 0.5, 0.5, { -0.75, 0, 0 } },
        { SHAPE_TORUS, 0.25, 0.25, 0.25, { 0, 1, 0.25 } },
        { SHAPE_TORUS, 0.25, 1, 1, { 1.25, 0, 0 } },
    };
    for (int i = 0; i < 13; i++) {
        const Affine map = affine_identity();
        Shape shape;
        Error err = { 0 };
        assert_true(shape_init(&shape, table[i].kind, table[i].ratio, &map, &err));
        const Vec3 p = shape_point(&shape, table[i].u, table[i].v);
        assert_true(p.x == table[i].at.x && p.y == table[i].at.y && p.z == table[i].at.z);
    }
}

static void shape_parameters_undo_points(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 2000; seed++) {
        const Shape shape = shape_random(seed);
        for (uint32_t k = 0; k < 20; k++) {
            float x[2];
            sampling_sobol2(k, seed, x);
            double u, v;
            const double u0 = (double)x[0], v0 = 0.02 + 0.9 * (double)x[1];
            shape_parameters(&shape, shape_point(&shape, u0, v0), &u, &v);
            /* Rounding of coordinates below 10, mapped back with a condition below 100, over the
             * smallest radius met, 0.1; angles near the seam may wrap. */
            const double tolerance = 10 * 100 / 0.1 * 32 * 0x1p-53;
            const double off = fabs(u - u0);
            assert_true(fmin(off, 1 - off) < tolerance);
            assert_true(fabs(v - v0) < tolerance);
            assert_true(u >= 0 && u <= 1 && v >= 0 && v <= 1);
        }
    }
}

static bool same(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static void expect_all_at(const Shape *shape, double u, double v)
{
    Vec3   point, normal;
    double density;
    shape_all_at(shape, u, v, &point, &normal, &density);
    assert_true(same(point, shape_point(shape, u, v)));
    assert_true(same(normal, shape_normal(shape, u, v)));
    assert_true(density == shape_density(shape, u, v));
    Vec3 place, across;
    shape_place_at(shape, u, v, &place, &across);
    assert_true(same(place, point) && same(across, normal));
}

/* Against central differences of shape_point: h^2 times third derivatives (2 pi)^3 * size, and
 * rounding / h. */
static void shape_density_and_normal_match_differences(void **state)
{
    (void)state;
    const double h = 1e-5;
    for (uint32_t seed = 0; seed < 2000; seed++) {
        const Shape shape = shape_random(seed);
        float x[2];
        sampling_sobol2(seed, 5, x);
        const double u = 0.1 + 0.8 * (double)x[0], v = 0.1 + 0.8 * (double)x[1];
        const Vec3 du = vec3_scale(vec3_sub(shape_point(&shape, u + h, v),
                                            shape_point(&shape, u - h, v)), 0.5 / h);
        const Vec3 dv = vec3_scale(vec3_sub(shape_point(&shape, u, v + h),
                                            shape_point(&shape, u, v - h)), 0.5 / h);
        const Vec3 cross = vec3_cross(du, dv);
        const double size = vec3_length(du) * vec3_length(dv);
        const Vec3 n = shape_normal(&shape, u, v);
        assert_true(fabs(vec3_length(cross) - shape_density(&shape, u, v)) < 1e-6 * size);
        expect_all_at(&shape, u, v);
        assert_true(fabs(vec3_length(n) - 1) < 1e-14);
        assert_true(fabs(vec3_dot(n, du)) < 1e-6 * vec3_length(du));
        assert_true(fabs(vec3_dot(n, dv)) < 1e-6 * vec3_length(dv));
    }
}

static void shape_normals_point_out(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 2000; seed++) {
        const Shape shape = shape_random(seed);
        float x[2];
        sampling_sobol2(seed, 6, x);
        const double u = (double)x[0], v = (double)x[1];
        Vec3 inner = shape.to_world.t; /* a point of the solid right below */
        if (shape.kind == SHAPE_DISC)
            inner = vec3_sub(shape_point(&shape, u, v), shape.to_world.z);
        else if (shape.kind == SHAPE_FRUSTUM)
            inner = affine_point(&shape.to_world, vec3(0, 0, v));
        else if (shape.kind == SHAPE_TORUS) /* the middle of the tube */
            inner = vec3_lerp(shape_point(&shape, u, 0.5), shape_point(&shape, u, 0), 0.5);
        const Vec3 out = vec3_sub(shape_point(&shape, u, v), inner);
        if (shape.kind == SHAPE_FRUSTUM && shape.ratio == 0 && v > 0.99)
            continue;
        assert_true(vec3_dot(shape_normal(&shape, u, v), out) > 0);
    }
    const Shape cone = shape_scaled(SHAPE_FRUSTUM, 0, 1, 1, 1);
    const Vec3 tip = shape_normal(&cone, 0.25, 1);
    assert_true(fabs(tip.y - sqrt(0.5)) < 1e-15 && fabs(tip.z - sqrt(0.5)) < 1e-15);
}

/* --- areas ----------------------------------------------------------------------------------- */

/* Circumference of an ellipse by the arithmetic-geometric mean (Gauss). */
static double ellipse_length(double a, double b)
{
    double x = a, y = b, weight = 0.5, sum = (a * a + b * b) / 2;
    while (fabs(x - y) > 1e-15 * a) {
        const double next = (x + y) / 2;
        y = sqrt(x * y);
        weight *= 2;
        sum -= weight * (x - next) * (x - next);
        x = next;
    }
    return 2 * M_PI * sum / x;
}

static void expect_area(const Shape *shape, double expected)
{
    const double area = shape_area(shape, 0, 1, 0, 1);
    if (!(fabs(area - expected) <= 1e-9 * expected))
        fail_msg("kind %d: area %.15g, expected %.15g", (int)shape->kind, area, expected);
}

static void shape_areas_of_round_forms(void **state)
{
    (void)state;
    Shape s = shape_scaled(SHAPE_SPHERE, 0, 2, 2, -2);
    expect_area(&s, 16 * M_PI);
    s = shape_scaled(SHAPE_DISC, 0, 3, 0.5, 1);
    expect_area(&s, 1.5 * M_PI);
    s = shape_scaled(SHAPE_FRUSTUM, 1, 2, 2, 3);
    expect_area(&s, 12 * M_PI);
    s = shape_scaled(SHAPE_FRUSTUM, 0, 3, 3, 4);
    expect_area(&s, 15 * M_PI);
    s = shape_scaled(SHAPE_FRUSTUM, 2.5, 2, 2, 4); /* radii 2 and 5, slant 5 */
    expect_area(&s, 35 * M_PI);
    s = shape_scaled(SHAPE_TORUS, 0.3, 2, 2, 2);
    expect_area(&s, 4 * M_PI * M_PI * 2 * 0.6);
    s = shape_scaled(SHAPE_TORUS, 0.001, 1, 1, -1);
    expect_area(&s, 4 * M_PI * M_PI * 0.001);
}

static void shape_areas_of_stretched_forms(void **state)
{
    (void)state;
    /* Ellipsoids by Legendre's elliptic integrals, evaluated elsewhere with 25 digits. */
    Shape s = shape_scaled(SHAPE_SPHERE, 0, 3, 1, 2);
    expect_area(&s, 48.88214630258203);
    s = shape_scaled(SHAPE_SPHERE, 0, 0.1, 10, 1);
    expect_area(&s, 63.84797081950867);
    s = shape_scaled(SHAPE_SPHERE, 0, 5, 5, 0.001); /* a flat oblate spheroid, closed form */
    const double e = sqrt(1 - 0.001 * 0.001 / 25);
    expect_area(&s, 2 * M_PI * 25 + M_PI * 1e-6 / e * log((1 + e) * (1 + e) / (1e-6 / 25)));
    s = shape_scaled(SHAPE_SPHERE, 0, 0.001, 0.001, 5); /* a needle: prolate */
    expect_area(&s, 2 * M_PI * 1e-6 * (1 + 5 / (0.001 * e) * asin(e)));
    /* Elliptic cylinder, and an oblique one: slant times girth across the slant. */
    s = shape_scaled(SHAPE_FRUSTUM, 1, 2, 1, 3);
    expect_area(&s, 3 * ellipse_length(2, 1));
    s = shape_scaled(SHAPE_FRUSTUM, 1, 1, 0.001, 3);
    expect_area(&s, 3 * ellipse_length(1, 0.001));
    const Affine shear = { { 1, 0, 0 }, { 0, 1, 0 }, { 2, 0, 1 }, { 0, 0, 0 } };
    Error err = { 0 };
    assert_true(shape_init(&s, SHAPE_FRUSTUM, 1, &shear, &err));
    expect_area(&s, sqrt(5) * ellipse_length(1, 1 / sqrt(5)));
}

/* Zones: Archimedes, and the torus band by hand. */
static void shape_areas_of_parts(void **state)
{
    (void)state;
    const Shape sphere = shape_scaled(SHAPE_SPHERE, 0, 2, 2, 2);
    assert_true(fabs(shape_area(&sphere, 0.1, 0.35, 0.2, 0.3) - 0.4 * M_PI) < 1e-12);
    assert_true(fabs(shape_area(&sphere, 0, 1, 0, 1e-10) - 16e-10 * M_PI) < 1e-21);
    const Shape torus = shape_scaled(SHAPE_TORUS, 0.5, 1, 1, 1);
    /* Upper outer quarter: integral of 2 pi r (1 + r cos) over 0..pi/2. */
    const double quarter = 2 * M_PI * 0.5 * (M_PI / 2 + 0.5);
    assert_true(fabs(shape_area(&torus, 0, 1, 0, 0.25) - quarter) < 1e-9 * quarter);
    assert_true(shape_area(&torus, 0.5, 0.5, 0, 1) == 0);
    const Shape cone = shape_scaled(SHAPE_FRUSTUM, 0, 3, 3, 4);
    assert_true(fabs(shape_area(&cone, 0, 0.5, 0.5, 1) - 15 * M_PI / 8) < 1e-9);
}

static void shape_areas_add_up(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 64; seed++) {
        const Shape shape = shape_random(seed);
        const double whole = shape_area(&shape, 0, 1, 0, 1);
        double sum = 0;
        for (int i = 0; i < 5; i++)
            for (int j = 0; j < 3; j++)
                sum += shape_area(&shape, i / 5.0, (i + 1) / 5.0, j / 3.0, (j + 1) / 3.0);
        assert_true(fabs(sum - whole) < 2e-9 * whole);
        /* And the density by a plain midpoint rule: smooth but for the poles in v. */
        double plain = 0;
        for (int i = 0; i < 400; i++)
            for (int j = 0; j < 400; j++)
                plain += shape_density(&shape, (i + 0.5) / 400, (j + 0.5) / 400) / 160000;
        assert_true(fabs(plain - whole) < 1e-4 * whole);
    }
}

/* --- boxes ----------------------------------------------------------------------------------- */

static void shape_bounds_are_tight(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 200; seed++) {
        const Shape shape = shape_random(seed);
        Vec3 lo, hi, low = { 1e9, 1e9, 1e9 }, high = { -1e9, -1e9, -1e9 };
        shape_bounds(&shape, &lo, &hi);
        for (int i = 0; i <= 200; i++)
            for (int j = 0; j <= 200; j++) {
                const double turn = j / 200.0, even = (1 - cos(M_PI * turn)) / 2;
                const double v = shape.kind == SHAPE_SPHERE ? even : turn;
                const Vec3 p = shape_point(&shape, i / 200.0, v);
                low = vec3_min(low, p);
                high = vec3_max(high, p);
            }
        for (int axis = 0; axis < 3; axis++) {
            assert_true(vec3_axis(lo, axis) <= vec3_axis(low, axis));
            assert_true(vec3_axis(hi, axis) >= vec3_axis(high, axis));
            /* 200 steps miss an extreme of a circle by half of (2 pi / 400)^2 of its radius. */
            const double slack = 2e-4 * (vec3_axis(hi, axis) - vec3_axis(lo, axis));
            assert_true(vec3_axis(low, axis) - vec3_axis(lo, axis) < slack);
            assert_true(vec3_axis(hi, axis) - vec3_axis(high, axis) < slack);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shape_refuses_bad_input),
        cmocka_unit_test(shape_landmarks),
        cmocka_unit_test(shape_parameters_undo_points),
        cmocka_unit_test(shape_density_and_normal_match_differences),
        cmocka_unit_test(shape_normals_point_out),
        cmocka_unit_test(shape_areas_of_round_forms),
        cmocka_unit_test(shape_areas_of_stretched_forms),
        cmocka_unit_test(shape_areas_of_parts),
        cmocka_unit_test(shape_areas_add_up),
        cmocka_unit_test(shape_bounds_are_tight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
