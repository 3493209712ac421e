/* math: the numbers that trace_pow and its version for vectors share. */
#ifndef STORMRING_TRACE_MATH_H
#define STORMRING_TRACE_MATH_H

#define LOG2_E 1.4426950408889634074
#define LN_2 0.69314718055994530942
#define LOG2_LOW 0.70710678118654752 /* the least mantissa: sqrt(1/2) */
#define EXP2_LEAST (-1021.0)         /* 2^y is normal above it */
#define POW_LEAST 1e-300             /* powers of smaller numbers are 0 */

/* Of 2 atanh(s) = 2 s + 2 s z (c[0] + c[1] z + ...), where z = s^2; and of exp(f) = 1 + f + f^2
 * (c[0] + c[1] f + ...). */
static const double trace_log2_terms[] = {
    1.0 / 3, 1.0 / 5, 1.0 / 7, 1.0 / 9, 1.0 / 11, 1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21};
static const double trace_exp2_terms[] = {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720,
    1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600,
    1.0 / 6227020800};

#endif
