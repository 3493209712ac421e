/*
 * Light, attenuation and surfaces, which the default method does in vectors: on random uneven grids
 * with holes, mirrored too, the promised error and the same bits in all instruction sets; and
 * marching in long double.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "rounds.h"
#include "volume_scenes.h"

enum { SIDE = 12, VALUES = 4 * SIDE * SIDE };

static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
static const struct volume_options converged = {VOLUME_ADAPTIVE, 1e-8, 0, ISA_AUTO, 1};

static double between(uint64_t seed, uint64_t *n, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(seed, (*n)++);
}

/* Waves and noise, of any share; `rough`: holes too. Of size cells, or one or two less. */
static struct grid random_grid(uint64_t seed, uint64_t *n, uint32_t size, bool rough)
{
    struct grid g = make_grid(size + 1, size > 2 ? size : 2, size > 3 ? size - 1 : 2);
    double wave[3], noise = pow(10, between(seed, n, -3, .5)), stretch = between(seed, n, 0, .3);
    for (int a = 0; a < 3; a++) {
        wave[a] = between(seed, n, -.7, .7);
        for (uint32_t i = 0; i < g.n[a]; i++) g.at[a][i] = i * (1 + stretch * i);
    }
    for (uint32_t i = 0; i < g.n[0] * g.n[1] * g.n[2]; i++) {
        double x = i % g.n[0], y = i / g.n[0] % g.n[1], z = i / g.n[0] / g.n[1];
        double s = 5 + 4 * sin(wave[0] * x + wave[1] * y) + wave[2] * z;
        g.value[i] = (float)(s + noise * between(seed, n, -1, 1));
        if (rough && rng_unit(seed, (*n)++) < .01) g.value[i] = NAN;
    }
    return g;
}

/* Spans wide enough for float. */
static struct scene random_scene(uint64_t seed, uint64_t *n)
{
    double from[3], at[3] = {5, 4, 3}, s = between(seed, n, -2, 4);
    double dense = pow(10, between(seed, n, -2, 1)), far = rng_unit(seed, (*n)++) < .5 ? 4 : 40;
    for (int a = 0; a < 3; a++) from[a] = at[a] + between(seed, n, -15, 15);
    struct scene c = make_scene(from, at);
    c.s.w = c.s.h = SIDE, c.s.angle = 45;
    for (int i = 0; i < 5; i++) {
        double k = i == 2 ? 0 : dense * between(seed, n, 0, 1);
        knot(&c, s, i & 1, between(seed, n, 0, 1), 1 - (i & 1), k);
        s += rng_unit(seed, (*n)++) < .2 ? 0 : between(seed, n, .4, 4);
    }
    c.s.lit = seed % 4 > 0;
    for (int a = 0; a < 3; a++) c.s.light[a] = at[a] + between(seed, n, -far, far);
    if (seed % 4 % 3 == 0) c.s.attenuation = pow(10, between(seed, n, -3, 0));
    return c;
}

static void add_surfaces(struct scene *c, uint64_t seed, uint64_t *n)
{
    for (int i = 0; i < 2; i++) iso(c, between(seed, n, 0, 10), i, .5, .2, between(seed, n, .1, 1));
}

/* In all instruction sets; the bits are the same. */
static void draw(const struct grid *g, const struct scene *c, float *p)
{
    static float wide[VALUES];
    struct volume_options o = usual;
    o.isa = ISA_SSE2;
    render(g, &c->s, &o, p, NULL);
    for (o.isa = ISA_AVX2; o.isa <= ISA_AVX512; o.isa++) {
        if (!isa_available(o.isa)) continue;
        render(g, &c->s, &o, wide, NULL);
        assert_memory_equal(p, wide, sizeof wide);
    }
}

/* The picture is as near to the converged one as the tolerance says. */
static void meets_the_tolerance(const struct grid *g, const struct scene *c, uint64_t seed)
{
    static float p[VALUES], q[VALUES];
    draw(g, c, p);
    render(g, &c->s, &converged, q, NULL);
    for (int i = 0; i < VALUES; i++)
        if (!(fabs((double)p[i] - (double)q[i]) <= usual.tolerance))
            fail_msg("seed %d, %d: %g, expected %g", (int)seed, i, (double)p[i], (double)q[i]);
}

static void keeps_the_tolerance(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)nightly(50, 200); seed++) {
        uint64_t n = 0;
        struct grid g = random_grid(seed, &n, 8, true);
        struct scene c = random_scene(seed, &n);
        if (seed % 3 == 0) add_surfaces(&c, seed, &n);
        for (int a = 0; a < 3 && seed % 5 == 0; a++) { /* seen from the other side */
            c.s.scale[a] = -1;
            c.s.from[a] *= -1, c.s.at[a] *= -1, c.s.light[a] *= -1;
        }
        c.s.knot = c.knot, c.s.iso = c.iso;
        meets_the_tolerance(&g, &c, seed);
        free_grid(&g);
    }
}

/* The light's kinks, in grids of one cell, which has all of a ray's alpha. */
static void one_cell(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)nightly(50, 200); seed++) {
        uint64_t n = 0;
        struct grid g = random_grid(seed, &n, 1, false);
        struct scene c = random_scene(seed, &n);
        for (int a = 0; a < 3; a++) c.s.from[a] = 2 - .4 * c.s.from[a], c.s.at[a] = .5;
        c.s.knot = c.knot;
        meets_the_tolerance(&g, &c, seed);
        free_grid(&g);
    }
}

/* Surfaces alone, without a map: the same picture as with a map that shows nothing. */
static void surfaces_alone(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        static float p[VALUES], q[VALUES];
        uint64_t n = 0;
        struct grid g = random_grid(seed, &n, 8, true);
        struct scene c = random_scene(seed, &n);
        add_surfaces(&c, seed, &n);
        c.s.knot = c.knot, c.s.iso = c.iso;
        c.s.n_knots = 0;
        draw(&g, &c, p);
        render(&g, &c.s, &converged, q, NULL);
        for (int i = 0; i < VALUES; i++) assert_true(fabsf(p[i] - q[i]) <= 1e-6F);
        free_grid(&g);
    }
}

/* ref_pixel knows light and attenuation. It steps over kinks of the light. */
static void marching(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 60; seed++) {
        static float p[VALUES];
        uint64_t n = 0;
        struct grid g = random_grid(seed, &n, 8, false);
        struct scene c = random_scene(seed, &n);
        c.s.knot = c.knot;
        render(&g, &c.s, &usual, p, NULL);
        for (uint32_t i = (uint32_t)(seed % 29); i < SIDE * SIDE; i += 29) {
            real r[4];
            ref_pixel(&g, &c.s, i % SIDE, i / SIDE, 24, r);
            for (uint32_t k = 0; k < 4; k++)
                if (!(fabs((double)(p[4 * i + k] - r[k])) <= usual.tolerance))
                    fail_msg("seed %d, %u: %g, expected %g", (int)seed, i, (double)p[4 * i + k],
                        (double)r[k]);
        }
        free_grid(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_the_tolerance),
        cmocka_unit_test(one_cell),
        cmocka_unit_test(surfaces_alone),
        cmocka_unit_test(marching),
    };
    return cmocka_run_group_tests_name("volume: light", tests, NULL, NULL);
}
