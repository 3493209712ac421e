/* stream_walk: LANES rays from cell to cell. */
#ifndef STORMRING_VOLUME_STREAM_WALK_H
#define STORMRING_VOLUME_STREAM_WALK_H

#include "volume/simd.h"
#include "volume/stream.h"

#define HALVES (LANES / VD)
#define UNROLLED _Pragma("GCC unroll 4")

/* ---- a lane's ray --------------------------------------------------------------------------- */

static void park(struct stream *s, int lane)
{
    struct stream_lanes *l = &s->lanes;
    l->t[lane] = 0;
    l->exit[lane] = -1;
    l->node[lane] = 0;
    for (int a = 0; a < 3; a++) {
        l->next[a][lane] = HUGE_VAL;
        l->prev[a][lane] = l->rate[a][lane] = 0;
        l->start[a][lane] = -HUGE_VAL;
        l->inv[a][lane] = 1;
        l->plane[a][lane] = l->step[a][lane] = l->to_node[a][lane] = 0;
    }
    s->parked |= 1u << lane;
}

static void put_axis(struct stream *s, int lane, const struct walk *w, int a)
{
    struct stream_lanes *l = &s->lanes;
    const struct volume *v = s->v;
    const struct front *f = &w->front;
    bool turned = v->stride[a] < 0;
    l->next[a][lane] = f->next[a];
    l->start[a][lane] = w->start[a];
    l->inv[a][lane] = w->inv[a];
    l->step[a][lane] = w->step[a];
    l->to_node[a][lane] = w->to_cell[a];
    l->plane[a][lane] = f->plane[a] - v->plane[0];
    if (w->step[a] == 0) {
        int32_t i = (int32_t)(f->plane[a] - w->zero[a]);
        double u = (w->o[a] - v->plane[a][i]) * v->inv_edge[a][i];
        l->prev[a][lane] = l->rate[a][lane] = 0;
        l->base[a][lane] = (float)(turned ? 1 - u : u);
        l->sign[a][lane] = 0;
        return;
    }
    bool up = (w->step[a] > 0) != turned;
    double behind = (*(f->plane[a] - w->step[a]) - w->start[a]) * w->inv[a];
    l->prev[a][lane] = behind;
    l->rate[a][lane] = 1 / (f->next[a] - behind);
    l->base[a][lane] = up ? 0 : 1;
    l->sign[a][lane] = up ? 1 : -1;
}

/* The next pixel whose ray meets the grid. */
static void put_ray(struct stream *s, int lane)
{
    struct volume *v = s->v;
    struct walk w;
    while (s->taken < s->n) {
        uint32_t i = s->taken++;
        struct stream_ray *r = &s->ray[i];
        *r = (struct stream_ray){.sum = {0}};
        v->counts.rays++;
        uint64_t pixel = lattice_pixel(s->pixels, v->camera.w, s->n0 + i);
        if (!walk_begin(&w, v, v->camera.eye, volume_direction(v, pixel))) continue;
        v->counts.hits++;
        for (int a = 0; a < 3; a++) r->o[a] = w.o[a], r->d[a] = w.d[a];
        r->before = w.before;
        s->lanes.t[lane] = w.front.t;
        s->lanes.exit[lane] = w.exit;
        s->lanes.node[lane] = (int64_t)w.front.cell;
        s->lanes.passed[lane] = 0;
        s->lanes.ray[lane] = (int32_t)i;
        for (int a = 0; a < 3; a++) put_axis(s, lane, &w, a);
        return;
    }
    park(s, lane);
}

static void take_ray(struct stream *s, int lane)
{
    struct volume_counts *c = &s->v->counts;
    uint32_t passed = (uint32_t)s->lanes.passed[lane];
    if (passed > c->most_cells) c->most_cells = passed;
}

/* ---- a step --------------------------------------------------------------------------------- */

/* Which axis ends the cell; of several, the first: the others' steps are of no length. */
struct which {
    vl x, y;
};
SIMD_INLINE vd of_axis(struct which m, vd x, vd y, vd z)
{
    return vd_choose(m.x, x, vd_choose(m.y, y, z));
}
SIMD_INLINE vl of_axis_l(struct which m, vl x, vl y, vl z)
{
    return vl_choose(m.x, x, vl_choose(m.y, y, z));
}
SIMD_INLINE struct which which_ends(const struct stream_lanes *l, int h)
{
    vd x = vd_load(l->next[0] + h), y = vd_load(l->next[1] + h), z = vd_load(l->next[2] + h);
    struct which m = {(vl)(x <= y) & (vl)(x <= z), (vl)(y <= z)};
    return m;
}
SIMD_INLINE vd cell_end(const struct stream_lanes *l, int h)
{
    vd x = vd_load(l->next[0] + h), y = vd_load(l->next[1] + h), z = vd_load(l->next[2] + h);
    return vd_min(vd_min(x, y), z);
}

/* Through the plane that ends the cell. */
SIMD_INLINE void pass(struct stream *s, int h, vd end)
{
    struct stream_lanes *l = &s->lanes;
    struct which m = which_ends(l, h);
    const vl mine[3] = {m.x, ~m.x & m.y, ~m.x & ~m.y};
    vl plane[3];
    UNROLLED
    for (int a = 0; a < 3; a++) {
        plane[a] = vl_load(l->plane[a] + h) + (mine[a] & vl_load(l->step[a] + h));
        vl_store(l->plane[a] + h, plane[a]);
    }
    vd start =
        of_axis(m, vd_load(l->start[0] + h), vd_load(l->start[1] + h), vd_load(l->start[2] + h));
    vd inv = of_axis(m, vd_load(l->inv[0] + h), vd_load(l->inv[1] + h), vd_load(l->inv[2] + h));
    vl to = of_axis_l(
        m, vl_load(l->to_node[0] + h), vl_load(l->to_node[1] + h), vl_load(l->to_node[2] + h));
    vd at = vd_gather(s->v->plane[0], of_axis_l(m, plane[0], plane[1], plane[2]));
    vd next = (at - start) * inv, rate = 1 / (next - end);
    vl_store(l->node + h, vl_load(l->node + h) + to);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vd_store(l->next[a] + h, vd_choose(mine[a], next, vd_load(l->next[a] + h)));
        vd_store(l->prev[a] + h, vd_choose(mine[a], end, vd_load(l->prev[a] + h)));
        vd_store(l->rate[a] + h, vd_choose(mine[a], rate, vd_load(l->rate[a] + h)));
    }
    vd_store(l->t + h, end);
}

/* ---- the list ------------------------------------------------------------------------------- */

/* The lanes of the mask, side by side. */
#ifdef __AVX2__
SIMD_INLINE void pack_f(const struct stream *s, float *to, vf a, unsigned mask)
{
    __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)s->pack[mask]));
    vf_store(to, _mm256_permutevar8x32_ps(a, order));
}
#else
SIMD_INLINE void pack_f(const struct stream *s, float *to, vf a, unsigned mask)
{
    (void)s;
    for (int i = 0; i < LANES; i++)
        if (mask >> i & 1) *to++ = a[i];
}
#endif
SIMD_INLINE void pack_d(double *to, const vd a[HALVES], unsigned mask)
{
    for (int i = 0; i < LANES; i++)
        if (mask >> i & 1) *to++ = a[i / VD][i % VD];
}

SIMD_INLINE void put_cells(struct stream *s, const vd end[HALVES], unsigned mask)
{
    const struct stream_lanes *l = &s->lanes;
    uint32_t n = s->cells;
    vd t[HALVES], long_[HALVES], u[HALVES], way[HALVES];
    UNROLLED
    for (int h = 0; h < HALVES; h++) {
        t[h] = vd_load(l->t + h * VD);
        long_[h] = end[h] - t[h];
    }
    UNROLLED
    for (int a = 0; a < 3; a++) {
        UNROLLED
        for (int h = 0; h < HALVES; h++) {
            vd rate = vd_load(l->rate[a] + h * VD);
            u[h] = (t[h] - vd_load(l->prev[a] + h * VD)) * rate;
            way[h] = long_[h] * rate;
        }
        vf base = vf_load(l->base[a]), sign = vf_load(l->sign[a]);
        pack_f(s, s->from[a] + n, base + sign * vf_narrow(u[0], u[1]), mask);
        pack_f(s, s->way[a] + n, sign * vf_narrow(way[0], way[1]), mask);
    }
    pack_f(s, s->len + n, vf_narrow(long_[0], long_[1]), mask);
    for (unsigned m = mask; m; m &= m - 1, n++) {
        int i = __builtin_ctz(m);
        s->node[n] = l->node[i];
        s->of[n] = l->ray[i];
        s->t0[n] = l->t[i];
        s->t1[n] = end[i / VD][i % VD];
    }
    s->cells = n;
}

/* ---- the walk ------------------------------------------------------------------------------- */

SIMD_INLINE unsigned ended(const struct stream_lanes *l)
{
    unsigned bits = 0;
    UNROLLED
    for (int h = 0; h < HALVES; h++)
        bits |= vl_signs(~(vl)(vd_load(l->t + h * VD) < vd_load(l->exit + h * VD))) << h * VD;
    return bits;
}

/* Fills the list; it is not full only when no ray is left. */
static void walk(struct stream *s)
{
    struct stream_lanes *l = &s->lanes;
    const uint8_t *live = s->v->live;
    while (s->cells <= STREAM_CELLS) {
        for (unsigned m = ended(l) & ~s->parked; m; m &= m - 1) {
            int lane = __builtin_ctz(m);
            take_ray(s, lane);
            put_ray(s, lane);
        }
        if (s->parked == (1u << LANES) - 1) return;
        vd end[HALVES];
        unsigned mask = 0;
        UNROLLED
        for (int h = 0; h < HALVES; h++) {
            end[h] = cell_end(l, h * VD);
            vd t = vd_load(l->t + h * VD);
            vl real = (vl)(end[h] > t) & (vl)(t < vd_load(l->exit + h * VD));
            vl_store(l->passed + h * VD, vl_load(l->passed + h * VD) - real);
            mask |= vl_signs(real & vl_bits(live, vl_load(l->node + h * VD))) << h * VD;
        }
        if (mask) put_cells(s, end, mask);
        UNROLLED
        for (int h = 0; h < HALVES; h++) pass(s, h * VD, end[h]);
    }
}

#endif
