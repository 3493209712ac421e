/*
 * The error that the adaptive method promises, in the worst pixel: random small grids with sharp
 * fronts, under lights and attenuations, with surfaces, against a picture of very many sub-steps.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "rounds.h"
#include "volume_scenes.h"

#define NODES 4
#define SIDE 4

static double between(uint64_t seed, uint64_t *n, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(seed, (*n)++);
}

static void random_grid(struct grid *g, uint64_t seed, uint64_t *n)
{
    double slope[3], steps = rng_unit(seed, (*n)++) < .5 ? 2 : 1e6;
    for (int a = 0; a < 3; a++) slope[a] = between(seed, n, -3, 3);
    double noise = between(seed, n, 0, 1) < .5 ? 1 : 10;
    for (uint32_t i = 0; i < NODES * NODES * NODES; i++) {
        double s = 5 + noise * between(seed, n, -1, 1);
        for (uint32_t a = 0, k = i; a < 3; a++, k /= NODES) s += slope[a] * (k % NODES - 1.5);
        g->value[i] =
            (float)(floor(s * steps) / steps); /* by halves: cells in which nothing varies */
    }
}

/* Soft or with fronts that a cell has hundreds of, thin or nearly opaque. */
static void random_map(struct scene *c, uint64_t seed, uint64_t *n)
{
    int knots = 2 + (int)(rng_u64(seed, (*n)++) % 6);
    double dense = pow(10, between(seed, n, -2, 1.5)), s = between(seed, n, -4, 6);
    for (int i = 0; i < knots; i++) {
        double k = rng_unit(seed, (*n)++) < .3 ? 0 : dense * between(seed, n, 0, 1);
        double r = rng_unit(seed, (*n)++) < .5 ? 0 : 1;
        knot(c, s, r, between(seed, n, 0, 1), 1 - r, k);
        s += rng_unit(seed, (*n)++) < .5 ? between(seed, n, .01, .05) : between(seed, n, .5, 5);
    }
}

static struct scene random_scene(uint64_t seed, uint64_t *n)
{
    double from[3], at[3] = {1.5, 1.5, 1.5};
    for (int a = 0; a < 3; a++) from[a] = between(seed, n, -5, 8);
    struct scene c = make_scene(from, at);
    c.s.w = c.s.h = SIDE, c.s.angle = 40;
    random_map(&c, seed, n);
    if (rng_unit(seed, (*n)++) < .5) iso(&c, between(seed, n, 0, 10), 1, .5, .2, .5);
    c.s.lit = rng_unit(seed, (*n)++) < .8;
    double far = rng_unit(seed, (*n)++) < .5 ? 2 : 30; /* or in the grid */
    for (int a = 0; a < 3; a++) c.s.light[a] = 1.5 + between(seed, n, -far, far);
    if (rng_unit(seed, (*n)++) < .4) c.s.attenuation = pow(10, between(seed, n, -2, 1));
    return c;
}

/* The worst component, of the picture of a seed by two methods. */
static double difference(
    uint64_t seed, const struct volume_options *a, const struct volume_options *b)
{
    static float p[2][4 * SIDE * SIDE];
    uint64_t n = 0;
    struct grid g = make_grid(NODES, NODES, NODES);
    random_grid(&g, seed, &n);
    struct scene c = random_scene(seed, &n);
    c.s.knot = c.knot, c.s.iso = c.iso;
    render(&g, &c.s, a, p[0], NULL);
    render(&g, &c.s, b, p[1], NULL);
    double worst = 0;
    for (int i = 0; i < 4 * SIDE * SIDE; i++)
        worst = fmax(worst, fabs((double)p[0][i] - (double)p[1][i]));
    free_grid(&g);
    return worst;
}

static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-5, 0, ISA_AUTO, 1};
static const struct volume_options converged = {VOLUME_ADAPTIVE, 1e-9, 0, ISA_AUTO, 1};
/* Whose own error is that of fronts and jumps, which a sub-step goes over. */
static const struct volume_options many = {VOLUME_TRAPEZOID, 0, 20000, ISA_AUTO, 1};

/* The worst of 70000 other seeds has an error of 6.3e-4. */
static void keeps_the_tolerance(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)nightly(200, 800); seed++) {
        double e = difference(seed, &usual, &converged);
        if (e > usual.tolerance) fail_msg("seed %d: error %.3g", (int)seed, e);
        if (seed % 4) continue;
        e = difference(seed, &fine, &converged);
        if (e > fine.tolerance) fail_msg("seed %d: error %.3g of 1e-5", (int)seed, e);
    }
}

static void converges_to_the_integral(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)nightly(8, 24); seed++) {
        double e = difference(seed, &converged, &many);
        if (e > 3e-4) fail_msg("seed %d: error %.3g", (int)seed, e);
    }
}

/* Spans that are narrow beside the steps from node to node, for which float does not do: a contour
 * and a wide haze, in fields of steps from 1 to 1e5. */
static void narrow_spans(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)nightly(100, 300); seed++) {
        static float p[2][4 * SIDE * SIDE];
        uint64_t n = 0;
        const double step = pow(10, between(seed, &n, 0, 5)), width = between(seed, &n, .01, .1);
        struct grid g = make_grid(NODES, NODES, NODES);
        for (uint32_t i = 0; i < NODES * NODES * NODES; i++)
            g.value[i] = (float)(step * between(seed, &n, -1, 1));
        struct scene c = random_scene(seed, &n);
        c.s.n_knots = 0;
        knot(&c, -2 * step, 1, 0, 0, .1), knot(&c, 0, 0, 1, 0, .2);
        knot(&c, width, 1, 1, 0, step / width), knot(&c, 2 * width, 0, 0, 1, 0);
        c.s.knot = c.knot, c.s.iso = c.iso;
        c.s.lit = seed % 4 == 0;
        render(&g, &c.s, &usual, p[0], NULL);
        render(&g, &c.s, &converged, p[1], NULL);
        for (int i = 0; i < 4 * SIDE * SIDE; i++) {
            double e = fabs((double)p[0][i] - (double)p[1][i]);
            if (e > usual.tolerance) fail_msg("seed %d: error %.3g", (int)seed, e);
        }
        free_grid(&g);
    }
}

/* A dense span that a ray touches over a whole cell, where the field is below the float of its
 * range: the optical depth is not what float says. */
static void dense_spans(void **state)
{
    (void)state;
    const double from[3] = {.50000002682, -5, .5}, at[3] = {.50000002682, .5, .5};
    float p[2][4];
    struct grid g = make_grid(2, 2, 2);
    for (uint32_t i = 0; i < 8; i++) g.value[i] = i & 1 ? 1000 : 0;
    struct scene c = make_scene(from, at);
    knot(&c, 500, 1, 1, 1, 0), knot(&c, 501, 1, 1, 1, 1e5);
    c.s.knot = c.knot;
    render(&g, &c.s, &usual, p[0], NULL);
    render(&g, &c.s, &converged, p[1], NULL);
    assert_true(p[1][3] > .9F);
    for (int i = 0; i < 4; i++)
        assert_true(fabs((double)p[0][i] - (double)p[1][i]) <= usual.tolerance);
    free_grid(&g);
}

/* Nothing varies; steps of 1e18; denormals, holes, and all together. */
static float hard_value(int kind, uint64_t i)
{
    static const float v[] = {5, 1e18F, -1e18F, 1e-40F, 0, NAN};
    double u = rng_unit(7, i);
    if (kind == 0) return 5;
    if (kind == 1) return v[1 + (i & 1)];
    if (kind == 2) return u < .3 ? 5 : (float)(10 * u);
    return v[(int)(6 * u)];
}

/* The work of a cell is bounded, whatever is in it: it does not wait for digits that rounding
 * takes. */
static void work_is_bounded(void **state)
{
    (void)state;
    static float p[4 * 16 * 16];
    const double from[3] = {-6, -9, 16}, at[3] = {3.5, 3.5, 3.5};
    static const double thick[] = {1, 1000, 1e17};
    for (int i = 0; i < 4 * 3 * 3; i++) {
        struct grid g = make_grid(8, 8, 8);
        for (uint32_t k = 0; k < 512; k++) g.value[k] = hard_value(i % 4, k);
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 16, c.s.angle = 40;
        double k = thick[i / 4 % 3];
        knot(&c, -1e18, .1, .2, .9, 0), knot(&c, 4.99, .9, .8, .1, .05 * k);
        knot(&c, 5, .2, .9, .3, 8 * k), knot(&c, 5.01, .9, .1, .1, k), knot(&c, 1e18, 1, 1, 1, k);
        iso(&c, 6, 1, .5, .2, .4);
        c.s.lit = i / 12 != 1;
        c.s.attenuation = i / 12 == 0 ? 0 : 1e-3 * k;
        for (int a = 0; a < 3; a++) c.s.light[a] = 3.3;
        struct volume_counts n;
        render(&g, &c.s, &converged, p, &n);
        for (int j = 0; j < 4 * 16 * 16; j++) assert_true(isfinite(p[j]));
        if (n.samples > 2000 * (n.cells + 1))
            fail_msg("case %d: %g samples in %g cells", i, (double)n.samples, (double)n.cells);
        free_grid(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_the_tolerance),
        cmocka_unit_test(converges_to_the_integral),
        cmocka_unit_test(narrow_spans),
        cmocka_unit_test(dense_spans),
        cmocka_unit_test(work_is_bounded),
    };
    return cmocka_run_group_tests_name("volume: error", tests, NULL, NULL);
}
