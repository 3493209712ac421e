/* Iso-surfaces, light, mirrored axes, skipping: how pictures of volumes look. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "volume/volume_int.h"
#include "volume_cases.h"

static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
static double waves(double x, double y, double z)
{
    return 5 + 3 * sin(x * 1.1 + 0.3) * cos(y * 0.9) + 2 * sin(z + x);
}
static void light_at(struct scene *c, double x, double y, double z)
{
    c->s.lit = true;
    c->s.light[0] = x, c->s.light[1] = y, c->s.light[2] = z;
}

static void sheets_lie_one_behind_the_other(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, of_z);
    struct scene c = make_scene(above, below);
    iso(&c, 1.5, 0, 1, 0, 0.5);
    iso(&c, 3.25, 1, 0, 0, 0.25);
    float p[4];
    render(&g, &c.s, &usual, p, NULL);
    near((double)p[0], 0.25, 1e-6), near((double)p[1], 0.75 * 0.5, 1e-6);
    near((double)p[3], 1 - 0.75 * 0.5, 1e-6);
    /* A fog of k = .2 and its own colour before, between and behind; all of it far away. */
    knot(&c, 0, 0, 0, 1, 0.2), knot(&c, 9, 0, 0, 1, 0.2);
    c.s.attenuation = 0.03;
    const struct volume_options gauss = {VOLUME_GAUSS, 0, 6, ISA_AUTO, 1};
    const struct volume_options doubling = {VOLUME_DOUBLING, 1e-6, 0, ISA_AUTO, 1};
    const struct volume_options *all[] = {&usual, &gauss, &doubling};
    for (int i = 0; i < 3; i++) {
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[0], 0.25 * exp(-0.2 * 1.75 - 0.03 * 16.75), 1e-5);
        near((double)p[1], 0.5 * 0.75 * exp(-0.2 * 3.5 - 0.03 * 18.5), 1e-5);
        near((double)p[3], 1 - 0.75 * 0.5 * exp(-0.2 * 5), 1e-5);
        double fog = 0, t = 15, tau = 0, through = 1;
        for (int k = 0; k < 50000; k++) {
            double h = 5.0 / 50000, z = 20 - t - h / 2;
            through = (z < 3.25 ? 0.75 : 1) * (z < 1.5 ? 0.5 : 1);
            fog += through * 0.2 * h * exp(-tau - 0.1 * h - 0.03 * (t + h / 2));
            t += h, tau += 0.2 * h;
        }
        near((double)p[2], fog, i == 0 ? 1.0 / 1024 : 1e-5);
    }
    free_grid(&g);
}

/* A fog of k = .2, a ramp of red from 0 to 1 at z = 0 .. 10, and planes across z: what is seen from
 * above is a sum of known parts. */
static void slices_are_opaque_as_said(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 11);
    fill(&g, of_z);
    struct scene c = make_scene(above, below);
    struct spec_slice slice[] = {{2, 2.5, .5}, {2, 6, .25}, {0, 2.2999, 1}};
    knot(&c, 0, 0, 1, 0, .2), knot(&c, 10, 1, 1, 0, .2);
    c.s.slice = slice, c.s.n_slices = 2, c.s.attenuation = .03;
    c.s.lit = true, c.s.light[0] = 1e9; /* at right angles to the gradient: fog has .3 of it */
    const struct volume_options gauss = {VOLUME_GAUSS, 0, 6, ISA_AUTO, 1};
    const struct volume_options *all[] = {&usual, &gauss};
    for (int i = 0; i < 2; i++) {
        const double e = i ? 1e-6 : 1.0 / 1024, a = .23;
        float p[4];
        render(&g, &c.s, all[i], p, NULL);
        /* The fog is .2 / .23 times what exp(-.23 t) loses, from z = 10 to 6, to 2.5, to 0. */
        const double at6 = exp(-a * 4), at2 = exp(-a * 7.5), at0 = exp(-a * 10);
        double fog = 1 - at6 + .75 * (at6 - at2 + .5 * (at2 - at0)), far = exp(-.03 * 10);
        double green = .3 * .2 / a * fog + .25 * at6 + .75 * .5 * at2;
        near((double)p[1], far * green, e);
        near((double)p[3], 1 - .75 * .5 * exp(-2), 1e-5);
    }
    /* Across x, just behind the ray's start: it hides all, with the colour of this place. */
    const double from[3] = {2.2, 1.6, 7.5}, to[3] = {3.2, 1.6, 7.5};
    struct scene d = make_scene(from, to);
    float p[4];
    knot(&d, 0, 0, 1, 0, 0), knot(&d, 10, 1, 1, 0, 0);
    d.s.slice = slice + 2, d.s.n_slices = 1;
    render(&g, &d.s, &usual, p, NULL);
    near((double)p[0], .75, 1e-6), near((double)p[1], 1, 0), near((double)p[3], 1, 0);
    free_grid(&g);
}

/* Only the part of the fog within the box absorbs; a surface outside of it is not there. */
static void a_box_cuts_rays(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 11);
    fill(&g, of_z);
    for (int turned = 0; turned < 2; turned++) {
        struct scene c = make_scene(above, below);
        knot(&c, 0, 1, 1, 1, .2), knot(&c, 10, 1, 1, 1, .2);
        iso(&c, 2, 1, 0, 0, 1), iso(&c, 9.5, 1, 0, 0, 1);
        static const double box[3][2] = {{2, 2.5}, {-1, 9}, {2.25, 7.75}};
        c.s.clipped = true;
        memcpy(c.s.clip, box, sizeof box);
        if (turned) c.s.scale[0] = -1, c.s.from[0] = c.s.at[0] = -2.3;
        float p[4];
        render(&g, &c.s, &usual, p, NULL);
        near((double)p[3], absorbed(.2 * 5.5), 1e-6), near((double)p[1], absorbed(.2 * 5.5), 1e-6);
        c.s.clip[0][1] = 2.1; /* beside the ray */
        render(&g, &c.s, &usual, p, NULL);
        assert_true(p[3] == 0);
        c.s.clip[0][0] = -8, c.s.clip[0][1] = -7; /* beside the grid */
        render(&g, &c.s, &usual, p, NULL);
        assert_true(p[3] == 0);
    }
    free_grid(&g);
}

/* Ambient .3, and .7 of the cosine, on both sides alike. */
static void light_follows_the_gradient(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, of_z);
    static const struct {
        double x, z, expected;
    } table[] = {{0, 1e9, 1}, {0, -1e9, 1}, {1e9, 0, 0.3}, {1e9, 1e9, 0.3 + 0.7 * 0.70710678},
        {-1e9, 1e9 * 1.7320508, 0.3 + 0.7 * 0.8660254}};
    for (int i = 0; i < 5; i++) {
        struct scene c = make_scene(above, below);
        light_at(&c, table[i].x, 0, table[i].z);
        iso(&c, 2.5, 1, 0.5, 0, 1);
        float p[4];
        render(&g, &c.s, &usual, p, NULL);
        near((double)p[0], table[i].expected, 1e-6);
        near((double)p[1], table[i].expected / 2, 1e-6);
        assert_true(p[3] == 1);
        c.s.n_isos = 0;
        knot(&c, -1, 1, 1, 1, 0.3), knot(&c, 9, 1, 1, 1, 0.3);
        render(&g, &c.s, &usual, p, NULL);
        near((double)p[0], table[i].expected * (1 - exp(-1.5)), 1e-5);
    }
    fill(&g, seven); /* no gradient: unlit */
    struct scene c = make_scene(above, below);
    light_at(&c, 1e9, 0, 0);
    knot(&c, 0, 1, 1, 1, 0.3), knot(&c, 9, 1, 1, 1, 0.3);
    float p[4];
    render(&g, &c.s, &usual, p, NULL);
    near((double)p[0], 1 - exp(-1.5), 1e-6);
    free_grid(&g);
}

static double largest(const float *a, const float *b, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs((double)a[i] - (double)b[i]));
    return most;
}

/* Light and attenuation vary along a ray as no polynomial does: the tolerance is kept nevertheless,
 * and all methods converge to one picture. */
static void light_keeps_the_tolerance(void **state)
{
    (void)state;
    struct grid g = make_grid(12, 11, 10);
    fill(&g, waves);
    const double from[3] = {-6, -9, 16}, at[3] = {5.5, 5, 4.5};
    static float p[3][4 * 24 * 24];
    for (int lit = 0; lit < 2; lit++) {
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 24, c.s.angle = 40, c.s.attenuation = 0.1;
        knot(&c, 4, 1, 0.1, 0, 0), knot(&c, 6, 0.2, 1, 0.4, 2), knot(&c, 7.5, 0.1, 0.3, 1, 0.5);
        if (lit) light_at(&c, 30, -20, 25);
        const struct volume_options exact = {VOLUME_TRAPEZOID, 0, 1000, ISA_AUTO, 1};
        const struct volume_options gauss = {VOLUME_GAUSS, 0, 12, ISA_AUTO, 1};
        render(&g, &c.s, &exact, p[0], NULL);
        render(&g, &c.s, &gauss, p[1], NULL);
        render(&g, &c.s, &usual, p[2], NULL);
        assert_true(largest(p[0], p[1], 4 * 24 * 24) < 2e-4);
        assert_true(largest(p[0], p[2], 4 * 24 * 24) <= 1.0 / 1024);
    }
    free_grid(&g);
}

/* A negative scale mirrors: the grid turned round, seen from the mirrored place. */
static void negative_scales_mirror(void **state)
{
    (void)state;
    struct grid g = make_grid(12, 11, 10), turned = make_grid(12, 11, 10);
    fill(&g, waves);
    for (uint32_t k = 0; k < 10; k++)
        for (uint32_t j = 0; j < 11; j++)
            for (uint32_t i = 0; i < 12; i++)
                turned.value[grid_node(&turned, i, j, k)] =
                    g.value[grid_node(&g, 11 - i, j, 9 - k)];
    for (uint32_t i = 0; i < 12; i++) turned.at[0][i] -= 11;
    for (uint32_t i = 0; i < 10; i++) turned.at[2][i] -= 9;
    const double from[3] = {6, -9, -16}, at[3] = {-5.5, 5, -4.5};
    static float p[2][4 * 24 * 24];
    for (int i = 0; i < 2; i++) {
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 24, c.s.angle = 40;
        knot(&c, 4, 1, 0.1, 0, 0), knot(&c, 6, 0.2, 1, 0.4, 2);
        iso(&c, 7, 1, 1, 1, 0.5);
        light_at(&c, -30, -20, -25);
        if (i == 0) c.s.scale[0] = c.s.scale[2] = -1;
        render(i ? &turned : &g, &c.s, &usual, p[i], NULL);
    }
    assert_true(largest(p[0], p[1], 4 * 24 * 24) < 1e-5);
    double sum = 0;
    for (int i = 0; i < 4 * 24 * 24; i++) sum += (double)p[0][i];
    assert_true(sum > 100);
    free_grid(&g);
    free_grid(&turned);
}

/* What is skipped is clear: where the same parts of the map absorb too little to be seen, all cells
 * are visited, and the picture is the same. */
static void skipping_changes_nothing(void **state)
{
    (void)state;
    struct grid g = wind_grid();
    g.value[grid_node(&g, 60, 45, 9)] = NAN;
    static float p[2][4 * 40 * 40];
    struct volume_counts n[2];
    for (int i = 0; i < 2; i++) {
        struct scene c = wind_scene(40);
        double none = i ? 1e-30 : 0;
        knot(&c, -100, 0.5, 0.5, 0.5, none), knot(&c, 40, 0.9, 0.2, 0.1, none);
        knot(&c, 42, 0.2, 0.9, 0.1, 1), knot(&c, 44, 0.2, 0.1, 0.9, none);
        knot(&c, 500, 0.2, 0.1, 0.9, none);
        render(&g, &c.s, &usual, p[i], &n[i]);
    }
    assert_true(largest(p[0], p[1], 4 * 40 * 40) < 1e-6);
    assert_true(n[0].cells * 5 < n[1].cells && n[0].most_cells == n[1].most_cells);
    free_grid(&g);
}

/* Threads write bits of the same bytes where their layers meet. */
static void threads_mark_the_same_cells(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 24; i++) {
        struct grid g = make_grid(2 + i % 7, 3 + i % 5, 2 + 3 * i);
        const size_t nodes = grid_node(&g, 0, 0, g.n[2]);
        for (size_t k = 0; k < nodes; k++) g.value[k] = (float)(8 * rng_unit(i, k));
        struct scene c = make_scene(above, below);
        knot(&c, 5, 0.5, 0.5, 0.5, 0), knot(&c, 6, 0.9, 0.2, 0.1, 1);
        iso(&c, 0.25, 0, 1, 0, 0.5);
        for (int a = 0; a < 3; a++) c.s.scale[a] = i >> a & 1 ? -1 : 1;
        struct volume *v[5];
        for (int threads = 1; threads <= 5; threads++) {
            struct volume_options o = usual;
            o.threads = threads;
            struct volume *one = v[0], *got = v[threads - 1] = volume_new(&g, &c.s, &o);
            if (threads == 1) continue;
            size_t blocks = (size_t)got->blocks[0] * got->blocks[1] * got->blocks[2];
            assert_memory_equal(one->live, got->live, nodes / 8 + 8);
            assert_memory_equal(one->block, got->block, blocks);
            assert_true(one->range == got->range && one->range > 0);
        }
        for (int k = 0; k < 5; k++) volume_free(v[k]);
        free_grid(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sheets_lie_one_behind_the_other),
        cmocka_unit_test(slices_are_opaque_as_said),
        cmocka_unit_test(a_box_cuts_rays),
        cmocka_unit_test(light_follows_the_gradient),
        cmocka_unit_test(light_keeps_the_tolerance),
        cmocka_unit_test(negative_scales_mirror),
        cmocka_unit_test(skipping_changes_nothing),
        cmocka_unit_test(threads_mark_the_same_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
