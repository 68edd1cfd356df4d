/* SPDX-License-Identifier: BSD-3-Clause */
/* raycast/lanes_avx512.h -- 16 rays side by side: what packet.h computes with, in AVX-512. */
#ifndef RAYCAST_LANES_H
#define RAYCAST_LANES_H

#include <immintrin.h>
#include <stdbool.h>
#include <stdint.h>

#define LANES 16u

typedef __m512  Floats;
typedef __m512d Doubles; /* half of the lanes */
typedef __m512i Words;

#define LANES_INLINE ALWAYS_INLINE

LANES_INLINE Floats floats_all(float x) { return _mm512_set1_ps(x); }
LANES_INLINE Floats floats_load(const float *p) { return _mm512_load_ps(p); }
LANES_INLINE void floats_store(float *p, Floats a) { _mm512_store_ps(p, a); }
LANES_INLINE Floats floats_min(Floats a, Floats b) { return _mm512_min_ps(a, b); }
LANES_INLINE Floats floats_max(Floats a, Floats b) { return _mm512_max_ps(a, b); }
LANES_INLINE Floats floats_abs(Floats a) { return _mm512_abs_ps(a); }
/* a * b + c, rounded once. */
LANES_INLINE Floats floats_fused(Floats a, Floats b, Floats c) { return _mm512_fmadd_ps(a, b, c); }
LANES_INLINE Floats floats_sign_of(Floats size, Floats sign)
{
    const Words bit = _mm512_set1_epi32(INT32_MIN);
    return _mm512_castsi512_ps(_mm512_ternarylogic_epi32(bit, _mm512_castps_si512(sign),
                                                         _mm512_castps_si512(size), 0xca));
}
/* Lanes of `mask` from a, the others from b. */
LANES_INLINE Floats floats_pick(unsigned mask, Floats a, Floats b)
{
    return _mm512_mask_mov_ps(b, (__mmask16)mask, a);
}
LANES_INLINE unsigned floats_less(Floats a, Floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
LANES_INLINE unsigned floats_less_equal(Floats a, Floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
LANES_INLINE unsigned floats_equal(Floats a, Floats b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ);
}
LANES_INLINE unsigned floats_signs(Floats a)
{
    return _mm512_movepi32_mask(_mm512_castps_si512(a));
}
LANES_INLINE float floats_least(Floats a) { return _mm512_reduce_min_ps(a); }
LANES_INLINE float floats_most(Floats a) { return _mm512_reduce_max_ps(a); }

/* The least or most of a, of b, of c and of d. */
LANES_INLINE __m128 floats_four(Floats a, Floats b, Floats c, Floats d, bool most)
{
    const Floats x[2] = { _mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d) };
    const Floats y[2] = { _mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d) };
    const Floats u = most ? floats_max(x[0], y[0]) : floats_min(x[0], y[0]);
    const Floats v = most ? floats_max(x[1], y[1]) : floats_min(x[1], y[1]);
    const Floats s = _mm512_shuffle_ps(u, v, 0x44), t = _mm512_shuffle_ps(u, v, 0xee);
    const Floats w = most ? floats_max(s, t) : floats_min(s, t);
    const __m256 low = _mm512_castps512_ps256(w), high = _mm512_extractf32x8_ps(w, 1);
    const __m256 r = most ? _mm256_max_ps(low, high) : _mm256_min_ps(low, high);
    const __m128 p = _mm256_castps256_ps128(r), q = _mm256_extractf128_ps(r, 1);
    return most ? _mm_max_ps(p, q) : _mm_min_ps(p, q);
}
/* a, once for every four lanes. */
LANES_INLINE Floats floats_repeat(__m128 a) { return _mm512_broadcast_f32x4(a); }
/* Each number of a four times, from number `first` on. */
LANES_INLINE Floats floats_stretch(__m128 a, int first)
{
    const Words at = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    return _mm512_permutexvar_ps(_mm512_add_epi32(at, _mm512_set1_epi32(first)),
                                 _mm512_castps128_ps512(a));
}

LANES_INLINE Words words_all(uint32_t x) { return _mm512_set1_epi32((int)x); }
LANES_INLINE Words words_load(const uint32_t *p) { return _mm512_load_si512(p); }
LANES_INLINE void words_store(uint32_t *p, Words a) { _mm512_store_si512(p, a); }
LANES_INLINE Words words_pick(unsigned mask, Words a, Words b)
{
    return _mm512_mask_mov_epi32(b, (__mmask16)mask, a);
}
LANES_INLINE unsigned words_less(Words a, Words b) { return _mm512_cmplt_epu32_mask(a, b); }
LANES_INLINE unsigned words_equal(Words a, Words b) { return _mm512_cmpeq_epi32_mask(a, b); }

LANES_INLINE Doubles doubles_all(double x) { return _mm512_set1_pd(x); }
LANES_INLINE Doubles doubles_load(const double *p) { return _mm512_load_pd(p); }
LANES_INLINE void doubles_store(double *p, Doubles a) { _mm512_store_pd(p, a); }
LANES_INLINE Doubles doubles_of(Floats a, int half)
{
    return _mm512_cvtps_pd(half == 0 ? _mm512_castps512_ps256(a) : _mm512_extractf32x8_ps(a, 1));
}
LANES_INLINE Floats floats_of(Doubles low, Doubles high)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high),
                              1);
}
/* a - b * c, rounded once. */
LANES_INLINE Doubles doubles_less_product(Doubles a, Doubles b, Doubles c)
{
    return _mm512_fnmadd_pd(b, c, a);
}
LANES_INLINE Doubles doubles_min(Doubles a, Doubles b) { return _mm512_min_pd(a, b); }
LANES_INLINE Doubles doubles_max(Doubles a, Doubles b) { return _mm512_max_pd(a, b); }
LANES_INLINE unsigned doubles_less_equal(Doubles a, Doubles b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}

/* The eight floats at row[0], row[1] ... of all lanes: field k of every lane. */
LANES_INLINE void floats_fields(const float *const row[LANES], Floats field[8])
{
    Floats r[8], s[8];
    /* Two rows a register, so that the last step puts all lanes in order. */
    for (int i = 0; i < 8; i++) {
        const int at = i < 4 ? i : i + 4;
        r[i] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(row[at])),
                                  _mm256_loadu_ps(row[at + 4]), 1);
    }
    for (int i = 0; i < 8; i += 2) {
        s[i] = _mm512_unpacklo_ps(r[i], r[i + 1]);
        s[i + 1] = _mm512_unpackhi_ps(r[i], r[i + 1]);
    }
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; j++) {
            r[i + 2 * j] = _mm512_shuffle_ps(s[i + j], s[i + j + 2], 0x44);
            r[i + 2 * j + 1] = _mm512_shuffle_ps(s[i + j], s[i + j + 2], 0xee);
        }
    for (int i = 0; i < 4; i++) {
        field[i] = _mm512_shuffle_f32x4(r[i], r[i + 4], 0x88);
        field[i + 4] = _mm512_shuffle_f32x4(r[i], r[i + 4], 0xdd);
    }
}

/* Four words a lane, a b c d, written to where out[] points, for the lanes of `mask`. */
LANES_INLINE void floats_scatter(float *const out[LANES], unsigned mask, Floats a, Floats b,
                                 Floats c, Floats d)
{
    const Floats ab = _mm512_unpacklo_ps(a, b), cd = _mm512_unpacklo_ps(c, d);
    const Floats ef = _mm512_unpackhi_ps(a, b), gh = _mm512_unpackhi_ps(c, d);
    const Floats row[4] = { _mm512_shuffle_ps(ab, cd, 0x44), _mm512_shuffle_ps(ab, cd, 0xee),
                            _mm512_shuffle_ps(ef, gh, 0x44), _mm512_shuffle_ps(ef, gh, 0xee) };
    _Alignas(64) float all[4][LANES];
    for (int i = 0; i < 4; i++)
        floats_store(all[i], row[i]);
    for (; mask != 0; mask &= mask - 1) {
        const int i = __builtin_ctz(mask);
        _mm_storeu_ps(out[i], _mm_load_ps(&all[i & 3][i & ~3]));
    }
}

LANES_INLINE Words words_without(Words a, uint32_t bits)
{
    return _mm512_andnot_si512(_mm512_set1_epi32((int)bits), a);
}
LANES_INLINE Words words_of(Floats a) { return _mm512_cvttps_epi32(a); } /* towards 0 */
LANES_INLINE Words words_min(Words a, Words b) { return _mm512_min_epi32(a, b); }
LANES_INLINE Words words_max(Words a, Words b) { return _mm512_max_epi32(a, b); }
LANES_INLINE Words words_or(Words a, Words b) { return _mm512_or_si512(a, b); }
LANES_INLINE Words words_left(Words a, unsigned bits)
{
    return _mm512_sll_epi32(a, _mm_cvtsi32_si128((int)bits));
}
/* 1 where the sign is set, else 0. */
LANES_INLINE Words words_sign(Floats a) { return _mm512_srli_epi32(_mm512_castps_si512(a), 31); }
/* table[a] of 32 entries; table[0] is 0. */
LANES_INLINE Words words_lookup(const uint16_t table[32], Words a)
{
    return _mm512_permutexvar_epi16(a, _mm512_loadu_si512(table));
}
LANES_INLINE Floats floats_bits(Words a) { return _mm512_castsi512_ps(a); }

#endif
