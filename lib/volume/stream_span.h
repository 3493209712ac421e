/*
 * stream_span: where rays have cells to visit. VD rays walk side by side from region to region
 * (leap.c), and each span of regions with live cells is noted, so that the walk from cell to cell
 * leaps over what is between them.
 */
#ifndef STORMRING_VOLUME_STREAM_SPAN_H
#define STORMRING_VOLUME_STREAM_SPAN_H

#include "volume/stream_simd.h"
#include "volume/stream.h"

struct aim {
    vd d[3], inv[3]; /* direction; its reciprocals, 0 on an axis without movement */
    vl up[3], down[3];
    vd in[3], out[3]; /* planes of entry and exit */
    vd near, at[3], exit;
    vd enter; /* t of the entry into a brick or a clip box; else 0 */
    vl hit;
};

/* On an even grid: times that never are. */
#define FAR 1e300
#define FAST_FAR 1e30

/* A ray on an axis. still, per_edge: the place in the cell and 1 / its edge if it does not move. */
struct start {
    vl cell, step, plane; /* plane: the first that it meets */
    vd start, inv, next, prev, rate, still, per_edge;
};

/* The time at plane n. */
SIMD_INLINE vd met_at(vd n, vd start, vd inv, bool fast)
{
    return fast ? vd_rounded(vd_rounded(n - start) * inv) : (n - start) * inv;
}

/* The axis whose plane ends the cell or region. Of several axes the first: the steps of the others
 * then have length 0. */
struct which {
    vl x, y;
};
SIMD_INLINE struct which which_ends(vd x, vd y, vd z)
{
    return (struct which){(vl)(x <= y) & (vl)(x <= z), (vl)(y <= z)};
}

/* VD rays among regions: their region, and on each axis the plane that ends it, as an index into
 * s->region_plane, and its time. */
struct march {
    vl region, plane[3];
    vd next[3];
};

SIMD_INLINE struct march march_begin(
    const struct stream *s, const struct aim *m, const struct start r[3])
{
    struct march w = {.region = {0}};
    int64_t first = 0, stride = 1;
    UNROLLED
    for (int a = 0; a < 3; a++) {
        const vl at = r[a].cell >> REGION_SHIFT;
        w.region += at * stride;
        w.plane[a] = first + at + (m->up[a] & 1);
        w.next[a] = met_at(vd_gather(s->region_plane, w.plane[a]), r[a].start, r[a].inv, s->fast);
        first += s->regions[a] + 1;
        stride *= s->regions[a];
    }
    return w;
}

/* The rays of `in` pass the plane that ends their region. */
SIMD_INLINE void march_on(const struct stream *s, struct march *w, const struct start r[3], vl in)
{
    const struct which m = which_ends(w->next[0], w->next[1], w->next[2]);
    const vl mine[3] = {in & m.x, in & ~m.x & m.y, in & ~m.x & ~m.y};
    int64_t stride = 1;
    vl plane = {0};
    vd start = vd_set(0), inv = start;
    UNROLLED
    for (int a = 0; a < 3; a++) {
        const vl step = mine[a] & r[a].step;
        w->region += step * stride;
        w->plane[a] += step;
        plane |= mine[a] & w->plane[a];
        start = vd_choose(mine[a], r[a].start, start);
        inv = vd_choose(mine[a], r[a].inv, inv);
        stride *= s->regions[a];
    }
    const vd met = met_at(vd_gather(s->region_plane, plane), start, inv, s->fast);
    UNROLLED
    for (int a = 0; a < 3; a++) w->next[a] = vd_choose(mine[a], met, w->next[a]);
}

/* The most cells that these rays can pass: all until the ends of their last regions. */
SIMD_INLINE vl most_cells(
    const struct stream *s, const struct march *w, const struct aim *m, const struct start r[3])
{
    int64_t first = 0;
    vl most = {0};
    UNROLLED
    for (int a = 0; a < 3; a++) {
        const vl plane = (w->plane[a] - first) << REGION_SHIFT;
        most += (m->up[a] & (plane - r[a].cell)) + (m->down[a] & (r[a].cell - plane)) + 1;
        first += s->regions[a] + 1;
    }
    return most;
}

/* Finds the spans of n rays from number `ray` on; of VD rays, if these are fewer. */
static void find_spans(
    struct stream *s, uint32_t ray, uint32_t n, const struct aim *m, const struct start r[3])
{
    struct stream_spans *of = s->spans + ray;
    struct march w = march_begin(s, m, r);
    const unsigned lanes = n < VD ? (1u << n) - 1 : (1u << VD) - 1;
    vl in = m->hit & (vl)(m->enter < m->exit), open = {0};
    vd t = m->enter;
    double time[VD];
    int64_t most[VD];
    for (uint32_t k = 0; k < VD && k < n; k++) of[k].n = of[k].taken = 0;
    while (vl_signs(in)) {
        const vd end = vd_min(w.next[0], vd_min(w.next[1], w.next[2]));
        const vl live = (vl)(vd_gather(s->region, w.region) > vd_set(0));
        const vl turns = in & (live ^ open);
        const unsigned bits = vl_signs(turns) & lanes, begins = vl_signs(live);
        if (bits) vd_store(time, t);
        for (unsigned b = bits; b; b &= b - 1) {
            const int k = __builtin_ctz(b);
            if (!(begins >> k & 1)) of[k].end[of[k].n - 1] = time[k];
            else if (of[k].n < STREAM_SPANS) of[k].begin[of[k].n++] = time[k];
        }
        open ^= turns;
        in &= (vl)(end < m->exit);
        t = end;
        march_on(s, &w, r, in);
    }
    vd_store(time, m->exit);
    vl_store(most, most_cells(s, &w, m, r));
    for (uint32_t k = 0; k < VD && k < n; k++) {
        if (vl_signs(open) >> k & 1) of[k].end[of[k].n - 1] = time[k];
        of[k].most = most[k];
    }
}

#endif
