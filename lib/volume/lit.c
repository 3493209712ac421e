/*
 * lit: the adaptive method where a light or an attenuation changes colours along the ray.
 *
 * A colour is c L: c of the map, L = exp(-a t) (0.3 + 0.7 |n.l|), n along the gradient g, a
 * quadratic in w, l to the light, linear in w. No sample decides what is good enough, for samples
 * agree by chance and by rounding; bounds do. A piece is first cut where g.l, a cubic, changes its
 * sign, as |n.l| has a kink there. Then it is halved until its optical depth is at most DEPTH_MAX
 * and its turn at most TURN_MAX. With x = -1 .. 1 in the piece, g = A + B x + C x^2, l = D + E x,
 *
 *     turn = (|B| + |C|) / |A| + |E| / |D| + a / 2 times the piece's length.
 *
 * So g and l do not vanish for |x| < 2, where L is as smooth as any such, and a rule of Gauss and
 * Legendre gains a digit a node or so. Its error is at most `straight` (the field along the piece
 * is as straight as BEND_MAX says) or `bent` (any cubic), times the greatest colour and the alpha
 * that the piece adds. These are 1.5 times what a search for the worst piece found: by hill
 * climbing from 400 random ones for each rule, over all cubics, extinctions and colours, A to E and
 * a that are allowed. As alphas of a ray's pieces sum up to 1 at most, so are its errors at most
 * the worst piece's.
 *
 * Time is bounded whatever the numbers are. Turns are above TURN_MAX only near a complex zero of
 * |g|^2 (four at most) or of |l|^2 (two), from which halving gets away in a few pieces a level;
 * depths above DEPTH_MAX halve to pieces of 1/2 and more, of which 75 make a ray opaque to the last
 * bit; and what exp(-a t) makes fainter than the tolerance is not halved. After HALVINGS_MAX a
 * piece is taken as it is: 1e-12 of a cell, next to a point where the field has no gradient.
 */
#include "volume/volume_int.h"

#define TURN_MAX 0.5
#define HALVINGS_MAX 40
#define NODES_LEAST 3

/* Errors of rules of 3 nodes and more. */
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
    for (uint32_t i = 0; i < v->map.n; i++) {
        const struct span *s = &v->map.span[i];
        double width = s->hi - s->lo;
        for (int c = 0; c < 3 && !s->clear; c++)
            v->bright = fmax(v->bright, fmax(s->rgb0[c], s->rgb0[c] + s->rgb1[c] * width));
    }
    double tolerance = v->o.tolerance / v->bright; /* infinite where all is black */
    gauss_rule(&v->rule, nodes_for(tolerance, straight, sizeof straight / sizeof *straight));
    gauss_rule(&v->bent, nodes_for(tolerance, bent, sizeof bent / sizeof *bent));
}

/* From w of the cell to the light. */
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
    double depth = depth_to(p, s, 1), fade = p->v->spec->attenuation, lo, hi;
    if (!(depth > 0) || path_done(p)) return;
    bool faint =
        fade > 0 &&
        p->v->bright * volume_exp(-fade * (p->cell->t + s->a * p->cell->len)) <= p->v->o.tolerance;
    bool even = depth <= DEPTH_MAX && turn_of(p, s) <= TURN_MAX;
    if (faint || even || halvings == HALVINGS_MAX) {
        cubic_bounds(s->q, &lo, &hi);
        gauss(p, s, depth, is_straight(s, lo, hi) ? &p->v->rule : &p->v->bent);
        return;
    }
    struct piece half[2];
    halve(s, half);
    for (int i = 0; i < 2; i++) by_turn(p, &half[i], halvings + 1);
}

/* From x to y of the piece. */
static void part(struct path *p, const struct piece *s, double x, double y)
{
    struct piece out = {.span = s->span,
        .a = s->a + (s->b - s->a) * x,
        .b = y < 1 ? s->a + (s->b - s->a) * y : s->b};
    cubic_part(s->q, x, y, out.q);
    if (out.a < out.b) by_turn(p, &out, 0);
}

/* g.l along the piece, 0 .. 1. */
static void facing(const struct path *p, const struct piece *s, double h[4])
{
    struct vec3 from = cell_gradient(p->cell, s->a), to = cell_gradient(p->cell, s->b);
    struct vec3 a = cell_gradient(p->cell, s->a + (s->b - s->a) / 2), l = to_light(p, s->a);
    struct vec3 way = v3_scale(p->dir, -(s->b - s->a) * p->cell->len);
    struct vec3 bend = v3_sub(v3_scale(v3_add(from, to), 2), v3_scale(a, 4));
    struct vec3 slope = v3_sub(v3_sub(to, from), bend);
    h[0] = v3_dot(from, l);
    h[1] = v3_dot(slope, l) + v3_dot(from, way);
    h[2] = v3_dot(bend, l) + v3_dot(slope, way);
    h[3] = v3_dot(bend, way);
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
