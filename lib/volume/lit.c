/*
 * lit: the adaptive method with a light or an attenuation, where colours change along the ray.
 *
 * A colour is c L: c from the map, L = exp(-a t) (0.3 + 0.7 |n.l|), n along the gradient g, a
 * quadratic in w, l to the light, linear in w. Bounds decide whether a rule is precise enough.
 * Samples do not decide, because they may agree by chance or by rounding. A piece is first cut
 * where g.l, a cubic, changes its sign, because |n.l| has a kink there. Then it is halved until its
 * optical depth is at most DEPTH_MAX and its turn at most TURN_MAX. With x = -1 .. 1 in the piece,
 * g = A + B x + C x^2, l = D + E x,
 *
 *     turn = (|B| + |C|) / |A| + |E| / |D| + a / 2 times the piece's length.
 *
 * So g and l do not vanish for |x| < 2, L is smooth there, and a Gauss-Legendre rule gains about a
 * digit per node. Its error is at most `straight` (the field along the piece is within BEND_MAX) or
 * `bent` (any cubic), times the largest colour and the alpha that the piece adds. These numbers are
 * 1.5 times the worst found by a search: hill climbing from 400 random pieces for each rule, over
 * all permitted cubics, extinctions, colours, A to E and a. The alphas of a ray's pieces sum up to
 * at most 1, so the ray's error is at most that of its worst piece.
 *
 * The time is bounded for all inputs. Turns exceed TURN_MAX only near a complex zero of |g|^2 (at
 * most four) or of |l|^2 (two), and halving leaves those after a few pieces per level. Depths above
 * DEPTH_MAX halve to pieces of at least 1/2, and 75 such pieces make a ray opaque to the last bit.
 * Pieces that exp(-a t) makes fainter than the tolerance are not halved. After HALVINGS_MAX a piece
 * is integrated as it is: it has 1e-12 of the cell's length and is next to a point where the field
 * has no gradient.
 *
 * The colours of a second field are a cubic of their own, so that extinction and colour are of
 * degree 6 together, whatever the field. A rule of 16 nodes is exact to degree 31. That leaves 16
 * for exp(-tau), of a depth of at most 1, and 9 for the light: 2e-5 of the colour is left out, and
 * with 32 nodes 1e-11.
 */
#include "volume/volume_int.h"

#define TURN_MAX 0.5
#define HALVINGS_MAX 40
#define NODES_LEAST 3
#define MIXED_COARSE 1e-4 /* tolerance from which 16 nodes do */

/* Error bounds of the rules of 3, 4, ... nodes. */
static const double straight[] = {1.8e-2, 2.5e-3, 3.7e-4, 5.2e-5, 7.5e-6, 1.2e-6, 1.7e-7, 2.6e-8,
    4e-9, 6.2e-10, 1.1e-10, 1.7e-11};
static const double bent[] = {
    .3, 5.1e-2, 1.1e-2, 1.9e-3, 2.9e-4, 4.6e-5, 6.5e-6, 1e-6, 1.6e-7, 2.7e-8, 4.1e-9, 4.5e-10};

static int nodes_for(double tolerance, const double *error, int n)
{
    int i = 0;
    while (i + 1 < n && error[i] > tolerance) i++;
    return NODES_LEAST + i;
}

void lit_rules(struct volume *v)
{
    const struct map *m = v->second ? &v->tint : &v->map;
    for (uint32_t i = 0; i < m->n; i++) {
        const struct map_span *s = &m->span[i];
        double width = s->hi - s->lo;
        for (int c = 0; c < 3 && !s->transparent; c++)
            v->bright = fmax(v->bright, fmax(s->rgb0[c], s->rgb0[c] + s->rgb1[c] * width));
    }
    volume_gauss_rule(&v->mixed, v->o.tolerance >= MIXED_COARSE ? 16 : 32);
    double tolerance = v->o.tolerance / v->bright; /* infinite if the map is black */
    volume_gauss_rule(&v->rule, nodes_for(tolerance, straight, sizeof straight / sizeof *straight));
    volume_gauss_rule(&v->bent, nodes_for(tolerance, bent, sizeof bent / sizeof *bent));
}

/* Vector from w of the cell to the light. */
static struct vec3 to_light(const struct path *p, double w)
{
    const double *l = p->v->spec->light;
    struct vec3 at = v3_mad(p->v->camera.eye, p->dir, p->cell->t + w * p->cell->len);
    return v3_sub(v3(l[0], l[1], l[2]), at);
}

static double turn_of(const struct path *p, const struct piece *s)
{
    double middle = s->a + (s->b - s->a) / 2, half = (s->b - s->a) / 2 * p->cell->len;
    double turn = p->v->spec->attenuation * half;
    if (!p->v->spec->lit) return turn;
    struct vec3 from = cell_gradient(p->cell, s->a), to = cell_gradient(p->cell, s->b);
    struct vec3 a = cell_gradient(p->cell, middle), c = v3_sub(v3_scale(v3_add(from, to), .5), a);
    double change = v3_len(v3_sub(to, from)) / 2 + v3_len(c);
    if (change > 0) turn += change / v3_len(a);
    return turn + half / v3_len(to_light(p, middle));
}

static void by_turn(struct path *p, const struct piece *s, int halvings)
{
    double depth = volume_depth_to(p, s, 1), fade = p->v->spec->attenuation, lo, hi;
    if (!(depth > 0) || path_done(p)) return;
    bool faint =
        fade > 0 &&
        p->v->bright * volume_exp(-fade * (p->cell->t + s->a * p->cell->len)) <= p->v->o.tolerance;
    bool even = depth <= DEPTH_MAX && turn_of(p, s) <= TURN_MAX;
    if (faint || even || halvings == HALVINGS_MAX) {
        cubic_bounds(s->q, &lo, &hi);
        const struct rule *r = volume_is_straight(s, lo, hi) ? &p->v->rule : &p->v->bent;
        volume_gauss(p, s, depth, s->tint ? &p->v->mixed : r);
        return;
    }
    struct piece half[2];
    volume_halve(s, half);
    for (int i = 0; i < 2; i++) by_turn(p, &half[i], halvings + 1);
}

/* Integrates the part x .. y of the piece. */
static void part(struct path *p, const struct piece *s, double x, double y)
{
    struct piece out = {.span = s->span,
        .a = s->a + (s->b - s->a) * x,
        .b = y < 1 ? s->a + (s->b - s->a) * y : s->b};
    cubic_part(s->q, x, y, out.q);
    out.tint = s->tint;
    if (s->tint) cubic_part(s->of_tint, x, y, out.of_tint);
    if (out.a < out.b) by_turn(p, &out, 0);
}

/* g.l along the piece, as a cubic on 0 .. 1. */
static void facing(const struct path *p, const struct piece *s, double h[4])
{
    struct vec3 from = cell_gradient(p->cell, s->a), to = cell_gradient(p->cell, s->b);
    struct vec3 a = cell_gradient(p->cell, s->a + (s->b - s->a) / 2), l = to_light(p, s->a);
    struct vec3 delta = v3_scale(p->dir, -(s->b - s->a) * p->cell->len);
    struct vec3 bend = v3_sub(v3_scale(v3_add(from, to), 2), v3_scale(a, 4));
    struct vec3 slope = v3_sub(v3_sub(to, from), bend);
    h[0] = v3_dot(from, l);
    h[1] = v3_dot(slope, l) + v3_dot(from, delta);
    h[2] = v3_dot(bend, l) + v3_dot(slope, delta);
    h[3] = v3_dot(bend, delta);
}

void lit_piece(struct path *p, const struct piece *s)
{
    double h[4], turn[4], done = 0;
    if (p->v->spec->lit) {
        facing(p, s, h);
        int n = cubic_monotone(h, turn);
        for (int i = 0; i + 1 < n; i++) {
            double a = turn[i], b = turn[i + 1];
            if ((cubic_at(h, a) < 0) == (cubic_at(h, b) < 0)) continue;
            double kink = cubic_root(h, a, b, 0);
            part(p, s, done, kink);
            done = kink;
        }
    }
    part(p, s, done, 1);
}
