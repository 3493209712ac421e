/*
 * Even grids, whose rays walk in float where the map is no finer than that allows: the promised
 * error, in fields that are as steep as that, and the same bits however the pixels are grouped.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "rounds.h"
#include "volume_scenes.h"

#define SIDE 24
#define VALUES (4 * SIDE * SIDE)

static double between(uint64_t seed, uint64_t *n, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(seed, (*n)++);
}

/* Waves, and noise from node to node of up to 4 times the span of the map. */
static struct grid even_grid(uint64_t seed, uint64_t *n)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++) size[a] = 2 + (uint32_t)(rng_u64(seed, (*n)++) % 45);
    if (seed % 7 == 0) size[seed % 3] = 400;
    struct grid g = make_grid(size[0], size[1], size[2]);
    const double noise = between(seed, n, 0, 1) < .5 ? 0 : pow(10, between(seed, n, -1, .6));
    for (int a = 0; a < 3; a++) {
        const double from = between(seed, n, -50, 50), edge = pow(2, between(seed, n, -2, 2));
        for (uint32_t i = 0; i < g.n[a]; i++) g.at[a][i] = from + i * edge;
    }
    for (uint32_t k = 0, i = 0; k < g.n[2]; k++)
        for (uint32_t y = 0; y < g.n[1]; y++)
            for (uint32_t x = 0; x < g.n[0]; x++, i++)
                g.value[i] = (float)(5 + 2 * sin(.3 * x) * cos(.2 * y + .4 * k) +
                                     noise * between(seed, n, -1, 1));
    return g;
}

/* From outside, from within, along an axis, or nearly so. */
static struct scene look(const struct grid *g, uint64_t seed, uint64_t *n)
{
    double from[3], at[3], far = 0;
    const int axis = (int)(seed / 4 % 3);
    for (int a = 0; a < 3; a++) {
        const double *p = g->at[a], length = p[g->n[a] - 1] - p[0];
        far = fmax(far, length);
        at[a] = seed % 4 < 2 ? p[0] + length * between(seed, n, .3, .7) : p[g->n[a] / 2];
        from[a] = seed % 4 == 1 ? p[0] + length * between(seed, n, .1, .9) : at[a];
    }
    for (int a = 0; a < 3; a++) {
        if (seed % 4 == 0) from[a] += 2 * far * between(seed, n, -1, 1);
        if (seed % 4 >= 2 && a == axis) from[a] += 2 * far;
        else if (seed % 4 == 3) from[a] += 1e-9 * far;
    }
    struct scene c = make_scene(from, at);
    const double thick = pow(10, between(seed, n, -1.5, 1)) / far * 10;
    c.s.w = c.s.h = SIDE, c.s.angle = 40;
    knot(&c, 4, .9, .2, .1, 0), knot(&c, 5, .1, .8, .3, thick);
    knot(&c, 6, .2, .3, .9, .3 * thick), knot(&c, 8, 1, 1, 1, 2 * thick);
    for (int a = 0; a < 3 && seed % 5 == 0; a++)
        c.s.scale[a] = -1, c.s.from[a] *= -1, c.s.at[a] *= -1;
    return c;
}

static void keeps_the_tolerance(void **state)
{
    (void)state;
    static float p[VALUES], q[VALUES];
    const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
    const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-7, 0, ISA_AUTO, 1};
    double seen = 0, worst = 0;
    for (uint64_t seed = 0; seed < (uint64_t)rounds(80); seed++) {
        uint64_t n = 0;
        struct grid g = even_grid(seed, &n);
        struct scene c = look(&g, seed, &n);
        c.s.knot = c.knot, c.s.iso = c.iso;
        render(&g, &c.s, &usual, p, NULL);
        render(&g, &c.s, &fine, q, NULL);
        for (int i = 0; i < VALUES; i++) {
            double e = fabs((double)p[i] - (double)q[i]);
            worst = fmax(worst, e);
            if (!(e <= usual.tolerance)) fail_msg("seed %d, %d: error %.3g", (int)seed, i, e);
            seen += (double)q[i] / VALUES;
        }
        free_grid(&g);
    }
    print_message("# at worst %.2g\n", worst);
    assert_true(seen > rounds(5));
}

/* By each kernel; one pixel at a time; in rows from the last. */
static void same_bits(void **state)
{
    (void)state;
    static float p[VALUES], q[VALUES];
    for (uint64_t seed = 0; seed < (uint64_t)rounds(40); seed++) {
        uint64_t n = 0;
        struct grid g = even_grid(seed, &n);
        struct scene c = look(&g, seed, &n);
        struct volume_options o = VOLUME_OPTIONS_DEFAULT;
        c.s.knot = c.knot, c.s.iso = c.iso;
        render(&g, &c.s, &o, p, NULL);
        for (o.isa = ISA_AUTO; o.isa <= ISA_AVX512; o.isa++) {
            struct lattice all = {0, 0, SIDE, SIDE, 1, 1};
            if (!isa_available(o.isa)) continue;
            struct volume *v = volume_new(&g, &c.s, &o);
            for (uint32_t y = SIDE; y-- > 0;)
                volume_pixels(v, &all, (uint64_t)y * SIDE, SIDE, q + 4 * (size_t)y * SIDE);
            assert_memory_equal(p, q, sizeof p);
            for (uint32_t i = 0; i < SIDE * SIDE; i++) volume_pixels(v, &all, i, 1, q + 4 * i);
            assert_memory_equal(p, q, sizeof p);
            volume_free(v);
        }
        free_grid(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_the_tolerance),
        cmocka_unit_test(same_bits),
    };
    return cmocka_run_group_tests_name("volume: even grids", tests, NULL, NULL);
}
