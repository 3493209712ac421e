/* Volume ray casting where roots and geometry degenerate: each case by its analytic answer, or by
 * its neighbours' limit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "volume/volume_int.h"
#include "volume_scenes.h"

static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO};
static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;

static void near(double got, double expected, double e)
{
    if (!(fabs(got - expected) <= e)) fail_msg("%.9g, expected %.9g", got, expected);
}
static double of_z(double x, double y, double z) { return 0 * (x + y) + z; }
static double seven(double x, double y, double z) { return 7 + 0 * (x + y + z); }
static double rough(double x, double y, double z)
{
    uint64_t node = (uint64_t)(x * 8 + 1000) * 1000003 + (uint64_t)(y * 8 + 1000) * 1009;
    return floor(10 * 64 * rng_unit(3, node + (uint64_t)(z * 8 + 1000))) / 64;
}

/* Alpha of the one ray from o to e. */
static double alpha_of(const struct grid *g, const struct scene *like, double ox, double oy,
    double oz, double ex, double ey, double ez)
{
    struct scene c = *like;
    const double o[3] = {ox, oy, oz}, e[3] = {ex, ey, ez};
    float p[4];
    c.s.knot = c.knot, c.s.iso = c.iso;
    for (int a = 0; a < 3; a++) c.s.from[a] = o[a], c.s.at[a] = e[a];
    render(g, &c.s, &fine, p, NULL);
    return (double)p[3];
}
static struct scene even_map(double k)
{
    const double zero[3] = {0, 0, 0};
    struct scene c = make_scene(zero, zero);
    knot(&c, -1e9, 1, 1, 1, k);
    knot(&c, 1e9, 1, 1, 1, k);
    return c;
}
static double absorbed(double depth) { return 1 - exp(-depth); }

/* ---- roots ----------------------------------------------------------------------------------- */

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
        struct scene c = even_map(0);
        iso(&c, table[i].value, 1, 1, 1, 0.5);
        near(alpha_of(&g, &c, -1, -1, 0.5, 1, 1, 0.5), table[i].alpha, 1e-7);
        near(alpha_of(&g, &c, 2, 2, 0.5, 0, 0, 0.5), table[i].alpha, 1e-7);
        near(alpha_of(&g, &c, 2, 2, 0.9, 0, 0, 0.1), table[i].alpha, 1e-7);
    }
    /* From above it is not met: -s + 1/2 touches 1/4. */
    for (size_t i = 0; i < 8; i++) g.value[i] = 0.5f - g.value[i];
    struct scene c = even_map(0);
    iso(&c, 0.25, 1, 1, 1, 0.5);
    double touched = alpha_of(&g, &c, -1, -1, 0.5, 1, 1, 0.5);
    assert_true(touched == 0 || fabs(touched - 0.75) < 1e-7);
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
    struct scene c = even_map(0);
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
    struct scene c = even_map(0);
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

/* ---- geometry -------------------------------------------------------------------------------- */

static void rays_in_faces_and_edges(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    fill(&g, rough);
    struct scene c = even_map(0);
    c.s.n_knots = 0;
    knot(&c, 0, 1, 0, 0, 0), knot(&c, 10, 0, 1, 0, 0.3);
    static const double place[][2] = {{2, 1.5}, {2, 2}, {1.5, 3}, {0, 0.5}, {4, 4}, {0, 0}};
    for (int i = 0; i < 6; i++) {
        double x = place[i][0], y = place[i][1], in = 1e-7;
        double dx = x > 3 ? -in : in, dy = y > 3 ? -in : in;
        double on = alpha_of(&g, &c, x, y, 9, x, y, 0);
        assert_true(on > 0.05);
        near(on, alpha_of(&g, &c, x + dx, y + dy, 9, x + dx, y + dy, 0), 1e-6);
        near(on, alpha_of(&g, &c, x, y, -9, x, y, 0), 1e-6);
    }
    assert_true(alpha_of(&g, &c, 4 + 1e-9, 2, 9, 4 + 1e-9, 2, 0) == 0);
    free_grid(&g);
}

/* The walk's cells, one after the other, and their length; 0: it misses. */
static uint32_t walked(
    const struct volume *v, struct vec3 o, struct vec3 d, double *length, double *gap)
{
    struct walk w;
    struct stretch s[1];
    double last = 0;
    uint32_t n = 0;
    *length = *gap = 0;
    if (!walk_begin(&w, v, o, d)) return 0;
    for (; walk_cells(&w, s, 1); n++) {
        *gap += fabs(s->t0 - last);
        last = s->t1;
        *length += s->t1 - s->t0;
    }
    return n;
}

static void slopes_of_almost_nothing(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 5; i++) g.at[a][i] -= 2;
    fill(&g, seven);
    struct scene c = even_map(0.1);
    struct volume *v = volume_new(&g, &c.s, &fine);
    static const double slope[] = {0.0, -0.0, 1e-30, -1e-30, 1e-320, 1e-160, -1e-199, 1e-17};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) {
            double length, gap, x = k - 1; /* a plane, inside */
            uint32_t n = walked(v, v3(x, 0.5, 10), v3(slope[i], -slope[i], -1), &length, &gap);
            assert_int_equal(n, 4);
            near(length, 4, 1e-12), near(gap, 0, 1e-12);
            n = walked(v, v3(0.5, -10, x), v3(-slope[i], 1, slope[i]), &length, &gap);
            assert_int_equal(n, 4);
            near(length, 4, 1e-12), near(gap, 0, 1e-12);
        }
    volume_free(v);
    free_grid(&g);
}

/* Through corners only: a cell a step, none of no length; all ways round. */
static void corner_diagonals(void **state)
{
    (void)state;
    struct grid g = make_grid(10, 10, 10);
    fill(&g, seven);
    struct scene c = even_map(0.1);
    struct volume *v = volume_new(&g, &c.s, &fine);
    for (int i = 0; i < 8; i++) {
        struct vec3 o = v3(i & 1 ? -3 : 12, i & 2 ? -3 : 12, i & 4 ? -3 : 12);
        struct vec3 d = v3_unit(v3_sub(v3(4.5, 4.5, 4.5), o));
        double length, gap;
        assert_int_equal(walked(v, o, d, &length, &gap), 9);
        near(length, 9 * sqrt(3), 1e-12), near(gap, 0, 1e-12);
    }
    volume_free(v);
    free_grid(&g);
}

/* Random rays through uneven planes: no gap, no overlap, the box's own length. */
static void cells_fill_the_ray(void **state)
{
    (void)state;
    struct grid g = make_grid(7, 12, 5);
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < g.n[a]; i++)
            g.at[a][i] = i + 0.4 * rng_unit(9, i * 3 + (uint32_t)a);
    fill(&g, seven);
    struct scene c = even_map(0.1);
    struct volume *v = volume_new(&g, &c.s, &fine);
    uint32_t hits = 0;
    for (uint64_t i = 0; i < 2000; i++) {
        double r[6], near_t = 0, far_t = HUGE_VAL, length, gap;
        for (uint64_t k = 0; k < 6; k++) r[k] = rng_unit(4, 6 * i + k);
        double o[3] = {40 * r[0] - 15, 40 * r[1] - 15, 40 * r[2] - 15};
        struct vec3 d = v3_unit(v3_sub(v3(6 * r[3], 11 * r[4], 4 * r[5]), v3(o[0], o[1], o[2])));
        const double way[3] = {d.x, d.y, d.z};
        for (int a = 0; a < 3; a++) {
            double t0 = (g.at[a][0] - o[a]) / way[a], t1 = (g.at[a][g.n[a] - 1] - o[a]) / way[a];
            near_t = fmax(near_t, fmin(t0, t1)), far_t = fmin(far_t, fmax(t0, t1));
        }
        uint32_t n = walked(v, v3(o[0], o[1], o[2]), d, &length, &gap);
        hits += n > 0;
        near(length, far_t > near_t ? far_t - near_t : 0, 1e-12);
        near(gap, 0, 1e-12);
    }
    assert_true(hits > 1000);
    volume_free(v);
    free_grid(&g);
}

static void cameras_inside_on_and_far(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    fill(&g, of_z);
    struct scene c = even_map(0);
    c.s.n_knots = 0;
    knot(&c, 0, 1, 1, 1, 0), knot(&c, 4, 1, 1, 1, 0.4);
    near(alpha_of(&g, &c, 1.5, 1.5, 2.5, 1.5, 1.5, 0), absorbed(0.05 * 2.5 * 2.5), 1e-6);
    near(alpha_of(&g, &c, 1.5, 1.5, 4, 1.5, 1.5, 0), absorbed(0.8), 1e-6);
    near(alpha_of(&g, &c, 2, 2, 2, 2, 2, 4), absorbed(0.05 * (16 - 4)), 1e-6);
    assert_true(alpha_of(&g, &c, 1.5, 1.5, 4, 1.5, 1.5, 9) == 0);
    assert_true(alpha_of(&g, &c, 4, 4, 4, 9, 9, 9) == 0);
    near(alpha_of(&g, &c, 1.5, 1.5, 1e7, 1.5, 1.5, 0), absorbed(0.8), 1e-6);
    near(alpha_of(&g, &c, 1e7, 2, 2, 0, 2, 2), absorbed(0.8), 1e-6);
    double s = 1e7 / sqrt(3), e = 1e-6;
    near(alpha_of(&g, &c, 2 + s, 2 + s, 2 + s, 2, 2, 2), absorbed(0.8 * sqrt(3)), e);
    free_grid(&g);
}

/* 7500 km by 16 km in metres, and the same in km. */
static void flat_grids_in_metres(void **state)
{
    (void)state;
    struct grid g = make_grid(31, 31, 17);
    fill(&g, rough);
    static float p[2][4 * 16 * 16];
    for (int k = 0; k < 2; k++) {
        const double unit = k ? 1000 : 1;
        const double from[3] = {-300 * unit, -500 * unit, 400 * unit};
        const double at[3] = {3750 * unit, 3750 * unit, 8 * unit};
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 16, c.s.angle = 20;
        c.s.scale[0] = c.s.scale[1] = 250 * unit;
        c.s.scale[2] = unit;
        knot(&c, 4, 1, 0, 0, 0), knot(&c, 6, 0, 1, 1, 0.02 / unit);
        render(&g, &c.s, &fine, p[k], NULL);
    }
    double sum = 0;
    for (int i = 0; i < 4 * 16 * 16; i++) {
        near((double)p[0][i], (double)p[1][i], 1e-6);
        sum += (double)p[0][i];
    }
    assert_true(sum > 50);
    free_grid(&g);
}

static void missing_values_are_clear(void **state)
{
    (void)state;
    struct grid g = make_grid(7, 7, 7);
    fill(&g, seven);
    g.value[grid_node(&g, 3, 3, 3)] = NAN;
    struct scene c = even_map(0.2);
    iso(&c, 7, 1, 1, 1, 0.5);
    near(alpha_of(&g, &c, 2.5, 2.5, 9, 2.5, 2.5, 0), absorbed(0.8), 1e-6);
    near(alpha_of(&g, &c, 0.5, 2.5, 9, 0.5, 2.5, 0), absorbed(1.2), 1e-6);
    for (size_t i = 0; i < 343; i++) g.value[i] = NAN;
    assert_true(alpha_of(&g, &c, 2.5, 2.5, 9, 2.5, 2.5, 0) == 0);
    free_grid(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leading_coefficients_near_zero),
        cmocka_unit_test(tangent_roots),
        cmocka_unit_test(roots_on_faces_count_once),
        cmocka_unit_test(cells_constant_at_a_knot),
        cmocka_unit_test(offsets_cost_no_digits),
        cmocka_unit_test(rays_in_faces_and_edges),
        cmocka_unit_test(slopes_of_almost_nothing),
        cmocka_unit_test(corner_diagonals),
        cmocka_unit_test(cells_fill_the_ray),
        cmocka_unit_test(cameras_inside_on_and_far),
        cmocka_unit_test(flat_grids_in_metres),
        cmocka_unit_test(missing_values_are_clear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
