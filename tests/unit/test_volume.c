/* Volume ray casting against closed forms, and against marching in long double. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "rounds.h"
#include "volume_cases.h"

#include <stdlib.h>
#include <string.h>

static const struct volume_options trapezoid16 = {VOLUME_TRAPEZOID, 0, 16, ISA_AUTO, 1};
static const struct volume_options doubling = {VOLUME_DOUBLING, 1e-7, 0, ISA_AUTO, 1};
static const struct volume_options gauss5 = {VOLUME_GAUSS, 0, 5, ISA_AUTO, 1};
static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-7, 0, ISA_AUTO, 1};
static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;

/* ---- closed forms --------------------------------------------------------------------------- */

static void constant_field(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, seven);
    struct scene c = make_scene(above, below);
    knot(&c, 0, 0.2, 0.4, 0.6, 0.3);
    knot(&c, 10, 0.2, 0.4, 0.6, 0.3);
    const struct volume_options *all[] = {&trapezoid16, &doubling, &gauss5, &fine, &usual};
    for (int i = 0; i < 5; i++) {
        float p[4];
        struct volume_counts n;
        render(&g, &c.s, all[i], p, &n);
        double alpha = 1 - exp(-0.3 * 5);
        near((double)p[3], alpha, 1e-6);
        for (int k = 0; k < 3; k++) near((double)p[k], 0.2 * (k + 1) * alpha, 1e-6);
        assert_int_equal(n.rays, 1);
        assert_int_equal(n.hits, 1);
        assert_int_equal(n.cells, 5);
        assert_int_equal(n.most_cells, 5);
    }
    free_grid(&g);
}

/* k = k' z from 5 to 0: alpha = 1 - exp(-k' 25 / 2); colour z / 5 of depth u = k' (25 - z^2) / 2
 * gives C = 1/5 of the integral of sqrt(25 - 2 u / k') exp(-u). */
static void linear_field(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, of_z);
    struct scene c = make_scene(above, below);
    knot(&c, 0, 0, 0, 1, 0);
    knot(&c, 5, 1, 0, 1, 0.5);
    double k = 0.1, depth = k * 12.5, sum = 0;
    for (int i = 0; i < 100000; i++) {
        double u = (i + 0.5) * depth / 100000;
        sum += sqrt(25 - 2 * u / k) / 5 * exp(-u) * depth / 100000;
    }
    const struct volume_options *all[] = {&doubling, &gauss5, &fine, &usual};
    for (int i = 0; i < 4; i++) {
        float p[4];
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[3], 1 - exp(-depth), i < 1 ? 1e-5 : 2e-7);
        near((double)p[0], sum, i == 0 ? 1e-5 : i == 3 ? 1.0 / 1024 : 1e-6);
        near((double)p[2], 1 - exp(-depth), i < 1 ? 1e-5 : 2e-7);
    }
    free_grid(&g);
}

/* C = the integral of c k exp(-(k + a) t) from where the ray enters. */
static void attenuation_dims_colour_and_not_alpha(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, seven);
    struct scene c = make_scene(above, below);
    knot(&c, 0, 1, 0.5, 0, 0.3);
    knot(&c, 10, 1, 0.5, 0, 0.3);
    c.s.attenuation = 0.05;
    const struct volume_options *all[] = {&doubling, &gauss5, &fine, &usual};
    double colour = 0.3 / 0.35 * (exp(-0.05 * 15) - exp(-0.05 * 15 - 0.35 * 5));
    for (int i = 0; i < 4; i++) {
        float p[4];
        render(&g, &c.s, all[i], p, NULL);
        near((double)p[3], 1 - exp(-0.3 * 5), 1e-6);
        near((double)p[0], colour, i == 3 ? 1.0 / 1024 : 2e-6);
        near((double)p[1], colour / 2, i == 3 ? 1.0 / 1024 : 2e-6);
    }
    free_grid(&g);
}

/* A field less a profile is rendered as one that was written so, bit by bit. Views share it. */
static void profile_is_subtracted(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 6);
    fill(&g, of_z);
    struct scene c = make_scene(above, below);
    knot(&c, -9, 1, 0.5, 0, 0.3);
    knot(&c, 10, 0, 0.5, 1, 0.5);
    struct spec_level profile[] = {{0, 3}, {2, 5.5}, {9, 1}};
    c.s.profile = profile, c.s.n_profile = 3;
    struct volume *v[2];
    float p[4], q[4];
    const struct lattice one = {0, 0, 1, 1, 1, 1};
    for (int i = 0; i < 2; i++) v[i] = volume_new(&g, &c.s, &usual);
    volume_free(v[0]);
    volume_pixels(v[1], &one, 0, 1, p);
    volume_free(v[1]);
    float *less = spec_deviation(&c.s, &g);
    memcpy(g.value, less, (size_t)5 * 4 * 6 * sizeof *less);
    free(less);
    c.s.n_profile = 0;
    render(&g, &c.s, &usual, q, NULL);
    assert_memory_equal(p, q, sizeof p);
    assert_true(p[3] > 0);
    free_grid(&g);
}

static void opacity_limit_and_background(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 4, 401);
    fill(&g, seven);
    struct scene c = make_scene((const double[3]){2.3, 1.6, 500}, below);
    knot(&c, 0, 1, 1, 1, 0.5);
    knot(&c, 10, 1, 1, 1, 0.5);
    c.s.opacity_limit = 0.99;
    float p[4];
    struct volume_counts n;
    render(&g, &c.s, &usual, p, &n);
    assert_true(p[3] >= 0.99f && n.cells < 12);
    c.s.backed = true;
    c.s.background[1] = 0.5;
    render(&g, &c.s, &usual, p, NULL);
    assert_true(p[3] == 1);
    near((double)p[1] - (double)p[0], 0.5 * (1 - (double)p[0]), 1e-6);
    c.s.from[0] = 100, c.s.at[0] = 200; /* past the grid */
    render(&g, &c.s, &usual, p, &n);
    assert_true(p[0] == 0 && p[1] == 0.5f && p[2] == 0 && p[3] == 1 && n.hits == 0);
    c.s.backed = false;
    render(&g, &c.s, &usual, p, NULL);
    assert_true(p[0] == 0 && p[1] == 0 && p[3] == 0);
    free_grid(&g);
}

/* ---- against the reference ------------------------------------------------------------------ */

#define SIDE 20

/* The picture of the wind by map i. */
static const real *reference(const struct grid *g, const struct spec *s, int i)
{
    static real out[4][4 * SIDE * SIDE];
    static bool drawn[4];
    for (uint32_t k = 0; k < SIDE * SIDE && !drawn[i]; k++)
        ref_pixel(g, s, k % SIDE, k / SIDE, 12, out[i] + 4 * k);
    drawn[i] = true;
    return out[i];
}
/* Root of the mean square, and the greatest error, of all channels. */
static double rms(const float *p, const real *r, double *most)
{
    double sum = 0;
    *most = 0;
    for (int i = 0; i < 4 * SIDE * SIDE; i++) {
        double e = fabs((double)((real)p[i] - r[i]));
        sum += e * e;
        *most = e > *most ? e : *most;
    }
    return sqrt(sum / (4 * SIDE * SIDE));
}
static void set_map(struct scene *c, int i)
{
    static const double width[] = {0, 5, 0.5, 0.05};
    if (i == 0) smooth_map(c);
    else contour_map(c, width[i]);
}

/* The default tolerance and others, on a smooth map and contours 5, .5 and .05 m/s wide. */
static void adaptive_keeps_its_tolerance(void **state)
{
    (void)state;
    static const double tolerance[] = {1e-2, 1.0 / 1024, 1e-4, 1e-5};
    struct grid g = wind_grid();
    for (int i = 0; i < rounds(4); i++) {
        struct scene c = wind_scene(SIDE);
        static float p[4 * SIDE * SIDE];
        double most, seen = 0;
        set_map(&c, i);
        const real *r = reference(&g, &c.s, i);
        for (int k = 0; k < SIDE * SIDE; k++) seen += (double)r[4 * k + 3] / (SIDE * SIDE);
        assert_true(seen > 0.1);
        for (int k = 0; k < 4; k++) {
            struct volume_options o = {VOLUME_ADAPTIVE, tolerance[k], 0, ISA_AUTO, 1};
            render(&g, &c.s, &o, p, NULL);
            rms(p, r, &most);
            if (most > tolerance[k])
                fail_msg("map %d: %g, expected at most %g", i, most, tolerance[k]);
        }
    }
    free_grid(&g);
}

/* One cell, whatever its corners, map and rays are: the error is within tolerance times alpha, and
 * not much less at worst. */
static void adaptive_keeps_its_bound(void **state)
{
    (void)state;
    enum { WIDTH = 8, VALUES = 4 * WIDTH * WIDTH };
    struct grid g = make_grid(2, 2, 2);
    double worst = 0;
    for (uint64_t i = 0; i < 1000; i++) {
        double r[19], end[2][3];
        float p[VALUES], q[VALUES];
        for (uint64_t k = 0; k < 19; k++) r[k] = rng_unit(11, 19 * i + k);
        for (int k = 0; k < 8; k++) g.value[k] = i & 1 ? r[k] > 0.5 : (float)r[k];
        for (int a = 0; a < 3; a++) end[0][a] = -1 + 3 * r[8 + a], end[1][a] = r[11 + a];
        struct scene c = make_scene(end[0], end[1]);
        double thick = 4 * r[14] * r[14], tolerance = pow(10, -0.5 - 3 * r[15]);
        bool falls = r[16] < 0.5;
        c.s.w = c.s.h = WIDTH;
        knot(&c, 0, falls, !falls, 0.5, r[17] < 0.5 ? 0 : thick * r[18]);
        knot(&c, 1, !falls, falls, 0.5, r[17] > 0.8 ? 0 : thick);
        const struct volume_options o = {VOLUME_ADAPTIVE, tolerance, 0, ISA_AUTO, 1};
        const struct volume_options exact = {VOLUME_GAUSS, 0, 12, ISA_AUTO, 1};
        render(&g, &c.s, &o, p, NULL);
        render(&g, &c.s, &exact, q, NULL);
        for (int k = 0; k < VALUES; k++) {
            double alpha = (double)q[k | 3], most = tolerance * alpha;
            near((double)p[k], (double)q[k], 2e-6 + (k % 4 == 3 ? 0 : most));
            if (alpha > 0.1) worst = fmax(worst, fabs((double)p[k] - (double)q[k]) / most);
        }
    }
    print_message("# at worst %.2g of tolerance times alpha\n", worst);
    assert_true(worst > 0.2);
    free_grid(&g);
}

/* Bounds of the error: trapezoid n = 1, 4, 16, 64, then knot-split m = 3. */
static void errors_are_those_expected(void **state)
{
    (void)state;
    static const double expected[4][5] = {{1.5e-3, 1e-4, 6e-6, 5e-7, 2e-7},
        {0.1, 1e-2, 5e-4, 5e-5, 3e-5}, {0.4, 0.2, 4e-2, 3e-3, 4e-5}, {0.4, 0.3, 0.3, 0.2, 4e-5}};
    struct grid g = wind_grid();
    for (int i = 0; i < 4; i++) {
        struct scene c = wind_scene(SIDE);
        static float p[4 * SIDE * SIDE];
        double most;
        set_map(&c, i);
        const real *r = reference(&g, &c.s, i);
        for (int k = 0; k < 5; k++) {
            struct volume_options o = {VOLUME_TRAPEZOID, 0, 1 << (2 * k), ISA_AUTO, 1};
            if (k == 4) o = (struct volume_options){VOLUME_GAUSS, 0, 3, ISA_AUTO, 1};
            render(&g, &c.s, &o, p, NULL);
            double e = rms(p, r, &most);
            print_message(
                "# map %d method %d n %d: rms %.2g, most %.2g\n", i, o.method, o.n, e, most);
            assert_true(e <= expected[i][k]);
        }
    }
    free_grid(&g);
}

/* Jumps and turns, more in a cell than are cut side by side, in every instruction set: within the
 * tolerance of the picture in double, and the same; with planes turned round, and nodes missing. */
static void many_knots(void **state)
{
    (void)state;
    struct grid g = wind_grid();
    for (size_t i = 0; i < 40; i++) g.value[i * 5003] = NAN;
    for (int turned = 0; turned < 2; turned++) {
        static float exact[4 * SIDE * SIDE], p[4 * SIDE * SIDE], first[4 * SIDE * SIDE];
        struct scene c = wind_scene(SIDE);
        const double sign = turned ? -1 : 1;
        for (int i = 0; i < 16; i++)
            knot(&c, 20 + (i + 1) / 2 * 1.5, i % 3 / 2.0, i % 4 / 3.0, i % 5 / 4.0, i % 3 * 0.2);
        for (int a = 0; a < 3; a++) {
            c.s.scale[a] = sign;
            c.s.from[a] *= sign, c.s.at[a] *= sign;
        }
        render(&g, &c.s, &fine, exact, NULL);
        for (enum isa isa = ISA_SSE2; isa <= ISA_AVX512; isa++) {
            struct volume_options o = VOLUME_OPTIONS_DEFAULT;
            o.isa = isa;
            if (!isa_available(isa)) continue;
            render(&g, &c.s, &o, p, NULL);
            for (int i = 0; i < 4 * SIDE * SIDE; i++)
                near((double)p[i], (double)exact[i], usual.tolerance);
            if (isa == ISA_SSE2) memcpy(first, p, sizeof p);
            assert_memory_equal(first, p, sizeof p);
        }
    }
    free_grid(&g);
}

/* Neither the width of vectors nor the order and grouping of pixels changes a bit. */
static void bits_are_the_same(void **state)
{
    (void)state;
    struct grid g = wind_grid();
    for (int i = 0; i < 6; i++) {
        static float narrow[4 * SIDE * SIDE], wide[4 * SIDE * SIDE], parts[4 * SIDE * SIDE];
        struct scene c = wind_scene(SIDE);
        set_map(&c, i % 4);
        if (i >= 4) c.s.lit = true, c.s.light[2] = 90, c.s.attenuation = .01;
        if (i >= 4) iso(&c, 20, 1, 1, 1, .5), iso(&c, 40, 0, 1, 1, .7);
        c.s.opacity_limit = 0.9;
        struct volume_options o = VOLUME_OPTIONS_DEFAULT;
        o.isa = ISA_SSE2;
        render(&g, &c.s, &o, narrow, NULL);
        for (o.isa = ISA_AVX2; o.isa <= ISA_AVX512; o.isa++) {
            if (!isa_available(o.isa)) continue;
            render(&g, &c.s, &o, wide, NULL);
            assert_memory_equal(narrow, wide, sizeof narrow);
        }
        struct volume *v = volume_new(&g, &c.s, &usual);
        volume_frame(v, SIDE, SIDE);
        for (uint32_t x = SIDE; x-- > 0;) {
            struct lattice column = {x, 0, 1, SIDE, 1, 1};
            float p[4 * SIDE];
            volume_pixels(v, &column, 7, SIDE - 7, p + 28);
            volume_pixels(v, &column, 0, 7, p);
            for (uint32_t y = 0; y < SIDE; y++)
                for (int k = 0; k < 4; k++)
                    parts[4 * (y * SIDE + x) + (uint32_t)k] = p[4 * y + (uint32_t)k];
        }
        assert_memory_equal(narrow, parts, sizeof narrow);
        volume_free(v);
    }
    free_grid(&g);
}

/* Within one span the trapezoid is of second order; nodes of Gauss and Legendre gain digits. */
static void orders_of_convergence(void **state)
{
    (void)state;
    struct grid g = make_grid(2, 2, 2);
    for (int i = 0; i < 8; i++) g.value[i] = (float)(1 + 8 * rng_unit(5, (uint64_t)i));
    struct scene c = make_scene((const double[3]){3, -2, 2.5}, (const double[3]){0.4, 0.5, 0.6});
    knot(&c, 0, 0, 1, 0, 0.05);
    knot(&c, 10, 1, 0, 0, 1.8);
    real r[4];
    ref_pixel(&g, &c.s, 0, 0, 400, r);
    double last = 0;
    for (int n = 4; n <= 64; n *= 2) {
        struct volume_options o = {VOLUME_TRAPEZOID, 0, n, ISA_AUTO, 1};
        float p[4];
        render(&g, &c.s, &o, p, NULL);
        double e = fabs((double)((real)p[0] - r[0]));
        if (last > 0 && n <= 32) assert_true(e < last / 3.2 && e > last / 5);
        last = e;
    }
    for (int m = 1; m <= 4; m++) {
        struct volume_options o = {VOLUME_GAUSS, 0, m, ISA_AUTO, 1};
        float p[4];
        render(&g, &c.s, &o, p, NULL);
        double e = fabs((double)((real)p[0] - r[0]));
        static const double expected[] = {8e-3, 5e-5, 2e-5, 1e-6};
        assert_true(e <= expected[m - 1]);
        near((double)p[3], (double)r[3], 1e-7);
    }
    free_grid(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_field),
        cmocka_unit_test(linear_field),
        cmocka_unit_test(attenuation_dims_colour_and_not_alpha),
        cmocka_unit_test(profile_is_subtracted),
        cmocka_unit_test(opacity_limit_and_background),
        cmocka_unit_test(adaptive_keeps_its_tolerance),
        cmocka_unit_test(adaptive_keeps_its_bound),
        cmocka_unit_test(errors_are_those_expected),
        cmocka_unit_test(many_knots),
        cmocka_unit_test(bits_are_the_same),
        cmocka_unit_test(orders_of_convergence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
