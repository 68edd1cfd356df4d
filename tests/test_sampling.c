/* SPDX-License-Identifier: BSD-3-Clause */
/* math/sampling: nets, seeds, maps of the square, frames. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "math/sampling.h"

static const uint32_t seeds[] = { 0, 1, 2, 0xffffffffU, 0x80000000U, 123456789 };
enum { SEEDS = sizeof seeds / sizeof *seeds };

/* --- nets: the numbers of points in elementary boxes are theorems, not estimates ------------- */

/* Counts 2^m points from index `start` in the boxes with 2^cut[k] slices along coordinate k;
 * each must hold `each` of them. */
static void expect_even(uint32_t start, int m, uint32_t seed, int dimensions, const int *cut,
                        unsigned each)
{
    static unsigned box[1 << 16];
    int bits = 0;
    for (int k = 0; k < dimensions; k++)
        bits += cut[k];
    assert_true(bits <= 16);
    memset(box, 0, sizeof *box << bits);
    for (uint32_t i = 0; i < 1u << m; i++) {
        float x[4];
        if (dimensions == 2)
            sampling_sobol2(start + i, seed, x);
        else
            sampling_sobol4(start + i, seed, x);
        uint32_t at = 0;
        for (int k = 0; k < dimensions; k++) {
            assert_true(x[k] >= 0 && x[k] < 1);
            at = at << cut[k] | (uint32_t)(x[k] * (float)(1 << cut[k]));
        }
        box[at]++;
    }
    for (uint32_t b = 0; b < 1u << bits; b++)
        assert_int_equal(box[b], each);
}

/* Sobol's first two coordinates make a (0,2)-sequence: one point in each box of area 2^-m. */
static void sobol2_is_a_net(void **state)
{
    (void)state;
    for (int s = 0; s < SEEDS; s++)
        for (int m = 0; m <= 10; m++)
            for (uint32_t block = 0; block < 5; block++)
                for (int c = 0; c <= m; c++) {
                    const int cut[2] = { c, m - c };
                    const uint32_t first = block < 4 ? block : UINT32_MAX >> m; /* the last one */
                    expect_even(first << m, m, seeds[s], 2, cut, 1);
                }
}

/* The polynomials have degrees 0, 1, 2, 3, so t = 0 + 0 + 1 + 2 = 3: eight points in each box of
 * volume 2^(3-m) [Sobol' 1967]. */
static void sobol4_is_a_net(void **state)
{
    (void)state;
    enum { M = 9, T = 3 };
    for (int s = 0; s < 3; s++)
        for (uint32_t block = 0; block < 3; block++)
            for (int a = 0; a <= M - T; a++)
                for (int b = 0; a + b <= M - T; b++)
                    for (int c = 0; a + b + c <= M - T; c++) {
                        const int cut[4] = { a, b, c, M - T - a - b - c };
                        expect_even(block << M, M, seeds[s], 4, cut, 1 << T);
                    }
}

static void sobol4_has_even_coordinates(void **state)
{
    (void)state;
    for (int s = 0; s < SEEDS; s++)
        for (int k = 0; k < 4; k++) {
            int cut[4] = { 0, 0, 0, 0 };
            cut[k] = 12;
            expect_even(7u << 12, 12, seeds[s], 4, cut, 1);
        }
}

/* Each point by itself is uniform over the seeds: that makes means unbiased. */
static void sobol_points_are_uniform_over_seeds(void **state)
{
    (void)state;
    enum { BINS = 16, TRIALS = 1 << 16 };
    const uint32_t indices[] = { 0, 1, 5, 1000003 };
    for (int n = 0; n < 4; n++) {
        unsigned count[6][BINS] = { { 0 } };
        for (uint32_t seed = 0; seed < TRIALS; seed++) {
            float x[6];
            sampling_sobol4(indices[n], seed, x);
            sampling_sobol2(indices[n], seed, x + 4);
            for (int k = 0; k < 6; k++)
                count[k][(int)(x[k] * BINS)]++;
        }
        for (int k = 0; k < 6; k++) {
            double chi2 = 0;
            for (int b = 0; b < BINS; b++) {
                const double off = count[k][b] - (double)TRIALS / BINS;
                chi2 += off * off / ((double)TRIALS / BINS);
            }
            assert_true(chi2 < 56.5); /* 15 degrees of freedom: 1 in 10^6 */
        }
    }
}

/* Two seeds have nothing in common: products of their coordinates average to 1/4. */
static void sobol_seeds_are_independent(void **state)
{
    (void)state;
    enum { TRIALS = 1 << 16 };
    double sum[4] = { 0 };
    for (uint32_t seed = 0; seed < TRIALS; seed++) {
        float x[4], y[4];
        sampling_sobol4(3, seed, x);
        sampling_sobol4(3, seed + 1, y);
        for (int k = 0; k < 4; k++)
            sum[k] += ((double)x[k] - 0.5) * ((double)y[k] - 0.5);
    }
    /* The product of two independent centred uniforms has deviation 1/12. */
    const double sigma = 1.0 / 12 / sqrt(TRIALS);
    for (int k = 0; k < 4; k++)
        assert_true(fabs(sum[k] / TRIALS) < 5 * sigma);
}

static double product_error(uint32_t points, uint32_t seed)
{
    double sum = 0;
    for (uint32_t i = 0; i < points; i++) {
        float x[4];
        sampling_sobol4(i, seed, x);
        sum += (double)x[0] * (double)x[1] * (double)x[2] * (double)x[3];
    }
    return sum / points - 1.0 / 16;
}

/* Random points gain 8 from 64 times as many; scrambled nets gain 512 on a smooth integrand in the
 * limit [Owen 1997], and beat order 1/N, 64, well before it. */
static void sobol4_converges_fast(void **state)
{
    (void)state;
    double few = 0, many = 0;
    for (uint32_t seed = 0; seed < 64; seed++) {
        few += pow(product_error(64, seed), 2);
        many += pow(product_error(4096, seed), 2);
    }
    assert_true(sqrt(few / many) > 64);
}

/* --- seeds ----------------------------------------------------------------------------------- */

static int bits_set(uint32_t x)
{
    return __builtin_popcount(x);
}

/* Every bit of every key turns about half of the seed's bits. */
static void seeds_avalanche(void **state)
{
    (void)state;
    enum { TRIALS = 1000 };
    for (int key = 0; key < 5; key++)
        for (int bit = 0; bit < 32; bit++) {
            long flips = 0;
            for (uint32_t i = 0; i < TRIALS; i++) {
                uint32_t k[4] = { i, 3 * i, 7, i >> 3 };
                uint32_t x, y;
                if (key < 4) {
                    x = sampling_seed(k[0], k[1], k[2], k[3]);
                    k[key] ^= 1u << bit;
                    y = sampling_seed(k[0], k[1], k[2], k[3]);
                } else {
                    x = sampling_mix(i);
                    y = sampling_mix(i ^ 1u << bit);
                }
                flips += bits_set(x ^ y);
            }
            /* 32000 coins: deviation sqrt(8000) = 89. The cheap mix is allowed a little bias. */
            assert_true(labs(flips - 16 * TRIALS) < (key < 4 ? 5 : 20) * 89);
        }
}

/* --- maps ------------------------------------------------------------------------------------ */

enum { GRID = 512 };

static double cell(int i)
{
    return (i + 0.5) / GRID;
}

/* The concentric map sends squares to discs: the share inside radius k/n is (k/n)^2 exactly, and
 * that is what a cosine distribution asks for. */
static void cosine_has_the_right_shares(void **state)
{
    (void)state;
    double sum_x = 0, sum_y = 0;
    static unsigned inside[GRID + 2];
    memset(inside, 0, sizeof inside);
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            const Vec3 w = sampling_cosine(cell(i), cell(j));
            sum_x += w.x;
            sum_y += w.y;
            assert_true(fabs(vec3_length(w) - 1) < 1e-14);
            const double r = sqrt(w.x * w.x + w.y * w.y);
            inside[(int)ceil(r * GRID)]++; /* r is an odd multiple of 1/GRID up to rounding */
        }
    unsigned total = 0;
    for (int k = 0; k <= GRID; k += 2) {
        total += k > 0 ? inside[k] + inside[k - 1] : inside[0];
        assert_int_equal(total, k * k);
    }
    assert_true(fabs(sum_x) < 1e-9 && fabs(sum_y) < 1e-9); /* symmetric: only rounding is left */
}

static void cosine_never_lies_flat(void **state)
{
    (void)state;
    const double edge[] = { 0, 0.5, 1, 1 - 0x1p-24, 0x1p-24 };
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++) {
            const Vec3 w = sampling_cosine(edge[i], edge[j]);
            assert_true(w.z >= 1e-4);
            assert_true(fabs(vec3_length(w) - 1) <= 1e-8);
        }
}

/* Against the C library: radius and angle, independently of the series. */
static void disc_is_the_concentric_map(void **state)
{
    (void)state;
    for (int i = 0; i <= 200; i++)
        for (int j = 0; j <= 200; j++) {
            const double p = i / 100.0 - 1, q = j / 100.0 - 1;
            double x, y, angle = 0;
            sampling_disc(i / 200.0, j / 200.0, &x, &y);
            const double radius = fmax(fabs(p), fabs(q));
            if (fabs(p) > fabs(q))
                angle = M_PI / 4 * q / p + (p < 0 ? M_PI : 0);
            else if (q != 0)
                angle = M_PI / 2 - M_PI / 4 * p / q + (q < 0 ? M_PI : 0);
            assert_true(fabs(x - radius * cos(angle)) < 8 * 0x1p-53);
            assert_true(fabs(y - radius * sin(angle)) < 8 * 0x1p-53);
        }
}

static void triangle_is_uniform(void **state)
{
    (void)state;
    double u1 = 0, v1 = 0, u2 = 0, uv = 0;
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            double u, v;
            sampling_triangle(cell(i), cell(j), &u, &v);
            assert_true(u >= 0 && v >= 0 && u + v <= 1);
            u1 += u;
            v1 += v;
            u2 += u * u;
            uv += u * v;
        }
    /* Midpoint rule: second derivatives below 2 in each half, and a kink along the diagonal that
     * 1/GRID of the cells see: within 1/GRID^2. */
    const double n = GRID * (double)GRID;
    assert_true(fabs(u1 / n - 1.0 / 3) < 1 / n);
    assert_true(fabs(v1 / n - 1.0 / 3) < 1 / n);
    assert_true(fabs(u2 / n - 1.0 / 6) < 1 / n);
    assert_true(fabs(uv / n - 1.0 / 12) < 1 / n);
}

static void sphere_is_uniform(void **state)
{
    (void)state;
    Vec3 mean = { 0, 0, 0 };
    double xx = 0, zz = 0;
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++) {
            const Vec3 w = sampling_sphere(cell(i), cell(j));
            assert_true(fabs(vec3_length(w) - 1) < 1e-14);
            mean = vec3_add(mean, w);
            xx += w.x * w.x;
            zz += w.z * w.z;
        }
    const double n = GRID * (double)GRID;
    assert_true(vec3_length(mean) / n < 1e-12);
    /* Midpoint rule in z, second derivative 8, h = 1/GRID: 8 h^2 / 24; exact in the angle. */
    assert_true(fabs(zz / n - 1.0 / 3) < 0.34 / n);
    assert_true(fabs(xx / n - 1.0 / 3) < 0.34 / n);
}

static void frame_is_orthonormal(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 10000; i++) {
        float x[2];
        sampling_sobol2(i, 9, x);
        Vec3 n = sampling_sphere((double)x[0], (double)x[1]);
        if (i < 8) {
            const double tiny = i & 4 ? 1e-9 : 0;
            n = vec3(i & 1 ? tiny : -tiny, 0, i & 2 ? 1 : -1);
        }
        Vec3 s, t;
        vec3_frame(n, &s, &t);
        const Vec3 cross = vec3_cross(s, t);
        assert_true(fabs(vec3_length(s) - 1) < 1e-14);
        assert_true(fabs(vec3_length(t) - 1) < 1e-14);
        assert_true(fabs(vec3_dot(s, t)) < 1e-14);
        assert_true(vec3_length(vec3_sub(cross, n)) < 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sobol2_is_a_net),
        cmocka_unit_test(sobol4_is_a_net),
        cmocka_unit_test(sobol4_has_even_coordinates),
        cmocka_unit_test(sobol_points_are_uniform_over_seeds),
        cmocka_unit_test(sobol_seeds_are_independent),
        cmocka_unit_test(sobol4_converges_fast),
        cmocka_unit_test(seeds_avalanche),
        cmocka_unit_test(cosine_has_the_right_shares),
        cmocka_unit_test(cosine_never_lies_flat),
        cmocka_unit_test(disc_is_the_concentric_map),
        cmocka_unit_test(triangle_is_uniform),
        cmocka_unit_test(sphere_is_uniform),
        cmocka_unit_test(frame_is_orthonormal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
