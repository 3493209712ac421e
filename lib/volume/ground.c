/*
 * ground: a surface of heights, bilinear between nodes, that ends rays. It is a sheet: seen from
 * above and from below, without sides. It is opaque, or flat and of some opacity: then its values
 * are colours only.
 *
 * A ray passes from cell to cell as in walk.c: the time at a plane is that of the plane, so it is
 * the same number for the cells on both sides. Above a cell, the ray's height over the ground is a
 * quadratic. The ray carries its side from cell to cell, and meets the ground where the side
 * changes. So no ray slips through the line where two cells meet, whatever rounding does.
 */
#include "volume/volume_int.h"

#include <stdlib.h>

#define MARGIN 0x1p-20 /* of the size of the ground: room around its heights */
#define ROOM 0x1p-40   /* of a height: what rounding may do to it */
#define BEHIND 0x1p-32 /* of the distance to the ground: at most this far behind it a ray ends */

struct ground {
    const struct grid *g;
    double *plane[2]; /* scaled, ascending */
    uint32_t cells[2];
    bool turned[2];
    double scale;        /* of heights */
    double bounds[3][2]; /* where it may be met: of the ground, and of the clip box */
    struct map colour;   /* by the height before scale */
    bool flat;
    double at, opacity; /* of a flat one, scaled */
};

/* A ray, from where it may meet the ground. */
struct over {
    const struct ground *g;
    double o[3], d[3], inv[2];
    double t, end;
    int step[2];
    int32_t i[2];
};

/* The cell of a time: corners h00, h10, h01, h11, scaled, and lengths of edges. */
struct patch {
    double h[4], edge[2];
    double u[2], delta[2]; /* local coordinates at the ray's entry; their change until exit */
    double q[4];           /* height of the ray above the ground, along the segment */
};

static float height(const struct ground *g, int32_t i, int32_t j)
{
    const uint32_t *n = g->g->n;
    return g->g->value[grid_node(g->g, g->turned[0] ? n[0] - 1 - (uint32_t)i : (uint32_t)i,
        g->turned[1] ? n[1] - 1 - (uint32_t)j : (uint32_t)j, 0)];
}

static void set_bounds(struct ground *g, const struct spec *s)
{
    const size_t nodes = (size_t)g->g->n[0] * g->g->n[1];
    double lo = HUGE_VAL, hi = -HUGE_VAL, size = 0;
    for (size_t i = 0; i < nodes; i++) {
        double z = (double)g->g->value[i] * g->scale;
        if (isnan(z)) continue;
        lo = fmin(lo, z), hi = fmax(hi, z);
    }
    if (g->flat) lo = hi = g->at;
    for (int a = 0; a < 2; a++) {
        g->bounds[a][0] = g->plane[a][0];
        g->bounds[a][1] = g->plane[a][g->cells[a]];
        size = fmax(size, g->bounds[a][1] - g->bounds[a][0]);
    }
    size = MARGIN * fmax(size, fmax(fabs(lo), fabs(hi)));
    g->bounds[2][0] = lo - size, g->bounds[2][1] = hi + size;
    /* A flat ground in a face of the clip box is in the box. */
    for (int a = 0; a < 3 && s->clipped; a++) {
        const bool turned = s->scale[a] < 0;
        const double room = a == 2 ? ROOM : 0, eye = fabs(s->from[a]);
        const double low = s->clip[a][turned] * s->scale[a];
        const double high = s->clip[a][!turned] * s->scale[a];
        g->bounds[a][0] = fmax(g->bounds[a][0], low - room * (fabs(low) + eye));
        g->bounds[a][1] = fmin(g->bounds[a][1], high + room * (fabs(high) + eye));
    }
}

struct ground *ground_new(const struct grid *of, const struct spec *s)
{
    struct ground *g = xcalloc(1, sizeof *g);
    g->g = of;
    g->scale = s->scale[2];
    g->flat = s->flat;
    g->at = s->flat_at * s->scale[2];
    g->opacity = s->flat ? s->flat_opacity : 1;
    for (int a = 0; a < 2; a++) {
        const uint32_t n = of->n[a];
        g->cells[a] = n - 1;
        g->turned[a] = s->scale[a] < 0;
        g->plane[a] = xmalloc(n, sizeof *g->plane[a]);
        for (uint32_t i = 0; i < n; i++)
            g->plane[a][i] = of->at[a][g->turned[a] ? n - 1 - i : i] * s->scale[a];
    }
    set_bounds(g, s);
    if (s->flat) map_init(&g->colour, s->ground, s->n_grounds);
    else map_init_colours(&g->colour, s->ground, s->n_grounds);
    return g;
}

void ground_free(struct ground *g)
{
    if (!g) return;
    for (int a = 0; a < 2; a++) free(g->plane[a]);
    free(g->colour.span);
    free(g);
}

/* ---- the ray -------------------------------------------------------------------------------- */

static double met(const struct over *r, int a, int32_t plane)
{
    return (r->g->plane[a][plane] - r->o[a]) * r->inv[a];
}

/* The first cell along an axis that the ray has not left at r->t. */
static int32_t first_cell(const struct over *r, int a)
{
    int32_t lo = 0, hi = (int32_t)r->g->cells[a] - 1;
    while (lo < hi) {
        const int32_t mid = (lo + hi) / 2;
        const bool above = r->step[a] < 0   ? met(r, a, mid + 1) > r->t
                           : r->step[a] > 0 ? met(r, a, mid + 1) <= r->t
                                            : r->g->plane[a][mid + 1] <= r->o[a];
        if (above) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

/* Clips the ray to the bounds. *before: distance from the eye to r->o. False if it misses. */
static bool begin(
    struct over *r, const struct ground *g, struct vec3 eye, struct vec3 dir, double *before)
{
    const double o[3] = {eye.x, eye.y, eye.z}, d[3] = {dir.x, dir.y, dir.z};
    double near = 0, far = HUGE_VAL;
    *r = (struct over){.g = g};
    for (int a = 0; a < 3; a++) {
        const double *end = g->bounds[a], inv = 1 / d[a];
        const bool up = d[a] > WALK_LEVEL, moves = up || d[a] < -WALK_LEVEL;
        r->d[a] = moves ? d[a] : 0;
        if (!moves && !(o[a] >= end[0] && o[a] <= end[1])) return false;
        if (!moves) continue;
        near = fmax(near, (end[!up] - o[a]) * inv);
        far = fmin(far, (end[up] - o[a]) * inv);
        if (a == 2) continue;
        r->step[a] = up ? 1 : -1;
        r->inv[a] = inv;
    }
    if (!(near < far)) return false;
    *before = near;
    for (int a = 0; a < 3; a++) r->o[a] = o[a] + near * r->d[a];
    r->end = far - near;
    for (int a = 0; a < 2; a++) r->i[a] = first_cell(r, a);
    return true;
}

/* The time at which the ray leaves its cell along an axis. */
static double leaves(const struct over *r, int a)
{
    return r->step[a] == 0 ? HUGE_VAL : met(r, a, r->i[a] + (r->step[a] > 0));
}

static double local(const struct over *r, int a, double t)
{
    const double *plane = r->g->plane[a] + r->i[a];
    double u = (r->o[a] + t * r->d[a] - plane[0]) / (plane[1] - plane[0]);
    return u < 0 ? 0 : u > 1 ? 1 : u;
}

/* False if a corner is missing. */
static bool patch_of(const struct over *r, double end, struct patch *p)
{
    const struct ground *g = r->g;
    for (int a = 0; a < 2; a++) {
        p->edge[a] = g->plane[a][r->i[a] + 1] - g->plane[a][r->i[a]];
        p->u[a] = local(r, a, r->t);
        p->delta[a] = local(r, a, end) - p->u[a];
    }
    for (int c = 0; c < 4; c++)
        p->h[c] = (double)height(g, r->i[0] + (c & 1), r->i[1] + (c >> 1)) * g->scale;
    if (isnan(p->h[0] + p->h[1] + p->h[2] + p->h[3])) return false;
    p->q[2] = p->q[3] = 0;
    if (g->flat) {
        p->q[0] = r->o[2] + r->t * r->d[2] - g->at;
        p->q[1] = (end - r->t) * r->d[2];
        return true;
    }
    const double x = p->h[1] - p->h[0], y = p->h[2] - p->h[0], xy = p->h[3] - p->h[2] - x;
    const double *u = p->u, *delta = p->delta;
    p->q[0] = (r->o[2] - p->h[0] + r->t * r->d[2]) - (u[0] * x + u[1] * (y + u[0] * xy));
    p->q[1] = (end - r->t) * r->d[2] - delta[0] * (x + u[1] * xy) - delta[1] * (y + u[0] * xy);
    p->q[2] = -delta[0] * delta[1] * xy;
    return true;
}

/* Goes on to `end`, and to the next cells. False at the end of the ground. */
static bool pass(struct over *r, const double next[2], double end)
{
    r->t = fmax(r->t, end);
    for (int a = 0; a < 2; a++) {
        if (!(next[a] <= r->t)) continue;
        r->i[a] += r->step[a];
        if (r->i[a] < 0 || r->i[a] >= (int32_t)r->g->cells[a]) return false;
    }
    return true;
}

/* The first w at which the side changes; negative: none. */
static double crossing_of(const struct patch *p, bool above)
{
    double w[4];
    const int n = cubic_monotone(p->q, w);
    for (int k = 0; k < n; k++) {
        if ((cubic_at(p->q, w[k]) >= 0) == above) continue;
        return k ? cubic_root(p->q, w[k - 1], w[k], 0) : 0;
    }
    return -1;
}

/* False if the ground has no colour there. */
static bool shade(
    const struct over *r, const struct spec *s, const struct patch *p, double w, struct meeting *m)
{
    const double u = p->u[0] + w * p->delta[0], v = p->u[1] + w * p->delta[1];
    const double x = p->h[1] - p->h[0], y = p->h[2] - p->h[0], xy = p->h[3] - p->h[2] - x;
    const double z = (p->h[0] + u * x + v * (y + u * xy)) / r->g->scale;
    double light = s->attenuation > 0 ? volume_exp(-s->attenuation * m->t) : 1;
    const int span = map_find(&r->g->colour, z);
    if (span < 0) return false;
    if (s->lit && !s->flat) {
        const struct vec3 n = v3(-(x + v * xy) / p->edge[0], -(y + u * xy) / p->edge[1], 1);
        const struct vec3 at = v3_mad(v3_of(s->from), v3_of(r->d), m->t);
        const struct vec3 l = v3_sub(v3_of(s->light), at);
        const double size = v3_dot(n, n) * v3_dot(l, l);
        if (size > 0)
            light *= VOLUME_AMBIENT + (1 - VOLUME_AMBIENT) * fabs(v3_dot(n, l)) / sqrt(size);
    }
    map_colour(&r->g->colour.span[span], z, m->rgb);
    for (int c = 0; c < 3; c++) m->rgb[c] *= light * r->g->opacity;
    m->through = 1 - r->g->opacity;
    return true;
}

/* A time behind the ground by more than rounding: what is in the ground's place is before it. */
static double behind(const struct over *r, double t, double eye)
{
    const double z = fabs(eye) + fabs(eye + t * r->d[2]);
    return t + fmin(ROOM * z / fabs(r->d[2]), BEHIND * t);
}

struct meeting ground_meet(const struct ground *g, const struct spec *s, struct vec3 dir)
{
    struct meeting m = {.is = false};
    struct over r;
    struct patch p;
    double before;
    bool above = false, known = false;
    if (!begin(&r, g, v3_of(s->from), dir, &before)) return m;
    while (!m.is && r.t < r.end) {
        const double next[2] = {leaves(&r, 0), leaves(&r, 1)};
        const double end = fmin(fmin(next[0], next[1]), r.end);
        if (end > r.t) {
            const bool there = patch_of(&r, end, &p);
            if (there && !known) above = p.q[0] >= 0;
            known = there;
            const double w = there ? crossing_of(&p, above) : -1;
            m.is = w >= 0;
            m.t = before + r.t + w * (end - r.t);
            if (m.is && !shade(&r, s, &p, w, &m)) return (struct meeting){.is = false};
            if (m.is) m.t = behind(&r, m.t, s->from[2]);
        }
        if (!pass(&r, next, end)) break;
    }
    return m;
}
