/*
 * simd: vectors as wide as the including file's target allows. vf holds VF floats, vd holds VD
 * doubles. + - * / work per lane and are exactly the IEEE operations. Comparisons yield one bit per
 * lane, lane 0 lowest.
 */
#ifndef STORMRING_SIMD_H
#define STORMRING_SIMD_H

#include "base/base.h"

/* SIMD_SCALAR forces one lane, as on machines whose vectors are not known here. SIMD_NARROW allows
 * at most four. */
#if defined(__AVX2__) && !defined(SIMD_NARROW) && !defined(SIMD_SCALAR)

#include <immintrin.h>
#define VF 8
#define VD 4
typedef __m256 vf;
typedef __m256d vd;
static inline vf vf_load(const float *p) { return _mm256_load_ps(p); }
static inline void vf_store(float *p, vf a) { _mm256_store_ps(p, a); }
static inline vf vf_set(float a) { return _mm256_set1_ps(a); }
static inline vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
static inline vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
static inline float vf_least(vf a)
{
    __m128 b = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_min_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_min_ss(b, _mm_shuffle_ps(b, b, 1)));
}
static inline vf vf_abs(vf a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
static inline vf vf_neg(vf a) { return _mm256_xor_ps(_mm256_set1_ps(-0.0f), a); }
/* Magnitude of a, sign of b. */
static inline vf vf_copysign(vf a, vf b)
{
    vf sign = _mm256_set1_ps(-0.0f);
    return _mm256_or_ps(_mm256_andnot_ps(sign, a), _mm256_and_ps(sign, b));
}
static inline unsigned vf_le(vf a, vf b)
{
    return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
}
static inline void vf_trunc(int32_t *p, vf a)
{
    _mm256_storeu_si256((__m256i *)(void *)p, _mm256_cvttps_epi32(a));
}
static inline vd vd_load(const double *p) { return _mm256_load_pd(p); }
static inline void vd_store(double *p, vd a) { _mm256_store_pd(p, a); }
static inline vd vd_set(double a) { return _mm256_set1_pd(a); }
static inline vd vd_sqrt(vd a) { return _mm256_sqrt_pd(a); }
static inline vd vd_abs(vd a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
static inline vd vd_and(vd a, vd b) { return _mm256_and_pd(a, b); }
static inline vd vd_le(vd a, vd b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
static inline vd vd_lt(vd a, vd b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
/* Per lane: a if m is all ones, b if m is all zeros. */
static inline vd vd_choose(vd m, vd a, vd b) { return _mm256_blendv_pd(b, a, m); }
static inline unsigned vd_bits(vd m) { return (unsigned)_mm256_movemask_pd(m); }

#elif defined(__SSE2__) && !defined(SIMD_SCALAR)

#include <emmintrin.h>
#define VF 4
#define VD 2
typedef __m128 vf;
typedef __m128d vd;
static inline vf vf_load(const float *p) { return _mm_load_ps(p); }
static inline void vf_store(float *p, vf a) { _mm_store_ps(p, a); }
static inline vf vf_set(float a) { return _mm_set1_ps(a); }
static inline vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
static inline vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }
static inline float vf_least(vf a)
{
    a = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps(a, a, 1)));
}
static inline vf vf_abs(vf a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
static inline vf vf_neg(vf a) { return _mm_xor_ps(_mm_set1_ps(-0.0f), a); }
static inline vf vf_copysign(vf a, vf b)
{
    vf sign = _mm_set1_ps(-0.0f);
    return _mm_or_ps(_mm_andnot_ps(sign, a), _mm_and_ps(sign, b));
}
static inline unsigned vf_le(vf a, vf b) { return (unsigned)_mm_movemask_ps(_mm_cmple_ps(a, b)); }
static inline void vf_trunc(int32_t *p, vf a)
{
    _mm_storeu_si128((__m128i *)(void *)p, _mm_cvttps_epi32(a));
}
static inline vd vd_load(const double *p) { return _mm_load_pd(p); }
static inline void vd_store(double *p, vd a) { _mm_store_pd(p, a); }
static inline vd vd_set(double a) { return _mm_set1_pd(a); }
static inline vd vd_sqrt(vd a) { return _mm_sqrt_pd(a); }
static inline vd vd_abs(vd a) { return _mm_andnot_pd(_mm_set1_pd(-0.0), a); }
static inline vd vd_and(vd a, vd b) { return _mm_and_pd(a, b); }
static inline vd vd_le(vd a, vd b) { return _mm_cmple_pd(a, b); }
static inline vd vd_lt(vd a, vd b) { return _mm_cmplt_pd(a, b); }
static inline vd vd_choose(vd m, vd a, vd b)
{
    return _mm_or_pd(_mm_and_pd(m, a), _mm_andnot_pd(m, b));
}
static inline unsigned vd_bits(vd m) { return (unsigned)_mm_movemask_pd(m); }

#else /* one lane; masks are 1 and 0 */

#define VF 1
#define VD 1
typedef float vf;
typedef double vd;
static inline vf vf_load(const float *p) { return *p; }
static inline void vf_store(float *p, vf a) { *p = a; }
static inline vf vf_set(float a) { return a; }
static inline vf vf_min(vf a, vf b) { return a < b ? a : b; }
static inline vf vf_max(vf a, vf b) { return a > b ? a : b; }
static inline float vf_least(vf a) { return a; }
static inline vf vf_abs(vf a) { return fabsf(a); }
static inline vf vf_neg(vf a) { return -a; }
static inline vf vf_copysign(vf a, vf b) { return copysignf(a, b); }
static inline unsigned vf_le(vf a, vf b) { return a <= b; }
static inline void vf_trunc(int32_t *p, vf a) { *p = (int32_t)a; }
static inline vd vd_load(const double *p) { return *p; }
static inline void vd_store(double *p, vd a) { *p = a; }
static inline vd vd_set(double a) { return a; }
static inline vd vd_sqrt(vd a) { return sqrt(a); }
static inline vd vd_abs(vd a) { return fabs(a); }
static inline vd vd_and(vd a, vd b) { return a * b; }
static inline vd vd_le(vd a, vd b) { return a <= b; }
static inline vd vd_lt(vd a, vd b) { return a < b; }
static inline vd vd_choose(vd m, vd a, vd b) { return m != 0 ? a : b; }
static inline unsigned vd_bits(vd m) { return m != 0; }

#endif
#endif
