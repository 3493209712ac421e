/* stream_cell: what the cells of the list add, LANES at a time. */
#ifndef STORMRING_VOLUME_STREAM_CELL_H
#define STORMRING_VOLUME_STREAM_CELL_H

#include "volume/simd.h"
#include "volume/stream.h"

/* ---- corners -------------------------------------------------------------------------------- */

#ifdef __AVX2__
SIMD_INLINE __m128 two_pairs(const float *p, const float *q)
{
    double a, b; /* two floats each */
    memcpy(&a, p, sizeof a);
    memcpy(&b, q, sizeof b);
    return _mm_castpd_ps(_mm_set_pd(b, a));
}
/* The values at the nodes, and at the next along x. */
SIMD_INLINE void pairs(const float *value, const int64_t *node, vf *low, vf *high)
{
    __m256 a = _mm256_set_m128(
        two_pairs(value + node[4], value + node[5]), two_pairs(value + node[0], value + node[1]));
    __m256 b = _mm256_set_m128(
        two_pairs(value + node[6], value + node[7]), two_pairs(value + node[2], value + node[3]));
    *low = _mm256_shuffle_ps(a, b, 0x88);
    *high = _mm256_shuffle_ps(a, b, 0xdd);
}
#else
SIMD_INLINE void pairs(const float *value, const int64_t *node, vf *low, vf *high)
{
    for (int i = 0; i < LANES; i++) {
        (*low)[i] = value[node[i]];
        (*high)[i] = value[node[i] + 1];
    }
}
#endif

/* ---- the field along the ray ---------------------------------------------------------------- */

struct cubics {
    vf base, p[4]; /* less base */
};

/* As cell_init. */
SIMD_INLINE struct cubics cubics(const struct stream *s, uint32_t j)
{
    struct cubics c;
    const float *value = s->v->value;
    const ptrdiff_t row = s->v->row, layer = s->v->layer;
    vf o, fx, fy, sxy, fz, sxz, syz, sxyz;
    pairs(value, s->node + j, &o, &fx);
    pairs(value + row, s->node + j, &fy, &sxy);
    pairs(value + layer, s->node + j, &fz, &sxz);
    pairs(value + row + layer, s->node + j, &syz, &sxyz);
    fx -= o, fy -= o, sxy -= o, fz -= o, sxz -= o, syz -= o, sxyz -= o;
    vf x = vf_load(s->from[0] + j), y = vf_load(s->from[1] + j), z = vf_load(s->from[2] + j);
    vf dx = vf_load(s->way[0] + j), dy = vf_load(s->way[1] + j), dz = vf_load(s->way[2] + j);
    vf fxy = sxy - fx - fy, fxz = sxz - fx - fz, fyz = syz - fy - fz;
    vf fxyz = sxyz - sxy - syz - fxz + fy;
    vf xy = fxy + fxyz * z, xz = fxz + fxyz * y, yz = fyz + fxyz * x;
    vf by_y = fy + fxy * x, by_z = fz + fxz * x + y * yz;
    c.base = o;
    c.p[0] = fx * x + y * by_y + z * by_z;
    c.p[1] = dx * (fx + fxy * y + z * xz) + dy * (by_y + z * yz) + dz * by_z;
    c.p[2] = dx * (dy * xy + dz * xz) + dy * dz * yz;
    c.p[3] = dx * dy * dz * fxyz;
    return c;
}

/* Bounds: the control points'. */
SIMD_INLINE void bounds(const vf p[4], vf *lo, vf *hi)
{
    vf b1 = p[0] + p[1] * (1.0f / 3), b2 = b1 + (p[1] + p[2]) * (1.0f / 3);
    vf b3 = p[0] + p[1] + p[2] + p[3];
    *lo = vf_min(vf_min(p[0], b1), vf_min(b2, b3));
    *hi = vf_max(vf_max(p[0], b1), vf_max(b2, b3));
}

/* ---- the map -------------------------------------------------------------------------------- */

#define FEW_EDGES 12 /* are looked at one by one */

/* The entries of the map that hold at lo and hi, both less base. */
SIMD_INLINE void entries(const struct stream_map *m, vf base, vf lo, vf hi, vi *first, vi *last)
{
    vi a = {0}, b = {0};
    for (uint32_t i = 0; i + 1 < m->edges; i++) {
        vf y = (m->edge_high[i] - base) + m->edge_low[i];
        a -= y <= lo;
        b -= y <= hi;
    }
    vf y = (m->edge_high[m->edges - 1] - base) + m->edge_low[m->edges - 1];
    *first = a - (m->closed ? y < lo : y <= lo);
    *last = b - (m->closed ? y < hi : y <= hi);
}

/* ---- what a stretch adds -------------------------------------------------------------------- */

struct added {
    vf rgb[3], alpha;
    vi rough; /* the colour is not within the tolerance */
};

/* The mean of the field, weighted by k exp(-depth): by quadrature, as gauss of integrate.c. */
SIMD_INLINE vf mean_by_nodes(const struct volume *v, const vf q[4], vf k0, vf k1, vf len)
{
    vf sum = vf_set(0), first = vf_set(0);
    for (int i = 0; i < v->m; i++) {
        const float x = (float)v->node[i], weight = (float)v->weight[i];
        vf mean =
            q[0] + x * (q[1] * (1.0f / 2) + x * (q[2] * (1.0f / 3) + x * (q[3] * (1.0f / 4))));
        vf s = q[0] + x * (q[1] + x * (q[2] + x * q[3]));
        vf w = weight * (k0 + k1 * s) * vf_exp(-(x * (k0 + k1 * mean) * len));
        sum += w;
        first += w * s;
    }
    return first / vf_choose(sum > vf_set(0), sum, vf_set(1));
}

/*
 * Of stretches of length len in the map's entries e, where the field is base + p and ranges as
 * far: from exact moments, as in integrate.c, and where these are not good enough by quadrature.
 * few: as of vf_lookup; fine: look for those.
 */
SIMD_INLINE struct added stretch(
    const struct stream *s, bool few, bool fine, vi e, vf base, const vf p[4], vf range, vf len)
{
    const struct stream_map *m = &s->map;
    struct added r;
    vf k0 = vf_lookup(m->k0, few, e), k1 = vf_lookup(m->k1, few, e);
    vf q0 = p[0] - ((vf_lookup(m->from_high, few, e) - base) + vf_lookup(m->from_low, few, e));
    vf q1 = p[1], q2 = p[2], q3 = p[3];
    vf one = q0 + q1 * (1.0f / 2) + q2 * (1.0f / 3) + q3 * (1.0f / 4);
    /* Its variance, as a sum of Legendre polynomials: the mean of the square is one^2 and that. */
    vf slant = q1 + q2 + q3 * 0.9f, bend = q2 + q3 * 1.5f;
    vf variance =
        slant * slant * (1.0f / 12) + bend * bend * (1.0f / 180) + q3 * q3 * (1.0f / 2800);
    vf k = k0 + k1 * one, depth = k * len;
    vi seen = depth > vf_set(0);
    vf mean = one + k1 * variance / vf_choose(seen, k, vf_set(1));
    vf error = vf_lookup(m->slope, few, e) * range * depth * (float)COVARIANCE;
    r.rough = ~(error <= vf_set(s->tolerance));
    if (fine && vi_signs(r.rough)) {
        const vf q[4] = {q0, q1, q2, q3};
        mean = vf_choose(r.rough, mean_by_nodes(s->v, q, k0, k1, len), mean);
        vi straight = vf_abs(q2) + vf_abs(q3) <= (float)BEND_MAX * range;
        r.rough &= ~(straight & (depth <= vf_set((float)DEPTH_MAX)));
    }
    r.alpha = vf_choose(seen, 1 - vf_exp(-depth), vf_set(0));
    UNROLLED
    for (int c = 0; c < 3; c++)
        r.rgb[c] = r.alpha * (vf_lookup(m->rgb0[c], few, e) + vf_lookup(m->rgb1[c], few, e) * mean);
    return r;
}

/* A row for each lane. */
SIMD_INLINE void put_added(float (*to)[4], const struct added *r)
{
#ifdef __AVX2__
    __m256 rg_low = _mm256_unpacklo_ps(r->rgb[0], r->rgb[1]);
    __m256 rg_high = _mm256_unpackhi_ps(r->rgb[0], r->rgb[1]);
    __m256 ba_low = _mm256_unpacklo_ps(r->rgb[2], r->alpha);
    __m256 ba_high = _mm256_unpackhi_ps(r->rgb[2], r->alpha);
    const __m256 row[4] = {/* row i and, behind it, i + 4 */
        _mm256_shuffle_ps(rg_low, ba_low, 0x44), _mm256_shuffle_ps(rg_low, ba_low, 0xee),
        _mm256_shuffle_ps(rg_high, ba_high, 0x44), _mm256_shuffle_ps(rg_high, ba_high, 0xee)};
    vf_store(to[0], _mm256_permute2f128_ps(row[0], row[1], 0x20));
    vf_store(to[2], _mm256_permute2f128_ps(row[2], row[3], 0x20));
    vf_store(to[4], _mm256_permute2f128_ps(row[0], row[1], 0x31));
    vf_store(to[6], _mm256_permute2f128_ps(row[2], row[3], 0x31));
#else
    for (int i = 0; i < LANES; i++) {
        to[i][0] = r->rgb[0][i], to[i][1] = r->rgb[1][i], to[i][2] = r->rgb[2][i];
        to[i][3] = r->alpha[i];
    }
#endif
}

SIMD_INLINE void cells_by(struct stream *s, bool few)
{
    const struct stream_map *m = &s->map;
    /* What is behind the end is some cell. */
    for (uint32_t j = s->cells; j % LANES; j++) s->node[j] = s->node[0];
    for (uint32_t j = 0; j < s->cells; j += LANES) {
        struct cubics c = cubics(s, j);
        vf lo, hi;
        vi first, last;
        bounds(c.p, &lo, &hi);
        entries(m, c.base, lo, hi, &first, &last);
        struct added r = stretch(s, few, false, first, c.base, c.p, hi - lo, vf_load(s->len + j));
        unsigned simple = vi_signs((first == last) & ~r.rough);
        put_added(s->add + j, &r);
        s->simple[j / LANES] = (uint8_t)simple;
        UNROLLED
        for (int i = 0; i < 4; i++) vf_store(s->p[i] + j, c.p[i]);
        vf_store(s->base + j, c.base);
        vi_store(s->first + j, first);
        vi_store(s->last + j, last);
    }
}
static void cells(struct stream *s)
{
    if (s->map.entries <= 8) cells_by(s, true);
    else cells_by(s, false);
}

#endif
