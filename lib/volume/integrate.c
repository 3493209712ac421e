/*
 * integrate: the volume rendering integral over a segment of a cell. Every method adds
 * sub-segments, each as T (1 - exp(-dtau)) times the k-weighted mean of its colour. The plain sum
 * of c k T would exceed alpha if k is large.
 */
#include "volume/volume_int.h"

#define DOUBLING_MAX 65536 /* maximum sub-steps per cell */
#define HALVINGS_MAX 24    /* maximum halvings of a piece */

/* ---- trapezoid: as published ---------------------------------------------------------------- */

/* Extinction, and the colour including light and attenuation, at w of the cell. */
static double sample(struct path *p, double w, double rgb[3])
{
    const struct map *m = &p->v->map;
    double s = p->cell->base + cubic_at(p->cell->p, w);
    int i = map_find(m, s);
    p->v->counts.samples++;
    rgb[0] = rgb[1] = rgb[2] = 0;
    if (i < 0 || m->span[i].transparent) return 0;
    const struct map_span *a = &m->span[i];
    double light = path_light(p, w);
    volume_colour(p, w, rgb);
    for (int c = 0; c < 3; c++) rgb[c] *= light;
    return a->k0 + a->k1 * (s - a->lo);
}

static void trapezoid(struct path *p, double a, double b, int n)
{
    double rgb[3], last[3], mean[3], k0 = sample(p, a, last);
    double step = (b - a) / n;
    for (int i = 1; i <= n; i++) {
        double k1 = sample(p, i < n ? a + i * step : b, rgb), k = k0 + k1;
        for (int c = 0; c < 3; c++) {
            mean[c] = k > 0 ? (k0 * last[c] + k1 * rgb[c]) / k : 0;
            last[c] = rgb[c];
        }
        if (k > 0) path_add(p, 0.5 * k * step * p->cell->len, mean);
        k0 = k1;
    }
}

static void doubling(struct path *p, double a, double b)
{
    const struct path begin = *p;
    struct path before;
    double change;
    int n = 1;
    trapezoid(p, a, b, n);
    do {
        before = *p;
        *p = begin;
        n *= 2;
        trapezoid(p, a, b, n);
        change = fabs(p->transmittance - before.transmittance);
        for (int c = 0; c < 3; c++) change = fmax(change, fabs(p->rgb[c] - before.rgb[c]));
    } while (change >= p->v->o.tolerance && n < DOUBLING_MAX);
}

/* ---- Gauss-Legendre ------------------------------------------------------------------------- */

static void by_depth(struct path *p, const struct piece *s, int halvings)
{
    double depth = volume_depth_to(p, s, 1);
    if (!(depth > 0) || path_done(p)) return;
    if (depth <= DEPTH_MAX || halvings == HALVINGS_MAX) {
        volume_gauss(p, s, depth, &p->v->rule);
        return;
    }
    struct piece half[2];
    volume_halve(s, half);
    by_depth(p, &half[0], halvings + 1);
    by_depth(p, &half[1], halvings + 1);
}

static void piece_gauss(struct path *p, const struct piece *s) { by_depth(p, s, 0); }

/* ---- adaptive ------------------------------------------------------------------------------- */

/* Adds the exact k-weighted mean colour, from the integrals of q and its square: no sampling, no
 * exp. The error is bounded relative to the alpha that the piece adds (COVARIANCE). So the error of
 * a ray is at most that of its worst piece. */
static void moments(struct path *p, const struct piece *s, double depth)
{
    const double *q = s->q;
    const struct map_span *f = s->span;
    double one = q[0] + q[1] / 2 + q[2] / 3 + q[3] / 4;
    double two = q[0] * (q[0] + q[1]) + (q[1] * q[1] + 2 * q[0] * q[2]) / 3 +
                 (q[0] * q[3] + q[1] * q[2]) / 2 + (q[2] * q[2] + 2 * q[1] * q[3]) / 5 +
                 q[2] * q[3] / 3 + q[3] * q[3] / 7;
    double mean = (f->k0 * one + f->k1 * two) / (f->k0 + f->k1 * one), rgb[3];
    for (int c = 0; c < 3; c++) rgb[c] = f->rgb0[c] + f->rgb1[c] * mean;
    p->v->counts.samples++;
    path_add(p, depth, rgb);
}

/* Uses exact moments or Gauss nodes if their error bound is small enough, or else splits it. */
static void by_bounds(struct path *p, const struct piece *s, int halvings)
{
    double depth = volume_depth_to(p, s, 1), lo, hi;
    if (!(depth > 0) || path_done(p)) return;
    cubic_bounds(s->q, &lo, &hi);
    double error = s->span->slope * (hi - lo) * depth * COVARIANCE;
    bool straight = volume_is_straight(s, lo, hi);
    if (error <= p->v->o.tolerance) moments(p, s, depth);
    else if ((straight && depth <= DEPTH_MAX) || halvings == HALVINGS_MAX)
        volume_gauss(p, s, depth, &p->v->rule);
    else {
        struct piece half[2];
        volume_halve(s, half);
        for (int i = 0; i < 2; i++) by_bounds(p, &half[i], halvings + 1);
    }
}

static void piece_adaptive(struct path *p, const struct piece *s)
{
    if (is_lit(p->v) || s->tint) lit_piece(p, s);
    else by_bounds(p, s, 0);
}

void volume_integrate_cut(struct path *p) { volume_pieces_cut(p, 0, 1, piece_adaptive); }

void volume_integrate(struct path *p, double a, double b)
{
    const struct volume_options *o = &p->v->o;
    if (p->v->map.n == 0) return;
    switch (o->method) {
    case VOLUME_TRAPEZOID: trapezoid(p, a, b, o->n); break;
    case VOLUME_DOUBLING: doubling(p, a, b); break;
    case VOLUME_GAUSS: volume_pieces(p, a, b, piece_gauss); break;
    case VOLUME_ADAPTIVE: volume_pieces(p, a, b, piece_adaptive); break;
    }
}
