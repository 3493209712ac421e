/*
 * Grids of which little is seen, over which rays leap: every live cell is visited as by the code
 * that takes one ray at a time, and the picture is the same, with vectors of any width.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "volume_scenes.h"

enum { SIDE = 21, VALUES = 4 * SIDE * SIDE };

static double between(uint64_t seed, uint64_t *n, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(seed, (*n)++);
}

/* Even planes, or uneven ones; balls, also in corners, of 1 to 6 cells; nothing between them. */
static struct grid balls(uint64_t seed, uint64_t *n)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++) size[a] = 3 + (uint32_t)(rng_u64(seed, (*n)++) % 60);
    struct grid g = make_grid(size[0], size[1], size[2]);
    double stretch = seed % 3 == 0 ? 0 : between(seed, n, 0, .05);
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < g.n[a]; i++) g.at[a][i] = i * (1 + stretch * i);
    for (int ball = (int)(seed % 5); ball > 0; ball--) {
        double at[3], r = between(seed, n, 1, 6);
        for (int a = 0; a < 3; a++) at[a] = between(seed, n, 0, g.n[a]);
        for (uint32_t k = 0, i = 0; k < g.n[2]; k++)
            for (uint32_t y = 0; y < g.n[1]; y++)
                for (uint32_t x = 0; x < g.n[0]; x++, i++) {
                    double d[3] = {x - at[0], y - at[1], k - at[2]};
                    double far = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / r;
                    if (far < 1) g.value[i] += (float)(10 * (1 - far));
                }
    }
    return g;
}

/* Around the grid, in it, or straight along an axis. */
static struct scene look(const struct grid *g, uint64_t seed, uint64_t *n)
{
    double from[3], at[3];
    const double far = seed % 3 == 1 ? .4 : 2;
    for (int a = 0; a < 3; a++) {
        double length = g->at[a][g->n[a] - 1];
        at[a] = length * (seed % 3 == 2 ? .5 : between(seed, n, .3, .7));
        from[a] = length / 2 + length * far * between(seed, n, -1, 1);
        if (seed % 3 == 2) from[a] = at[a] + (a == (int)(seed / 3 % 3) ? 2 * length : 0);
    }
    struct scene c = make_scene(from, at);
    c.s.w = c.s.h = SIDE, c.s.angle = 50;
    knot(&c, 1, .9, .2, .1, 0), knot(&c, 20, .1, .8, .3, 2);
    if (seed % 4 == 0) iso(&c, 3, 1, 1, 1, .5);
    for (int a = 0; a < 3 && seed % 2 == 0; a++) {
        c.s.scale[a] = -1;
        c.s.from[a] *= -1, c.s.at[a] *= -1;
    }
    return c;
}

static void every_live_cell(void **state)
{
    (void)state;
    const struct volume_options usual = VOLUME_OPTIONS_DEFAULT,
                                least = {VOLUME_ADAPTIVE, usual.tolerance, 0, ISA_SSE2, 1},
                                alone = {VOLUME_ADAPTIVE, 1e-8, 0, ISA_AUTO, 1};
    uint64_t cells = 0;
    for (uint64_t seed = 0; seed < 120; seed++) {
        static float p[VALUES], q[VALUES];
        struct volume_counts got, expected;
        uint64_t n = 0;
        struct grid g = balls(seed, &n);
        struct scene c = look(&g, seed, &n);
        c.s.knot = c.knot, c.s.iso = c.iso;
        render(&g, &c.s, &usual, p, &got);
        render(&g, &c.s, &least, q, NULL);
        assert_memory_equal(p, q, sizeof p);
        render(&g, &c.s, &alone, q, &expected);
        for (int i = 0; i < VALUES; i++)
            if (!(fabs((double)p[i] - (double)q[i]) <= usual.tolerance))
                fail_msg("seed %d, %d: %g, expected %g", (int)seed, i, (double)p[i], (double)q[i]);
        if (got.hits != expected.hits || got.cells != expected.cells ||
            got.most_cells != expected.most_cells)
            fail_msg("seed %d: %d hits, %d cells, at most %d; expected %d, %d, %d", (int)seed,
                (int)got.hits, (int)got.cells, (int)got.most_cells, (int)expected.hits,
                (int)expected.cells, (int)expected.most_cells);
        cells += got.cells;
        free_grid(&g);
    }
    assert_true(cells > 20000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_live_cell)};
    return cmocka_run_group_tests_name("volume: leaps", tests, NULL, NULL);
}
