/*
 * simd: vectors of VD doubles, as wide as the file that includes this is compiled for, by the
 * compilers' own vectors: + - * / work lane by lane, each exactly the IEEE operation, so that the
 * width changes no bit.
 */
#ifndef STORMRING_VOLUME_SIMD_H
#define STORMRING_VOLUME_SIMD_H

#include "base/base.h"

#include <string.h>

#ifdef __AVX2__
#define VD 4
#else
#define VD 2
#endif
typedef double vd __attribute__((vector_size(8 * VD)));
typedef float vf __attribute__((vector_size(4 * VD)));
typedef int64_t vl __attribute__((vector_size(8 * VD)));

#define SIMD_INLINE static inline __attribute__((always_inline))

SIMD_INLINE vd vd_load(const double *p)
{
    vd a;
    memcpy(&a, p, sizeof a);
    return a;
}
SIMD_INLINE vd vd_widen(const float *p)
{
    vf a;
    memcpy(&a, p, sizeof a);
    return __builtin_convertvector(a, vd);
}
SIMD_INLINE void vd_store(double *p, vd a) { memcpy(p, &a, sizeof a); }
SIMD_INLINE vd vd_set(double a) { return a - (vd){0}; }
/* m's lanes all ones: a, all zeros: b */
SIMD_INLINE vd vd_choose(vl m, vd a, vd b) { return (vd)((m & (vl)a) | (~m & (vl)b)); }
SIMD_INLINE vd vd_min(vd a, vd b) { return vd_choose((vl)(a < b), a, b); }
SIMD_INLINE vd vd_max(vd a, vd b) { return vd_choose((vl)(a > b), a, b); }

/* exp(x) for x <= 0, as volume_exp. */
SIMD_INLINE vd vd_exp(vd x)
{
    const vd log2_e = vd_set(1.4426950408889634074);
    const vd ln2_high = vd_set(0.693147180369123816490),
             ln2_low = vd_set(1.90821492927058770002e-10);
    const vd round = vd_set(0x1.8p52); /* its last bits are then n */
    vd sum = x * log2_e + round, n = sum - round;
    vd f = (x - n * ln2_high) - n * ln2_low, f2 = f * f, f4 = f2 * f2;
    vd q = (1.0 / 2 + 1.0 / 6 * f) + (1.0 / 24 + 1.0 / 120 * f) * f2 +
           ((1.0 / 720 + 1.0 / 5040 * f) + (1.0 / 40320 + 1.0 / 362880 * f) * f2) * f4 +
           ((1.0 / 3628800 + 1.0 / 39916800 * f) + (1.0 / 479001600 + 1.0 / 6227020800 * f) * f2) *
               (f4 * f4);
    vd scale = (vd)(((vl)sum + 1023) << 52);
    return vd_choose((vl)(x > vd_set(-700)), (1 + (f + f2 * q)) * scale, vd_set(0));
}

#endif
