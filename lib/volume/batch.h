/*
 * batch: consecutive cells of one ray, whose cubics and integrals are computed side by side. A
 * cell's contribution depends on the cells in front only through the factor T.
 */
#ifndef STORMRING_VOLUME_BATCH_H
#define STORMRING_VOLUME_BATCH_H

#include <stdint.h>

#define BATCH 8

/*
 * Error bound for a piece of optical depth D whose colour c, of range R, is replaced by its
 * k-weighted mean: at most alpha R D / 8, for every c. In u = tau, 0 .. D, the error is D |cov(c,
 * g)| with g = exp(-u), so at most D R E(g - Eg)+ (as in G. Gruess, Math. Zeitschrift 39, 1935, but
 * for a known g). With a = D / 2, E(g - Eg)+ is alpha times
 *
 *     (a coth a - 1 + ln(sinh a / a)) / (4 a^2) <= (a^2 / 3 + a^2 / 6) / (4 a^2) = 1/8
 *
 * since a coth a is 1 plus the sum, and sinh a / a the product, over n = 1, 2, ... of 2 a^2 / (a^2
 * + n^2 pi^2) and 1 + a^2 / (n^2 pi^2).
 */
#define COVARIANCE (1.0 / 8)

struct span;
struct stream;
struct lattice;

struct batch {
    double o[3], d[3]; /* of the ray */
    uint32_t n;
    /* Input: entry and exit of each cell; lower planes; 1 / edge lengths; values at the corners, x
     * fastest. */
    double t0[BATCH], t1[BATCH], plane[3][BATCH], inv[3][BATCH];
    float corner[8][BATCH];
    /* Output of kernel->cubics: the field along the ray minus `corner[0]`; bounds of the field, not
     * minus it. */
    double p[4][BATCH], lo[BATCH], hi[BATCH];
    /* Input: the span; extinction and colour at its lower end and per unit of s. */
    const struct span *span[BATCH];
    double from[BATCH], k0[BATCH], k1[BATCH], rgb0[3][BATCH], rgb1[3][BATCH], slope[BATCH];
    /* Output of kernel->moments: optical depth, exp(-depth), the k-weighted mean colour, and a
     * bound on its error. */
    double depth[BATCH], through[BATCH], rgb[3][BATCH], error[BATCH];
};

struct kernel {
    void (*cubics)(struct batch *);
    void (*moments)(struct batch *);
    void (*rays)(struct stream *, const struct lattice *, uint64_t n0, uint32_t n);
};
const struct kernel *volume_kernel_sse2(void);
/* NULL if this build or this machine lacks the instructions. */
const struct kernel *volume_kernel_avx2(void);
const struct kernel *volume_kernel_avx512(void);

#endif
