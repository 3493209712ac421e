/*
 * batch: cells of one ray, in order, whose cubics and integrals are worked out side by side. What
 * a cell adds does not depend on what is in front of it, but for the factor T.
 */
#ifndef STORMRING_VOLUME_BATCH_H
#define STORMRING_VOLUME_BATCH_H

#include <stdint.h>

#define BATCH 8

/*
 * What a piece of optical depth D is wrong by where its colour c, of range R, is replaced by its
 * k-weighted mean: no more than alpha R D / 8, whatever c is. In u = tau, 0 .. D, the error is
 * D |cov(c, g)| with g = exp(-u), so at most D R E(g - Eg)+ (as in G. Gruess, Math. Zeitschrift 39,
 * 1935, but for a g that is known). With a = D / 2, E(g - Eg)+ is alpha times
 *
 *     (a coth a - 1 + ln(sinh a / a)) / (4 a^2) <= (a^2 / 3 + a^2 / 6) / (4 a^2) = 1/8
 *
 * since a coth a is 1 plus the sum, and sinh a / a the product, over n = 1, 2, ... of
 * 2 a^2 / (a^2 + n^2 pi^2) and 1 + a^2 / (n^2 pi^2).
 */
#define COVARIANCE (1.0 / 8)

struct span;
struct stream;
struct lattice;

struct batch {
    double o[3], d[3]; /* of the ray */
    uint32_t n;
    /* Given: where the ray is in them; the lower planes, 1 / edges; values at the corners, x
     * fastest. */
    double t0[BATCH], t1[BATCH], plane[3][BATCH], inv[3][BATCH];
    float corner[8][BATCH];
    /* By kernel->cubics: the field less `corner[0]` along the ray, and its bounds with it. */
    double p[4][BATCH], lo[BATCH], hi[BATCH];
    /* Given: the span; extinction and colours at its lower end, and by unit of s. */
    const struct span *span[BATCH];
    double from[BATCH], k0[BATCH], k1[BATCH], rgb0[3][BATCH], rgb1[3][BATCH], slope[BATCH];
    /* By kernel->moments: optical depth, exp(-depth), the k-weighted mean colour, and what that may
     * be wrong by. */
    double depth[BATCH], through[BATCH], rgb[3][BATCH], error[BATCH];
};

struct kernel {
    void (*cubics)(struct batch *);
    void (*moments)(struct batch *);
    void (*rays)(struct stream *, const struct lattice *, uint64_t n0, uint32_t n);
};
const struct kernel *kernel_sse2(void);
/* NULL where this machine has no such instructions. */
const struct kernel *kernel_avx2(void);
const struct kernel *kernel_avx512(void);

#endif
