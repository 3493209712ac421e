/*
 * exp: of sums and products of doubles only. A C library's own differs in the last bit from host
 * to host, as it picks variants with FMA at run time.
 */
#include "volume/volume_int.h"

#include <string.h>

#define LOG2_E 1.4426950408889634074
#define LN_2_HIGH 0.693147180369123816490 /* 33 bits: n times it is exact */
#define LN_2_LOW 1.90821492927058770002e-10

double volume_exp(double x)
{
    if (!(x > -700)) return 0;
    int n = (int)(x * LOG2_E - 0.5);
    double f = (x - n * LN_2_HIGH) - n * LN_2_LOW; /* |f| <= ln 2 / 2 */
    static const double c[] = {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040,
        1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600,
        1.0 / 6227020800};
    double f2 = f * f, f4 = f2 * f2;
    double q = (c[0] + c[1] * f) + (c[2] + c[3] * f) * f2 +
               ((c[4] + c[5] * f) + (c[6] + c[7] * f) * f2) * f4 +
               ((c[8] + c[9] * f) + (c[10] + c[11] * f) * f2) * (f4 * f4);
    uint64_t bits = (uint64_t)(n + 1023) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return (1 + (f + f2 * q)) * scale;
}
