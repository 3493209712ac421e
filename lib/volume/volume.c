/*
 * volume: prepares a grid for one specification and casts the rays of its pixels.
 */
#include "volume/volume_int.h"

#include <stdlib.h>

/* Number of nodes of the smallest rule whose error on pieces of DEPTH_MAX and BEND_MAX, times the
 * colour range, is within the tolerance. */
static int nodes_for(double tolerance, const struct map *m)
{
    static const double error[] = {4e-3, 2e-4, 8e-6, 2.5e-7, 7e-9}; /* of 3, 4, ... nodes */
    double range = 0;
    for (uint32_t i = 0; i < m->n; i++)
        if (!m->span[i].transparent)
            range = fmax(range, m->span[i].slope * (m->span[i].hi - m->span[i].lo));
    int n = 0;
    while (n < 5 && range * error[n] > tolerance) n++;
    return 3 + n;
}

static void set_planes(struct volume *v, const struct grid *g, const double scale[3])
{
    const ptrdiff_t stride[3] = {1, g->n[0], (ptrdiff_t)g->n[0] * g->n[1]};
    double *room = xmalloc((size_t)g->n[0] + g->n[1] + g->n[2] + 6 * BLOCK, sizeof *room);
    v->first = v->value;
    v->row = stride[1];
    v->layer = stride[2];
    for (int a = 0; a < 3; a++) {
        uint32_t n = g->n[a];
        v->cells[a] = n - 1;
        double *plane = v->plane[a] = room + BLOCK;
        room += n + 2 * BLOCK;
        for (uint32_t i = 0; i < BLOCK; i++)
            plane[n + i] = HUGE_VAL, plane[-1 - (int)i] = -HUGE_VAL;
        v->inv_edge[a] = xmalloc(n, sizeof *v->inv_edge[a]);
        bool turned = scale[a] < 0;
        v->stride[a] = turned ? -stride[a] : stride[a];
        if (turned) v->first += stride[a] * (ptrdiff_t)(n - 1);
        if (turned) v->origin += stride[a] * (ptrdiff_t)(n - 2);
        for (uint32_t i = 0; i < n; i++) plane[i] = g->at[a][turned ? n - 1 - i : i] * scale[a];
        for (uint32_t i = 0; i + 1 < n; i++) v->inv_edge[a][i] = 1 / (plane[i + 1] - plane[i]);
    }
}

/* Own cells and bounds, in scaled order. */
static void set_brick(struct volume *v, const struct grid *g, const double scale[3])
{
    v->brick = g->brick.is;
    for (int a = 0; a < 3; a++)
        for (int end = 0; end < 2; end++) {
            int of = scale[a] < 0 ? !end : end;
            uint32_t plane = g->brick.own[a][of];
            if (!v->brick) plane = end ? v->cells[a] : 0;
            else if (of != end) plane = v->cells[a] - plane;
            v->own[a][end] = plane;
            v->whole[a][end] = v->brick ? g->brick.whole[a][of] * scale[a] : v->plane[a][plane];
        }
}

/* Where rays are seen: in the clip box, and in the planes of a brick. */
static void set_inside(struct volume *v, const struct spec *s)
{
    v->narrowed = v->brick || s->clipped;
    for (int a = 0; a < 3; a++) {
        double *in = v->inside[a];
        const bool turned = s->scale[a] < 0;
        in[0] = v->plane[a][0], in[1] = v->plane[a][v->cells[a]];
        if (!s->clipped) continue;
        in[0] = fmax(in[0], s->clip[a][turned] * s->scale[a]);
        in[1] = fmin(in[1], s->clip[a][!turned] * s->scale[a]);
    }
}

bool volume_check(const struct grid *g, const struct spec *s, char err[ERR_BYTES])
{
    if (s->n_colours && !g->second)
        return err_set(err, "colour lines and a grid of one field, expected a second field in it");
    if (s->n_grounds && !g->ground)
        return err_set(
            err, "ground lines and a grid without ground, expected one of one level in it");
    return true;
}

struct volume *volume_new(
    const struct grid *g, const struct spec *s, const struct volume_options *o)
{
    struct volume *v = xcalloc(1, sizeof *v);
    v->spec = s;
    v->o = *o;
    v->value = volume_deviation(g, s);
    set_planes(v, g, s->scale);
    set_brick(v, g, s->scale);
    set_inside(v, s);
    slice_init(v);
    map_init(&v->map, s->knot, s->n_knots);
    map_init_colours(&v->tint, s->colour, s->n_colours);
    if (s->n_colours) v->second = g->second + (v->first - v->value);
    if (s->n_grounds) v->ground = ground_new(g->ground, s);
    skip_init(v);
    v->camera = camera_new(v3_of(s->from), v3_of(s->at), v3_of(s->up), s->angle);
    volume_frame(v, s->w, s->h);
    volume_gauss_rule(
        &v->rule, o->method == VOLUME_GAUSS ? o->n : nodes_for(o->tolerance, &v->map));
    if (o->method == VOLUME_ADAPTIVE && (is_lit(v) || v->second)) lit_rules(v);
    if (volume_stream_fits(v)) v->stream = volume_stream_new(v);
    v->side = v->above = xcalloc(s->n_isos + 1, sizeof *v->above);
    v->crossing = xcalloc(3 * s->n_isos + s->n_slices + 1, sizeof *v->crossing);
    return v;
}

void volume_free(struct volume *v)
{
    if (!v) return;
    free(v->plane[0] - BLOCK);
    for (int a = 0; a < 3; a++) free(v->inv_edge[a]);
    volume_stream_free(v->stream);
    volume_deviation_free(v->value);
    free(v->map.span);
    free(v->tint.span);
    free(v->live);
    free(v->block);
    slice_free(v);
    ground_free(v->ground);
    free(v->side);
    free(v->crossing);
    free(v);
}

void volume_frame(struct volume *v, uint32_t w, uint32_t h)
{
    v->camera.w = w;
    v->camera.h = h;
    v->counts = (struct volume_counts){0};
}

static void ray(struct path *p, struct walk *w)
{
    struct segment s;
    double last = -1;
    while (!path_done(p) && walk_cell(w, &s)) {
        cell_init(p->cell, w->v, w->o, w->d, &s);
        p->cell->t += w->before;
        if (w->v->second) cell_second(p->second, p->cell, w->v, s.i);
        bool own = volume_owns(w->v, s.i);
        volume_surfaces(p, &s, w->o, w->d, s.t0 != last, own);
        last = s.t1;
        p->v->counts.cells += own;
    }
}

static void pixel(struct volume *v, uint64_t at, float *rgba)
{
    struct cell cell, second;
    struct path p = {.v = v, .transmittance = 1, .cell = &cell, .dir = volume_direction(v, at)};
    if (v->second) p.second = &second;
    struct walk w;
    struct meeting m = {.is = false};
    if (v->ground) m = ground_meet(v->ground, v->spec, p.dir);
    v->counts.rays++;
    bool hits = walk_begin(&w, v, v->camera.eye, p.dir);
    if (hits && m.is) {
        w.exit = fmin(w.exit, m.t - w.before);
        hits = w.front.t < w.exit;
    }
    if (hits) {
        v->counts.hits++;
        ray(&p, &w);
        if (w.front.passed > v->counts.most_cells) v->counts.most_cells = w.front.passed;
    }
    if (m.is) volume_put_ground(v, &m, p.rgb, p.transmittance, rgba);
    else volume_put(v, p.rgb, p.transmittance, rgba);
}

void volume_pixels(struct volume *v, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba)
{
    if (v->stream) volume_stream_pixels(v->stream, l, n0, n, rgba);
    for (uint32_t i = 0; !v->stream && i < n; i++)
        pixel(v, lattice_pixel(l, v->camera.w, n0 + i), rgba + 4 * (size_t)i);
}

void volume_counts(const struct volume *v, struct volume_counts *c) { *c = v->counts; }
