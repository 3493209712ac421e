/* Volume ray casting where roots degenerate: each case by its analytic answer, or by its
 * neighbours' limit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "volume/volume_int.h"
#include "volume_cases.h"

static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO, 1};
static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;

static void leading_coefficients_near_zero(void **state)
{
    (void)state;
    static const double lead[] = {0, 1e-320, 1e-30, -1e-17, 1e-12};
    for (int i = 0; i < 5; i++) {
        double p[4] = {0.1, -1, 1, lead[i]}, line[4] = {-0.25, 1, lead[i], lead[i]}, w[4];
        assert_int_equal(cubic_monotone(p, w), 3);
        near(w[1], 0.5, 1e-9);
        assert_int_equal(cubic_monotone(line, w), 2);
        near(cubic_root(line, 0, 1, 0), 0.25, 1e-9);
        near(cubic_root(p, 0, w[1], 0) + 0, 0.5 - sqrt(0.15), 1e-9);
    }
    double level[4] = {3, 0, 0, 0}, w[4];
    assert_int_equal(cubic_monotone(level, w), 2);
}

/* s = u (1 - v) along u = v is t (1 - t): it touches 1/4 in the middle. */
static void tangent_roots(void **state)
{
    (void)state;
    struct grid g = make_grid(2, 2, 2);
    g.value[grid_node(&g, 1, 0, 0)] = g.value[grid_node(&g, 1, 0, 1)] = 1;
    static const struct {
        double value, alpha;
    } table[] = {{0.25 - 1e-12, 0.75}, {0.25 - 1e-3, 0.75}, {0.25 + 1e-12, 0}, {0.1, 0.75}};
    for (int i = 0; i < 4; i++) {
        struct scene c;
        even_map(&c, 0);
        iso(&c, table[i].value, 1, 1, 1, 0.5);
        near(alpha_of(&g, &c, -1, -1, 0.5, 1, 1, 0.5), table[i].alpha, 1e-7);
        near(alpha_of(&g, &c, 2, 2, 0.5, 0, 0, 0.5), table[i].alpha, 1e-7);
        near(alpha_of(&g, &c, 2, 2, 0.9, 0, 0, 0.1), table[i].alpha, 1e-7);
    }
    /* From above it is not met: -s + 1/2 touches 1/4. */
    for (size_t i = 0; i < 8; i++) g.value[i] = 0.5f - g.value[i];
    struct scene c;
    even_map(&c, 0);
    iso(&c, 0.25, 1, 1, 1, 0.5);
    double touched = alpha_of(&g, &c, -1, -1, 0.5, 1, 1, 0.5);
    assert_true(touched == 0 || fabs(touched - 0.75) < 1e-7);
    free_grid(&g);
}

/* Rain is 0 in many cells and on many faces, and nowhere less. */
static void no_surface_at_the_least_value(void **state)
{
    (void)state;
    static const struct volume_options methods[] = {VOLUME_OPTIONS_DEFAULT,
        {VOLUME_ADAPTIVE, 1e-9, 0, ISA_AUTO, 1}, {VOLUME_GAUSS, 0, 9, ISA_AUTO, 1}};
    static float p[4 * 64 * 64];
    const double at[3] = {4, 4, 4};
    struct grid g = make_grid(9, 9, 9);
    for (uint64_t i = 0; i < 729; i++)
        g.value[i] = rng_unit(5, i) < .6 ? 0 : (float)(30 * rng_unit(6, i));
    for (int i = 0; i < 6; i++) {
        double far = i / 3 ? 1e4 : 1;
        const double from[3] = {4 + 20 * far, 4 + 17 * far, 4 + 13 * far};
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 64, c.s.angle = 20 / far;
        knot(&c, 0, 0, 0, 0, 0);
        knot(&c, 30, 1, 1, 1, 0);
        iso(&c, 0, 1, 1, 1, 0.5);
        render(&g, &c.s, &methods[i % 3], p, NULL);
        for (int v = 3; v < 4 * 64 * 64; v += 4) near((double)p[v], 0, 0);
    }
    free_grid(&g);
}

/* Sheets at nodes' heights, looked at from many directions: each ray meets each once. */
static void roots_on_faces_count_once(void **state)
{
    (void)state;
    struct grid g = make_grid(8, 7, 9);
    for (uint32_t i = 0; i < 8; i++) g.at[0][i] = i * 0.7 + 0.05 * i * i;
    fill(&g, of_z);
    for (int turn = 0; turn < 2; turn++) {
        const double from[3] = {3.3, 2.2, turn ? -40 : 40}, at[3] = {3.1, 2.9, 4};
        struct scene c = make_scene(from, at);
        c.s.angle = 2, c.s.w = c.s.h = 32;
        for (int i = 0; i < 3; i++) iso(&c, 2 + i, 1, 1, 1, 0.5);
        static float p[4 * 32 * 32];
        render(&g, &c.s, &usual, p, NULL);
        for (int i = 0; i < 32 * 32; i++) near((double)p[4 * i + 3], 0.875, 1e-6);
    }
    /* The same with planes in between, where only rounding tells the sides: f = x + y + z. */
    for (uint32_t k = 0; k < 9; k++)
        for (uint32_t j = 0; j < 7; j++)
            for (uint32_t i = 0; i < 8; i++)
                g.value[grid_node(&g, i, j, k)] = (float)(i + j + k) / 3;
    struct scene c;
    even_map(&c, 0);
    for (int i = 1; i < 8; i++) iso(&c, (double)((float)i / 3), 1, 1, 1, 0.25);
    for (int i = 0; i < 7; i++) g.at[0][i] = i; /* diagonals go through nodes */
    near(alpha_of(&g, &c, -1, -1, -1, 1, 1, 1), 1 - pow(0.75, 7), 1e-6);
    free_grid(&g);
}

static void cells_constant_at_a_knot(void **state)
{
    (void)state;
    struct grid g = make_grid(4, 4, 4);
    fill(&g, seven);
    struct scene c;
    even_map(&c, 0);
    c.s.n_knots = 0;
    knot(&c, 6, 1, 1, 1, 0), knot(&c, 7, 1, 1, 1, 0.3), knot(&c, 8, 1, 1, 1, 0);
    near(alpha_of(&g, &c, 1.3, 1.4, 9, 1.3, 1.4, 0), absorbed(0.9), 1e-6);
    c.s.n_knots = 0; /* a jump: the upper side holds */
    knot(&c, 6, 1, 1, 1, 5), knot(&c, 7, 1, 1, 1, 5);
    knot(&c, 7, 1, 1, 1, 0.2), knot(&c, 9, 1, 1, 1, 0.2);
    near(alpha_of(&g, &c, 1.3, 1.4, 9, 1.3, 1.4, 0), absorbed(0.6), 1e-6);
    c.s.n_knots = 0; /* the last knot belongs to the map, the first too */
    knot(&c, 6, 1, 1, 1, 1), knot(&c, 7, 1, 1, 1, 0.1);
    near(alpha_of(&g, &c, 1.3, 1.4, 9, 1.3, 1.4, 0), absorbed(0.3), 1e-6);
    c.s.n_knots = 0;
    knot(&c, 7, 1, 1, 1, 0.1), knot(&c, 8, 1, 1, 1, 2);
    near(alpha_of(&g, &c, 1.3, 1.4, 9, 1.3, 1.4, 0), absorbed(0.3), 1e-6);
    free_grid(&g);
}

/* Pressure in Pa: the same picture as without the offset. */
static void offsets_cost_no_digits(void **state)
{
    (void)state;
    struct grid g = make_grid(9, 9, 9);
    fill(&g, rough);
    const double from[3] = {-9, -7, 15}, at[3] = {4, 4, 4};
    static float p[2][4 * 24 * 24];
    for (int k = 0; k < 2; k++) {
        const double offset = k ? 101325 : 0;
        for (size_t i = 0; k && i < 9 * 9 * 9; i++) g.value[i] += (float)offset;
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 24;
        knot(&c, 4.75 + offset, 1, 0, 0, 0), knot(&c, 5 + offset, 0, 1, 0, 20);
        knot(&c, 5.25 + offset, 0, 0, 1, 0);
        render(&g, &c.s, &fine, p[k], NULL);
    }
    for (int i = 0; i < 4 * 24 * 24; i++) near((double)p[0][i], (double)p[1][i], 2e-7);
    free_grid(&g);
}

/* However deep a cell is, what is seen is where it begins: at the top, as the light is above it. */
static void deep_cells_are_opaque(void **state)
{
    (void)state;
    static const struct volume_options methods[] = {VOLUME_OPTIONS_DEFAULT,
        {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO, 1}, {VOLUME_GAUSS, 0, 9, ISA_AUTO, 1}};
    struct grid g = make_grid(4, 4, 4);
    fill(&g, of_z);
    for (int i = 0; i < 30; i++) {
        struct scene c = make_scene(above, below);
        double k = pow(10, 4 + i / 6 * 3);
        float p[4];
        knot(&c, 0, 0, 0, 0, k);
        knot(&c, 6, 1, 1, 1, k);
        c.s.lit = i % 2;
        for (int a = 0; a < 3; a++) c.s.light[a] = above[a];
        render(&g, &c.s, &methods[i / 2 % 3], p, NULL);
        for (int v = 0; v < 4; v++) near((double)p[v], v < 3 ? .5 : 1, 1e-3);
    }
    free_grid(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leading_coefficients_near_zero),
        cmocka_unit_test(tangent_roots),
        cmocka_unit_test(no_surface_at_the_least_value),
        cmocka_unit_test(roots_on_faces_count_once),
        cmocka_unit_test(cells_constant_at_a_knot),
        cmocka_unit_test(offsets_cost_no_digits),
        cmocka_unit_test(deep_cells_are_opaque),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
