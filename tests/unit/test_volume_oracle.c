/*
 * The promise of the adaptive method against volume_oracle.h: 200 random grids, of uneven axes,
 * with missing values, mirrored and stretched, with maps that jump, surfaces, lights, attenuation,
 * clip boxes, slices, colours by a second field, and a ground; from outside, from inside, and along
 * the axes.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "volume_oracle.h"
#include "volume_scenes.h"

enum { SEEDS = 200, SIDE = 8, VALUES = 4 * SIDE * SIDE };

struct draw {
    uint64_t seed, n;
};
static double between(struct draw *d, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(d->seed, d->n++);
}
static bool odds(struct draw *d, double p) { return between(d, 0, 1) < p; }

struct look {
    struct grid g;
    struct scene c;
    struct spec_slice slice[4];
    struct spec_knot colour[6], ground[3];
};

static void draw_grid(struct draw *d, struct grid *g)
{
    uint32_t n[3];
    for (int a = 0; a < 3; a++) n[a] = 2 + (uint32_t)between(d, 0, 5);
    *g = make_grid(n[0], n[1], n[2]);
    for (int a = 0; a < 3; a++) {
        double at = between(d, -9, 9), step = between(d, .2, 2);
        for (uint32_t i = 0; i < n[a]; i++, at += step * between(d, .3, 3)) g->at[a][i] = at;
    }
    const double holes = odds(d, .3) ? .08 : 0, noise = odds(d, .5) ? 1 : 8;
    double slope[3];
    for (int a = 0; a < 3; a++) slope[a] = between(d, -2, 2);
    for (uint32_t i = 0; i < n[0] * n[1] * n[2]; i++) {
        double s = noise * between(d, -1, 1);
        for (uint32_t a = 0, k = i; a < 3; k /= n[a], a++) s += slope[a] * (k % n[a]);
        g->value[i] = odds(d, holes) ? NAN : (float)s;
    }
}

static double coordinate(struct draw *d, const struct grid *g, int a)
{
    if (odds(d, .3)) return g->at[a][(uint32_t)between(d, 0, g->n[a])]; /* a plane's */
    return between(d, g->at[a][0], g->at[a][g->n[a] - 1]);
}

static void draw_map(struct draw *d, struct scene *c)
{
    const int knots = 2 + (int)between(d, 0, 6);
    /* If it is empty, slices and surfaces are all there is. */
    const double dense = odds(d, .2) ? 0 : pow(10, between(d, -2, 1));
    double s = between(d, -8, 0);
    for (int i = 0; i < knots; i++) {
        double k = odds(d, .3) ? 0 : dense * between(d, 0, 1);
        knot(c, s, between(d, 0, 1), odds(d, .5), between(d, 0, 1), k);
        if (!odds(d, .2) || i % 2 == 0) s += odds(d, .2) ? between(d, .02, .1) : between(d, .5, 5);
    }
    if (c->knot[knots - 1].s == c->knot[0].s) c->knot[knots - 1].s += 1;
}

static void draw_slices(struct draw *d, struct look *l)
{
    struct spec *s = &l->c.s;
    s->slice = l->slice;
    for (int a = 0; a < 3; a++) /* ascending, as spec_read sorts them */
        if (odds(d, .6))
            l->slice[s->n_slices++] = (struct spec_slice){a,
                s->clipped && odds(d, .3) ? s->clip[a][odds(d, .5)] : coordinate(d, &l->g, a),
                between(d, 0, 1)};
}

/* A box that has at least a third of the grid along each axis. */
static void draw_clip(struct draw *d, struct look *l)
{
    struct spec *s = &l->c.s;
    s->clipped = true;
    for (int a = 0; a < 3; a++) {
        const double low = l->g.at[a][0], high = l->g.at[a][l->g.n[a] - 1];
        s->clip[a][0] = odds(d, .3) ? low : low + (high - low) * between(d, -.1, .3);
        s->clip[a][1] = odds(d, .3) ? high : low + (high - low) * between(d, .7, 1.1);
        if (odds(d, .2)) s->clip[a][0] = l->g.at[a][l->g.n[a] / 2 - 1];
        if (odds(d, .2)) s->clip[a][1] = l->g.at[a][l->g.n[a] / 2];
        if (!(s->clip[a][0] < s->clip[a][1])) s->clip[a][0] = low;
    }
}

/* From outside, from inside, or along an axis, from where a row and a column of rays are within
 * planes that are across the others. */
static void draw_view(struct draw *d, struct look *l)
{
    struct spec *s = &l->c.s;
    double at[3], size = 0;
    for (int a = 0; a < 3; a++) {
        const double low = l->g.at[a][0], high = l->g.at[a][l->g.n[a] - 1];
        s->scale[a] = odds(d, .3) ? -between(d, .3, 3) : odds(d, .5) ? 1 : between(d, .3, 3);
        s->at[a] = coordinate(d, &l->g, a) * s->scale[a];
        at[a] = (low + high) / 2 * s->scale[a];
        size = fmax(size, (high - low) * fabs(s->scale[a]));
        s->up[a] = between(d, -1, 1);
    }
    const bool inside = odds(d, .3), along = odds(d, .25);
    for (int a = 0; a < 3; a++)
        s->from[a] =
            inside ? coordinate(d, &l->g, a) * s->scale[a] : at[a] + size * between(d, -1.5, 1.5);
    if (along) {
        const int axis = (int)between(d, 0, 3);
        for (int a = 0; a < 3; a++) {
            s->from[a] = a == axis ? s->at[a] + (odds(d, .5) ? 2 : -2) * size : s->at[a];
            s->up[a] = a == (axis + 1) % 3;
        }
    }
    s->angle = between(d, 10, 50);
}

/* A second field, which has the holes of the first, and its colours, some of which jump. */
static void draw_second(struct draw *d, struct look *l)
{
    struct spec *s = &l->c.s;
    const size_t nodes = grid_node(&l->g, 0, 0, l->g.n[2]);
    l->g.second = xmalloc(nodes, sizeof *l->g.second);
    for (size_t i = 0; i < nodes; i++)
        l->g.second[i] = isnan(l->g.value[i]) ? NAN : (float)between(d, -5, 5);
    s->colour = l->colour;
    s->n_colours = 1 + (size_t)between(d, 0, 6);
    double at = between(d, -6, 2);
    for (size_t i = 0; i < s->n_colours; i++) {
        l->colour[i] = (struct spec_knot){at, {odds(d, .5), between(d, 0, 1), between(d, 0, 1)}, 0};
        if (!odds(d, .2) || i % 2 == 0) at += odds(d, .3) ? between(d, .01, .1) : between(d, .5, 4);
    }
}

/* A ground within the grid or beyond it, on other nodes, with holes. */
static void draw_ground(struct draw *d, struct look *l)
{
    struct spec *s = &l->c.s;
    struct grid *g = l->g.ground = xmalloc(1, sizeof *g);
    const double *z = l->g.at[2], high = z[l->g.n[2] - 1] - z[0], holes = odds(d, .3) ? .1 : 0;
    *g = make_grid(2 + (uint32_t)between(d, 0, 7), 2 + (uint32_t)between(d, 0, 7), 1);
    for (int a = 0; a < 2; a++) {
        const double from = l->g.at[a][0], to = l->g.at[a][l->g.n[a] - 1];
        const double wide = (to - from) * between(d, .6, 1.5);
        for (uint32_t i = 0; i < g->n[a]; i++)
            g->at[a][i] = from + wide * (i + between(d, -.3, .3)) / (g->n[a] - 1);
    }
    for (uint32_t i = 0; i < g->n[0] * g->n[1]; i++)
        g->value[i] = odds(d, holes) ? NAN : (float)(z[0] + high * between(d, -.2, .8));
    s->ground = l->ground;
    s->n_grounds = 1 + (size_t)between(d, 0, 3);
    double at = z[0];
    for (size_t i = 0; i < s->n_grounds; i++, at += high * between(d, .2, .5))
        l->ground[i] = (struct spec_knot){at, {odds(d, .5), between(d, 0, 1), between(d, 0, 1)}, 0};
}

static void draw_look(struct draw *d, struct look *l)
{
    const double zero[3] = {0, 0, 0};
    draw_grid(d, &l->g);
    l->c = make_scene(zero, zero);
    struct spec *s = &l->c.s;
    s->w = s->h = SIDE;
    draw_view(d, l);
    draw_map(d, &l->c);
    for (int i = 0; i < 2; i++)
        if (odds(d, .3)) iso(&l->c, between(d, -4 + 5 * i, 5 * i), .9, .3, .4, between(d, .1, 1));
    s->lit = odds(d, .5);
    for (int a = 0; a < 3; a++) s->light[a] = s->at[a] + between(d, -20, 20);
    if (odds(d, .3)) s->attenuation = pow(10, between(d, -3, 0));
    if (odds(d, .5)) draw_clip(d, l);
    if (odds(d, .6)) draw_slices(d, l);
    if (odds(d, .4)) draw_second(d, l);
    if (odds(d, .4)) draw_ground(d, l);
    s->knot = l->c.knot, s->iso = l->c.iso, s->slice = l->slice;
}

/* The number of rays that graze something, which are left out. */
static int compare(uint64_t seed, const struct volume_options *o)
{
    static float p[VALUES];
    struct draw d = {seed, 0};
    static struct look l;
    int left_out = 0;
    draw_look(&d, &l);
    render(&l.g, &l.c.s, o, p, NULL);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        oracle_real q[4];
        if (!oracle_pixel(&l.g, &l.c.s, i % SIDE, i / SIDE, q)) {
            left_out++;
            continue;
        }
        for (int c = 0; c < 4; c++) {
            const double e = fabs((double)(p[4 * i + (uint32_t)c] - q[c]));
            if (!(e <= o->tolerance))
                fail_msg("seed %d, pixel %d, %d: %.6g, expected %.6g", (int)seed, (int)i, c,
                    (double)p[4 * i + (uint32_t)c], (double)q[c]);
        }
    }
    grid_free(&l.g);
    return left_out;
}

static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-5, 0, ISA_AUTO, 1};

static void keeps_the_promise(void **state)
{
    (void)state;
    int left_out = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        left_out += compare(seed, &usual);
        if (seed % 4 == 0) compare(seed, &fine);
    }
    if (left_out > SEEDS * SIDE * SIDE / 100) fail_msg("%d rays graze something", left_out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(keeps_the_promise)};
    return cmocka_run_group_tests_name("volume: oracle", tests, NULL, NULL);
}
