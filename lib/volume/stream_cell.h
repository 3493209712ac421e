/* stream_cell: the contributions of segments of the cells of the list, VF at a time. */
#ifndef STORMRING_VOLUME_STREAM_CELL_H
#define STORMRING_VOLUME_STREAM_CELL_H

#include "volume/stream_field.h"

/* ---- what a segment adds -------------------------------------------------------------------- */

/*
 * The colour of a segment of optical depth D is the mean of c, weighted by exp(-u), u = tau from 0
 * to D. Let c be its mean over u, a part that is linear in u, and a remainder r. The mean comes
 * from exact moments. The linear part rises by c(end) - c(begin), so r has the same value at both
 * ends. It contributes its rise times
 *
 *     1 / D - 1 / (exp(D) - 1) - 1 / 2 = -D / 12 + D^3 / 720 - D^5 / 30240 + ...
 *
 * r is omitted; it would contribute at most its range times D / 8 (see COVARIANCE). Within an entry
 * of the map c is linear in the field q, and u is the integral of k0 + k1 q. So r is a polynomial
 * of degree 4 along the ray, within the range of its control points.
 */
struct added {
    vf rgb[3], alpha;
    vf error; /* bound on the colour's error, per alpha */
};

/* The factor of the linear part's rise. through: exp(-depth). */
SIMD_INLINE vf lag(vf depth, vf through, vf alpha)
{
    vf square = depth * depth;
    vf few = depth * ((square * (1.0f / 720) - 1.0f / 12) - square * square * (1.0f / 30240));
    vi deep = depth >= vf_set(1);
    if (!vi_signs(deep)) return few;
    return vf_choose(deep, 1 / depth - through / alpha - 0.5f, few);
}

/* The range of r. k0: k at the start; slope: rise of q per unit of k. */
SIMD_INLINE vf rest_range(const vf q[4], vf k0, vf k1, vf slope)
{
    vf bend = slope * k1, zero = vf_set(0);
    vf r1 = q[1] - slope * k0, r2 = q[2] - bend * q[1] * 0.5f;
    vf r3 = q[3] - bend * q[2] * (1.0f / 3);
    vf b1 = r1 * 0.25f, b2 = r1 * 0.5f + r2 * (1.0f / 6);
    vf b3 = r1 * 0.75f + r2 * 0.5f + r3 * 0.25f;
    return vf_max(vf_max(b1, b2), vf_max(b3, zero)) - vf_min(vf_min(b1, b2), vf_min(b3, zero));
}

/* Integrates segments of length len in the map's entries e, where the field is base + p. few: see
 * vf_lookup. */
SIMD_INLINE struct added integrate_segment(
    const struct stream_map *m, bool few, vi e, vf base, const vf p[4], vf len)
{
    struct added r;
    vf k0 = vf_lookup(m->k0, few, e), k1 = vf_lookup(m->k1, few, e);
    vf from = (vf_lookup(m->from_high, few, e) - base) + vf_lookup(m->from_low, few, e);
    const vf q[4] = {p[0] - from, p[1], p[2], p[3]};
    vf one = q[0] + q[1] * (1.0f / 2) + q[2] * (1.0f / 3) + q[3] * (1.0f / 4);
    /* The variance, as a sum of Legendre polynomials. The mean square is one^2 plus the
     * variance. */
    vf slant = q[1] + q[2] + q[3] * 0.9f, bend = q[2] + q[3] * 1.5f;
    vf variance =
        slant * slant * (1.0f / 12) + bend * bend * (1.0f / 180) + q[3] * q[3] * (1.0f / 2800);
    vf k = k0 + k1 * one, depth = k * len, rise = q[1] + q[2] + q[3];
    vi seen = depth > vf_set(0);
    vf by_k = 1 / vf_choose(seen, k, vf_set(1)), through = vf_exp(-depth);
    vf range = rest_range(q, k0 + k1 * q[0], k1, rise * by_k);
    r.alpha = vf_choose(seen, 1 - through, vf_set(0));
    r.error = vf_lookup(m->slope, few, e) * range * depth * (float)COVARIANCE;
    vf mean = one + k1 * variance * by_k + rise * lag(depth, through, 1 - through);
    mean = vf_choose(seen, mean, vf_set(0));
    UNROLLED
    for (int c = 0; c < 3; c++)
        r.rgb[c] = r.alpha * (vf_lookup(m->rgb0[c], few, e) + vf_lookup(m->rgb1[c], few, e) * mean);
    return r;
}

#if SIMD_BYTES >= 32
SIMD_INLINE void put_eight(float (*to)[4], __m256 r, __m256 g, __m256 b, __m256 a)
{
    __m256 rg_low = _mm256_unpacklo_ps(r, g), rg_high = _mm256_unpackhi_ps(r, g);
    __m256 ba_low = _mm256_unpacklo_ps(b, a), ba_high = _mm256_unpackhi_ps(b, a);
    const __m256 row[4] = {/* row i, followed by row i + 4 */
        _mm256_shuffle_ps(rg_low, ba_low, 0x44), _mm256_shuffle_ps(rg_low, ba_low, 0xee),
        _mm256_shuffle_ps(rg_high, ba_high, 0x44), _mm256_shuffle_ps(rg_high, ba_high, 0xee)};
    _mm256_storeu_ps(to[0], _mm256_permute2f128_ps(row[0], row[1], 0x20));
    _mm256_storeu_ps(to[2], _mm256_permute2f128_ps(row[2], row[3], 0x20));
    _mm256_storeu_ps(to[4], _mm256_permute2f128_ps(row[0], row[1], 0x31));
    _mm256_storeu_ps(to[6], _mm256_permute2f128_ps(row[2], row[3], 0x31));
}
#endif
/* Writes one row per lane. */
SIMD_INLINE void put_added(float (*to)[4], const struct added *r)
{
#if SIMD_BYTES == 64
    put_eight(to, _mm512_castps512_ps256(r->rgb[0]), _mm512_castps512_ps256(r->rgb[1]),
        _mm512_castps512_ps256(r->rgb[2]), _mm512_castps512_ps256(r->alpha));
    put_eight(to + 8, _mm512_extractf32x8_ps(r->rgb[0], 1), _mm512_extractf32x8_ps(r->rgb[1], 1),
        _mm512_extractf32x8_ps(r->rgb[2], 1), _mm512_extractf32x8_ps(r->alpha, 1));
#elif SIMD_BYTES == 32
    put_eight(to, r->rgb[0], r->rgb[1], r->rgb[2], r->alpha);
#else
    for (int i = 0; i < VF; i++) {
        to[i][0] = r->rgb[0][i], to[i][1] = r->rgb[1][i], to[i][2] = r->rgb[2][i];
        to[i][3] = r->alpha[i];
    }
#endif
}

#endif
