/*
 * simd: vectors as wide as the including file's target allows: VD doubles, or LANES floats in as
 * many bytes. + - * / use the compilers' vector types, work per lane and are exactly the IEEE
 * operations. So the width changes no bit. The other operations are written with intrinsics, and in
 * plain C for other targets.
 */
#ifndef STORMRING_VOLUME_SIMD_H
#define STORMRING_VOLUME_SIMD_H

#include "base/base.h"

#include <string.h>

#ifdef __AVX2__
#include <immintrin.h>
#endif
#ifdef __AVX512F__
#define VD 8
#elif defined __AVX2__
#define VD 4
#else
#define VD 2
#endif
#define LANES (2 * VD)
#define ALL_LANES ((1u << LANES) - 1)
typedef double vd __attribute__((vector_size(8 * VD)));
typedef int64_t vl __attribute__((vector_size(8 * VD)));
typedef float vf __attribute__((vector_size(4 * LANES)));
typedef int32_t vi __attribute__((vector_size(4 * LANES)));
typedef float vh __attribute__((vector_size(4 * VD))); /* half as many floats as a vf */

#define SIMD_INLINE static inline __attribute__((always_inline))
#define UNROLLED _Pragma("GCC unroll 4") /* keeps arrays of vectors in registers */

/* ---- doubles -------------------------------------------------------------------------------- */

SIMD_INLINE vd vd_load(const double *p)
{
    vd a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vd_store(double *p, vd a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vl vl_load(const int64_t *p)
{
    vl a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vl_store(int64_t *p, vl a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vd vd_sqrt(vd a)
{
#ifdef __AVX512F__
    return _mm512_sqrt_pd(a);
#elif defined __AVX2__
    return _mm256_sqrt_pd(a);
#else
    for (int i = 0; i < VD; i++) a[i] = sqrt(a[i]);
    return a;
#endif
}
SIMD_INLINE vd vd_set(double a) { return a - (vd){0}; }
/* Per lane: a if m is all ones, b if m is all zeros. */
SIMD_INLINE vd vd_choose(vl m, vd a, vd b)
{
#ifdef __AVX512F__
    return (vd)_mm512_ternarylogic_epi64((__m512i)m, (__m512i)a, (__m512i)b, 0xca);
#elif defined __AVX2__
    return _mm256_blendv_pd(b, a, (vd)m);
#else
    return (vd)((m & (vl)a) | (~m & (vl)b));
#endif
}
SIMD_INLINE vl vl_choose(vl m, vl a, vl b) { return (vl)vd_choose(m, (vd)a, (vd)b); }
/* a < b ? a : b, and a > b ? a : b. */
SIMD_INLINE vd vd_min(vd a, vd b)
{
#ifdef __AVX512F__
    return _mm512_min_pd(a, b);
#elif defined __AVX2__
    return _mm256_min_pd(a, b);
#else
    return vd_choose((vl)(a < b), a, b);
#endif
}
SIMD_INLINE vd vd_max(vd a, vd b)
{
#ifdef __AVX512F__
    return _mm512_max_pd(a, b);
#elif defined __AVX2__
    return _mm256_max_pd(a, b);
#else
    return vd_choose((vl)(a > b), a, b);
#endif
}
/* One bit per lane: its sign. */
SIMD_INLINE unsigned vl_signs(vl m)
{
#ifdef __AVX512F__
    return _mm512_movepi64_mask((__m512i)m);
#elif defined __AVX2__
    return (unsigned)_mm256_movemask_pd((vd)m);
#else
    unsigned bits = 0;
    for (int i = 0; i < VD; i++) bits |= (unsigned)(m[i] < 0) << i;
    return bits;
#endif
}
SIMD_INLINE vd vd_gather(const double *p, vl at)
{
#ifdef __AVX512F__
    return _mm512_i64gather_pd((__m512i)at, p, 8);
#elif defined __AVX2__
    return _mm256_i64gather_pd(p, (__m256i)at, 8);
#else
    vd a;
    for (int i = 0; i < VD; i++) a[i] = p[at[i]];
    return a;
#endif
}
/* The same with indices in memory. Faster if the indices were stored long before. */
SIMD_INLINE vd vd_fetch(const double *p, const int64_t *at)
{
#ifdef __AVX512F__
    return _mm512_set_pd(
        p[at[7]], p[at[6]], p[at[5]], p[at[4]], p[at[3]], p[at[2]], p[at[1]], p[at[0]]);
#elif defined __AVX2__
    return _mm256_set_pd(p[at[3]], p[at[2]], p[at[1]], p[at[0]]);
#else
    vd a;
    for (int i = 0; i < VD; i++) a[i] = p[at[i]];
    return a;
#endif
}
/* The sign of lane i is bit at[i] & 7 of p[byte[i]]. Reads 8 bytes from p + byte[i] on. */
SIMD_INLINE vl vl_bits(const uint8_t *p, const int64_t *byte, vl at)
{
    vl word;
#ifdef __AVX512F__
    double b[8];
    for (int i = 0; i < 8; i++) memcpy(b + i, p + byte[i], sizeof *b);
    word = (vl)_mm512_set_pd(b[7], b[6], b[5], b[4], b[3], b[2], b[1], b[0]);
#elif defined __AVX2__
    double b[4];
    for (int i = 0; i < 4; i++) memcpy(b + i, p + byte[i], sizeof *b);
    word = (vl)_mm256_set_pd(b[3], b[2], b[1], b[0]);
#else
    for (int i = 0; i < VD; i++) word[i] = p[byte[i]];
#endif
    return word << (63 - (at & 7));
}

/* ---- floats --------------------------------------------------------------------------------- */

SIMD_INLINE vf vf_load(const float *p)
{
    vf a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vf_store(float *p, vf a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vi vi_load(const int32_t *p)
{
    vi a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vi_store(int32_t *p, vi a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vf vf_set(float a) { return a - (vf){0}; }
SIMD_INLINE vi vi_set(int32_t a) { return a - (vi){0}; }
SIMD_INLINE vf vf_choose(vi m, vf a, vf b)
{
#ifdef __AVX512F__
    return (vf)_mm512_ternarylogic_epi32((__m512i)m, (__m512i)a, (__m512i)b, 0xca);
#elif defined __AVX2__
    return _mm256_blendv_ps(b, a, (vf)m);
#else
    return (vf)((m & (vi)a) | (~m & (vi)b));
#endif
}
SIMD_INLINE vf vf_min(vf a, vf b)
{
#ifdef __AVX512F__
    return _mm512_min_ps(a, b);
#elif defined __AVX2__
    return _mm256_min_ps(a, b);
#else
    return vf_choose((vi)(a < b), a, b);
#endif
}
SIMD_INLINE vf vf_max(vf a, vf b)
{
#ifdef __AVX512F__
    return _mm512_max_ps(a, b);
#elif defined __AVX2__
    return _mm256_max_ps(a, b);
#else
    return vf_choose((vi)(a > b), a, b);
#endif
}
SIMD_INLINE vf vf_abs(vf a) { return (vf)((vi)a & INT32_MAX); }
SIMD_INLINE unsigned vi_signs(vi m)
{
#ifdef __AVX512F__
    return _mm512_movepi32_mask((__m512i)m);
#elif defined __AVX2__
    return (unsigned)_mm256_movemask_ps((vf)m);
#else
    unsigned bits = 0;
    for (int i = 0; i < LANES; i++) bits |= (unsigned)(m[i] < 0) << i;
    return bits;
#endif
}
/* Joins two halves. */
SIMD_INLINE vf vf_narrow(vd a, vd b)
{
    vh low = __builtin_convertvector(a, vh), high = __builtin_convertvector(b, vh);
#ifdef __AVX512F__
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif defined __AVX2__
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#endif
}
/* p[at]. few: the table has at most 8 entries and room for 16. */
SIMD_INLINE vf vf_lookup(const float *p, bool few, vi at)
{
#ifdef __AVX512F__
    if (few) return _mm512_permutexvar_ps((__m512i)at, vf_load(p));
    return _mm512_i32gather_ps((__m512i)at, p, 4);
#elif defined __AVX2__
    if (few) return _mm256_permutevar8x32_ps(vf_load(p), (__m256i)at);
    return _mm256_i32gather_ps(p, (__m256i)at, 4);
#else
    (void)few;
    vf a;
    for (int i = 0; i < LANES; i++) a[i] = p[at[i]];
    return a;
#endif
}
/* exp(x) for x <= 0, to within 2 units in the last place. */
SIMD_INLINE vf vf_exp(vf x)
{
    const vf round = vf_set(0x1.8p23f); /* adding this puts n into the last bits */
    vf sum = x * 1.44269504f + round, n = sum - round;
    vf f = (x - n * 0.693359375f) + n * 2.12194440e-4f, f2 = f * f; /* ln 2 in two parts */
    vf q = (0.5f + f * (1.0f / 6)) +
           f2 * ((1.0f / 24 + f * (1.0f / 120)) + f2 * (1.0f / 720 + f * (1.0f / 5040)));
    vf scale = (vf)(((vi)sum + 127) << 23);
    return vf_choose(x > vf_set(-80), (1 + (f + f2 * q)) * scale, vf_set(0));
}

#endif
