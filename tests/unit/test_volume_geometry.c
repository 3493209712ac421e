/* Volume ray casting where geometry degenerates: each case by its analytic answer, or by its
 * neighbours' limit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "volume/volume_int.h"
#include "volume_cases.h"

static const struct volume_options fine = {VOLUME_ADAPTIVE, 1e-6, 0, ISA_AUTO, 1};

static void rays_in_faces_and_edges(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    fill(&g, rough);
    struct scene c;
    even_map(&c, 0);
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
    struct segment s;
    double last = 0;
    uint32_t n = 0;
    *length = *gap = 0;
    if (!walk_begin(&w, v, o, d)) return 0;
    for (; walk_cell(&w, &s); n++) {
        *gap += fabs(s.t0 - last);
        last = s.t1;
        *length += s.t1 - s.t0;
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
    struct scene c;
    even_map(&c, 0.1);
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
    struct scene c;
    even_map(&c, 0.1);
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
    struct scene c;
    even_map(&c, 0.1);
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
    struct scene c;
    even_map(&c, 0);
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

/* Along, or almost along, planes of the grid: as along them. */
static void pictures_of_almost_no_slope(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 5; i++) g.at[a][i] -= 2;
    fill(&g, rough);
    struct scene c;
    even_map(&c, 0);
    c.s.n_knots = 0;
    knot(&c, 0, 1, 0, 0, 0), knot(&c, 6, 0, 1, 0, 0.5), knot(&c, 6.5, 0, 0, 1, 0);
    static const double slope[] = {-0.0, 1e-30, -1e-30, 1e-320, 1e-160, -1e-199, 1e-17, -1e-9};
    double up = alpha_of(&g, &c, 0, 0.3, 9, 0, 0.3, 0), side = alpha_of(&g, &c, 9, 0, 0, 0, 0, 0);
    assert_true(up > 0.05 && side > 0.05);
    for (int i = 0; i < 8; i++) {
        near(alpha_of(&g, &c, 0, 0.3, 9, 9 * slope[i], 0.3, 0), up, 1e-6);
        near(alpha_of(&g, &c, 9, 0, 0, 0, slope[i], -slope[i]), side, 1e-6);
    }
    free_grid(&g);
}

/* From corners, edges, faces and the middle, along axes and diagonals, where 0 / 0 is near: as long
 * as the way to the box's end. */
static void no_index_is_nan(void **state)
{
    (void)state;
    struct grid g = make_grid(5, 5, 5);
    fill(&g, seven);
    struct scene c;
    even_map(&c, 0.1);
    for (int place = 0; place < 27; place++)
        for (int way = 0; way < 27; way++) {
            const int p[3] = {place % 3, place / 3 % 3, place / 9};
            const int d[3] = {way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1};
            double to[3], steps = 4;
            for (int a = 0; a < 3; a++) {
                to[a] = 2 * p[a] + d[a];
                if (d[a]) steps = fmin(steps, d[a] > 0 ? 4 - 2 * p[a] : 2 * p[a]);
            }
            if (way == 13) continue; /* nowhere */
            double length = steps * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            near(alpha_of(&g, &c, 2 * p[0], 2 * p[1], 2 * p[2], to[0], to[1], to[2]),
                absorbed(0.1 * length), 1e-6);
        }
    free_grid(&g);
}

static double slanted(double x, double y, double z) { return x + 2 * y + 3 * z; }
/* A linear field needs no more than two nodes of an axis. */
static void two_nodes_are_enough(void **state)
{
    (void)state;
    static float p[2][4 * 16 * 16];
    const double from[3] = {-4, -7, 12}, at[3] = {2, 2, 2};
    for (int two = 0; two < 8; two++) {
        struct grid g = make_grid(two & 1 ? 2 : 5, two & 2 ? 2 : 5, two & 4 ? 2 : 5);
        for (int a = 0; a < 3; a++) g.at[a][g.n[a] - 1] = 4;
        fill(&g, slanted);
        struct scene c = make_scene(from, at);
        c.s.w = c.s.h = 16, c.s.angle = 20;
        knot(&c, 5, 1, 0, 0, 0), knot(&c, 12, 0, 1, 0, 0.6), knot(&c, 12.5, 0, 0, 1, 0);
        iso(&c, 15, 1, 1, 1, 0.5);
        render(&g, &c.s, &fine, p[two > 0], NULL);
        double sum = 0;
        for (int i = 0; i < 4 * 16 * 16; i++) {
            if (two) near((double)p[1][i], (double)p[0][i], 5e-6);
            sum += (double)p[two > 0][i];
        }
        assert_true(sum > 100);
        free_grid(&g);
    }
}

static void missing_values_are_clear(void **state)
{
    (void)state;
    struct grid g = make_grid(7, 7, 7);
    fill(&g, seven);
    g.value[grid_node(&g, 3, 3, 3)] = NAN;
    struct scene c;
    even_map(&c, 0.2);
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
        cmocka_unit_test(rays_in_faces_and_edges),
        cmocka_unit_test(slopes_of_almost_nothing),
        cmocka_unit_test(corner_diagonals),
        cmocka_unit_test(cells_fill_the_ray),
        cmocka_unit_test(cameras_inside_on_and_far),
        cmocka_unit_test(flat_grids_in_metres),
        cmocka_unit_test(pictures_of_almost_no_slope),
        cmocka_unit_test(no_index_is_nan),
        cmocka_unit_test(two_nodes_are_enough),
        cmocka_unit_test(missing_values_are_clear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
