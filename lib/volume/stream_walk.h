/* stream_walk: moves VF rays from cell to cell. */
#ifndef STORMRING_VOLUME_STREAM_WALK_H
#define STORMRING_VOLUME_STREAM_WALK_H

#include "volume/stream_lane.h"

#define HALVES (VF / VD)

/* ---- a step --------------------------------------------------------------------------------- */

SIMD_INLINE vd of_axis(struct which m, vd x, vd y, vd z)
{
    return vd_choose(m.x, x, vd_choose(m.y, y, z));
}
SIMD_INLINE vl of_axis_l(struct which m, vl x, vl y, vl z)
{
    return vl_choose(m.x, x, vl_choose(m.y, y, z));
}
SIMD_INLINE vd of_axes(struct which m, double (*of)[STREAM_WALKERS], int h)
{
    return of_axis(m, vd_load(of[0] + h), vd_load(of[1] + h), vd_load(of[2] + h));
}

/* Steps through the plane that ends the cell and finds the plane that ends the next. */
SIMD_INLINE void pass(struct stream *s, int h)
{
    struct stream_lanes *l = &s->lanes;
    vd next[3] = {vd_load(l->next[0] + h), vd_load(l->next[1] + h), vd_load(l->next[2] + h)};
    const struct which m = which_ends(next[0], next[1], next[2]);
    const vl mine[3] = {m.x, ~m.x & m.y, ~m.x & ~m.y};
    const vd end = vd_load(l->end + h), at = vd_fetch(s->v->plane[0], l->beyond + h);
    const vd met = (at - of_axes(m, l->start, h)) * of_axes(m, l->inv, h), rate = 1 / (met - end);
    vl beyond[3];
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vl step = vl_load(l->step[a] + h), plane = vl_load(l->plane[a] + h) + (mine[a] & step);
        next[a] = vd_choose(mine[a], met, next[a]);
        beyond[a] = plane + step;
        vl_store(l->plane[a] + h, plane);
        vd_store(l->next[a] + h, next[a]);
        vd_store(l->prev[a] + h, vd_choose(mine[a], end, vd_load(l->prev[a] + h)));
        vd_store(l->rate[a] + h, vd_choose(mine[a], rate, vd_load(l->rate[a] + h)));
    }
    vl node = vl_load(l->node + h) + of_axis_l(m, vl_load(l->to_node[0] + h),
                                         vl_load(l->to_node[1] + h), vl_load(l->to_node[2] + h));
    const struct which then = which_ends(next[0], next[1], next[2]);
    vl_store(l->node + h, node);
    vl_store(l->byte + h, node >> 3);
    vl_store(l->beyond + h, of_axis_l(then, beyond[0], beyond[1], beyond[2]));
    vd_store(l->t + h, end);
    vd_store(l->end + h, of_axis(then, next[0], next[1], next[2]));
}

/* The same on an even grid. `number` counts planes: its time is a product, and `rate` is the same
 * in all cells. */
SIMD_INLINE void pass_even(struct stream *s, int h)
{
    struct stream_lanes *l = &s->lanes;
    vd next[3] = {vd_load(l->next[0] + h), vd_load(l->next[1] + h), vd_load(l->next[2] + h)};
    const struct which m = which_ends(next[0], next[1], next[2]);
    const vl mine[3] = {m.x, ~m.x & m.y, ~m.x & ~m.y};
    vl node = vl_load(l->node + h);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vd number = vd_load(l->number[a] + h) + (vd)(mine[a] & (vl)vd_load(l->way[a] + h));
        next[a] = (number - vd_load(l->start[a] + h)) * vd_load(l->inv[a] + h);
        vd_store(l->number[a] + h, number);
        vd_store(l->next[a] + h, next[a]);
        node += mine[a] & vl_load(l->to_node[a] + h);
    }
    vl_store(l->node + h, node);
    vl_store(l->byte + h, node >> 3);
    vd_store(l->t + h, vd_load(l->end + h));
    vd_store(l->end + h, vd_min(next[0], vd_min(next[1], next[2])));
}

/* ---- the list ------------------------------------------------------------------------------- */

/* Compaction: the lanes of the mask become adjacent. */
#if SIMD_BYTES == 64
struct order {
    __mmask16 of;
};
SIMD_INLINE struct order order_of(const struct stream *s, unsigned mask)
{
    (void)s;
    return (struct order){(__mmask16)mask};
}
SIMD_INLINE void pack_f(struct order order, void *to, vf a)
{
    a = _mm512_maskz_compress_ps(order.of, a);
    memcpy(to, &a, sizeof a);
}
SIMD_INLINE void pack_l(const struct stream *s, int64_t *to, const vl a[HALVES], unsigned mask)
{
    (void)s;
    vl_store(to, (vl)_mm512_maskz_compress_epi64((__mmask8)mask, (__m512i)a[0]));
    to += __builtin_popcount(mask & 255);
    vl_store(to, (vl)_mm512_maskz_compress_epi64((__mmask8)(mask >> 8), (__m512i)a[1]));
}
SIMD_INLINE void pack_n(struct order order, int64_t *to, vi a)
{
    __m512i packed = _mm512_maskz_compress_epi32(order.of, (__m512i)a);
    vl_store(to, (vl)_mm512_cvtepi32_epi64(_mm512_castsi512_si256(packed)));
    vl_store(to + VD, (vl)_mm512_cvtepi32_epi64(_mm512_extracti32x8_epi32(packed, 1)));
}
#elif SIMD_BYTES == 32
struct order {
    __m256i of;
};
SIMD_INLINE struct order order_of(const struct stream *s, unsigned mask)
{
    return (struct order){_mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)s->pack[mask]))};
}
SIMD_INLINE void pack_f(struct order order, void *to, vf a)
{
    a = _mm256_permutevar8x32_ps(a, order.of);
    memcpy(to, &a, sizeof a);
}
SIMD_INLINE void pack_half(const struct stream *s, int64_t *to, vl a, unsigned mask)
{
    __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)s->half_pack[mask]));
    vl_store(to, (vl)_mm256_permutevar8x32_ps((vf)a, order));
}
SIMD_INLINE void pack_l(const struct stream *s, int64_t *to, const vl a[HALVES], unsigned mask)
{
    pack_half(s, to, a[0], mask & 15);
    pack_half(s, to + __builtin_popcount(mask & 15), a[1], mask >> 4);
}
SIMD_INLINE void pack_n(struct order order, int64_t *to, vi a)
{
    __m256i packed = _mm256_permutevar8x32_epi32((__m256i)a, order.of);
    vl_store(to, (vl)_mm256_cvtepi32_epi64(_mm256_castsi256_si128(packed)));
    vl_store(to + VD, (vl)_mm256_cvtepi32_epi64(_mm256_extracti128_si256(packed, 1)));
}
#else
struct order {
    unsigned mask;
};
SIMD_INLINE struct order order_of(const struct stream *s, unsigned mask)
{
    (void)s;
    return (struct order){mask};
}
SIMD_INLINE void pack_f(struct order order, void *to, vf a)
{
    float *next = to;
    for (int i = 0; i < VF; i++)
        if (order.mask >> i & 1) memcpy(next++, (const float *)&a + i, sizeof *next);
}
SIMD_INLINE void pack_l(const struct stream *s, int64_t *to, const vl a[HALVES], unsigned mask)
{
    (void)s;
    for (int i = 0; i < VF; i++)
        if (mask >> i & 1) *to++ = a[i / VD][i % VD];
}
SIMD_INLINE void pack_n(struct order order, int64_t *to, vi a)
{
    for (int i = 0; i < VF; i++)
        if (order.mask >> i & 1) *to++ = a[i];
}
#endif

/* What light, attenuation and surfaces need. */
SIMD_INLINE void put_cells_wide(
    struct stream *s, int h0, const vd end[HALVES], unsigned mask, bool even)
{
    const struct stream_lanes *l = &s->lanes;
    const struct order order = order_of(s, mask);
    const uint32_t n = s->cells;
    vd t[HALVES], x[HALVES], y[HALVES];
    vl times[2][HALVES];
    UNROLLED
    for (int h = 0; h < HALVES; h++) {
        t[h] = vd_load(l->t + h0 + h * VD);
        x[h] = vd_load(l->before + h0 + h * VD) + t[h];
        times[0][h] = (vl)t[h], times[1][h] = (vl)end[h];
    }
    pack_f(order, s->eye + n, vf_narrow(x[0], x[1]));
    pack_l(s, s->begin + n, times[0], mask);
    pack_l(s, s->end + n, times[1], mask);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        UNROLLED
        for (int h = 0; h < HALVES; h++) {
            const int i = h0 + h * VD;
            x[h] = vd_load(l->light[a] + i) - vd_load(l->dir[a] + i) * t[h];
            y[h] = even ? vd_set(s->v->inv_edge[a][0])
                        : vd_load(l->rate[a] + i) * vd_abs(vd_load(l->inv[a] + i)) +
                              vd_load(l->still[a] + i);
        }
        pack_f(order, s->way[a] + n, vf_narrow(x[0], x[1]));
        pack_f(order, s->edge[a] + n, vf_narrow(y[0], y[1]));
    }
}

SIMD_INLINE void put_cells(struct stream *s, int h0, const vd end[HALVES], unsigned mask, bool even)
{
    const struct stream_lanes *l = &s->lanes;
    const struct order order = order_of(s, mask);
    uint32_t n = s->cells;
    vl node[HALVES];
    vd t[HALVES], length[HALVES], u[HALVES], delta[HALVES];
    UNROLLED
    for (int h = 0; h < HALVES; h++) {
        t[h] = vd_load(l->t + h0 + h * VD);
        length[h] = end[h] - t[h];
    }
    UNROLLED
    for (int a = 0; a < 3; a++) {
        UNROLLED
        for (int h = 0; h < HALVES; h++) {
            vd rate = vd_load(l->rate[a] + h0 + h * VD);
            u[h] = even ? 1 - (vd_load(l->next[a] + h0 + h * VD) - t[h]) * rate
                        : (t[h] - vd_load(l->prev[a] + h0 + h * VD)) * rate;
            delta[h] = length[h] * rate;
        }
        vf base = vf_load(l->base[a] + h0), sign = vf_load(l->sign[a] + h0);
        pack_f(order, s->from[a] + n, base + sign * vf_narrow(u[0], u[1]));
        pack_f(order, s->delta[a] + n, sign * vf_narrow(delta[0], delta[1]));
    }
    pack_f(order, s->len + n, vf_narrow(length[0], length[1]));
    pack_f(order, s->of + n, (vf)vi_load(l->ray + h0));
    UNROLLED
    for (int h = 0; h < HALVES; h++) node[h] = vl_load(l->node + h0 + h * VD);
    pack_l(s, s->node + n, node, mask);
    s->cells = n + (uint32_t)__builtin_popcount(mask);
}

/* ---- the walk ------------------------------------------------------------------------------- */

/* VF rays from lane h0: adds their live cells to the list and steps to the next cells. */
SIMD_INLINE void step(struct stream *s, int h0, bool wide, bool even)
{
    struct stream_lanes *l = &s->lanes;
    vd end[HALVES];
    unsigned mask = 0;
    UNROLLED
    for (int i = 0; i < HALVES; i++) {
        const int h = h0 + i * VD;
        end[i] = vd_load(l->end + h);
        if (wide) end[i] = vd_min(end[i], vd_load(l->stop + h)); /* a clip box ends within a cell */
        vd t = vd_load(l->t + h);
        vl real = (vl)(end[i] > t) & (vl)(t < vd_load(l->exit + h));
        vl_store(l->passed + h, vl_load(l->passed + h) - real);
        mask |= vl_signs(real & vl_bits(s->v->live, l->byte + h, vl_load(l->node + h))) << i * VD;
    }
    if (mask && wide) put_cells_wide(s, h0, end, mask, even);
    if (mask) put_cells(s, h0, end, mask, even);
    UNROLLED
    for (int i = 0; i < HALVES; i++) {
        if (even) pass_even(s, h0 + i * VD);
        else pass(s, h0 + i * VD);
    }
}

#endif
