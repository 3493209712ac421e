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

/* k times the range of r. start: k at the start. */
SIMD_INLINE vf rest_range(const vf q[4], vf k, vf k1, vf start, vf rise)
{
    vf bend = rise * k1, zero = vf_set(0);
    vf r1 = k * q[1] - rise * start, r2 = k * q[2] - bend * q[1] * 0.5f;
    vf r3 = k * q[3] - bend * q[2] * (1.0f / 3);
    vf b1 = r1 * 0.25f, b2 = r1 * 0.5f + r2 * (1.0f / 6);
    vf b3 = r1 * 0.75f + r2 * 0.5f + r3 * 0.25f;
    return vf_max(vf_max(b1, b2), vf_max(b3, zero)) - vf_min(vf_min(b1, b2), vf_min(b3, zero));
}

/* (1 - exp(-d)) / d for d in 0 .. 1, to within 2^-23: polynomial through the Chebyshev nodes. */
SIMD_INLINE vf thin_share(vf d)
{
    vf d2 = d * d;
    return (0.9999999329f - d * 0.4999951599f) + d2 * (0.1666096712f - d * 0.04141876303f) +
           d2 * d2 * (0.007837363802f - d * 0.0009125453917f);
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
    vf k = k0 + k1 * one, depth = k * len, rise = q[1] + q[2] + q[3], square = depth * depth;
    vi seen = depth > vf_set(0), thick = depth >= vf_set(1);
    vf slope = vf_lookup(m->slope, few, e) * (float)COVARIANCE;
    vf error = slope * len * rest_range(q, k, k1, k0 + k1 * q[0], rise);
    vf per_k = vf_choose(seen, len * thin_share(depth), vf_set(0)), alpha = k * per_k;
    vf lag = depth * ((square * (1.0f / 720) - 1.0f / 12) - square * square * (1.0f / 30240));
    if (vi_signs(thick)) {
        vf by_k = 1 / k, through = vf_exp(-depth), thick_alpha = 1 - through;
        vf range = rest_range(q, vf_set(1), k1, k0 + k1 * q[0], rise * by_k);
        alpha = vf_choose(thick, thick_alpha, alpha);
        per_k = vf_choose(thick, thick_alpha * by_k, per_k);
        lag = vf_choose(thick, 1 / depth - through / thick_alpha - 0.5f, lag);
        error = vf_choose(thick, slope * range * depth, error);
    }
    vf moment = alpha * (one + rise * lag) + k1 * variance * per_k;
    r.alpha = alpha;
    r.error = error;
    UNROLLED
    for (int c = 0; c < 3; c++)
        r.rgb[c] = vf_lookup(m->rgb0[c], few, e) * alpha + vf_lookup(m->rgb1[c], few, e) * moment;
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
