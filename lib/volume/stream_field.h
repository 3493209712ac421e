/* stream_field: the field in the cells of the list, VF at a time. */
#ifndef STORMRING_VOLUME_STREAM_FIELD_H
#define STORMRING_VOLUME_STREAM_FIELD_H

#include "volume/stream_simd.h"
#include "volume/stream.h"

/* ---- corners -------------------------------------------------------------------------------- */

#if SIMD_BYTES >= 32
SIMD_INLINE __m128 two_pairs(const float *p, const float *q)
{
    double a, b; /* two floats each */
    memcpy(&a, p, sizeof a);
    memcpy(&b, q, sizeof b);
    return _mm_castpd_ps(_mm_set_pd(b, a));
}
SIMD_INLINE void eight_pairs(const float *value, const int64_t *node, __m256 *low, __m256 *high)
{
    __m256 a = _mm256_set_m128(
        two_pairs(value + node[4], value + node[5]), two_pairs(value + node[0], value + node[1]));
    __m256 b = _mm256_set_m128(
        two_pairs(value + node[6], value + node[7]), two_pairs(value + node[2], value + node[3]));
    *low = _mm256_shuffle_ps(a, b, 0x88);
    *high = _mm256_shuffle_ps(a, b, 0xdd);
}
#endif
/* The values at the nodes and at their neighbours along x. */
SIMD_INLINE void pairs(const float *value, const int64_t *node, vf *low, vf *high)
{
#if SIMD_BYTES == 64
    __m256 a, b, c, d;
    eight_pairs(value, node, &a, &b);
    eight_pairs(value, node + 8, &c, &d);
    *low = _mm512_insertf32x8(_mm512_castps256_ps512(a), c, 1);
    *high = _mm512_insertf32x8(_mm512_castps256_ps512(b), d, 1);
#elif SIMD_BYTES == 32
    __m256 a, b;
    eight_pairs(value, node, &a, &b);
    *low = a, *high = b;
#else
    for (int i = 0; i < VF; i++) {
        (*low)[i] = value[node[i]];
        (*high)[i] = value[node[i] + 1];
    }
#endif
}

/* ---- the field along the ray ---------------------------------------------------------------- */

struct cubics {
    vf base, p[4]; /* minus base */
    vf range;      /* the greatest difference of a corner from base */
    vf g[3][3];    /* derivatives along the cell's edges: coefficients of 1, w, w^2 */
};

/* The same as cell_init. */
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
    c.range = vf_max(vf_max(vf_max(vf_abs(fx), vf_abs(fy)), vf_max(vf_abs(fz), vf_abs(sxy))),
        vf_max(vf_max(vf_abs(sxz), vf_abs(syz)), vf_abs(sxyz)));
    vf x = vf_load(s->from[0] + j), y = vf_load(s->from[1] + j), z = vf_load(s->from[2] + j);
    vf dx = vf_load(s->delta[0] + j), dy = vf_load(s->delta[1] + j), dz = vf_load(s->delta[2] + j);
    vf fxy = sxy - fx - fy, fxz = sxz - fx - fz, fyz = syz - fy - fz;
    vf fxyz = sxyz - sxy - syz - fxz + fy;
    vf xy = fxy + fxyz * z, xz = fxz + fxyz * y, yz = fyz + fxyz * x;
    vf by_y = fy + fxy * x, by_z = fz + fxz * x + y * yz;
    c.base = o;
    c.p[0] = fx * x + y * by_y + z * by_z;
    c.p[1] = dx * (fx + fxy * y + z * xz) + dy * (by_y + z * yz) + dz * by_z;
    c.p[2] = dx * (dy * xy + dz * xz) + dy * dz * yz;
    c.p[3] = dx * dy * dz * fxyz;
    c.g[0][0] = fx + fxy * y + z * xz, c.g[0][1] = dy * xy + dz * xz, c.g[0][2] = dy * dz * fxyz;
    c.g[1][0] = by_y + z * yz, c.g[1][1] = dx * xy + dz * yz, c.g[1][2] = dx * dz * fxyz;
    c.g[2][0] = by_z, c.g[2][1] = dx * xz + dy * yz, c.g[2][2] = dx * dy * fxyz;
    return c;
}

/* Bounds from the control points. */
SIMD_INLINE void bounds(const vf p[4], vf *lo, vf *hi)
{
    vf b1 = p[0] + p[1] * (1.0f / 3), b2 = b1 + (p[1] + p[2]) * (1.0f / 3);
    vf b3 = p[0] + p[1] + p[2] + p[3];
    *lo = vf_min(vf_min(p[0], b1), vf_min(b2, b3));
    *hi = vf_max(vf_max(p[0], b1), vf_max(b2, b3));
}

/* ---- the map -------------------------------------------------------------------------------- */

#define FEW_EDGES 12 /* are looked at one by one */

/* The map entries at lo and hi, both relative to base. */
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

#endif
