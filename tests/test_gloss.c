/* SPDX-License-Identifier: BSD-3-Clause */
/* Gloss: reciprocal, nothing won, densities those of the samples; mirrors where it is smooth. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "math/sampling.h"
#include "radiosity/mirrors.h"
#include "render/gloss.h"

static const Vec3 up = { 0, 0, 1 };

static Vec3 direction(double height, double angle)
{
    const double r = sqrt(1 - height * height);
    return vec3(r * cos(angle), r * sin(angle), height);
}

static Gloss rough(double roughness, double exponent, Vec3 view)
{
    Material m = material_default();
    Gloss    gloss;
    m.roughness = roughness;
    m.exponent = exponent;
    m.specular = rgb(1, 1, 1);
    gloss_init(&gloss, &m, up, up, vec3_scale(view, -1));
    return gloss;
}

static const struct {
    double roughness, exponent, height;
} kinds[] = { { 0.3, 1, 0.9 }, { 0.5, 1, 0.5 }, { 0.7, 1, 0.2 },  { 1, 1, 0.7 },
              { 0, 5, 0.9 },   { 0, 30, 0.6 },  { 0, 30, 0.15 } };
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Integrals over the hemisphere by the midpoint rule, even in solid angle, against means over
 * samples: shares that come out above, and what they carry. */
static void densities_are_those_of_samples(void **state)
{
    (void)state;
    enum { CELLS = 512, SAMPLES = 1 << 14 };
    for (int k = 0; k < KINDS; k++) {
        const Gloss g = rough(kinds[k].roughness, kinds[k].exponent,
                              direction(kinds[k].height, 0.3));
        const double cell = 2 * M_PI / CELLS / CELLS;
        double       above = 0, albedo = 0, density;
        for (int i = 0; i < CELLS; i++)
            for (int j = 0; j < CELLS; j++) {
                const Vec3 out = direction((i + 0.5) / CELLS, 2 * M_PI * (j + 0.5) / CELLS);
                albedo += cell * gloss_value(&g, out, &density);
                above += cell * density;
            }
        double drawn = 0, carried = 0, most = 0;
        for (uint32_t i = 0; i < SAMPLES; i++) {
            float u[2];
            Vec3  out;
            sampling_sobol2(i, 7, u);
            if (!gloss_sample(&g, u, &out))
                continue;
            const double value = gloss_value(&g, out, &density);
            assert_true(density > 0);
            drawn += 1.0 / SAMPLES;
            carried += value / density / SAMPLES;
            most = fmax(most, value / density);
        }
        /* A net of 2^14 points, and 2^18 cells, miss such means by less: edges cross about as many
         * cells of either as their side has. */
        assert_true(fabs(drawn - above) < 4.0 / CELLS);
        assert_true(fabs(carried - albedo) < 4.0 / CELLS);
        const double e = kinds[k].exponent; /* a lobe about a slanted axis may be cut, not swell */
        assert_true(albedo <= 1 + 4.0 / CELLS && most <= (e + 2) / (e + 1) + 1e-9);
        if (kinds[k].roughness > 0) /* microfacets lose, by light that meets them twice */
            assert_true(albedo <= 1 + 1.0 / CELLS && most <= 1 + 1e-9);
    }
}

/* Of even light, the mean over directions that it comes from, by the midpoint rule in the square of
 * the cosine and the direction that leaves. */
static void shares_for_solvers(void **state)
{
    (void)state;
    enum { ROWS = 32, CELLS = 256 };
    static const double roughness[] = { 0.5, 0.6, 0.8, 1 };
    for (int k = 0; k < 4; k++) {
        Material m = material_default();
        double   sum = 0, density;
        m.roughness = roughness[k];
        for (int i = 0; i < ROWS; i++) {
            const Gloss g = rough(roughness[k], 1, direction(sqrt((i + 0.5) / ROWS), 0));
            for (int j = 0; j < CELLS * CELLS; j++)
                sum += gloss_value(&g, direction((j / CELLS + 0.5) / CELLS,
                                                 2 * M_PI * (j % CELLS + 0.5) / CELLS), &density);
        }
        /* The table is even between its entries but for its bend: second differences are below
         * 0.04, an eighth of which lines miss; the entries' noise is below 0.001. */
        const double share = sum * 2 * M_PI / ROWS / CELLS / CELLS;
        assert_true(fabs(mirrors_gloss_back(&m) - share) <= 0.04 / 8 + 0.002);
    }
}

static void both_ways_are_alike(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++)
        for (int i = 0; i < 100; i++) {
            float u[4];
            double density;
            sampling_sobol4((uint32_t)i, 3, u);
            const Vec3 a = direction(0.05 + 0.9 * u[0], 6 * u[1]);
            const Vec3 b = direction(0.05 + 0.9 * u[2], 6 * u[3]);
            const Gloss there = rough(kinds[k].roughness, kinds[k].exponent, a);
            const Gloss back = rough(kinds[k].roughness, kinds[k].exponent, b);
            const double one = gloss_value(&there, b, &density) / b.z;
            const double two = gloss_value(&back, a, &density) / a.z;
            assert_true(fabs(one - two) <= 1e-9 * fmax(one, 1));
        }
}

/* Trowbridge and Reitz at normal incidence, in closed form: D / (4 cos) times Smith's shadowing. */
static void straight_down_is_known(void **state)
{
    (void)state;
    const double alpha = 0.25;
    const Gloss  g = rough(0.5, 1, up);
    for (int i = 1; i < 10; i++) {
        const double l = 0.1 * i, t = acos(l) / 2, h = cos(t);
        const double d = alpha * alpha /
                         (M_PI * pow(h * h * (alpha * alpha - 1) + 1, 2));
        /* Of a view from above nothing is hidden: Lambda = 0. */
        const double lambda = (sqrt(1 + alpha * alpha * (1 / (l * l) - 1)) - 1) / 2;
        double       density;
        assert_true(fabs(gloss_value(&g, direction(l, 1), &density) -
                         d / (4 * (1 + lambda))) <= 1e-9);
        assert_true(fabs(density - d / 4) <= 1e-9);
    }
}

static void smooth_is_a_mirror(void **state)
{
    (void)state;
    const Vec3  view = direction(0.6, 0.3);
    const Gloss g = rough(0.02, 1, view);
    for (uint32_t i = 0; i < 64; i++) {
        float  u[2];
        Vec3   out;
        double density;
        sampling_sobol2(i, 7, u);
        u[0] *= 0.9F; /* without the tails, which are long */
        assert_true(gloss_sample(&g, u, &out));
        /* Slopes up to alpha sqrt(0.9 / 0.1) turn the mirror direction by twice as much, more
         * across a slanted view: 1 / 0.6. */
        const Vec3 mirror = vec3(-view.x, -view.y, view.z);
        assert_true(vec3_length(vec3_sub(out, mirror)) <= 2 * 0.0004 * 3 / 0.6);
        assert_true(fabs(gloss_value(&g, out, &density) / density - 1) < 1e-3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities_are_those_of_samples),
        cmocka_unit_test(shares_for_solvers),
        cmocka_unit_test(both_ways_are_alike),
        cmocka_unit_test(straight_down_is_known),
        cmocka_unit_test(smooth_is_a_mirror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
