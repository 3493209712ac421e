/*
 * volume_oracle: the colour of a ray by code that shares none with lib/volume, in long double, for
 * all that a specification has. A ray is cut at every plane of the grid, every side of the clip box
 * and every slice; within a cell it is cut where the field meets a knot or a surface, and where the
 * light is at right angles to the gradient. Between two cuts all is smooth, and Gauss' rule of five
 * nodes is applied to ever smaller parts until two halves agree with the whole.
 */
#ifndef VOLUME_ORACLE_H
#define VOLUME_ORACLE_H

#include "volume/volume.h"

#include <stdlib.h>

/* A double becomes a long double wherever the two meet, on purpose. */
#pragma GCC diagnostic ignored "-Wdouble-promotion"
typedef long double oracle_real;

#define ORACLE_CUTS 512
#define ORACLE_SURFACES 8
#define ORACLE_AGREE 1e-8L
#define ORACLE_NEAR 1e-9L /* of the field's size: nearer is grazing */

struct oracle {
    const struct grid *g;
    const struct spec *s;
    oracle_real o[3], d[3];
    oracle_real rgb[3], tau, through; /* through: of sheets, beside exp(-tau) */
    bool above[ORACLE_SURFACES], known;
    bool grazes; /* rounding decides what the ray meets: the answer is worth nothing */
    /* the cell */
    uint32_t i[3];
    oracle_real t0, len, p[4], second[4], facing[4];
};

/* Plane i of axis a in scaled space, ascending; the value at a node by these indices. */
static inline oracle_real oracle_plane(const struct oracle *r, int a, uint32_t i)
{
    const double scale = r->s->scale[a];
    return r->g->at[a][scale < 0 ? r->g->n[a] - 1 - i : i] * scale;
}
static inline oracle_real oracle_node(
    const struct oracle *r, const float *value, const uint32_t i[3])
{
    uint32_t at[3];
    for (int a = 0; a < 3; a++) at[a] = r->s->scale[a] < 0 ? r->g->n[a] - 1 - i[a] : i[a];
    return value[grid_node(r->g, at[0], at[1], at[2])];
}

/* The field and its gradient in the ray's cell, at distance t from the eye. */
static inline oracle_real oracle_field(
    const struct oracle *r, const float *value, oracle_real t, oracle_real grad[3])
{
    oracle_real u[3], h[3], s = 0;
    for (int a = 0; a < 3; a++) {
        oracle_real low = oracle_plane(r, a, r->i[a]);
        h[a] = oracle_plane(r, a, r->i[a] + 1) - low;
        u[a] = (r->o[a] + t * r->d[a] - low) / h[a];
        if (grad) grad[a] = 0;
    }
    for (uint32_t c = 0; c < 8; c++) {
        const uint32_t at[3] = {r->i[0] + (c & 1), r->i[1] + (c >> 1 & 1), r->i[2] + (c >> 2)};
        oracle_real v = oracle_node(r, value, at), w[3];
        for (uint32_t a = 0; a < 3; a++) w[a] = c >> a & 1 ? u[a] : 1 - u[a];
        s += v * w[0] * w[1] * w[2];
        for (uint32_t a = 0; a < 3 && grad; a++)
            grad[a] += (c >> a & 1 ? v : -v) * w[(a + 1) % 3] * w[(a + 2) % 3] / h[a];
    }
    return s;
}
static inline void oracle_to_light(const struct oracle *r, oracle_real t, oracle_real l[3])
{
    for (int a = 0; a < 3; a++) l[a] = r->s->light[a] - (r->o[a] + t * r->d[a]);
}
static inline oracle_real oracle_dot(const oracle_real a[3], const oracle_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline oracle_real oracle_fade(const struct oracle *r, oracle_real t)
{
    return expl(-(oracle_real)r->s->attenuation * t);
}
static inline oracle_real oracle_light(const struct oracle *r, oracle_real t)
{
    oracle_real g[3], l[3], fade = oracle_fade(r, t);
    if (!r->s->lit) return fade;
    oracle_field(r, r->g->value, t, g);
    oracle_to_light(r, t, l);
    oracle_real size = oracle_dot(g, g) * oracle_dot(l, l);
    if (!(size > 0)) return fade;
    return fade * (0.3L + 0.7L * fabsl(oracle_dot(g, l)) / sqrtl(size));
}

/* The two knots around a value; NULL outside of the map. */
static inline const struct spec_knot *oracle_knots(const struct spec *s, oracle_real v)
{
    for (size_t j = s->n_knots; j-- > 1;)
        if (v >= s->knot[j - 1].s && v <= s->knot[j].s && s->knot[j].s > s->knot[j - 1].s)
            return &s->knot[j - 1];
    return NULL;
}
static inline void oracle_colour(const struct spec_knot *k, oracle_real v, oracle_real rgb[3])
{
    oracle_real x = (v - k[0].s) / ((oracle_real)k[1].s - k[0].s);
    for (int c = 0; c < 3; c++) rgb[c] = k[0].rgb[c] + (k[1].rgb[c] - (oracle_real)k[0].rgb[c]) * x;
}

/* The colour of a value in a list of knots, whose ends hold beyond them too. */
static inline void oracle_list(
    const struct spec_knot *k, size_t n, oracle_real v, oracle_real rgb[3])
{
    size_t j = 0;
    while (j < n && k[j].s <= v) j++;
    if (j > 0 && j < n) {
        oracle_colour(&k[j - 1], v, rgb);
        return;
    }
    for (int c = 0; c < 3; c++) rgb[c] = k[j == 0 ? 0 : n - 1].rgb[c];
}

/* ---- cubics --------------------------------------------------------------------------------- */

static inline oracle_real oracle_at(const oracle_real p[4], oracle_real w)
{
    return p[0] + w * (p[1] + w * (p[2] + w * p[3]));
}
/* Through four values at 0, 1/3, 2/3 and 1. */
static inline void oracle_through(const oracle_real v[4], oracle_real p[4])
{
    p[0] = v[0];
    p[1] = (-11 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3]) / 2;
    p[2] = (18 * v[0] - 45 * v[1] + 36 * v[2] - 9 * v[3]) / 2;
    p[3] = (-9 * v[0] + 27 * v[1] - 27 * v[2] + 9 * v[3]) / 2;
}
/* 0, the turning points, and 1. */
static inline int oracle_turns(const oracle_real p[4], oracle_real w[4])
{
    oracle_real a = 3 * p[3], b = 2 * p[2], c = p[1], disc = b * b - 4 * a * c, root[2];
    int n = 0, found = 0;
    w[n++] = 0;
    if (disc > 0) {
        oracle_real q = -(b + copysignl(sqrtl(disc), b)) / 2;
        if (a != 0) root[found++] = q / a;
        if (q != 0) root[found++] = c / q;
    }
    if (found == 2 && root[0] > root[1]) {
        oracle_real swap = root[0];
        root[0] = root[1], root[1] = swap;
    }
    for (int k = 0; k < found; k++)
        if (root[k] > w[n - 1] && root[k] < 1) w[n++] = root[k];
    w[n++] = 1;
    return n;
}
struct oracle_cut {
    oracle_real w;
    int surface; /* or -1 */
};
static inline int oracle_by_place(const void *a, const void *b)
{
    const struct oracle_cut *x = a, *y = b;
    return (x->w > y->w) - (x->w < y->w);
}
static inline int oracle_by_value(const void *a, const void *b)
{
    const oracle_real x = *(const oracle_real *)a, y = *(const oracle_real *)b;
    return (x > y) - (x < y);
}
/* Appends the places where p changes between below y and not below. */
static inline int oracle_meet(struct oracle *r, const oracle_real p[4], oracle_real y, int surface,
    struct oracle_cut *cut, int n)
{
    oracle_real w[4], size = fabsl(y);
    int turns = oracle_turns(p, w);
    for (int k = 0; k < 4; k++) size += fabsl(p[k]);
    bool above = surface >= 0 && r->known ? r->above[surface] : p[0] >= y;
    for (int k = 0; k < turns; k++) {
        oracle_real value = oracle_at(p, w[k]);
        if (surface >= 0 && fabsl(value - y) < ORACLE_NEAR * size) r->grazes = true;
        if ((value >= y) == above) continue;
        oracle_real lo = k ? w[k - 1] : 0, hi = w[k];
        for (int step = 0; step < 70; step++) {
            oracle_real middle = (lo + hi) / 2;
            if ((oracle_at(p, middle) >= y) == above) lo = middle;
            else hi = middle;
        }
        above = !above;
        cut[n++] = (struct oracle_cut){hi, surface};
    }
    if (surface >= 0) r->above[surface] = above;
    return n;
}

/* ---- what a part adds ----------------------------------------------------------------------- */

static inline void oracle_sheet(
    struct oracle *r, const oracle_real rgb[3], oracle_real light, oracle_real opacity)
{
    oracle_real seen = r->through * expl(-r->tau) * opacity * light;
    for (int c = 0; c < 3; c++) r->rgb[c] += seen * rgb[c];
    r->through *= 1 - opacity;
}

/* Depth from the cell's entry to w, between two knots: k is a cubic there. */
static inline oracle_real oracle_depth(
    const struct oracle *r, const struct spec_knot *k, oracle_real w)
{
    const oracle_real *p = r->p,
                      per = (k[1].k - (oracle_real)k[0].k) / ((oracle_real)k[1].s - k[0].s);
    oracle_real mean = p[0] + w * (p[1] / 2 + w * (p[2] / 3 + w * p[3] / 4));
    return w * r->len * (k[0].k + per * (mean - k[0].s));
}
static inline void oracle_gauss(const struct oracle *r, const struct spec_knot *k, oracle_real a,
    oracle_real b, oracle_real from, oracle_real out[3])
{
    const oracle_real inner = sqrtl(5 - 2 * sqrtl(10 / 7.0L)) / 3;
    const oracle_real outer = sqrtl(5 + 2 * sqrtl(10 / 7.0L)) / 3;
    const oracle_real node[5] = {0, inner, -inner, outer, -outer};
    const oracle_real heavy = (322 + 13 * sqrtl(70)) / 900, slight = (322 - 13 * sqrtl(70)) / 900;
    const oracle_real weight[5] = {128 / 225.0L, heavy, heavy, slight, slight};
    for (int c = 0; c < 3; c++) out[c] = 0;
    for (int j = 0; j < 5; j++) {
        oracle_real w = (a + b) / 2 + node[j] * (b - a) / 2, rgb[3], v = oracle_at(r->p, w);
        oracle_real x = (v - k[0].s) / ((oracle_real)k[1].s - k[0].s);
        oracle_real seen = (k[0].k + (k[1].k - (oracle_real)k[0].k) * x) * r->len * (b - a) / 2;
        seen *= weight[j] * expl(-(r->tau + oracle_depth(r, k, w) - from)) *
                oracle_light(r, r->t0 + w * r->len);
        if (!r->s->n_colours) oracle_colour(k, v, rgb);
        else oracle_list(r->s->colour, r->s->n_colours, oracle_at(r->second, w), rgb);
        for (int c = 0; c < 3; c++) out[c] += seen * rgb[c];
    }
}
static inline void oracle_part(struct oracle *r, const struct spec_knot *k, oracle_real a,
    oracle_real b, oracle_real from, int halvings)
{
    oracle_real whole[3], half[2][3], middle = (a + b) / 2, worst = 0;
    oracle_real begin = oracle_depth(r, k, a) - from, end = oracle_depth(r, k, b) - from;
    if (r->tau + begin > 50) return;
    bool deep = end - begin > 2;
    if (!deep || halvings > 40) {
        oracle_gauss(r, k, a, b, from, whole);
        oracle_gauss(r, k, a, middle, from, half[0]);
        oracle_gauss(r, k, middle, b, from, half[1]);
        for (int c = 0; c < 3; c++) worst = fmaxl(worst, fabsl(half[0][c] + half[1][c] - whole[c]));
        if (worst < ORACLE_AGREE || halvings > 40) {
            for (int c = 0; c < 3; c++) r->rgb[c] += r->through * (half[0][c] + half[1][c]);
            return;
        }
    }
    oracle_part(r, k, a, middle, from, halvings + 1);
    oracle_part(r, k, middle, b, from, halvings + 1);
}
static inline void oracle_piece(struct oracle *r, oracle_real a, oracle_real b)
{
    const struct spec_knot *k = b > a ? oracle_knots(r->s, oracle_at(r->p, (a + b) / 2)) : NULL;
    if (!k) return;
    oracle_real from = oracle_depth(r, k, a);
    for (int j = 0; j < 4; j++)
        oracle_part(r, k, a + (b - a) * j / 4, a + (b - a) * (j + 1) / 4, from, 0);
    r->tau += oracle_depth(r, k, b) - from;
}

/* ---- the ray -------------------------------------------------------------------------------- */

/* The cell of a point that is within one, or on a face: the upper one. False outside, outside of
 * the clip box, and where a corner is missing. */
static inline bool oracle_cell(struct oracle *r, oracle_real t)
{
    for (int a = 0; a < 3; a++) {
        const oracle_real x = r->o[a] + t * r->d[a];
        const uint32_t n = r->g->n[a];
        const double scale = r->s->scale[a];
        if (!(x >= oracle_plane(r, a, 0) && x <= oracle_plane(r, a, n - 1))) return false;
        if (r->s->clipped) {
            oracle_real one = r->s->clip[a][0] * scale, two = r->s->clip[a][1] * scale;
            if (!(x >= fminl(one, two) && x <= fmaxl(one, two))) return false;
        }
        for (r->i[a] = 0; r->i[a] + 2 < n && x >= oracle_plane(r, a, r->i[a] + 1);) r->i[a]++;
    }
    for (uint32_t c = 0; c < 8; c++) {
        const uint32_t at[3] = {r->i[0] + (c & 1), r->i[1] + (c >> 1 & 1), r->i[2] + (c >> 2)};
        if (isnan(oracle_node(r, r->g->value, at))) return false;
    }
    return true;
}

static inline void oracle_slices(struct oracle *r, oracle_real t)
{
    for (size_t i = 0; i < r->s->n_slices; i++) {
        const struct spec_slice *s = &r->s->slice[i];
        const oracle_real at = s->at * r->s->scale[s->axis];
        if (r->d[s->axis] == 0 || (at - r->o[s->axis]) / r->d[s->axis] != t) continue;
        oracle_real v = oracle_field(r, r->g->value, t, NULL), rgb[3];
        const struct spec_knot *k = oracle_knots(r->s, v);
        for (size_t j = 0; j < r->s->n_knots; j++)
            if (fabsl(v - r->s->knot[j].s) < ORACLE_NEAR * (fabsl(v) + 1)) r->grazes = true;
        if (!k) continue;
        oracle_colour(k, v, rgb);
        if (r->s->n_colours) {
            v = oracle_field(r, r->g->second, t, NULL);
            for (size_t j = 0; j < r->s->n_colours; j++)
                if (fabsl(v - r->s->colour[j].s) < ORACLE_NEAR * (fabsl(v) + 1)) r->grazes = true;
            oracle_list(r->s->colour, r->s->n_colours, v, rgb);
        }
        oracle_sheet(r, rgb, oracle_fade(r, t), s->opacity);
    }
}

/* From t0 to t1 in one cell. */
static inline void oracle_stretch(struct oracle *r, oracle_real t0, oracle_real t1)
{
    struct oracle_cut cut[ORACLE_CUTS];
    oracle_real v[4], second[4] = {0}, h[4], g[3], l[3], from = 0;
    int n = 0;
    r->t0 = t0, r->len = t1 - t0;
    for (int k = 0; k < 4; k++) {
        v[k] = oracle_field(r, r->g->value, t0 + r->len * k / 3, g);
        if (r->s->n_colours) second[k] = oracle_field(r, r->g->second, t0 + r->len * k / 3, NULL);
        oracle_to_light(r, t0 + r->len * k / 3, l);
        h[k] = oracle_dot(g, l);
    }
    oracle_through(v, r->p);
    oracle_through(h, r->facing);
    oracle_through(second, r->second);
    for (size_t i = 0; i < r->s->n_knots; i++)
        n = oracle_meet(r, r->p, r->s->knot[i].s, -1, cut, n);
    for (size_t i = 0; i < r->s->n_colours; i++)
        n = oracle_meet(r, r->second, r->s->colour[i].s, -1, cut, n);
    for (size_t i = 0; i < r->s->n_isos; i++)
        n = oracle_meet(r, r->p, r->s->iso[i].s, (int)i, cut, n);
    if (r->s->lit) n = oracle_meet(r, r->facing, 0, -1, cut, n);
    r->known = true;
    qsort(cut, (size_t)n, sizeof *cut, oracle_by_place);
    for (int i = 0; i < n; i++) {
        oracle_piece(r, from, cut[i].w);
        from = cut[i].w;
        if (cut[i].surface < 0) continue;
        const struct spec_iso *iso = &r->s->iso[cut[i].surface];
        oracle_real rgb[3];
        for (int c = 0; c < 3; c++) rgb[c] = iso->rgb[c];
        oracle_sheet(r, rgb, oracle_light(r, t0 + from * r->len), iso->opacity);
    }
    oracle_piece(r, from, 1);
}

/* ---- the ground ----------------------------------------------------------------------------- */

static inline oracle_real oracle_edge(const struct oracle *r, int a, uint32_t i)
{
    return r->s->ground ? r->g->ground->at[a][i] * r->s->scale[a] : 0;
}
/* The ray's height above the ground of cell i, by a formula of its own; *z: that of the ground. */
static inline oracle_real oracle_over(
    const struct oracle *r, const uint32_t i[2], oracle_real t, oracle_real *z, oracle_real n[3])
{
    const struct grid *g = r->g->ground;
    oracle_real u[2], h[2], c[4];
    for (int a = 0; a < 2; a++) {
        h[a] = oracle_edge(r, a, i[a] + 1) - oracle_edge(r, a, i[a]);
        u[a] = (r->o[a] + t * r->d[a] - oracle_edge(r, a, i[a])) / h[a];
    }
    for (uint32_t k = 0; k < 4; k++)
        c[k] = (oracle_real)g->value[(i[1] + (k >> 1)) * g->n[0] + i[0] + (k & 1)];
    *z = (1 - u[1]) * ((1 - u[0]) * c[0] + u[0] * c[1]) + u[1] * ((1 - u[0]) * c[2] + u[0] * c[3]);
    const oracle_real scale = r->s->scale[2];
    n[0] = -scale * ((1 - u[1]) * (c[1] - c[0]) + u[1] * (c[3] - c[2])) / h[0];
    n[1] = -scale * ((1 - u[0]) * (c[2] - c[0]) + u[0] * (c[3] - c[1])) / h[1];
    n[2] = 1;
    return r->o[2] + t * r->d[2] - *z * scale;
}
static inline bool oracle_clip(const struct oracle *r, oracle_real t)
{
    for (int a = 0; a < 3 && r->s->clipped; a++) {
        const oracle_real x = r->o[a] + t * r->d[a], one = r->s->clip[a][0] * r->s->scale[a];
        const oracle_real two = r->s->clip[a][1] * r->s->scale[a];
        if (!(x >= fminl(one, two) && x <= fmaxl(one, two))) return false;
        if (fminl(fabsl(x - one), fabsl(x - two)) < ORACLE_NEAR * (1 + fabsl(x))) return false;
    }
    return true;
}
/* Where the ray meets the ground first; infinity: nowhere. */
static inline oracle_real oracle_ground(struct oracle *r, oracle_real rgb[3])
{
    const struct grid *g = r->g->ground;
    oracle_real first = HUGE_VALL, z, n[3], l[3];
    for (uint32_t j = 0; j + 1 < g->n[1]; j++)
        for (uint32_t i = 0; i + 1 < g->n[0]; i++) {
            const uint32_t at[2] = {i, j};
            oracle_real near = 0, far = HUGE_VALL, v[4];
            for (int a = 0; a < 2; a++) {
                oracle_real one = oracle_edge(r, a, at[a]), two = oracle_edge(r, a, at[a] + 1);
                oracle_real in = (one - r->o[a]) / r->d[a], out = (two - r->o[a]) / r->d[a];
                bool within = r->o[a] >= fminl(one, two) && r->o[a] < fmaxl(one, two);
                if (r->d[a] == 0) far = within ? far : -1;
                else near = fmaxl(near, fminl(in, out)), far = fminl(far, fmaxl(in, out));
            }
            if (far > 1e4L) far = 1e4L; /* a ray straight up or down */
            if (!(near < far)) continue;
            for (int k = 0; k < 4; k++)
                v[k] = oracle_over(r, at, near + (far - near) * k / 3, &z, n);
            if (isnan(v[0])) continue;
            oracle_real p[4];
            struct oracle_cut cut[ORACLE_CUTS];
            oracle_through(v, p);
            int cuts = oracle_meet(r, p, 0, -1, cut, 0);
            for (int k = 0; k < cuts; k++) {
                oracle_real t = near + (far - near) * cut[k].w;
                if (!(t < first) || !oracle_clip(r, t)) continue;
                first = t;
                oracle_over(r, at, t, &z, n);
                oracle_to_light(r, t, l);
                oracle_real light = oracle_fade(r, t);
                if (r->s->lit)
                    light *= 0.3L + 0.7L * fabsl(oracle_dot(n, l)) /
                                        sqrtl(oracle_dot(n, n) * oracle_dot(l, l));
                oracle_list(r->s->ground, r->s->n_grounds, z, rgb);
                for (int c = 0; c < 3; c++) rgb[c] *= light;
            }
        }
    return first;
}

static inline void oracle_ray(struct oracle *r)
{
    oracle_real *t =
        xmalloc((size_t)r->g->n[0] + r->g->n[1] + r->g->n[2] + r->s->n_slices + 8, sizeof *t);
    size_t n = 0;
    t[n++] = 0;
    for (int a = 0; a < 3; a++) {
        const double scale = r->s->scale[a];
        if (r->d[a] == 0) continue;
        for (uint32_t i = 0; i < r->g->n[a]; i++)
            t[n++] = (oracle_plane(r, a, i) - r->o[a]) / r->d[a];
        for (int end = 0; end < 2 && r->s->clipped; end++)
            t[n++] = ((oracle_real)(r->s->clip[a][end] * scale) - r->o[a]) / r->d[a];
        for (size_t i = 0; i < r->s->n_slices; i++)
            if (r->s->slice[i].axis == a)
                t[n++] = ((oracle_real)(r->s->slice[i].at * scale) - r->o[a]) / r->d[a];
    }
    oracle_real ground[3], end = r->s->n_grounds ? oracle_ground(r, ground) : HUGE_VALL;
    if (end < HUGE_VALL) t[n++] = end;
    qsort(t, n, sizeof *t, oracle_by_value);
    r->known = false;
    /* A slice is seen if the cell before it or that behind it is. */
    for (size_t j = 0; j + 1 < n && t[j] < end; j++) {
        if (t[j] < 0 || t[j] == t[j + 1]) continue;
        bool before = r->known, in = oracle_cell(r, (t[j] + t[j + 1]) / 2);
        if (!in) {
            r->known = false;
            continue;
        }
        if (!before) oracle_slices(r, t[j]);
        oracle_stretch(r, t[j], t[j + 1]);
        oracle_slices(r, t[j + 1]);
    }
    if (end < HUGE_VALL) oracle_sheet(r, ground, 1, 1);
    free(t);
}

/* The colour of pixel x, y. False if the ray grazes something. */
static inline bool oracle_pixel(
    const struct grid *g, const struct spec *s, uint32_t x, uint32_t y, oracle_real out[4])
{
    struct oracle r = {.g = g, .s = s, .through = 1};
    oracle_real f[3], right[3], up[3], len = 0,
                                       half = tanl((oracle_real)s->angle * acosl(-1) / 360);
    for (int a = 0; a < 3; a++) r.o[a] = s->from[a], f[a] = (oracle_real)s->at[a] - s->from[a];
    len = sqrtl(oracle_dot(f, f));
    for (int a = 0; a < 3; a++) f[a] /= len;
    for (int a = 0; a < 3; a++)
        right[a] = f[(a + 1) % 3] * s->up[(a + 2) % 3] - f[(a + 2) % 3] * s->up[(a + 1) % 3];
    len = sqrtl(oracle_dot(right, right));
    for (int a = 0; a < 3; a++) right[a] /= len;
    for (int a = 0; a < 3; a++)
        up[a] = right[(a + 1) % 3] * f[(a + 2) % 3] - right[(a + 2) % 3] * f[(a + 1) % 3];
    oracle_real sx = (2 * (x + 0.5L) - s->w) / s->h, sy = (s->h - 2 * (y + 0.5L)) / s->h;
    for (int a = 0; a < 3; a++) r.d[a] = f[a] + half * (sx * right[a] + sy * up[a]);
    len = sqrtl(oracle_dot(r.d, r.d));
    for (int a = 0; a < 3; a++) r.d[a] /= len;
    oracle_ray(&r);
    for (int c = 0; c < 3; c++) out[c] = r.rgb[c];
    out[3] = 1 - r.through * expl(-r.tau);
    return !r.grazes;
}

#endif
