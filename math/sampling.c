/* SPDX-License-Identifier: BSD-3-Clause */
/* Scrambled Sobol' points and the maps that use them. The only file that includes Random123.
 *
 * Everything up to the last step is done on bit-reversed words: there the first coordinate is the
 * index itself, and Owen scrambling, in which a bit may depend on the bits above it only, becomes
 * a hash built of additions and multiplications, whose carries run upwards [laine11]. */
#include "math/sampling.h"

#include <Random123/philox.h>
#include <assert.h>
#include <stddef.h>

/* --- seeds ----------------------------------------------------------------------------------- */

uint32_t sampling_seed(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    /* Any fixed key does: the counter holds all that varies. */
    const philox4x32_key_t key = { { 0x69736f6c, 0x75780001 } };
    const philox4x32_ctr_t counter = { { a, b, c, d } };
    return philox4x32(counter, key).v[0];
}

/* A bijection of 32-bit words: xor-shift and odd multiplier in turn, constants from a search for
 * the least bias by C. Wellons ("lowbias32"). */
static inline uint32_t word_mix(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ x >> 16;
}

uint32_t sampling_mix(uint32_t x)
{
    /* The bijection keeps 0; seeds often are 0. */
    return word_mix(x + 0x9e3779b9U);
}

/* --- scrambled Sobol' points ----------------------------------------------------------------- */

static inline uint32_t bits_reverse(uint32_t x)
{
    x = __builtin_bswap32(x);
    x = (x & 0xf0f0f0f0U) >> 4 | (x & 0x0f0f0f0fU) << 4;
    x = (x & 0xccccccccU) >> 2 | (x & 0x33333333U) << 2;
    return (x & 0xaaaaaaaaU) >> 1 | (x & 0x55555555U) << 1;
}

/* Owen scrambling of a bit-reversed word: each step is a bijection in which bits only move up.
 * The scheme is [laine11]'s; the constants, which mix better, were found by N. Vegdahl. */
static inline uint32_t owen_hash(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526c56U;
    return x ^ x * 0x53a22864U;
}

/* The second coordinate, bit-reversed. Its matrix is Pascal's triangle mod 2, the fifth Kronecker
 * power of (1 1; 0 1), so it is applied in five steps without a table. */
static inline uint32_t pascal_product(uint32_t x)
{
    x ^= x >> 16;
    x ^= (x & 0xff00ff00U) >> 8;
    x ^= (x & 0xf0f0f0f0U) >> 4;
    x ^= (x & 0xccccccccU) >> 2;
    return x ^ (x & 0xaaaaaaaaU) >> 1;
}

/* Third and fourth coordinate: bit-reversed direction numbers out of the initial values (1 3) and
 * (1 3 1) and polynomials of [joe08], combined for each value of four bits of the index, so that a
 * coordinate takes 8 look-ups in place of 32. */
#define SPAN(a, b, c, d) \
    0, (a), (b), (a) ^ (b), (c), (a) ^ (c), (b) ^ (c), (a) ^ (b) ^ (c), (d), (a) ^ (d), \
    (b) ^ (d), (a) ^ (b) ^ (d), (c) ^ (d), (a) ^ (c) ^ (d), (b) ^ (c) ^ (d), \
    (a) ^ (b) ^ (c) ^ (d)

static const uint32_t third_span[8][16] = {
    { SPAN(0x00000001U, 0x00000003U, 0x00000006U, 0x00000009U) },
    { SPAN(0x00000017U, 0x0000003aU, 0x00000071U, 0x000000a3U) },
    { SPAN(0x00000116U, 0x00000339U, 0x00000677U, 0x000009aaU) },
    { SPAN(0x00001601U, 0x00003903U, 0x00007706U, 0x0000aa09U) },
    { SPAN(0x00010117U, 0x0003033aU, 0x00060671U, 0x000909a3U) },
    { SPAN(0x00171616U, 0x003a3939U, 0x00717777U, 0x00a3aaaaU) },
    { SPAN(0x01170001U, 0x033a0003U, 0x06710006U, 0x09a30009U) },
    { SPAN(0x16160017U, 0x3939003aU, 0x77770071U, 0xaaaa00a3U) },
};
static const uint32_t fourth_span[8][16] = {
    { SPAN(0x00000001U, 0x00000003U, 0x00000004U, 0x0000000aU) },
    { SPAN(0x0000001fU, 0x0000002eU, 0x00000045U, 0x000000c9U) },
    { SPAN(0x0000011bU, 0x000002a4U, 0x0000079aU, 0x00000b67U) },
    { SPAN(0x0000101eU, 0x0000302dU, 0x00004041U, 0x0000a0c3U) },
    { SPAN(0x0001f104U, 0x0002e28aU, 0x000457dfU, 0x000c9baeU) },
    { SPAN(0x0011a105U, 0x002a7289U, 0x0079e7dbU, 0x00b6dba4U) },
    { SPAN(0x0100011aU, 0x030002a7U, 0x0400079eU, 0x0a000b6dU) },
    { SPAN(0x1f001001U, 0x2e003003U, 0x45004004U, 0xc900a00aU) },
};

static inline uint32_t span_product(const uint32_t span[8][16], uint32_t x)
{
    return span[0][x & 15] ^ span[1][x >> 4 & 15] ^ span[2][x >> 8 & 15] ^
           span[3][x >> 12 & 15] ^ span[4][x >> 16 & 15] ^ span[5][x >> 20 & 15] ^
           span[6][x >> 24 & 15] ^ span[7][x >> 28];
}

/* Scrambling the index too shuffles the points within each aligned block of 2^k, so that the same
 * index under two seeds has nothing in common [burley20]. */
static inline uint32_t index_shuffle(uint32_t index, uint32_t seed)
{
    return bits_reverse(owen_hash(bits_reverse(index), seed));
}

/* The upper 24 bits: all a float holds without rounding up to 1. */
static inline float unit_float(uint32_t x)
{
    return (float)(int32_t)(x >> 8) * 0x1p-24F;
}

/* A seed of its own for each coordinate: the steps of the golden ratio never meet. */
static inline uint32_t coordinate_seed(uint32_t seed, uint32_t coordinate)
{
    return word_mix(seed + 0x9e3779b9U * (coordinate + 1));
}

void sampling_sobol4(uint32_t index, uint32_t seed, float out[4])
{
    assert(out != NULL);
    const uint32_t i = index_shuffle(index, coordinate_seed(seed, 0));
    uint32_t x[4] = { i, pascal_product(i), span_product(third_span, i),
                      span_product(fourth_span, i) };

    for (uint32_t k = 0; k < 4; k++)
        out[k] = unit_float(bits_reverse(owen_hash(x[k], coordinate_seed(seed, k + 1))));
}

void sampling_sobol2(uint32_t index, uint32_t seed, float out[2])
{
    assert(out != NULL);
    const uint32_t i = index_shuffle(index, coordinate_seed(seed, 0));

    out[0] = unit_float(bits_reverse(owen_hash(i, coordinate_seed(seed, 1))));
    out[1] = unit_float(bits_reverse(owen_hash(pascal_product(i), coordinate_seed(seed, 2))));
}

/* --- maps of the square ---------------------------------------------------------------------- */

/* Cosine and sine for |x| <= pi / 4 by their Taylor series to x^17, whose remainder is below half
 * an ulp there: several times faster than the C library's, and the same on every machine. */
static inline void circle_point(double x, double *c, double *s)
{
    const double q = x * x;

    *c = 1 + q * (-1.0 / 2 + q * (1.0 / 24 + q * (-1.0 / 720 + q * (1.0 / 40320 +
         q * (-1.0 / 3628800 + q * (1.0 / 479001600 + q * (-1.0 / 87178291200 +
         q * (1.0 / 20922789888000))))))));
    *s = x * (1 + q * (-1.0 / 6 + q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880 +
         q * (-1.0 / 39916800 + q * (1.0 / 6227020800 + q * (-1.0 / 1307674368000 +
         q * (1.0 / 355687428096000)))))))));
}

void sampling_disc(double a, double b, double *x, double *y)
{
    assert(x != NULL && y != NULL);
    const double p = 2 * a - 1, q = 2 * b - 1;
    double c, s;

    if (fabs(p) > fabs(q)) { /* the quarters left and right: radius p, angle pi/4 q/p */
        circle_point(M_PI_4 * (q / p), &c, &s);
        *x = p * c;
        *y = p * s;
    } else if (q != 0) {
        circle_point(M_PI_4 * (p / q), &c, &s);
        *x = q * s;
        *y = q * c;
    } else {
        *x = *y = 0;
    }
}

Vec3 sampling_cosine(double a, double b)
{
    /* The lowest direction: of 1e8 rays one is that flat, and its cosine weighs next to nothing,
     * but a ray in its own plane would meet its neighbours edge on. */
    static const double lowest = 1e-4;
    Vec3 w;

    sampling_disc(a, b, &w.x, &w.y);
    const double square = 1 - (w.x * w.x + w.y * w.y);
    w.z = square > lowest * lowest ? sqrt(square) : lowest;
    return w;
}

void sampling_triangle(double a, double b, double *u, double *v)
{
    assert(u != NULL && v != NULL);
    /* Each half of the square beside the diagonal is sheared onto half of the triangle; both keep
     * areas (factor 1/2) and meet on the diagonal without a jump [heitz19]. */
    if (b > a) {
        *u = a / 2;
        *v = b - a / 2;
    } else {
        *u = a - b / 2;
        *v = b / 2;
    }
}

Vec3 sampling_sphere(double a, double b)
{
    const double radius = 2 * sqrt(fmax(a * (1 - a), 0)); /* sqrt(1 - z^2) without cancellation */
    const double angle = 2 * M_PI * b;
    return vec3(radius * cos(angle), radius * sin(angle), 1 - 2 * a);
}
