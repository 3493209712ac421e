/*
 * stream_simd: vector operations that only the stream needs: indices, gathers, tables, exp. simd.h
 * has the others.
 */
#ifndef STORMRING_VOLUME_STREAM_SIMD_H
#define STORMRING_VOLUME_STREAM_SIMD_H

#include "simd/simd.h"

#define ALL_LANES ((1u << VF) - 1)
typedef float vh __attribute__((vector_size(4 * VD))); /* half as many floats as a vf */

#define UNROLLED_ALL _Pragma("GCC unroll 16")
#define UNROLLED _Pragma("GCC unroll 4") /* keeps arrays of vectors in registers */

/* ---- doubles -------------------------------------------------------------------------------- */

SIMD_INLINE vl vl_load(const int64_t *p)
{
    vl a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vl_store(int64_t *p, vl a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vl vl_choose(vl m, vl a, vl b) { return (vl)vd_choose(m, (vd)a, (vd)b); }
SIMD_INLINE vd vd_gather(const double *p, vl at)
{
#if SIMD_BYTES == 64
    return _mm512_i64gather_pd((__m512i)at, p, 8);
#elif SIMD_BYTES == 32
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
#if SIMD_BYTES == 64
    return _mm512_set_pd(
        p[at[7]], p[at[6]], p[at[5]], p[at[4]], p[at[3]], p[at[2]], p[at[1]], p[at[0]]);
#elif SIMD_BYTES == 32
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
#if SIMD_BYTES == 64
    double b[8];
    for (int i = 0; i < 8; i++) memcpy(b + i, p + byte[i], sizeof *b);
    word = (vl)_mm512_set_pd(b[7], b[6], b[5], b[4], b[3], b[2], b[1], b[0]);
#elif SIMD_BYTES == 32
    double b[4];
    for (int i = 0; i < 4; i++) memcpy(b + i, p + byte[i], sizeof *b);
    word = (vl)_mm256_set_pd(b[3], b[2], b[1], b[0]);
#else
    for (int i = 0; i < VD; i++) word[i] = p[byte[i]];
#endif
    return word << (63 - (at & 7));
}

/* ---- floats --------------------------------------------------------------------------------- */

SIMD_INLINE vi vi_load(const int32_t *p)
{
    vi a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vi_store(int32_t *p, vi a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vi vi_set(int32_t a) { return a - (vi){0}; }
/* a as floats. */
SIMD_INLINE vd vd_rounded(vd a)
{
    return __builtin_convertvector(__builtin_convertvector(a, vh), vd);
}
/* The sign of lane i is bit at[i] & 7 of p[byte[i]]. Reads 4 bytes from p + byte[i] on. */
SIMD_INLINE vi vi_bits(const uint8_t *p, const int32_t *byte, vi at)
{
    int32_t b[VF];
    UNROLLED_ALL
    for (int i = 0; i < VF; i++) memcpy(b + i, p + byte[i], sizeof *b);
#if SIMD_BYTES == 64
    vi word = (vi)_mm512_set_epi32(b[15], b[14], b[13], b[12], b[11], b[10], b[9], b[8], b[7], b[6],
        b[5], b[4], b[3], b[2], b[1], b[0]);
#elif SIMD_BYTES == 32
    vi word = (vi)_mm256_set_epi32(b[7], b[6], b[5], b[4], b[3], b[2], b[1], b[0]);
#else
    vi word = vi_load(b);
#endif
    return word << (31 - (at & 7));
}
/* Joins two halves. */
SIMD_INLINE vf vf_narrow(vd a, vd b)
{
    vh low = __builtin_convertvector(a, vh), high = __builtin_convertvector(b, vh);
#if SIMD_BYTES == 64
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif SIMD_BYTES == 32
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#endif
}
SIMD_INLINE vf vf_sqrt(vf a)
{
#if SIMD_BYTES == 64
    return _mm512_sqrt_ps(a);
#elif SIMD_BYTES == 32
    return _mm256_sqrt_ps(a);
#elif defined SIMD_SSE2
    return _mm_sqrt_ps(a);
#else
    for (int i = 0; i < VF; i++) a[i] = sqrtf(a[i]);
    return a;
#endif
}
/* p[at]. few: the table has at most 8 entries and room for 16. */
SIMD_INLINE vf vf_lookup(const float *p, bool few, vi at)
{
#if SIMD_BYTES == 64
    if (few) return _mm512_permutexvar_ps((__m512i)at, vf_load(p));
    return _mm512_i32gather_ps((__m512i)at, p, 4);
#elif SIMD_BYTES == 32
    if (few) return _mm256_permutevar8x32_ps(vf_load(p), (__m256i)at);
    return _mm256_i32gather_ps(p, (__m256i)at, 4);
#else
    (void)few;
    vf a;
    for (int i = 0; i < VF; i++) a[i] = p[at[i]];
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
