/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/lanes_avx2.h -- 8 rays side by side: what packet.h computes with, in AVX2. */
#ifndef RAYCAST_LANES_H
#define RAYCAST_LANES_H

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

#define LANES 8u

typedef __m256  Floats;
typedef __m256d Doubles; /* half of the lanes */
typedef __m256i Words;

#define LANES_INLINE ALWAYS_INLINE

/* All bits of the lanes in `mask`. */
LANES_INLINE Floats floats_mask(unsigned mask)
{
    const Words bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const Words set = _mm256_and_si256(_mm256_set1_epi32((int)mask), bit);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit));
}
LANES_INLINE Floats floats_all(float x) { return _mm256_set1_ps(x); }
LANES_INLINE Floats floats_load(const float *p) { return _mm256_load_ps(p); }
LANES_INLINE void floats_store(float *p, Floats a) { _mm256_store_ps(p, a); }
LANES_INLINE Floats floats_min(Floats a, Floats b) { return _mm256_min_ps(a, b); }
LANES_INLINE Floats floats_max(Floats a, Floats b) { return _mm256_max_ps(a, b); }
LANES_INLINE Floats floats_abs(Floats a)
{
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}
/* a * b + c, rounded once. */
LANES_INLINE Floats floats_fused(Floats a, Floats b, Floats c) { return _mm256_fmadd_ps(a, b, c); }
LANES_INLINE Floats floats_sign_of(Floats size, Floats sign)
{
    const Floats bit = _mm256_set1_ps(-0.0f);
    return _mm256_or_ps(_mm256_and_ps(bit, sign), _mm256_andnot_ps(bit, size));
}
/* Lanes of `mask` from a, the others from b. */
LANES_INLINE Floats floats_pick(unsigned mask, Floats a, Floats b)
{
    return _mm256_blendv_ps(b, a, floats_mask(mask));
}
LANES_INLINE unsigned floats_signs(Floats a) { return (unsigned)_mm256_movemask_ps(a); }
LANES_INLINE unsigned floats_less(Floats a, Floats b)
{
    return floats_signs(_mm256_cmp_ps(a, b, _CMP_LT_OQ));
}
LANES_INLINE unsigned floats_less_equal(Floats a, Floats b)
{
    return floats_signs(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}
LANES_INLINE unsigned floats_equal(Floats a, Floats b)
{
    return floats_signs(_mm256_cmp_ps(a, b, _CMP_EQ_OQ));
}
LANES_INLINE float floats_least(Floats a)
{
    __m128 m = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    m = _mm_min_ps(m, _mm_movehl_ps(m, m));
    return _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps(m, m, 1)));
}
LANES_INLINE float floats_most(Floats a)
{
    __m128 m = _mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    m = _mm_max_ps(m, _mm_movehl_ps(m, m));
    return _mm_cvtss_f32(_mm_max_ss(m, _mm_shuffle_ps(m, m, 1)));
}

/* The least or most of a, of b, of c and of d. */
LANES_INLINE __m128 floats_four(Floats a, Floats b, Floats c, Floats d, bool most)
{
    const Floats x[2] = { _mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d) };
    const Floats y[2] = { _mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d) };
    const Floats u = most ? floats_max(x[0], y[0]) : floats_min(x[0], y[0]);
    const Floats v = most ? floats_max(x[1], y[1]) : floats_min(x[1], y[1]);
    const Floats s = _mm256_shuffle_ps(u, v, 0x44), t = _mm256_shuffle_ps(u, v, 0xee);
    const Floats w = most ? floats_max(s, t) : floats_min(s, t);
    const __m128 p = _mm256_castps256_ps128(w), q = _mm256_extractf128_ps(w, 1);
    return most ? _mm_max_ps(p, q) : _mm_min_ps(p, q);
}
/* a, once for every four lanes. */
LANES_INLINE Floats floats_repeat(__m128 a)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(a), a, 1);
}
/* Each number of a four times, from number `first` on. */
LANES_INLINE Floats floats_stretch(__m128 a, int first)
{
    const Words at = _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
    return _mm256_permutevar8x32_ps(_mm256_castps128_ps256(a),
                                    _mm256_add_epi32(at, _mm256_set1_epi32(first)));
}

LANES_INLINE Words words_all(uint32_t x) { return _mm256_set1_epi32((int)x); }
LANES_INLINE Words words_load(const uint32_t *p) { return _mm256_load_si256((const Words *)p); }
LANES_INLINE void words_store(uint32_t *p, Words a) { _mm256_store_si256((Words *)p, a); }
LANES_INLINE Words words_pick(unsigned mask, Words a, Words b)
{
    return _mm256_castps_si256(floats_pick(mask, _mm256_castsi256_ps(a), _mm256_castsi256_ps(b)));
}
LANES_INLINE unsigned words_less(Words a, Words b)
{
    const Words top = _mm256_set1_epi32(INT32_MIN); /* there is only a signed comparison */
    const Words less = _mm256_cmpgt_epi32(_mm256_xor_si256(b, top), _mm256_xor_si256(a, top));
    return floats_signs(_mm256_castsi256_ps(less));
}
LANES_INLINE unsigned words_equal(Words a, Words b)
{
    return floats_signs(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)));
}

LANES_INLINE Doubles doubles_all(double x) { return _mm256_set1_pd(x); }
LANES_INLINE Doubles doubles_load(const double *p) { return _mm256_load_pd(p); }
LANES_INLINE void doubles_store(double *p, Doubles a) { _mm256_store_pd(p, a); }
LANES_INLINE Doubles doubles_of(Floats a, int half)
{
    return _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(a) : _mm256_extractf128_ps(a, 1));
}
LANES_INLINE Floats floats_of(Doubles low, Doubles high)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)),
                                _mm256_cvtpd_ps(high), 1);
}
/* a - b * c, rounded once. */
LANES_INLINE Doubles doubles_less_product(Doubles a, Doubles b, Doubles c)
{
    return _mm256_fnmadd_pd(b, c, a);
}
LANES_INLINE Doubles doubles_min(Doubles a, Doubles b) { return _mm256_min_pd(a, b); }
LANES_INLINE Doubles doubles_max(Doubles a, Doubles b) { return _mm256_max_pd(a, b); }
LANES_INLINE unsigned doubles_less_equal(Doubles a, Doubles b)
{
    return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ));
}

/* Eight rows of eight floats become eight columns. */
LANES_INLINE void eight_turned(const float *const row[8], __m256 column[8])
{
    __m256 r[8], s[8];
    for (int i = 0; i < 8; i++)
        r[i] = _mm256_loadu_ps(row[i]);
    for (int i = 0; i < 8; i += 2) {
        s[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
        s[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
    }
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; j++) {
            r[i + 2 * j] = _mm256_shuffle_ps(s[i + j], s[i + j + 2], 0x44);
            r[i + 2 * j + 1] = _mm256_shuffle_ps(s[i + j], s[i + j + 2], 0xee);
        }
    for (int i = 0; i < 4; i++) {
        column[i] = _mm256_permute2f128_ps(r[i], r[i + 4], 0x20);
        column[i + 4] = _mm256_permute2f128_ps(r[i], r[i + 4], 0x31);
    }
}

/* The eight floats at row[0], row[1] ... of all lanes: field k of every lane. */
LANES_INLINE void floats_fields(const float *const row[LANES], Floats field[8])
{
    eight_turned(row, field);
}

/* Four words a lane, a b c d, written to where out[] points, for the lanes of `mask`. */
LANES_INLINE void floats_scatter(float *const out[LANES], unsigned mask, Floats a, Floats b,
                                 Floats c, Floats d)
{
    const Floats ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d);
    const Floats ef = _mm256_unpackhi_ps(a, b), gh = _mm256_unpackhi_ps(c, d);
    const Floats row[4] = { _mm256_shuffle_ps(ab, cd, 0x44), _mm256_shuffle_ps(ab, cd, 0xee),
                            _mm256_shuffle_ps(ef, gh, 0x44), _mm256_shuffle_ps(ef, gh, 0xee) };
    _Alignas(32) float all[4][LANES];
    for (int i = 0; i < 4; i++)
        floats_store(all[i], row[i]);
    for (; mask != 0; mask &= mask - 1) {
        const int i = __builtin_ctz(mask);
        _mm_storeu_ps(out[i], _mm_load_ps(&all[i & 3][i & ~3]));
    }
}

LANES_INLINE Words words_without(Words a, uint32_t bits)
{
    return _mm256_andnot_si256(_mm256_set1_epi32((int)bits), a);
}
LANES_INLINE Words words_of(Floats a) { return _mm256_cvttps_epi32(a); } /* towards 0 */
LANES_INLINE Words words_min(Words a, Words b) { return _mm256_min_epi32(a, b); }
LANES_INLINE Words words_max(Words a, Words b) { return _mm256_max_epi32(a, b); }
LANES_INLINE Words words_or(Words a, Words b) { return _mm256_or_si256(a, b); }
LANES_INLINE Words words_left(Words a, unsigned bits)
{
    return _mm256_sll_epi32(a, _mm_cvtsi32_si128((int)bits));
}
/* 1 where the sign is set, else 0. */
LANES_INLINE Words words_sign(Floats a) { return _mm256_srli_epi32(_mm256_castps_si256(a), 31); }
/* table[a] of 32 entries; table[0] is 0. */
LANES_INLINE Words words_lookup(const uint16_t table[32], Words a)
{
    _Alignas(32) uint32_t at[LANES];
    words_store(at, a);
    for (unsigned i = 0; i < LANES; i++)
        at[i] = table[at[i]];
    return words_load(at);
}
LANES_INLINE Floats floats_bits(Words a) { return _mm256_castsi256_ps(a); }

#endif
