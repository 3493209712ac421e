/* stream_ray: the list added to its rays, front to back. */
#ifndef STORMRING_VOLUME_STREAM_RAY_H
#define STORMRING_VOLUME_STREAM_RAY_H

#include "volume/stream_cell.h"
#include "volume/stream_cut.h"
#include "volume/stream_walk.h"

/* One cell, by the methods of one ray: in double, cut where the map has knots. */
static void alone(struct stream *s, uint32_t j, struct stream_ray *r)
{
    struct volume *v = s->v;
    struct cell cell;
    struct stretch at = {.t0 = s->t0[j], .t1 = s->t1[j]};
    struct path p = {.v = v, .clear = 1 - r->sum[3], .cell = &cell};
    cell_of_index(v, s->node[j], at.i);
    cell_init(&cell, v, r->o, r->d, &at);
    cell.t += r->before;
    for (int c = 0; c < 3; c++) p.rgb[c] = r->sum[c];
    integrate_cut(&p, NULL);
    for (int c = 0; c < 3; c++) r->sum[c] = p.rgb[c];
    r->sum[3] = 1 - p.clear;
}

static void add(struct stream *s)
{
    struct volume *v = s->v;
    const double limit = v->spec->opacity_limit;
    for (uint32_t j = 0; j < s->cells; j++) {
        struct stream_ray *r = &s->ray[s->of[j]];
        if (r->done) continue;
        v->counts.cells++;
        if (s->simple[j]) {
            v->counts.samples++;
            add_to(r, s->add[j], limit);
        } else if (s->piece[j] == STREAM_ALONE) {
            alone(s, j, r);
            r->done = r->sum[3] >= limit;
        } else {
            for (uint32_t i = s->piece[j]; i < s->piece_end[j] && !r->done; i++) add_piece(s, i, r);
        }
    }
}

static void rays(struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n)
{
    s->pixels = l;
    s->n0 = n0;
    s->n = n;
    s->taken = s->parked = 0;
    for (int lane = 0; lane < LANES; lane++) put_ray(s, lane);
    do {
        s->cells = 0;
        walk(s);
        cells(s);
        cut(s);
        add(s);
        for (int lane = 0; lane < LANES; lane++)
            if (!(s->parked >> lane & 1) && s->ray[s->lanes.ray[lane]].done)
                s->lanes.exit[lane] = -1;
    } while (s->cells);
}

#endif
