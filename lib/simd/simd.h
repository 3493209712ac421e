/*
 * simd: vectors as wide as the including file's target allows: VD doubles, or VF floats in as many
 * bytes. + - * / and comparisons use the compilers' vector types and work per lane. + - * / are
 * exactly the IEEE operations, so the width changes no bit. A comparison gives a mask: all bits of
 * a lane are 1 or 0. The other operations are written with intrinsics, and in plain C for other
 * targets.
 */
#ifndef STORMRING_SIMD_H
#define STORMRING_SIMD_H

#include "base/base.h"

#include <string.h>

/* An including file may define SIMD_MOST, the bytes of its widest vectors. With 8, a vd has one
 * lane. */
#ifndef SIMD_MOST
#define SIMD_MOST 64
#endif
#if defined __AVX512F__ && SIMD_MOST >= 64
#define SIMD_BYTES 64
#elif defined __AVX2__ && SIMD_MOST >= 32
#define SIMD_BYTES 32
#elif SIMD_MOST >= 16
#define SIMD_BYTES 16
#else
#define SIMD_BYTES 8
#endif
#if defined __SSE2__ && SIMD_BYTES >= 16
#include <immintrin.h>
#define SIMD_SSE2
#endif

#define VD (SIMD_BYTES / 8)
#define VF (SIMD_BYTES / 4)
typedef double vd __attribute__((vector_size(SIMD_BYTES)));
typedef int64_t vl __attribute__((vector_size(SIMD_BYTES)));
typedef float vf __attribute__((vector_size(SIMD_BYTES)));
typedef int32_t vi __attribute__((vector_size(SIMD_BYTES)));
/* The same in arrays of their elements, aligned to the vector. */
typedef double vd_memory __attribute__((vector_size(SIMD_BYTES), may_alias));
typedef float vf_memory __attribute__((vector_size(SIMD_BYTES), may_alias));

#define SIMD_INLINE static inline __attribute__((always_inline))

/* ---- doubles -------------------------------------------------------------------------------- */

SIMD_INLINE vd vd_load(const double *p)
{
    vd a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vd_store(double *p, vd a) { memcpy(p, &a, sizeof a); }
/* The same, faster without AVX, for p aligned to SIMD_BYTES. */
SIMD_INLINE vd vd_aligned(const double *p) { return *(const vd_memory *)p; }
SIMD_INLINE void vd_store_aligned(double *p, vd a) { *(vd_memory *)p = a; }
SIMD_INLINE vd vd_set(double a) { return a - (vd){0}; }
/* By intrinsics, because gcc 12 takes masks of SSE2 apart where they are joined. */
SIMD_INLINE vl vd_lt(vd a, vd b)
{
#if SIMD_BYTES == 32
    return (vl)_mm256_cmp_pd(a, b, _CMP_LT_OQ);
#elif SIMD_BYTES == 16 && defined SIMD_SSE2
    return (vl)_mm_cmplt_pd(a, b);
#else
    return (vl)(a < b);
#endif
}
SIMD_INLINE vl vd_le(vd a, vd b)
{
#if SIMD_BYTES == 32
    return (vl)_mm256_cmp_pd(a, b, _CMP_LE_OQ);
#elif SIMD_BYTES == 16 && defined SIMD_SSE2
    return (vl)_mm_cmple_pd(a, b);
#else
    return (vl)(a <= b);
#endif
}
SIMD_INLINE vd vd_abs(vd a) { return (vd)((vl)a & INT64_MAX); }
SIMD_INLINE vd vd_sqrt(vd a)
{
#if SIMD_BYTES == 64
    return _mm512_sqrt_pd(a);
#elif SIMD_BYTES == 32
    return _mm256_sqrt_pd(a);
#elif defined SIMD_SSE2
    return _mm_sqrt_pd(a);
#else
    for (int i = 0; i < VD; i++) a[i] = sqrt(a[i]);
    return a;
#endif
}
/* Per lane: a if m is all ones, b if m is all zeros. */
SIMD_INLINE vd vd_choose(vl m, vd a, vd b)
{
#if SIMD_BYTES == 64
    return (vd)_mm512_ternarylogic_epi64((__m512i)m, (__m512i)a, (__m512i)b, 0xca);
#elif SIMD_BYTES == 32
    return _mm256_blendv_pd(b, a, (vd)m);
#else
    return (vd)((m & (vl)a) | (~m & (vl)b));
#endif
}
/* a < b ? a : b, and a > b ? a : b. */
SIMD_INLINE vd vd_min(vd a, vd b)
{
#if SIMD_BYTES == 64
    return _mm512_min_pd(a, b);
#elif SIMD_BYTES == 32
    return _mm256_min_pd(a, b);
#elif defined SIMD_SSE2
    return _mm_min_pd(a, b);
#else
    return vd_choose(vd_lt(a, b), a, b);
#endif
}
SIMD_INLINE vd vd_max(vd a, vd b)
{
#if SIMD_BYTES == 64
    return _mm512_max_pd(a, b);
#elif SIMD_BYTES == 32
    return _mm256_max_pd(a, b);
#elif defined SIMD_SSE2
    return _mm_max_pd(a, b);
#else
    return vd_choose(vd_lt(b, a), a, b);
#endif
}
/* One bit per lane, lane 0 lowest: its sign. */
SIMD_INLINE unsigned vl_signs(vl m)
{
#if SIMD_BYTES == 64
    return _mm512_movepi64_mask((__m512i)m);
#elif SIMD_BYTES == 32
    return (unsigned)_mm256_movemask_pd((vd)m);
#elif defined SIMD_SSE2
    return (unsigned)_mm_movemask_pd((vd)m);
#else
    unsigned bits = 0;
    for (int i = 0; i < VD; i++) bits |= (unsigned)(m[i] < 0) << i;
    return bits;
#endif
}

/* ---- floats --------------------------------------------------------------------------------- */

SIMD_INLINE vf vf_load(const float *p)
{
    vf a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE void vf_store(float *p, vf a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vf vf_aligned(const float *p) { return *(const vf_memory *)p; }
SIMD_INLINE void vf_store_aligned(float *p, vf a) { *(vf_memory *)p = a; }
SIMD_INLINE vf vf_set(float a) { return a - (vf){0}; }
SIMD_INLINE vf vf_abs(vf a) { return (vf)((vi)a & INT32_MAX); }
SIMD_INLINE vf vf_choose(vi m, vf a, vf b)
{
#if SIMD_BYTES == 64
    return (vf)_mm512_ternarylogic_epi32((__m512i)m, (__m512i)a, (__m512i)b, 0xca);
#elif SIMD_BYTES == 32
    return _mm256_blendv_ps(b, a, (vf)m);
#else
    return (vf)((m & (vi)a) | (~m & (vi)b));
#endif
}
SIMD_INLINE vf vf_min(vf a, vf b)
{
#if SIMD_BYTES == 64
    return _mm512_min_ps(a, b);
#elif SIMD_BYTES == 32
    return _mm256_min_ps(a, b);
#elif defined SIMD_SSE2
    return _mm_min_ps(a, b);
#else
    return vf_choose(a < b, a, b);
#endif
}
SIMD_INLINE vf vf_max(vf a, vf b)
{
#if SIMD_BYTES == 64
    return _mm512_max_ps(a, b);
#elif SIMD_BYTES == 32
    return _mm256_max_ps(a, b);
#elif defined SIMD_SSE2
    return _mm_max_ps(a, b);
#else
    return vf_choose(a > b, a, b);
#endif
}
SIMD_INLINE unsigned vi_signs(vi m)
{
#if SIMD_BYTES == 64
    return _mm512_movepi32_mask((__m512i)m);
#elif SIMD_BYTES == 32
    return (unsigned)_mm256_movemask_ps((vf)m);
#elif defined SIMD_SSE2
    return (unsigned)_mm_movemask_ps((vf)m);
#else
    unsigned bits = 0;
    for (int i = 0; i < VF; i++) bits |= (unsigned)(m[i] < 0) << i;
    return bits;
#endif
}

/* ---- wide floats: 16 with AVX-512, whatever SIMD_MOST; otherwise as many as in a vf --------- */

#if defined __AVX512F__ && SIMD_BYTES >= 32
#define VW 16
#else
#define VW VF
#endif
typedef float vw __attribute__((vector_size(4 * VW)));
typedef int32_t vwi __attribute__((vector_size(4 * VW)));
typedef float vw_memory __attribute__((vector_size(4 * VW), may_alias));
typedef int32_t vwi_memory __attribute__((vector_size(4 * VW), may_alias));

SIMD_INLINE vw vw_aligned(const float *p) { return *(const vw_memory *)p; }
SIMD_INLINE void vw_store_aligned(float *p, vw a) { *(vw_memory *)p = a; }
SIMD_INLINE vw vw_set(float a) { return a - (vw){0}; }
SIMD_INLINE vw vw_abs(vw a) { return (vw)((vwi)a & INT32_MAX); }
/* a if b >= 0, -a otherwise: by the sign bits. */
SIMD_INLINE vw vw_flip(vw a, vw b) { return (vw)((vwi)a ^ ((vwi)b & INT32_MIN)); }
/* a < b ? a : b, and a > b ? a : b. */
SIMD_INLINE vw vw_min(vw a, vw b)
{
#if VW > VF
    return _mm512_min_ps(a, b);
#else
    return vf_min(a, b);
#endif
}
SIMD_INLINE vw vw_max(vw a, vw b)
{
#if VW > VF
    return _mm512_max_ps(a, b);
#else
    return vf_max(a, b);
#endif
}
/* a * b - c, with or without rounding of the product: for bounds only. */
SIMD_INLINE vw vw_mul_sub(vw a, vw b, vw c)
{
#if VW > VF
    return _mm512_fmsub_ps(a, b, c);
#else
    return a * b - c;
#endif
}
/* One bit per lane, lane 0 lowest: a <= b. */
SIMD_INLINE unsigned vw_le_bits(vw a, vw b)
{
#if VW > VF
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
#else
    return vi_signs((vi)(a <= b));
#endif
}
/* One bit per lane: a < 0. */
SIMD_INLINE unsigned vw_negative_bits(vw a)
{
#if VW > VF
    return _mm512_cmp_ps_mask(a, _mm512_setzero_ps(), _CMP_LT_OQ);
#else
    return vi_signs((vi)(a < vw_set(0)));
#endif
}
/* One bit per lane: p[lane] == a, for p aligned to the vector. */
SIMD_INLINE unsigned vw_equal_bits(const uint32_t *p, uint32_t a)
{
    vwi b = *(const vwi_memory *)p;
#if VW > VF
    return _mm512_cmpeq_epi32_mask((__m512i)b, _mm512_set1_epi32((int32_t)a));
#else
    return vi_signs((vi)(b == (int32_t)a - (vwi){0}));
#endif
}

#endif
