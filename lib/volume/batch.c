/*
 * batch: the adaptive method on several cells of one ray at once. Most cells lie in one span of the
 * map and are thin enough for exact moments. piece.c handles the others.
 */
#include "volume/volume_int.h"

static void put(struct batch *b, uint32_t j, const struct volume *v, const struct segment *c)
{
    const ptrdiff_t x = v->stride[0], y = v->stride[1], z = v->stride[2];
    const int32_t *i = c->i;
    const float *s = v->first + i[0] * x + i[1] * y + i[2] * z;
    b->t0[j] = c->t0;
    b->t1[j] = c->t1;
    for (int a = 0; a < 3; a++) {
        b->plane[a][j] = v->plane[a][i[a]];
        b->inv[a][j] = v->inv_edge[a][i[a]];
    }
    b->corner[0][j] = s[0];
    b->corner[1][j] = s[x];
    b->corner[2][j] = s[y];
    b->corner[3][j] = s[x + y];
    b->corner[4][j] = s[z];
    b->corner[5][j] = s[x + z];
    b->corner[6][j] = s[y + z];
    b->corner[7][j] = s[x + y + z];
}

enum kind { CELL_TRANSPARENT, CELL_SIMPLE, CELL_CUT };

static void use_span(struct batch *b, uint32_t j, const struct span *s)
{
    b->span[j] = s;
    b->from[j] = s->lo;
    b->k0[j] = s->k0;
    b->k1[j] = s->k1;
    b->slope[j] = s->slope;
    for (int c = 0; c < 3; c++) {
        b->rgb0[c][j] = s->rgb0[c];
        b->rgb1[c][j] = s->rgb1[c];
    }
}

/* hint: the span used last. */
static enum kind classify(struct batch *b, uint32_t j, const struct map *m, int *hint)
{
    double lo = b->lo[j], hi = b->hi[j];
    const struct span *s = &m->span[*hint];
    if (!(lo >= s->lo && hi < s->hi)) {
        if (hi < m->span[0].lo || lo > m->span[m->n - 1].hi) return CELL_TRANSPARENT;
        int first = map_find(m, lo), last = map_find(m, hi);
        if (first != last || first < 0) return CELL_CUT;
        *hint = first;
        s = &m->span[first];
    }
    if (s->transparent) return CELL_TRANSPARENT;
    use_span(b, j, s);
    return CELL_SIMPLE;
}

/* Integrates the batch and adds it to the ray, front to back. */
static void gather(struct path *p, struct batch *b, const struct walk *w, int *hint)
{
    struct volume *v = p->v;
    enum kind kind[BATCH];
    bool simple = false;
    v->kernel->cubics(b);
    for (uint32_t j = 0; j < b->n; j++) {
        kind[j] = classify(b, j, &v->map, hint);
        simple |= kind[j] == CELL_SIMPLE;
    }
    if (simple) v->kernel->moments(b);
    for (uint32_t j = 0; j < b->n && !path_done(p); j++) {
        v->counts.cells++;
        if (kind[j] == CELL_SIMPLE && b->error[j] <= v->o.tolerance) {
            v->counts.samples++;
            if (!(b->depth[j] > 0)) continue;
            double seen = p->transmittance * (1 - b->through[j]);
            for (int c = 0; c < 3; c++) p->rgb[c] += seen * b->rgb[c][j];
            p->transmittance *= b->through[j];
        } else if (kind[j] != CELL_TRANSPARENT) {
            struct cell *c = p->cell; /* without light the other members are not read */
            c->base = (double)b->corner[0][j];
            c->t = w->before + b->t0[j];
            c->len = b->t1[j] - b->t0[j];
            for (int k = 0; k < 4; k++) c->p[k] = b->p[k][j];
            volume_integrate_cut(p, kind[j] == CELL_CUT ? NULL : b->span[j]);
        }
    }
}

void batch_ray(struct path *p, struct walk *w)
{
    struct batch *b = &p->v->batch;
    struct segment cell[BATCH];
    int hint = 0;
    for (int a = 0; a < 3; a++) b->o[a] = w->o[a], b->d[a] = w->d[a];
    while (!path_done(p) && (b->n = walk_cells(w, cell, BATCH)) > 0) {
        for (uint32_t j = 0; j < b->n; j++) put(b, j, w->v, &cell[j]);
        gather(p, b, w, &hint);
    }
}
