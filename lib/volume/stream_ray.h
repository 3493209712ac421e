/* stream_ray: adds the list to its rays, front to back. */
#ifndef STORMRING_VOLUME_STREAM_RAY_H
#define STORMRING_VOLUME_STREAM_RAY_H

#include "volume/stream_cell.h"
#include "volume/stream_cut.h"
#include "volume/stream_walk.h"

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

/* False for cells of a brick's overlap. Without surfaces and slices they are not in the list. */
static bool owns(const struct stream *s, uint32_t j)
{
    int32_t i[3];
    if (!s->v->brick || !volume_has_sheets(s->v)) return true;
    cell_of_index(s->v, s->node[j], i);
    return volume_owns(s->v, i);
}

static void add(struct stream *s)
{
    struct volume *v = s->v;
    const double limit = v->spec->opacity_limit;
    uint64_t cells = 0, samples = 0;
    for (uint32_t j = 0; j < s->cells; j++) {
        double *sum = s->sum[s->of[j]];
        if (sum[3] >= limit) continue;
        if (!owns(s, j)) {
            if (!s->whole[j] && s->piece[j] == STREAM_ALONE) alone_wide(s, j, false, sum);
            continue;
        }
        cells++;
        if (s->whole[j]) {
            samples += s->whole[j] - 1u;
            add_to(sum, s->add[j]);
        } else if (s->piece[j] == STREAM_ALONE) {
            if (s->wide) alone_wide(s, j, true, sum);
            else alone(s, j, sum);
        } else {
            for (uint32_t i = s->piece[j]; i < s->piece_end[j] && sum[3] < limit; i++)
                add_piece(s, i, sum);
        }
    }
    v->counts.cells += cells;
    v->counts.samples += samples;
}

/* See stream_kernel. */
static void rays(struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n)
{
    s->pixels = l;
    s->n0 = n0;
    s->n = n;
    s->taken = s->parked = 0;
    memset(s->sum, 0, sizeof s->sum);
    for (int lane = 0; lane < STREAM_WALKERS; lane++) put_ray(s, lane);
    do {
        s->cells = 0;
        for (int h = 0; h < STREAM_WALKERS; h += VF) refill(s, h);
        if (s->wide) walk(s, true);
        else walk(s, false);
        cells(s);
        cut(s);
        add(s);
        for (int lane = 0; lane < STREAM_WALKERS; lane++)
            if (!(s->parked >> lane & 1) &&
                s->sum[s->lanes.ray[lane]][3] >= s->v->spec->opacity_limit)
                s->lanes.exit[lane] = -1;
    } while (s->cells);
}

#endif
