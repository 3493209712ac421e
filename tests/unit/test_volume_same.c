/*
 * Pictures of volumes that have to be the same: of a grid that is mirrored, turned, refined, in
 * other units, or cut in two.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "rounds.h"
#include "volume_scenes.h"

#include <string.h>

enum { SIDE = 24, VALUES = 4 * SIDE * SIDE };

/* Each takes the same cells by the same operations, except for refinement. */
static const struct {
    const char *name;
    struct volume_options o;
    double most; /* difference: of rounding, or of another choice within the tolerance */
} methods[] = {
    {"adaptive", VOLUME_OPTIONS_DEFAULT, 2.0 / 1024},
    {"adaptive:1e-6", {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO, 1}, 5e-6},
    {"gauss:5", {VOLUME_GAUSS, 0, 5, ISA_AUTO, 1}, 2e-6},
    {"trapezoid:3", {VOLUME_TRAPEZOID, 0, 3, ISA_AUTO, 1}, 2e-6},
    {"doubling:1e-4", {VOLUME_DOUBLING, 1e-4, 0, ISA_AUTO, 1}, 2e-4},
};
#define METHODS (sizeof methods / sizeof *methods)

/* Multiples of 1/64 that differ from node to node, so that means of 8 of them are exact. */
static double rough(double x, double y, double z)
{
    uint64_t node = (uint64_t)(x * 64) * 1000003 + (uint64_t)(y * 64) * 1009 + (uint64_t)(z * 64);
    return floor(64 * (5 + 4 * sin(x * 0.7) * cos(y * 0.6) + 2 * rng_unit(3, node))) / 64;
}
/* Uneven planes at multiples of 1/8. */
static struct grid rough_grid(void)
{
    struct grid g = make_grid(9, 8, 7);
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < g.n[a]; i++) g.at[a][i] = i * (1 + 0.125 * (i / 3)) + 0.5 * a;
    fill(&g, rough);
    return g;
}
static struct scene seen(void)
{
    const double from[3] = {-5, -7, 11}, at[3] = {4.5, 4.5, 4};
    struct scene c = make_scene(from, at);
    c.s.w = c.s.h = SIDE, c.s.angle = 38;
    knot(&c, 2, 0.1, 0.2, 0.9, 0), knot(&c, 5, 0.2, 0.9, 0.3, 0.1);
    knot(&c, 7, 0.9, 0.8, 0.1, 0.4), knot(&c, 7, 0.2, 0.1, 0.1, 0.05);
    knot(&c, 8, 1, 1, 1, 5), knot(&c, 8.25, 0, 0.5, 0.5, 0);
    return c;
}
static struct grid copy(const struct grid *g)
{
    struct grid out = make_grid(g->n[0], g->n[1], g->n[2]);
    for (int a = 0; a < 3; a++) memcpy(out.at[a], g->at[a], g->n[a] * sizeof(double));
    memcpy(out.value, g->value, grid_node(g, 0, 0, g->n[2]) * sizeof(float));
    return out;
}
static void picture(const struct grid *g, struct scene *c, size_t method, float *p)
{
    c->s.knot = c->knot, c->s.iso = c->iso;
    render(g, &c->s, &methods[method].o, p, NULL);
}
/* Is anything there to be compared? */
static void assert_seen(const float *p)
{
    double sum = 0;
    for (int i = 3; i < VALUES; i += 4) sum += (double)p[i];
    double share = sum / (double)(SIDE * SIDE);
    assert_true(share > 0.2 && share < 0.95);
}
static void assert_same(
    const char *what, size_t method, const float *p, const float *q, double most)
{
    for (int i = 0; i < VALUES; i++)
        if (!(fabs((double)p[i] - (double)q[i]) <= most))
            fail_msg("%s, %s: %d: %.9g and %.9g", what, methods[method].name, i, (double)p[i],
                (double)q[i]);
}

/* ---- mirrored, turned ------------------------------------------------------------------------ */

/* Left and right change places, along each axis. */
static void mirrored(void **state)
{
    (void)state;
    static float p[VALUES], q[VALUES], turned[VALUES];
    struct grid g = rough_grid();
    for (int a = 0; a < 3; a++) {
        struct grid m = copy(&g);
        for (uint32_t i = 0; i < g.n[a]; i++) m.at[a][i] = -g.at[a][g.n[a] - 1 - i];
        for (uint32_t k = 0; k < g.n[2]; k++)
            for (uint32_t j = 0; j < g.n[1]; j++)
                for (uint32_t i = 0; i < g.n[0]; i++) {
                    uint32_t to[3] = {i, j, k};
                    to[a] = g.n[a] - 1 - to[a];
                    m.value[grid_node(&m, to[0], to[1], to[2])] = g.value[grid_node(&g, i, j, k)];
                }
        for (size_t method = 0; method < METHODS; method++) {
            struct scene c = seen();
            picture(&g, &c, method, p);
            assert_seen(p);
            c.s.from[a] *= -1, c.s.at[a] *= -1, c.s.up[a] *= -1;
            picture(&m, &c, method, q);
            for (int i = 0; i < SIDE * SIDE; i++)
                memcpy(turned + 4 * (i - i % SIDE + SIDE - 1 - i % SIDE), q + 4 * i, 16);
            assert_same("mirrored", method, p, turned, methods[method].most);
        }
        free_grid(&m);
    }
    free_grid(&g);
}

/* x, y, z become y, z, x, and z, x, y: rotations, so that the picture stays. */
static void permuted(void **state)
{
    (void)state;
    static float p[VALUES], q[VALUES];
    struct grid g = rough_grid();
    for (int shift = 1; shift < 3; shift++) {
        uint32_t n[3];
        for (int a = 0; a < 3; a++) n[(a + shift) % 3] = g.n[a];
        struct grid m = make_grid(n[0], n[1], n[2]);
        for (int a = 0; a < 3; a++) memcpy(m.at[(a + shift) % 3], g.at[a], g.n[a] * sizeof(double));
        for (uint32_t k = 0; k < g.n[2]; k++)
            for (uint32_t j = 0; j < g.n[1]; j++)
                for (uint32_t i = 0; i < g.n[0]; i++) {
                    const uint32_t from[3] = {i, j, k};
                    uint32_t to[3];
                    for (int a = 0; a < 3; a++) to[(a + shift) % 3] = from[a];
                    m.value[grid_node(&m, to[0], to[1], to[2])] = g.value[grid_node(&g, i, j, k)];
                }
        for (size_t method = 0; method < METHODS; method++) {
            struct scene c = seen(), turned = c;
            for (int a = 0; a < 3; a++) {
                turned.s.from[(a + shift) % 3] = c.s.from[a];
                turned.s.at[(a + shift) % 3] = c.s.at[a];
                turned.s.up[(a + shift) % 3] = c.s.up[a];
            }
            picture(&g, &c, method, p);
            picture(&m, &turned, method, q);
            assert_same("permuted", method, p, q, methods[method].most);
        }
        free_grid(&m);
    }
    free_grid(&g);
}

/* ---- refined --------------------------------------------------------------------------------- */

/* A node in the middle of each edge, face and cell, by the trilinear formula: exact in float. */
static struct grid refined_grid(const struct grid *g)
{
    struct grid m = make_grid(2 * g->n[0] - 1, 2 * g->n[1] - 1, 2 * g->n[2] - 1);
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < m.n[a]; i++)
            m.at[a][i] = (g->at[a][i / 2] + g->at[a][(i + 1) / 2]) / 2;
    for (uint32_t k = 0; k < m.n[2]; k++)
        for (uint32_t j = 0; j < m.n[1]; j++)
            for (uint32_t i = 0; i < m.n[0]; i++) {
                double sum = 0;
                for (uint32_t c = 0; c < 8; c++)
                    sum += (double)g->value[grid_node(
                        g, (i + (c & 1)) / 2, (j + (c >> 1 & 1)) / 2, (k + (c >> 2)) / 2)];
                m.value[grid_node(&m, i, j, k)] = (float)(sum / 8);
            }
    return m;
}

/* The field is the same, and so is the picture, up to the error of the method. */
static void refined(void **state)
{
    (void)state;
    static float p[VALUES], q[VALUES];
    static const double most[METHODS] = {2.0 / 1024, 5e-6, 1e-4, 0.3, 0.05};
    struct grid g = rough_grid(), m = refined_grid(&g);
    for (size_t method = 0; method < METHODS; method++) {
        struct scene c = seen();
        picture(&g, &c, method, p);
        picture(&m, &c, method, q);
        assert_same("refined", method, p, q, most[method]);
    }
    free_grid(&m);
    free_grid(&g);
}

/* ---- other units ----------------------------------------------------------------------------- */

/* All lengths times a factor, extinction and attenuation by it: powers of two change no bit. */
static void scaled(void **state)
{
    (void)state;
    static const double factors[] = {1024, 0x1p-20, 0x1p30, 1000, 1e-7, 1 / 3.0};
    static float p[VALUES], q[VALUES];
    struct grid g = rough_grid();
    for (size_t method = 0; method < METHODS; method++)
        for (int form = 0; form < 3; form++) { /* plain; attenuated; with surfaces and light */
            struct scene c = seen();
            if (form == 1) c.s.attenuation = 0.02;
            if (form == 2) iso(&c, 6, 1, 1, 1, 0.5), c.s.lit = true, c.s.light[2] = 30;
            picture(&g, &c, method, p);
            for (int f = 0; f < rounds(6); f++) {
                struct scene far = c;
                double factor = factors[f];
                for (int a = 0; a < 3; a++) {
                    far.s.scale[a] = factor;
                    far.s.from[a] *= factor, far.s.at[a] *= factor, far.s.light[a] *= factor;
                }
                far.s.attenuation /= factor;
                for (size_t i = 0; i < far.s.n_knots; i++) far.knot[i].k /= factor;
                picture(&g, &far, method, q);
                if (f < 3) assert_memory_equal(p, q, sizeof p);
                assert_same("scaled", method, p, q, methods[method].most);
            }
        }
    free_grid(&g);
}

/* All values times a factor, and the map and surfaces with them: no picture changes. */
static void other_values(void **state)
{
    (void)state;
    static const double factors[] = {0x1p-30, 0x1p-70, 0x1p-90, 0x1p-115, 0x1p50};
    static float p[VALUES], q[VALUES];
    for (size_t method = 0; method < METHODS; method++)
        for (int form = 0; form < 2; form++) { /* plain; with a surface */
            struct grid g = rough_grid();
            struct scene c = seen();
            if (form == 1) iso(&c, 6, 1, 1, 1, 0.5);
            picture(&g, &c, method, p);
            double at = 1;
            for (size_t f = 0; f < sizeof factors / sizeof *factors; f++) {
                const double factor = factors[f] / at;
                for (size_t i = 0; i < grid_node(&g, 0, 0, g.n[2]); i++)
                    g.value[i] = (float)((double)g.value[i] * factor);
                for (size_t i = 0; i < c.s.n_knots; i++) c.knot[i].s *= factor;
                for (size_t i = 0; i < c.s.n_isos; i++) c.iso[i].s *= factor;
                at = factors[f];
                picture(&g, &c, method, q);
                assert_same("other_values", method, p, q, methods[method].most);
            }
            free_grid(&g);
        }
}

/* ---- cut in two ------------------------------------------------------------------------------ */

static struct grid half(const struct grid *g, int axis, uint32_t from, uint32_t nodes)
{
    uint32_t n[3] = {g->n[0], g->n[1], g->n[2]}, low[3] = {0, 0, 0};
    n[axis] = nodes, low[axis] = from;
    struct grid m = make_grid(n[0], n[1], n[2]);
    for (int a = 0; a < 3; a++) memcpy(m.at[a], g->at[a] + low[a], n[a] * sizeof(double));
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++)
            for (uint32_t i = 0; i < n[0]; i++)
                m.value[grid_node(&m, i, j, k)] =
                    g->value[grid_node(g, i + low[0], j + low[1], k + low[2])];
    return m;
}

/* At a plane of the grid, along each axis: the nearer part over the farther one is the whole. */
static void split(void **state)
{
    (void)state;
    static float whole[VALUES], near[VALUES], far[VALUES];
    struct grid g = rough_grid();
    for (int a = 0; a < 3; a++) {
        struct grid low = half(&g, a, 0, 4), high = half(&g, a, 3, g.n[a] - 3);
        for (size_t method = 0; method < METHODS; method++) {
            struct scene c = seen();
            c.s.attenuation = 0.02;
            bool low_first = c.s.from[a] < g.at[a][3];
            picture(&g, &c, method, whole);
            picture(low_first ? &low : &high, &c, method, near);
            picture(low_first ? &high : &low, &c, method, far);
            for (int i = 0; i < VALUES; i++) near[i] += (1 - near[i | 3]) * far[i];
            assert_same("split", method, whole, near, methods[method].most);
        }
        free_grid(&low);
        free_grid(&high);
    }
    free_grid(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mirrored),
        cmocka_unit_test(permuted),
        cmocka_unit_test(refined),
        cmocka_unit_test(scaled),
        cmocka_unit_test(other_values),
        cmocka_unit_test(split),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
