/*
 * stream_fast: the walk in float, on even grids.
 *
 * The time at plane n is (n - start) * inv, with `start` and `inv` rounded once for the ray. The
 * difference and the product are rounded for each plane, and two more products for the place in the
 * cell. No time depends on another one, so errors do not add up from cell to cell. On a grid of N
 * cells along its longest axis, each of these six errors is at most 2^-24 N cells of an axis. So on
 * three axes a value is wrong by at most 18 * 2^-24 N of the range of its cell's values. stream.c
 * takes this walk where that changes values by at most a quarter of the tolerance, relative to the
 * span of the map: a contour that is narrow beside the steps from node to node needs doubles.
 */
#ifndef STORMRING_VOLUME_STREAM_FAST_H
#define STORMRING_VOLUME_STREAM_FAST_H

#include "volume/stream_walk.h"

/* As put_cells. */
SIMD_INLINE void put_cells_fast(struct stream *s, int h, vf t, vf end, const vf next[3], unsigned m)
{
    const struct stream_fast *q = &s->quick;
    const struct order order = order_of(s, m);
    const uint32_t n = s->cells;
    const vf length = end - t;
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vf rate = vf_load(q->rate[a] + h);
        pack_f(order, s->from[a] + n, vf_load(q->base[a] + h) - (next[a] - t) * rate);
        pack_f(order, s->delta[a] + n, length * rate);
    }
    pack_f(order, s->len + n, length);
    pack_f(order, s->of + n, (vf)vi_load(s->lanes.ray + h));
    pack_n(order, s->node + n, vi_load(q->node + h));
    s->cells = n + (uint32_t)__builtin_popcount(m);
}

/* As step. Returns the lanes whose rays have ended. */
SIMD_INLINE unsigned step_fast(struct stream *s, int h)
{
    struct stream_fast *q = &s->quick;
    const vf t = vf_load(q->t + h), end = vf_load(q->end + h), exit = vf_load(q->exit + h);
    vf next[3] = {vf_load(q->next[0] + h), vf_load(q->next[1] + h), vf_load(q->next[2] + h)};
    vi node = vi_load(q->node + h), real = (end > t) & (t < exit);
    const vi x = (next[0] <= next[1]) & (next[0] <= next[2]), y = ~x & (next[1] <= next[2]);
    const vi mine[3] = {x, y, ~x & ~y};
    const unsigned mask = vi_signs(real & vi_bits(s->v->live, q->byte + h, node));
    vi_store(q->passed + h, vi_load(q->passed + h) - real);
    if (mask) put_cells_fast(s, h, t, end, next, mask);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vf number = vf_load(q->number[a] + h) + (vf)(mine[a] & (vi)vf_load(q->way[a] + h));
        next[a] = (number - vf_load(q->start[a] + h)) * vf_load(q->inv[a] + h);
        vf_store(q->number[a] + h, number);
        vf_store(q->next[a] + h, next[a]);
        node += mine[a] & vi_load(q->to_node[a] + h);
    }
    vi_store(q->node + h, node);
    vi_store(q->byte + h, node >> 3);
    vf_store(q->t + h, end);
    vf_store(q->end + h, vf_min(next[0], vf_min(next[1], next[2])));
    return vi_signs(~(end < exit));
}

#endif
