/*
 * stream_lit: segments with a light or an attenuation, VF at a time: a Gauss-Legendre rule over
 * pieces in which neither the field nor the light changes much, as in lit.c.
 *
 * A piece has the greatest turn of lit.c, an optical depth of at most LIT_DEPTH, and no change of
 * the sign of g.l. The error of the rule is then, per alpha, at most
 *
 *     straight * bright           if the field is within BEND_MAX of a straight line
 *     near[0] * bright + near[1] * range   if k varies by at most LIT_NEAR of its maximum
 *     any[0] * bright + any[1] * range     for every cubic
 *
 * with the greatest colour `bright` and the range of colours in the piece: c = its middle + the
 * rest, and the rest is at most half the range. The five numbers are 1.8 times the worst found by
 * hill climbing from 150 random pieces for each. (stream.c)
 *
 * g.l, |g|^2 and |l|^2 are polynomials along the cell, in float. Relative to 1, the greatest
 * gradient of the cell, they are wrong by at most 2^-21. So digits are lost if the gradient is
 * small beside that elsewhere in the cell, or the light is near: then the cell is done alone.
 */
#ifndef STORMRING_VOLUME_STREAM_LIT_H
#define STORMRING_VOLUME_STREAM_LIT_H

#include "volume/stream_cell.h"

#define LIT_TURN 0.5F
#define LIT_DEPTH 0.5F
#define LIT_DEEP 256 /* is done alone */
#define LIT_NEAR 0.6F
#define LIT_LEAST 0x1p-19F /* |g|^2 and |l|^2, times the tolerance */

/* ---- the light in a cell -------------------------------------------------------------------- */

SIMD_INLINE vf dot(const vf a[3], const vf b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The polynomials of cells j .. j+VF. */
SIMD_INLINE void put_light(struct stream *s, uint32_t j, const struct cubics *c)
{
    vf per[3], l[2][3], g[3][3], most = vf_set(0), far = vf_set(0), v[LIGHT_VALUES];
    UNROLLED
    for (int a = 0; a < 3; a++) {
        per[a] = vf_load(s->edge[a] + j);
        l[0][a] = vf_load(s->way[a] + j);
        l[1][a] = -(vf_load(s->delta[a] + j) / per[a]);
        most = vf_max(most, per[a]);
        far = vf_max(far, vf_abs(l[0][a]) + vf_abs(l[1][a]));
    }
    const vf steep = 1 / (c->range * most), near = 1 / far;
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vf by = per[a] * steep;
        g[0][a] = c->g[a][0] * by, g[1][a] = c->g[a][1] * by, g[2][a] = c->g[a][2] * by;
        l[0][a] *= near, l[1][a] *= near;
    }
    v[LIGHT_FACING] = dot(g[0], l[0]);
    v[LIGHT_FACING + 1] = dot(g[0], l[1]) + dot(g[1], l[0]);
    v[LIGHT_FACING + 2] = dot(g[1], l[1]) + dot(g[2], l[0]);
    v[LIGHT_FACING + 3] = dot(g[2], l[1]);
    v[LIGHT_SLOPE] = dot(g[1], g[1]);
    v[LIGHT_GRADIENT] = dot(g[0], g[0]);
    v[LIGHT_GRADIENT + 1] = 2 * dot(g[0], g[1]);
    v[LIGHT_GRADIENT + 2] = 2 * dot(g[0], g[2]) + v[LIGHT_SLOPE];
    v[LIGHT_GRADIENT + 3] = 2 * dot(g[1], g[2]);
    v[LIGHT_GRADIENT + 4] = dot(g[2], g[2]);
    v[LIGHT_WAY] = dot(l[0], l[0]);
    v[LIGHT_WAY + 1] = 2 * dot(l[0], l[1]);
    v[LIGHT_WAY + 2] = dot(l[1], l[1]);
    /* Without a gradient the factor is 1: that of a gradient towards the light. */
    const vi flat = c->range == vf_set(0);
    for (int i = 0; i < LIGHT_VALUES; i++) {
        bool one = i == LIGHT_FACING || i == LIGHT_GRADIENT || i == LIGHT_WAY;
        vf_store(s->light[i] + j, vf_choose(flat, vf_set(one ? 1 : 0), v[i]));
    }
}

/* The cells of some pieces: their light; the distance from the eye; their length. */
struct lit {
    vf v[LIGHT_VALUES], eye, len;
};

SIMD_INLINE vf facing(const struct lit *l, vf w)
{
    const vf *v = l->v + LIGHT_FACING;
    return v[0] + w * (v[1] + w * (v[2] + w * v[3]));
}
SIMD_INLINE vf gradient(const struct lit *l, vf w)
{
    const vf *v = l->v + LIGHT_GRADIENT;
    return v[0] + w * (v[1] + w * (v[2] + w * (v[3] + w * v[4])));
}
SIMD_INLINE vf way(const struct lit *l, vf w)
{
    const vf *v = l->v + LIGHT_WAY;
    return v[0] + w * (v[1] + w * v[2]);
}
/* The factor of a colour at w. */
SIMD_INLINE vf shading(const struct lit *l, vf w)
{
    vf cosine = vf_abs(facing(l, w)) / vf_sqrt(gradient(l, w) * way(l, w));
    return (float)VOLUME_AMBIENT + (float)(1 - VOLUME_AMBIENT) * vf_min(cosine, vf_set(1));
}

/* The turn of the part a .. b, without that of the attenuation; infinity if float does not do. */
SIMD_INLINE vf turn_of(const struct stream *s, const struct lit *l, vf a, vf b)
{
    vf w = (a + b) * 0.5f, half = (b - a) * 0.5f;
    vf gg = gradient(l, w), ll = way(l, w), least = vf_set(LIT_LEAST / s->tolerance);
    vf b3 = l->v[LIGHT_GRADIENT + 3], b4 = l->v[LIGHT_GRADIENT + 4];
    vf slope = vf_max(l->v[LIGHT_SLOPE] + 2 * w * (b3 + 2 * w * b4), vf_set(0));
    vf turn = half * ((vf_sqrt(slope) + half * vf_sqrt(b4)) / vf_sqrt(gg) +
                         vf_sqrt(l->v[LIGHT_WAY + 2] / ll));
    return vf_choose((gg >= least) & (ll >= least), turn, vf_set(HUGE_VALF));
}

/* ---- what a segment adds -------------------------------------------------------------------- */

/* See above. k: at the ends of the field's range, which is `range`. */
SIMD_INLINE vf lit_error(
    const struct stream *s, const vf q[4], vf range, vf k_lo, vf k_hi, vf slope)
{
    const float bright = s->bright;
    vf most = vf_max(k_lo, k_hi), least = vf_min(k_lo, k_hi), colours = slope * range;
    vf any = bright * s->any[0] + colours * s->any[1];
    vf near = bright * s->near[0] + colours * s->near[1];
    vi straight = vf_abs(q[2]) + vf_abs(q[3]) <= (float)BEND_MAX * range;
    vi is_near = least >= (1 - LIT_NEAR) * most;
    vf error = vf_choose(is_near, near, any);
    return vf_choose(straight, vf_min(error, vf_set(bright * s->straight)), error);
}

/* Integrates part a .. b of the cells of l, where the field is base + p in the map's entries e.
 * *turn: that of the part, in units of the greatest. */
SIMD_INLINE struct added integrate_lit(
    const struct stream *s, vi e, vf base, const vf p[4], const struct lit *l, vf a, vf b, vf *turn)
{
    const struct stream_map *m = &s->map;
    const bool few = m->entries <= 8, lit = s->v->spec->lit;
    const float fade = (float)s->v->spec->attenuation;
    struct added r;
    vf k0 = vf_lookup(m->k0, few, e), k1 = vf_lookup(m->k1, few, e), lo, hi;
    vf from = (vf_lookup(m->from_high, few, e) - base) + vf_lookup(m->from_low, few, e);
    const vf q[4] = {p[0] - from, p[1], p[2], p[3]};
    vf h = b - a, len = h * l->len, faded = vf_exp(-fade * (l->eye + a * l->len));
    /* Depth and attenuation from the start of the part, as a polynomial without constant. */
    const vf per = k1 * len;
    const vf u[4] = {(k0 + k1 * q[0]) * len, per * q[1] * (1.0f / 2), per * q[2] * (1.0f / 3),
        per * q[3] * (1.0f / 4)};
    vf depth = u[0] + u[1] + u[2] + u[3], first = u[0] + fade * len;
    vi seen = depth > vf_set(0);
    vf sum = vf_set(0), by_q = vf_set(0);
    for (int i = 0; i < s->nodes; i++) {
        const float w = s->at[i];
        vf x = q[0] + w * (q[1] + w * (q[2] + w * q[3]));
        vf through = vf_exp(-(w * (first + w * (u[1] + w * (u[2] + w * u[3])))));
        vf add = s->weight[i] * (k0 + k1 * x) * through;
        if (lit) add *= shading(l, a + h * w);
        sum += add;
        by_q += add * x;
    }
    vf scale = vf_choose(seen, len * faded, vf_set(0));
    sum *= scale, by_q *= scale;
    UNROLLED
    for (int c = 0; c < 3; c++)
        r.rgb[c] = vf_lookup(m->rgb0[c], few, e) * sum + vf_lookup(m->rgb1[c], few, e) * by_q;
    r.alpha = vf_choose(seen, 1 - vf_exp(-depth), vf_set(0));
    bounds(q, &lo, &hi);
    vf t = 0.5f * fade * len;
    if (lit) t += turn_of(s, l, a, b);
    vf error = lit_error(s, q, hi - lo, k0 + k1 * lo, k0 + k1 * hi, vf_lookup(m->slope, few, e));
    vf deep = depth * (1 / LIT_DEPTH);
    error = vf_max(error, vf_choose(deep > vf_set(1), s->tolerance * 1.01f * deep * deep, error));
    /* Where the attenuation leaves less than half the tolerance, any colour will do. */
    vi faint = faded * s->bright <= vf_set(s->tolerance * 0.5f);
    vi good = (t <= vf_set(LIT_TURN)) & (depth <= vf_set(LIT_DEEP));
    error = vf_choose(good, error * faded, vf_set(HUGE_VALF));
    r.error = vf_choose(~seen | faint, vf_set(0), error);
    *turn = vf_choose(t >= vf_set(0), t * (1 / LIT_TURN), vf_set(HUGE_VALF)); /* NaN: infinity */
    return r;
}

/* ---- cells of the list ---------------------------------------------------------------------- */

/* True where g.l may change its sign in the cell. */
SIMD_INLINE vi has_kink(const struct lit *l)
{
    vf lo, hi;
    bounds(l->v + LIGHT_FACING, &lo, &hi);
    return ~((lo >= vf_set(0)) | (hi <= vf_set(0)));
}

/* Integrates all cells; marks those that are simple. */
static void integrate_lit_cells(struct stream *s)
{
    for (uint32_t j = 0; j < s->cells; j += VF) {
        const vf p[4] = {
            vf_load(s->p[0] + j), vf_load(s->p[1] + j), vf_load(s->p[2] + j), vf_load(s->p[3] + j)};
        struct lit l = {.eye = vf_load(s->eye + j), .len = vf_load(s->len + j)};
        vi first = vi_load(s->first + j), last = vi_load(s->last + j), kink = {0};
        vf turn;
        for (int i = 0; i < LIGHT_VALUES && s->v->spec->lit; i++) l.v[i] = vf_load(s->light[i] + j);
        struct added r =
            integrate_lit(s, first, vf_load(s->base + j), p, &l, vf_set(0), vf_set(1), &turn);
        if (s->v->spec->lit) kink = has_kink(&l);
        put_added(s->add + j, &r);
        vf_store(s->turn + j, turn);
        s->simple[j / VF] = (uint16_t)vi_signs(
            (first == last) & (~kink | (r.error == vf_set(0))) & (r.error <= vf_set(s->tolerance)));
    }
}

#endif
