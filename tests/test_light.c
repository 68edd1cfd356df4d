/* SPDX-License-Identifier: BSD-3-Clause */
/* math/light and math/affine: fluxes by integration over directions, maps and their inverses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "math/affine.h"
#include "math/light.h"
#include "math/sampling.h"
#include "math/tolerance.h"

/* --- lights ---------------------------------------------------------------------------------- */

static double degrees_cosine(double degrees)
{
    return cos(degrees * M_PI / 180);
}

/* Integral of light_share over all directions, in a frame that has nothing to do with the light's
 * axis but shares no code with light_flux: midpoint rule over a grid of the sphere. */
static double flux_by_integration(const Light *light, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            sum += light_share(light, sampling_sphere((i + 0.5) / n, (j + 0.5) / n));
    return 4 * M_PI * sum / ((double)n * n);
}

static void light_flux_is_the_integral(void **state)
{
    (void)state;
    const struct { LightKind kind; double inner, outer; } table[] = {
        { LIGHT_POINT, 0, 0 },    { LIGHT_COSINE, 0, 0 },  { LIGHT_SPOT, 20, 50 },
        { LIGHT_SPOT, 0, 90 },    { LIGHT_SPOT, 60, 120 }, { LIGHT_SPOT, 0, 180 },
        { LIGHT_SPOT, 180, 180 },
    };
    for (int k = 0; k < 7; k++)
        for (int axis = 0; axis < 3; axis++) {
            const Light light = {
                .kind = table[k].kind,
                .direction = vec3_unit(vec3(axis - 0.3, axis * axis - 1.7, 0.4)),
                .intensity = { 1, 2, 0 },
                .cos_inner = degrees_cosine(table[k].inner),
                .cos_outer = degrees_cosine(table[k].outer),
            };
            const int n = 1000;
            const Rgb flux = light_flux(&light);
            const double expected = flux_by_integration(&light, n);
            /* Lipschitz with constant 2 / (cos_inner - cos_outer) < 7 except at kinks; the
             * midpoint rule is then good to 1/n^2 times a few tens. */
            assert_true(fabs(flux.r - expected) < 50.0 / n / n);
            assert_true(flux.g == 2 * flux.r && flux.b == 0);
        }
}

/* A spot with a hard edge is a cone: 2 pi (1 - cos). */
static void light_hard_spot_is_a_cone(void **state)
{
    (void)state;
    Light light = { .kind = LIGHT_SPOT, .direction = { 0, 0, -1 }, .intensity = { 3, 3, 3 } };
    light.cos_inner = light.cos_outer = 0.5;
    assert_true(fabs(light_flux(&light).g - 3 * M_PI) < 1e-14);
    assert_true(light_share(&light, vec3(0, 0, -1)) == 1);
    assert_true(light_share(&light, vec3(0, 0, 1)) == 0);
    assert_true(light_share(&light, vec3(sqrt(0.75), 0, -0.5)) == 1);
    assert_true(light_share(&light, vec3(sqrt(1 - 0.49 * 0.49), 0, -0.49)) == 0);
}

static void light_share_falls_smoothly(void **state)
{
    (void)state;
    const Light spot = { .kind = LIGHT_SPOT, .direction = { 1, 0, 0 }, .cos_inner = 0.8,
                         .cos_outer = 0.4 };
    const struct { double cosine, share; } table[] = {
        { 1, 1 }, { 0.8, 1 }, { 0.7, 0.5625 }, { 0.6, 0.25 }, { 0.5, 0.0625 }, { 0.4, 0 },
        { 0, 0 }, { -1, 0 },
    };
    for (int i = 0; i < 8; i++) {
        const double c = table[i].cosine;
        const double share = light_share(&spot, vec3(c, 0, sqrt(1 - c * c)));
        assert_true(fabs(share - table[i].share) < 8 * DBL_EPSILON);
    }
    const Light lamp = { .kind = LIGHT_COSINE, .direction = { 0, 1, 0 } };
    assert_true(light_share(&lamp, vec3(0.8, 0.6, 0)) == 0.6);
    assert_true(light_share(&lamp, vec3(0.8, -0.6, 0)) == 0);
    assert_true(light_share(&lamp, vec3(0, 1 + DBL_EPSILON, 0)) == 1); /* rounded unit vectors */
}

/* --- affine maps ----------------------------------------------------------------------------- */

static void expect_near(Vec3 a, Vec3 b, double tolerance)
{
    assert_true(vec3_length(vec3_sub(a, b)) <= tolerance);
}

static void affine_rotations_are_right_handed(void **state)
{
    (void)state;
    const Affine x = affine_rotation(0, 90), y = affine_rotation(1, 90), z = affine_rotation(2, 90);
    expect_near(affine_vector(&x, vec3(0, 1, 0)), vec3(0, 0, 1), 0); /* exactly */
    expect_near(affine_vector(&y, vec3(0, 0, 1)), vec3(1, 0, 0), 0);
    expect_near(affine_vector(&z, vec3(1, 0, 0)), vec3(0, 1, 0), 0);
    const Affine a = affine_rotation(2, 30), b = affine_rotation(2, -30 + 720);
    expect_near(affine_vector(&a, vec3(2, 0, 5)), vec3(sqrt(3), 1, 5), 4 * DBL_EPSILON);
    const Affine none = affine_then(&a, &b);
    expect_near(affine_vector(&none, vec3(2, 3, 5)), vec3(2, 3, 5), 32 * DBL_EPSILON);
    const Affine back = affine_rotation(1, -450);
    expect_near(affine_vector(&back, vec3(1, 0, 0)), vec3(0, 0, 1), 0);
}

static void affine_then_is_in_order(void **state)
{
    (void)state;
    Affine move = affine_identity();
    move.t = vec3(1, 0, 0);
    const Affine turn = affine_rotation(2, 90);
    const Affine a = affine_then(&move, &turn), b = affine_then(&turn, &move);
    expect_near(affine_point(&a, vec3(0, 0, 0)), vec3(0, 1, 0), 0);
    expect_near(affine_point(&b, vec3(0, 0, 0)), vec3(1, 0, 0), 0);
}

static Affine random_map(uint32_t seed, double scale)
{
    double e[12];
    for (uint32_t i = 0; i < 12; i++)
        e[i] = scale * (sampling_seed(seed, i, 0, 0) * 0x1p-31 - 1);
    return (Affine){ { e[0], e[1], e[2] }, { e[3], e[4], e[5] }, { e[6], e[7], e[8] },
                     { e[9], e[10], e[11] } };
}

static void affine_inverse_undoes(void **state)
{
    (void)state;
    const double scales[] = { 1, 1e-60, 1e60, 1e-100 };
    for (uint32_t seed = 0; seed < 4000; seed++) {
        const double scale = scales[seed % 4];
        const Affine a = random_map(seed, scale);
        Affine inverse;
        assert_true(affine_invert(&a, &inverse));
        const Affine both = affine_then(&a, &inverse);
        /* Error of an inverse: a small multiple of u times the condition number. */
        const double norm = vec3_length(a.x) + vec3_length(a.y) + vec3_length(a.z);
        const double back = vec3_length(inverse.x) + vec3_length(inverse.y) +
                            vec3_length(inverse.z);
        const double tolerance = 16 * rounding_bound(1) * norm * back;
        expect_near(both.x, vec3(1, 0, 0), tolerance);
        expect_near(both.y, vec3(0, 1, 0), tolerance);
        expect_near(both.z, vec3(0, 0, 1), tolerance);
        expect_near(both.t, vec3(0, 0, 0), tolerance);
    }
}

static void affine_inverse_refuses(void **state)
{
    (void)state;
    Affine maps[7];
    for (int i = 0; i < 7; i++)
        maps[i] = affine_identity();
    maps[0].x = vec3(0, 0, 0);
    maps[1].z = vec3(1, 2, 0);
    maps[2].y = vec3(3, 0, 0);
    maps[3].t.x = NAN;
    maps[4].y.y = INFINITY;
    maps[5] = (Affine){ { 1, 2, 3 }, { 4, 5, 6 }, { 7, 8, 9 }, { 0, 0, 0 } };
    maps[6].z = vec3(0, NAN, 1);
    for (int i = 0; i < 7; i++) {
        Affine out = affine_rotation(0, 12);
        assert_false(affine_invert(&maps[i], &out));
        assert_true(out.y.z == affine_rotation(0, 12).y.z); /* untouched */
    }
}

static void affine_normals_stay_normal(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 1000; seed++) {
        const Affine a = random_map(seed, 3);
        Affine inverse;
        assert_true(affine_invert(&a, &inverse));
        const Vec3 n = vec3(0.6, 0, 0.8), along = vec3(0.8, 5, -0.6);
        const Vec3 m = affine_normal(&inverse, n);
        /* M^-T n . M d = n . d */
        const double size = vec3_length(m) * vec3_length(affine_vector(&a, along));
        assert_true(fabs(vec3_dot(m, affine_vector(&a, along))) <= 64 * DBL_EPSILON * size);
        assert_true(vec3_dot(m, affine_vector(&a, n)) > 0);
    }
    const Affine mirror = { { -2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 4 }, { 9, 9, 9 } };
    assert_true(affine_determinant(&mirror) == -24);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_flux_is_the_integral),
        cmocka_unit_test(light_hard_spot_is_a_cone),
        cmocka_unit_test(light_share_falls_smoothly),
        cmocka_unit_test(affine_rotations_are_right_handed),
        cmocka_unit_test(affine_then_is_in_order),
        cmocka_unit_test(affine_inverse_undoes),
        cmocka_unit_test(affine_inverse_refuses),
        cmocka_unit_test(affine_normals_stay_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
