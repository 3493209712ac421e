/*
 * math: the transcendental functions that pixels depend on. A C library's versions may differ in
 * the last bit between hosts, because the library picks FMA variants at run time. These are plain
 * sums and products of doubles.
 */
#include "trace/math.h"
#include "trace/trace_int.h"

#include <string.h>

/* log2 of a normal x > 0: x = m 2^e with m in [sqrt(1/2), sqrt 2), log m = 2 atanh((m-1)/(m+1)). */
static double log2_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int e = (int)(bits >> 52) - 1022;
    bits = (bits & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x3fe0000000000000);
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m < LOG2_LOW) {
        m *= 2;
        e--;
    }
    double s = (m - 1) / (m + 1), z = s * s; /* z < .0295: the first omitted term is below 1e-17 */
    const double *c = trace_log2_terms;
    /* Estrin's scheme (pairs, then pairs of pairs): shorter dependency chains than Horner's. */
    double z2 = z * z, z4 = z2 * z2;
    double p = (c[0] + c[1] * z) + (c[2] + c[3] * z) * z2 +
               ((c[4] + c[5] * z) + (c[6] + c[7] * z) * z2) * z4 + (c[8] + c[9] * z) * (z4 * z4);
    return (double)e + 2 * LOG2_E * (s + s * z * p);
}

/* 2^y for y <= 0. Returns 0 if the result would not be a normal number. */
static double exp2_of(double y)
{
    if (!(y > EXP2_LEAST)) return 0;
    int n = (int)(y - 0.5);
    double f = (y - n) * LN_2; /* |f| <= ln 2 / 2 */
    const double *c = trace_exp2_terms;
    double f2 = f * f, f4 = f2 * f2;
    double q = (c[0] + c[1] * f) + (c[2] + c[3] * f) * f2 +
               ((c[4] + c[5] * f) + (c[6] + c[7] * f) * f2) * f4 +
               ((c[8] + c[9] * f) + (c[10] + c[11] * f) * f2) * (f4 * f4);
    double p = 1 + (f + f2 * q);
    uint64_t bits = (uint64_t)(n + 1023) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return p * scale;
}

double trace_pow(double x, double y)
{
    if (x < POW_LEAST) return 0;
    if (x >= 1) return 1;
    return exp2_of(y * log2_of(x));
}
