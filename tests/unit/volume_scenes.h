/*
 * volume_scenes: fields, maps and views for the tests of volume, and a reference that shares no
 * code with it: long double, plain marching of each cell by small steps.
 */
#ifndef VOLUME_SCENES_H
#define VOLUME_SCENES_H

#include "volume/volume.h"

#include <stdlib.h>

/* A grid whose planes are at 0, 1, 2 ...; the caller sets values, and frees with free_grid. */
static inline struct grid make_grid(uint32_t nx, uint32_t ny, uint32_t nz)
{
    struct grid g = {.n = {nx, ny, nz}, .name = "s"};
    for (int a = 0; a < 3; a++) {
        g.at[a] = xmalloc(g.n[a], sizeof(double));
        for (uint32_t i = 0; i < g.n[a]; i++) g.at[a][i] = i;
    }
    g.value = xcalloc((size_t)nx * ny * nz, sizeof(float));
    return g;
}
static inline void free_grid(struct grid *g)
{
    for (int a = 0; a < 3; a++) free(g->at[a]);
    free(g->value);
}
static inline void fill(struct grid *g, double (*f)(double x, double y, double z))
{
    for (uint32_t k = 0; k < g->n[2]; k++)
        for (uint32_t j = 0; j < g->n[1]; j++)
            for (uint32_t i = 0; i < g->n[0]; i++)
                g->value[grid_node(g, i, j, k)] = (float)f(g->at[0][i], g->at[1][j], g->at[2][k]);
}

/* Wind: two jets of 60 and 45 m/s that meander, over a background, and noise at the grid's scale;
 * uneven levels. */
static inline double wind(double x, double y, double z)
{
    double a = (y - 55 - 12 * sin(x / 15)) / 9, b = (x - 80 - 8 * sin(y / 11)) / 7;
    double high = (z - 11) / 5, low = (z - 6) / 4;
    double jets = 60 * exp(-a * a - high * high) + 45 * exp(-b * b - low * low);
    uint64_t node = (uint64_t)(x * 64) * 1000003 + (uint64_t)(y * 64) * 1009 + (uint64_t)(z * 64);
    return fabs(8 + 5 * sin(x / 9) * cos(y / 13) + jets + 3 * (rng_unit(1, node) - 0.5));
}
static inline struct grid wind_grid(void)
{
    struct grid g = make_grid(121, 97, 18);
    for (uint32_t k = 0; k < 18; k++) g.at[2][k] = k * (0.6 + 0.025 * k);
    fill(&g, wind);
    return g;
}

#define KNOTS_MAX 16
struct scene {
    struct spec s;
    struct spec_knot knot[KNOTS_MAX];
    struct spec_iso iso[8];
};
static inline void knot(struct scene *c, double s, double r, double g, double b, double k)
{
    c->s.knot = c->knot;
    c->knot[c->s.n_knots++] = (struct spec_knot){s, {r, g, b}, k};
}
static inline void iso(struct scene *c, double s, double r, double g, double b, double opacity)
{
    c->s.iso = c->iso;
    c->iso[c->s.n_isos++] = (struct spec_iso){s, {r, g, b}, opacity};
}
/* One pixel, from `from` towards `at`. */
static inline struct scene make_scene(const double from[3], const double at[3])
{
    struct scene c = {.s = {.up = {0.1, 0.2, 1}, .angle = 30, .w = 1, .h = 1, .scale = {1, 1, 1}}};
    for (int a = 0; a < 3; a++) c.s.from[a] = from[a], c.s.at[a] = at[a];
    c.s.opacity_limit = 1;
    return c;
}
static inline struct scene wind_scene(uint32_t side)
{
    const double from[3] = {20, -90, 95}, at[3] = {60, 45, 5};
    struct scene c = make_scene(from, at);
    c.s.angle = 32;
    c.s.w = c.s.h = side;
    return c;
}
static inline void smooth_map(struct scene *c)
{
    knot(c, 10, 0.1, 0.2, 0.9, 0);
    knot(c, 30, 0.2, 0.9, 0.3, 0.04);
    knot(c, 45, 0.9, 0.8, 0.1, 0.12);
    knot(c, 90, 0.9, 0.1, 0.1, 0.3); /* above all values: the map has no jump */
}
/* A tent at 30 m/s, as wide as said, of one optical depth for each value. */
static inline void contour_map(struct scene *c, double width)
{
    knot(c, 30 - width / 2, 0.9, 0.3, 0.1, 0);
    knot(c, 30, 0.9, 0.7, 0.2, 12 / width);
    knot(c, 30 + width / 2, 0.3, 0.3, 0.9, 0);
}

static inline void render(const struct grid *g, const struct spec *s,
    const struct volume_options *o, float *rgba, struct volume_counts *n)
{
    struct volume *v = volume_new(g, s, o);
    struct lattice all = {0, 0, s->w, s->h, 1, 1};
    volume_frame(v, s->w, s->h);
    volume_pixels(v, &all, 0, s->w * s->h, rgba);
    if (n) volume_counts(v, n);
    volume_free(v);
}

/* Alpha of the one ray from o to e. */
static inline double alpha_of(const struct grid *g, const struct scene *like, double ox, double oy,
    double oz, double ex, double ey, double ez)
{
    struct scene c = *like;
    const double o[3] = {ox, oy, oz}, e[3] = {ex, ey, ez};
    const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO, 1};
    float p[4];
    c.s.knot = c.knot, c.s.iso = c.iso;
    for (int a = 0; a < 3; a++) c.s.from[a] = o[a], c.s.at[a] = e[a];
    render(g, &c.s, &fine, p, NULL);
    return (double)p[3];
}
/* One extinction for all values. The specification points into its scene, which stays in place. */
static inline void even_map(struct scene *c, double k)
{
    const double zero[3] = {0, 0, 0};
    *c = make_scene(zero, zero);
    knot(c, -1e9, 1, 1, 1, k);
    knot(c, 1e9, 1, 1, 1, k);
}

/* ---- the reference: of up to KNOTS_MAX knots ------------------------------------------------- */

/* A double becomes a long double wherever the two meet, on purpose. */
#pragma GCC diagnostic ignored "-Wdouble-promotion"
typedef long double real;

static inline real ref_field(const struct grid *g, const uint32_t i[3], const real u[3])
{
    real s = 0;
    for (uint32_t c = 0; c < 8; c++) {
        real w = 1;
        for (uint32_t a = 0; a < 3; a++) w *= c >> a & 1 ? u[a] : 1 - u[a];
        size_t at = grid_node(g, i[0] + (c & 1), i[1] + (c >> 1 & 1), i[2] + (c >> 2));
        s += w * (real)g->value[at];
    }
    return s;
}
static inline real ref_map(const struct spec *m, real s, real rgb[3])
{
    for (size_t j = m->n_knots; j-- > 1;) {
        const struct spec_knot *a = &m->knot[j - 1], *b = &m->knot[j];
        if (!(s >= a->s && s <= b->s && b->s > a->s)) continue;
        real x = (s - a->s) / ((real)b->s - a->s);
        for (int c = 0; c < 3; c++) rgb[c] = a->rgb[c] + (b->rgb[c] - (real)a->rgb[c]) * x;
        return a->k + (b->k - (real)a->k) * x;
    }
    rgb[0] = rgb[1] = rgb[2] = 0;
    return 0;
}
static inline int ref_by_value(const void *a, const void *b)
{
    const real x = *(const real *)a, y = *(const real *)b;
    return (x > y) - (x < y);
}
/* The ray's field at t, the cell given by a point known to be inside it. */
static inline real ref_along(
    const struct grid *g, const uint32_t i[3], const real o[3], const real d[3], real t)
{
    real u[3];
    for (int a = 0; a < 3; a++)
        u[a] = (o[a] + t * d[a] - g->at[a][i[a]]) / ((real)g->at[a][i[a] + 1] - g->at[a][i[a]]);
    return ref_field(g, i, u);
}
/* The factor of the colour at t: the gradient by differences across the cell. */
static inline real ref_light(const struct grid *g, const struct spec *m, const uint32_t i[3],
    const real o[3], const real d[3], real t)
{
    real u[3], gg = 0, ll = 0, gl = 0;
    if (!m->lit) return 1;
    for (int a = 0; a < 3; a++)
        u[a] = (o[a] + t * d[a] - g->at[a][i[a]]) / ((real)g->at[a][i[a] + 1] - g->at[a][i[a]]);
    for (int a = 0; a < 3; a++) {
        real lo[3] = {u[0], u[1], u[2]}, hi[3] = {u[0], u[1], u[2]};
        lo[a] = 0, hi[a] = 1;
        real slope = (ref_field(g, i, hi) - ref_field(g, i, lo)) /
                     ((real)g->at[a][i[a] + 1] - g->at[a][i[a]]);
        real l = m->light[a] - (o[a] + t * d[a]);
        gg += slope * slope, ll += l * l, gl += slope * l;
    }
    if (!(gg * ll > 0)) return 1;
    return VOLUME_AMBIENT + (1 - VOLUME_AMBIENT) * fabsl(gl) / sqrtl(gg * ll);
}
/* Adds the stretch t0 .. t1 between two cuts, in parts of small optical depth: tau by Simpson's
 * rule, colour at the middles. */
static inline void ref_stretch(const struct grid *g, const struct spec *m, const uint32_t i[3],
    const real o[3], const real d[3], real t0, real t1, real *tau, real out[4])
{
    if (*tau > 60) return;                             /* behind it is 1e-26 */
    real rgb[3], unused[3], near = (t1 - t0) * 1e-12L; /* within the stretch, off the knots */
    int parts = 4 + (int)(300 * (t1 - t0) * ref_map(m, ref_along(g, i, o, d, (t0 + t1) / 2), rgb));
    real h = (t1 - t0) / parts, k0 = ref_map(m, ref_along(g, i, o, d, t0 + near), unused);
    for (int p = 0; p < parts; p++) {
        real t = t0 + h * (p + 0.5L), end = t0 + h * (p + 1) - (p + 1 == parts ? near : 0);
        real km = ref_map(m, ref_along(g, i, o, d, t), rgb);
        real k1 = ref_map(m, ref_along(g, i, o, d, end), unused);
        real dtau = h * (k0 + 4 * km + k1) / 6, seen = expl(-*tau) * -expm1l(-dtau);
        seen *= expl(-(real)m->attenuation * t) * ref_light(g, m, i, o, d, t);
        for (int c = 0; c < 3; c++) out[c] += seen * rgb[c];
        *tau += dtau;
        k0 = k1;
    }
}
/* Between cuts: cells' faces, and where some sample-to-sample interval meets a knot (by
 * bisection). `steps`: samples of each stretch between faces. */
static inline void ref_ray(const struct grid *g, const struct spec *m, const real o[3],
    const real d[3], int steps, real out[4])
{
    size_t n = 0;
    real *cut = xmalloc((size_t)g->n[0] + g->n[1] + g->n[2], sizeof *cut), tau = 0;
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < g->n[a]; i++)
            if (d[a] != 0 && (g->at[a][i] - o[a]) / d[a] > 0)
                cut[n++] = (g->at[a][i] - o[a]) / d[a];
    qsort(cut, n, sizeof *cut, ref_by_value);
    for (int c = 0; c < 4; c++) out[c] = 0;
    for (size_t j = 0; j < n; j++) {
        real t0 = j ? cut[j - 1] : 0, t1 = cut[j], middle = (t0 + t1) / 2;
        uint32_t i[3];
        bool in = true;
        for (int a = 0; a < 3; a++) {
            real x = o[a] + middle * d[a];
            in = in && x >= g->at[a][0] && x <= g->at[a][g->n[a] - 1];
            for (i[a] = 0; in && i[a] + 2 < g->n[a] && x >= g->at[a][i[a] + 1];) i[a]++;
        }
        for (int k = 0; in && k < steps; k++) {
            real a = t0 + (t1 - t0) * k / steps, b = t0 + (t1 - t0) * (k + 1) / steps;
            real sa = ref_along(g, i, o, d, a), sb = ref_along(g, i, o, d, b), edges[KNOTS_MAX + 2];
            int n_edges = 0;
            edges[n_edges++] = a;
            for (size_t q = 0; q < m->n_knots; q++) {
                real y = m->knot[q].s, lo = a, hi = b;
                if ((sa < y) == (sb < y)) continue;
                for (int r = 0; r < 70; r++) {
                    real mid = (lo + hi) / 2;
                    if ((ref_along(g, i, o, d, mid) < y) == (sa < y)) lo = mid;
                    else hi = mid;
                }
                edges[n_edges++] = lo;
            }
            edges[n_edges++] = b;
            qsort(edges, (size_t)n_edges, sizeof *edges, ref_by_value);
            for (int e = 1; e < n_edges; e++)
                ref_stretch(g, m, i, o, d, edges[e - 1], edges[e], &tau, out);
        }
    }
    out[3] = -expm1l(-tau);
    free(cut);
}
/* Of pixel x, y: the view computed again. */
static inline void ref_pixel(
    const struct grid *g, const struct spec *m, uint32_t x, uint32_t y, int steps, real out[4])
{
    real f[3], r[3], u[3], d[3], o[3], len = 0, half = tanl((real)m->angle * acosl(-1) / 360);
    for (int a = 0; a < 3; a++) o[a] = m->from[a], f[a] = (real)m->at[a] - m->from[a];
    for (int a = 0; a < 3; a++) len += f[a] * f[a];
    for (int a = 0; a < 3; a++) f[a] /= sqrtl(len);
    len = 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        r[a] = f[b] * m->up[c] - f[c] * m->up[b];
        len += r[a] * r[a];
    }
    for (int a = 0; a < 3; a++) r[a] /= sqrtl(len);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        u[a] = r[b] * f[c] - r[c] * f[b];
    }
    real sx = (2 * (x + 0.5L) - m->w) / m->h, sy = (m->h - 2 * (y + 0.5L)) / m->h;
    len = 0;
    for (int a = 0; a < 3; a++) d[a] = f[a] + half * (sx * r[a] + sy * u[a]), len += d[a] * d[a];
    for (int a = 0; a < 3; a++) d[a] /= sqrtl(len);
    ref_ray(g, m, o, d, steps, out);
}

#endif
