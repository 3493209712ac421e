/* stream_ray: moves the rays, and adds the list to them, front to back. */
#ifndef STORMRING_VOLUME_STREAM_RAY_H
#define STORMRING_VOLUME_STREAM_RAY_H

#include "volume/stream_cut.h"
#include "volume/stream_fast.h"

/* ---- the walk ------------------------------------------------------------------------------- */

/* One bit per lane from h0 on whose ray has ended. */
SIMD_INLINE unsigned ended(const struct stream *s, int h0)
{
    const struct stream_lanes *l = &s->lanes;
    unsigned mask = 0;
    if (s->fast) return vi_signs(~(vf_load(s->quick.t + h0) < vf_load(s->quick.exit + h0)));
    UNROLLED
    for (int h = 0; h < VF; h += VD)
        mask |= vl_signs(~(vl)(vd_load(l->t + h0 + h) < vd_load(l->exit + h0 + h))) << h;
    return mask;
}

/* Lanes whose rays have ended take the next rays, unless these leap to another live region. */
static void refill(struct stream *s, int h0, unsigned mask)
{
    for (unsigned m = mask & ~(s->parked >> h0); m; m &= m - 1) {
        int lane = h0 + __builtin_ctz(m);
        const bool seen = (s->fast ? (double)s->quick.exit[lane] : s->lanes.exit[lane]) >= 0;
        if (s->leaps && seen && volume_leap(s, lane)) continue;
        take_ray(s, lane);
        put_ray(s, lane);
    }
}

/*
 * Fills the list. Stops early only if no ray is left. A new ray's lane is written by scalar stores;
 * it is loaded as vectors only after the steps of the other lanes, because an immediate load would
 * stall.
 */
SIMD_INLINE void walk(struct stream *s, bool wide, bool even)
{
    while (s->cells <= STREAM_CELLS && s->parked != UINT32_MAX)
        for (int h = 0; h < s->walkers; h += VF) {
            step(s, h, wide, even);
            unsigned mask = ended(s, h);
            if (mask) refill(s, h, mask);
        }
}
static void walk_fast(struct stream *s)
{
    while (s->cells <= STREAM_CELLS && s->parked != UINT32_MAX)
        for (int h = 0; h < STREAM_WALKERS; h += VF) {
            unsigned mask = step_fast(s, h);
            if (mask) refill(s, h, mask);
        }
}

/* ---- the list ------------------------------------------------------------------------------- */

/* Renders one cell, with its surfaces, as volume.c does. own: see volume_surfaces. */
static void alone_wide(struct stream *s, uint32_t j, bool own, double sum[4])
{
    struct volume *v = s->v;
    struct stream_ray *r = &s->ray[s->of[j]];
    struct cell cell;
    struct segment in;
    struct path p = {.v = v, .transmittance = 1 - sum[3], .cell = &cell, .dir = v3_of(r->d)};
    memcpy(&in.t0, &s->begin[j], sizeof in.t0);
    memcpy(&in.t1, &s->end[j], sizeof in.t1);
    cell_of_index(v, s->node[j], in.i);
    cell_init(&cell, v, r->o, r->d, &in);
    cell.t += r->before;
    for (int c = 0; c < 3; c++) p.rgb[c] = sum[c];
    v->above = s->above + (size_t)s->of[j] * v->spec->n_isos;
    volume_surfaces(&p, &in, r->o, r->d, in.t0 != r->last, own);
    r->last = in.t1;
    for (int c = 0; c < 3; c++) sum[c] = p.rgb[c];
    sum[3] = 1 - p.transmittance;
}

/* Integrates one cell without vectors. */
static void alone(struct stream *s, uint32_t j, double sum[4])
{
    struct cell cell = {.base = (double)s->base[j], .len = (double)s->len[j]};
    struct path p = {.v = s->v, .transmittance = 1 - sum[3], .cell = &cell};
    for (int i = 0; i < 4; i++) cell.p[i] = (double)s->p[i][j];
    for (int c = 0; c < 3; c++) p.rgb[c] = sum[c];
    volume_integrate_cut(&p);
    for (int c = 0; c < 3; c++) sum[c] = p.rgb[c];
    sum[3] = 1 - p.transmittance;
}

/* Adds cell j. */
static void add_cell(struct stream *s, uint32_t j, bool own)
{
    const double limit = s->v->spec->opacity_limit;
    struct volume_counts *n = &s->v->counts;
    double *sum = s->sum[s->of[j]];
    if (sum[3] >= limit) return;
    n->cells += own;
    if (s->whole[j]) {
        if (!own) return;
        n->samples += s->whole[j] - 1u;
        add_to(sum, s->add[j]);
    } else if (s->piece[j] == STREAM_ALONE) {
        if (s->wide) alone_wide(s, j, own, sum);
        else alone(s, j, sum);
    } else {
        for (uint32_t i = s->piece[j]; own && i < s->piece_end[j] && sum[3] < limit; i++)
            add_piece(s, i, sum);
    }
}

/* Adds cells j .. end, all of them whole. */
static void add_whole(struct stream *s, uint32_t j, uint32_t end)
{
    const double limit = s->v->spec->opacity_limit;
    uint64_t cells = 0, samples = 0;
    for (; j < end; j++) {
        double *sum = s->sum[s->of[j]];
        if (sum[3] >= limit) continue;
        add_to(sum, s->add[j]);
        samples += s->whole[j];
        cells++;
    }
    s->v->counts.cells += cells;
    s->v->counts.samples += samples - cells;
}

static void add(struct stream *s)
{
    /* The list has cells of a brick's overlap only if there are surfaces or slices. */
    const bool brick = s->v->brick && volume_has_sheets(s->v);
    for (uint32_t g = 0, end; g < s->cells; g = end) {
        for (end = g; end < s->cells && !s->parts[end / VF] && !brick;) end += VF;
        if (end > s->cells) end = s->cells;
        add_whole(s, g, end);
        for (g = end; end < s->cells && end < g + VF; end++) {
            int32_t i[3];
            if (brick) cell_of_index(s->v, s->node[end], i);
            add_cell(s, end, !brick || volume_owns(s->v, i));
        }
    }
}

/* See stream_kernel. */
static void rays(struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n)
{
    s->pixels = l;
    s->n0 = n0;
    s->n = n;
    s->taken = 0;
    s->parked = ~(UINT32_MAX >> (32 - s->walkers));
    memset(s->sum, 0, sizeof s->sum);
    for (int lane = 0; lane < s->walkers; lane++) put_ray(s, lane);
    do {
        s->cells = 0;
        for (int h = 0; h < s->walkers; h += VF) refill(s, h, ended(s, h));
        if (s->fast) walk_fast(s);
        else if (s->wide && s->even) walk(s, true, true);
        else if (s->wide) walk(s, true, false);
        else if (s->even) walk(s, false, true);
        else walk(s, false, false);
        cells(s);
        cut(s);
        add(s);
        for (int lane = 0; lane < s->walkers; lane++)
            if (!(s->parked >> lane & 1) &&
                s->sum[s->lanes.ray[lane]][3] >= s->v->spec->opacity_limit)
                s->lanes.exit[lane] = -1, s->quick.exit[lane] = -1;
    } while (s->cells);
}

#endif
