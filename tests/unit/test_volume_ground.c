/* The ground: rays end there, and none slips through a line between two cells. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "rounds.h"
#include "volume_cases.h"

#include <string.h>

static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;
static const struct volume_options gauss = {VOLUME_GAUSS, 0, 6, ISA_AUTO, 1};

/* A grid of z with a ground. */
static struct grid with_ground(uint32_t nx, uint32_t ny, double (*f)(double x, double y, double z))
{
    struct grid g = make_grid(5, 4, 11);
    fill(&g, of_z);
    g.ground = xmalloc(1, sizeof *g.ground);
    *g.ground = make_grid(nx, ny, 1);
    fill(g.ground, f);
    return g;
}
static double slope(double x, double y, double z) { return 1 + x / 2 + 0 * (y + z); }
static double hills(double x, double y, double z)
{
    return .2 * rng_unit(5, (uint64_t)(x * 1009 + y * 64 + z)); /* flatter than all rays */
}

/* Straight down through fog to the slope at x = 2.3, and to what is beyond the grid. */
static void it_ends_rays(void **state)
{
    (void)state;
    struct grid g = with_ground(9, 9, slope);
    struct spec_knot ground[] = {{0, {0, 1, 0}, 0}, {4, {1, 0, 0}, 0}};
    const double z = 2.15, fog = .2 * (10 - z), seen = exp(-fog);
    const struct volume_options *all[] = {&usual, &gauss};
    for (int i = 0; i < 2; i++) {
        struct scene c = make_scene(above, below);
        float p[4];
        knot(&c, 0, 0, 0, 1, .2), knot(&c, 10, 0, 0, 1, .2);
        c.s.ground = ground, c.s.n_grounds = 2;
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[0], seen * z / 4, 1e-6), near((double)p[1], seen * (1 - z / 4), 1e-6);
        near((double)p[2], 1 - seen, 1e-6), assert_true(p[3] == 1);
        c.s.from[0] = c.s.at[0] = 6; /* 1 + 6 / 2 is red */
        render(&g, &c.s, all[i], p, NULL);
        assert_true(p[0] == 1 && p[1] == 0 && p[2] == 0 && p[3] == 1);
        c.s.from[0] = c.s.at[0] = 8.5; /* beyond the ground */
        render(&g, &c.s, all[i], p, NULL);
        assert_true(p[3] == 0);
        /* From below it hides all; light and attenuation are as on a surface. */
        c.s.from[0] = c.s.at[0] = 6, c.s.from[2] = -6, c.s.at[2] = 9;
        c.s.lit = true, c.s.light[0] = 6, c.s.light[1] = above[1], c.s.light[2] = 1e6;
        c.s.attenuation = .01;
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[0], (.3 + .7 / sqrt(1.25)) * exp(-.1), 1e-5);
        assert_true(p[3] == 1);
        c.s.clipped = true; /* to what is above it */
        for (int a = 0; a < 3; a++) c.s.clip[a][0] = 4.5, c.s.clip[a][1] = 9;
        render(&g, &c.s, all[i], p, NULL);
        assert_true(p[3] == 0);
    }
    grid_free(&g);
}

/* Rays to points of the lines between cells, from all sides, and to nodes. */
static void no_ray_slips_through(void **state)
{
    (void)state;
    struct grid g = with_ground(12, 9, hills);
    struct spec_knot ground[] = {{0, {1, 1, 1}, 0}};
    const struct grid *h = g.ground;
    for (int a = 0; a < 2; a++)
        for (uint32_t i = 0; i < h->n[a]; i++) h->at[a][i] = i * .7 + .1 * rng_unit(9, i);
    for (uint64_t n = 0; n < (uint64_t)rounds(20000); n++) {
        double from[3], at[3];
        const uint32_t i = 1 + (uint32_t)(10 * rng_unit(n, 0)),
                       j = 1 + (uint32_t)(7 * rng_unit(n, 1));
        const double u = n % 7 ? rng_unit(n, 2) : 0;
        const bool along = n % 2;
        const uint32_t k = along ? i - 1 : i, l = along ? j : j - 1;
        at[0] = h->at[0][i] + u * (h->at[0][k] - h->at[0][i]);
        at[1] = h->at[1][j] + u * (h->at[1][l] - h->at[1][j]);
        at[2] = (double)h->value[grid_node(h, i, j, 0)] * (1 - u) +
                u * (double)h->value[grid_node(h, k, l, 0)];
        for (int a = 0; a < 3; a++) from[a] = at[a] + 20 * (rng_unit(n, 3 + (uint64_t)a) - .5);
        from[2] = at[2] + (n % 3 ? 12 : -12);
        struct scene c = make_scene(from, at);
        c.s.ground = ground, c.s.n_grounds = 1;
        float p[4];
        render(&g, &c.s, &usual, p, NULL);
        if (p[3] != 1) fail_msg("ray %d slips through", (int)n);
    }
    grid_free(&g);
}

/* From somewhere to a point at this height. */
static struct scene towards_height(double z, uint64_t seed)
{
    double from[3], at[3];
    for (int a = 0; a < 3; a++) at[a] = a < 2 ? .2 + 1.6 * rng_unit(seed, (uint64_t)a) : z;
    for (int a = 0; a < 3; a++) from[a] = at[a] + 20 * (rng_unit(seed, 2 + (uint64_t)a) - .5);
    return make_scene(from, at);
}

static double even(double x, double y, double z) { return 2.7 + 0 * (x + y + z); }

/* The clip box begins or ends at the height of a flat ground, which is then in it. */
static void it_is_seen_in_a_face_of_the_clip_box(void **state)
{
    (void)state;
    struct grid g = with_ground(4, 3, even);
    struct spec_knot ground[] = {{0, {1, 1, 1}, 0}};
    const double z = (double)g.ground->value[0];
    for (uint64_t n = 0; n < (uint64_t)rounds(2000); n++) {
        struct scene c = towards_height(z, n);
        c.s.ground = ground, c.s.n_grounds = 1, c.s.clipped = true;
        for (int a = 0; a < 3; a++) c.s.clip[a][0] = -9, c.s.clip[a][1] = 9;
        c.s.clip[2][n % 2] = z;
        float p[4];
        render(&g, &c.s, &usual, p, NULL);
        if (p[3] != 1) fail_msg("ray %d does not see the ground", (int)n);
    }
    grid_free(&g);
}

static double level(double x, double y, double z) { return 3 + 0 * (x + y + z); }

/* A slice, a surface and a flat ground in one place are seen in this order, without speckles. */
static void it_is_behind_what_is_in_its_place(void **state)
{
    (void)state;
    struct grid in[] = {with_ground(4, 3, even), with_ground(4, 3, level)}; /* in cells, in faces */
    struct spec_knot ground[] = {{0, {1, 0, 0}, 0}};
    for (uint64_t n = 0; n < (uint64_t)rounds(2000); n++) {
        const double z = (double)in[n % 2].ground->value[0];
        struct spec_slice slice = {2, z, .5};
        struct scene c = towards_height(z, n);
        knot(&c, 0, 0, 0, 1, 0), knot(&c, 10, 0, 0, 1, 0), iso(&c, z, 0, 1, 0, .5);
        c.s.slice = &slice, c.s.n_slices = 1;
        if (n / 2 % 2) c.s.ground = ground, c.s.n_grounds = 1;
        float p[4];
        render(&in[n % 2], &c.s, &usual, p, NULL);
        near((double)p[2], .5, 1e-6), near((double)p[1], .25, 1e-6);
        near((double)p[0], n / 2 % 2 ? .25 : 0, 1e-6);
    }
    for (int i = 0; i < 2; i++) grid_free(&in[i]);
}

/* What a specification names must be there. */
/* A flat ground has the colours of its values, without light, and lets some of the background
 * through; where they have no colour, it is not there. */
static void it_may_be_flat(void **state)
{
    (void)state;
    struct grid g = with_ground(9, 9, slope);
    struct spec_knot ground[] = {{0, {0, 1, 0}, 0}, {4, {1, 0, 0}, 0}};
    const double value = 2.15, fog = .2 * (10 - 5), seen = exp(-fog);
    const struct volume_options *all[] = {&usual, &gauss};
    for (int i = 0; i < 2; i++) {
        struct scene c = make_scene(above, below);
        float p[4];
        knot(&c, 0, 0, 0, 1, .2), knot(&c, 10, 0, 0, 1, .2);
        c.s.ground = ground, c.s.n_grounds = 2;
        c.s.flat = true, c.s.flat_at = 5, c.s.flat_opacity = .75;
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[0], .75 * seen * value / 4, 1e-6);
        near((double)p[1], .75 * seen * (1 - value / 4), 1e-6);
        near((double)p[2], 1 - seen, 1e-6), near((double)p[3], 1 - .25 * seen, 1e-6);
        ground[1].s = 2;
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[2], 1 - exp(-2), 1e-6), near((double)p[3], 1 - exp(-2), 1e-6);
        ground[1].s = 4;
    }
    grid_free(&g);
}

static void it_must_be_there(void **state)
{
    (void)state;
    struct grid g = with_ground(3, 3, slope), bare = make_grid(2, 2, 2);
    struct scene c = make_scene(above, below);
    struct spec_knot knots[] = {{0, {1, 1, 1}, 0}};
    char err[ERR_BYTES];
    assert_true(volume_check(&g, &c.s, err) && volume_check(&bare, &c.s, err));
    c.s.ground = knots, c.s.n_grounds = 1;
    assert_true(volume_check(&g, &c.s, err));
    assert_false(volume_check(&bare, &c.s, err));
    assert_non_null(strstr(err, "a grid without ground, expected"));
    c.s.colour = knots, c.s.n_colours = 1;
    assert_false(volume_check(&g, &c.s, err));
    assert_non_null(strstr(err, "a grid of one field, expected"));
    grid_free(&g);
    grid_free(&bare);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_ends_rays),
        cmocka_unit_test(no_ray_slips_through),
        cmocka_unit_test(it_is_seen_in_a_face_of_the_clip_box),
        cmocka_unit_test(it_is_behind_what_is_in_its_place),
        cmocka_unit_test(it_may_be_flat),
        cmocka_unit_test(it_must_be_there),
    };
    return cmocka_run_group_tests_name("volume: ground", tests, NULL, NULL);
}
