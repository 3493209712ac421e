/*
 * Triangles of polygons: they cover it once, whatever its shape, plane and order; and it always
 * ends.
 */
#include "rounds.h"
#include "scene/scene.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define CORNERS_MAX 4000

struct polygon {
    uint32_t n;
    struct vec3 v[CORNERS_MAX];
    struct triangle t[CORNERS_MAX];
    uint32_t triangles;
};

static struct polygon *shape; /* of the test that runs */

static int make_shape(void **state)
{
    (void)state;
    shape = xcalloc(1, sizeof *shape);
    return 0;
}

static int free_shape(void **state)
{
    (void)state;
    free(shape);
    return 0;
}

static void add(double x, double y) { shape->v[shape->n++] = v3(x, y, 0); }

static void triangulate(enum prim_kind kind)
{
    struct scene s = {.vertices = shape->v, .n_vertices = shape->n};
    struct prim p = {.kind = kind, .poly = {0, shape->n}};
    memset(shape->t, 0xff, sizeof shape->t);
    shape->triangles = scene_triangulate(&s, &p, shape->t);
    assert_true(shape->triangles <= shape->n - 2);
    for (uint32_t i = 0; i < shape->triangles; i++)
        for (int k = 0; k < 3; k++) {
            assert_true(shape->t[i].v[k] < shape->n);
            assert_true(shape->t[i].v[k] != shape->t[i].v[(k + 1) % 3]);
        }
    assert_int_equal(
        shape->t[shape->triangles].v[0], UINT32_MAX); /* nothing behind them is written */
}

/* Twice the area, as a vector. */
static struct vec3 triangle_area(const struct triangle *t)
{
    const struct vec3 *v = shape->v;
    return v3_cross(v3_sub(v[t->v[1]], v[t->v[0]]), v3_sub(v[t->v[2]], v[t->v[0]]));
}

static struct vec3 outline_area(void)
{
    struct vec3 a = v3(0, 0, 0);
    for (uint32_t i = 1; i + 1 < shape->n; i++)
        a = v3_add(
            a, v3_cross(v3_sub(shape->v[i], shape->v[0]), v3_sub(shape->v[i + 1], shape->v[0])));
    return a;
}

/*
 * Every triangle faces as the polygon does, and their areas add up to its own: with corners taken
 * from its outline only, that leaves neither gaps nor overlaps.
 */
static void check_cover(double tolerance)
{
    struct vec3 whole = outline_area(), n = v3_unit(whole);
    double sum = 0;
    triangulate(PRIM_POLYGON);
    for (uint32_t i = 0; i < shape->triangles; i++) {
        double a = v3_dot(triangle_area(&shape->t[i]), n);
        assert_true(a > 0);
        sum += a;
    }
    assert_true(fabs(sum - v3_len(whole)) <= tolerance * v3_len(whole));
}

/*
 * The shape as it is; from every corner on; backwards; turned out of its plane; and far from
 * the origin.
 */
static void check_everywhere(double tolerance)
{
    uint32_t n = shape->n;
    struct vec3 *v = xcalloc(n, sizeof *v);
    memcpy(v, shape->v, n * sizeof *v);
    for (uint32_t from = 0; from < n; from += 1 + n / 40)
        for (int way = 0; way < 6; way++) {
            for (uint32_t i = 0; i < n; i++) {
                struct vec3 p = v[way & 1 ? (from + n - i) % n : (from + i) % n];
                if (way >= 4)
                    p = v3(
                        1e4 - .3 * p.x + .9 * p.y, .8 * p.x + .6 * p.y - 2e4, .6 * p.x - .4 * p.y);
                else if (way >= 2) p = v3(p.y, .25, p.x);
                shape->v[i] = p;
            }
            check_cover(tolerance);
        }
    free(v);
}

static void test_convex(void **state)
{
    (void)state;
    add(0, 0), add(1, 0), add(1, 1), add(0, 1);
    check_cover(0);
    assert_int_equal(shape->triangles, 2);
    check_everywhere(1e-9);
}

static void test_concave(void **state)
{
    (void)state;
    add(0, 0), add(4, 0), add(4, 4), add(2, 1), add(0, 4), add(1, .5);
    check_cover(1e-15);
    assert_int_equal(shape->triangles, 4);
    check_everywhere(1e-8);
}

/* SPD's gear face: 144 corners, half of them reflex. */
static void add_gear(double z_noise)
{
    static const double at[4] = {-.19, .19, .3, .7}, radius[4] = {.995, .995, .9, .9};
    for (int i = 0; i < 144; i++) {
        double a = 2 * M_PI / 36 * (i / 4 + at[i % 4]), r = radius[i % 4];
        add(r * cos(a), r * sin(a));
        shape->v[i].z = z_noise * (rng_unit(7, (uint64_t)i) - .5);
    }
}

static void test_gear(void **state)
{
    (void)state;
    add_gear(0);
    check_cover(1e-14);
    assert_int_equal(shape->triangles, 142);
    check_everywhere(1e-7);
}

static void test_off_plane(void **state)
{
    (void)state;
    add_gear(1e-5);
    check_cover(1e-12);
    assert_int_equal(shape->triangles, 142);
}

static void test_spiral(void **state)
{
    (void)state;
    for (int i = 0; i <= 300; i++) add((1 + i * .02) * cos(i * .1), (1 + i * .02) * sin(i * .1));
    for (int i = 300; i >= 0; i--) add((.9 + i * .02) * cos(i * .1), (.9 + i * .02) * sin(i * .1));
    check_cover(1e-12);
    assert_int_equal(shape->triangles, 600);
}

static void test_comb(void **state)
{
    (void)state;
    for (int i = 0; i < 1000; i++) add(2 * i, 0), add(2 * i + 1, 100);
    add(2000, 0), add(2000, -1), add(-1, -1);
    check_cover(1e-12);
    assert_int_equal(shape->triangles, shape->n - 2);
}

/* Petals that all end at one place. */
static void test_flower(void **state)
{
    (void)state;
    for (int i = 0; i < 1200; i++) {
        double a = 2 * M_PI * i / 1200, b = a + M_PI / 1200;
        add(0, 0), add(cos(a), sin(a)), add(cos(b), sin(b));
    }
    check_cover(1e-9);
    assert_int_equal(shape->triangles, 1200);
}

/*
 * Corners on a line, and in a cluster: asking all of them, or those of a cell of a grid, about
 * every ear takes minutes.
 */
static void test_many_corners(void **state)
{
    (void)state;
    const uint32_t N = (uint32_t)rounds(200000);
    struct vec3 *v = xcalloc(N, sizeof *v);
    struct triangle *t = xcalloc(N, sizeof *t);
    struct scene s = {.vertices = v, .n_vertices = N};
    struct prim p = {.kind = PRIM_POLYGON, .poly = {0, N}};
    for (uint32_t i = 0; i + 3 < N; i++) v[i] = v3(i, i & 1 ? 100 : 0, 0); /* a comb */
    v[N - 3] = v3(N, 0, 0), v[N - 2] = v3(N, -1, 0), v[N - 1] = v3(-1, -1, 0);
    assert_int_equal(scene_triangulate(&s, &p, t), N - 2);
    for (uint32_t i = 0; i < N; i++) { /* a star, in a corner of what the last point spans */
        double a = 2 * M_PI * i / (double)N, r = 1e-6 * (.05 + rng_unit(1, i));
        v[i] = v3(r * cos(a), r * sin(a), 0);
    }
    v[N - 1] = v3(1, 0, 0);
    assert_int_equal(scene_triangulate(&s, &p, t), N - 2);
    free(v);
    free(t);
}

/* A hole, joined to the outline by an edge there and back: two corners of it coincide, twice. */
static void test_hole(void **state)
{
    (void)state;
    add(0, 0), add(4, 0), add(4, 4), add(0, 4), add(0, 0);
    add(1, 1), add(1, 3), add(3, 3), add(3, 1), add(1, 1);
    check_cover(1e-15);
    assert_int_equal(shape->triangles, 8);
    check_everywhere(1e-9);
}

static void test_holes(void **state)
{
    (void)state;
    /* Three diamonds, each joined to the lower edge. */
    add(0, 0);
    for (int i = 0; i < 3; i++) {
        double x = 2 + 3 * i;
        add(x, 0), add(x, 1), add(x - 1, 2), add(x, 3), add(x + 1, 2), add(x, 1), add(x, 0);
    }
    add(10, 0), add(10, 4), add(0, 4);
    check_cover(1e-14);
    check_everywhere(1e-8);
}

static void test_straight_and_repeated(void **state)
{
    (void)state;
    add(0, 0), add(1, 0), add(1, 0), add(2, 0), add(3, 0), add(3, 3), add(3, 3), add(1.5, 3),
        add(0, 3), add(0, 3), add(0, 0);
    check_cover(0);
    assert_int_equal(shape->triangles, 5); /* straight corners are kept, so that no T is left */
    check_everywhere(1e-9);
    shape->n = 0; /* edges that go there and back enclose nothing */
    add(0, 0), add(3, 0), add(5, 0), add(3, 0), add(3, 3), add(3, 5), add(3, 4), add(3, 3),
        add(0, 3);
    check_cover(0);
}

static void test_no_area(void **state)
{
    (void)state;
    for (int i = 0; i < 5; i++) shape->v[i] = v3(i * .1, i * .2, i * .3);
    shape->n = 5;
    triangulate(PRIM_POLYGON);
    assert_int_equal(shape->triangles, 0);
    for (int i = 0; i < 5; i++) shape->v[i] = v3(1, 2, 3);
    triangulate(PRIM_POLYGON);
    assert_int_equal(shape->triangles, 0);
    triangulate(PRIM_PATCH);
    assert_int_equal(shape->triangles, 0);
    for (int i = 0; i < 5; i++) shape->v[i] = v3(i % 2, i % 2, 0); /* there and back */
    triangulate(PRIM_POLYGON);
    assert_int_equal(shape->triangles, 0);
}

static void test_crossing_ends(void **state)
{
    (void)state;
    add(0, 0), add(2, 2), add(2, 0), add(0, 1.5); /* a bow tie */
    triangulate(PRIM_POLYGON);
    assert_true(shape->triangles > 0);
    shape->n = 0;
    for (int i = 0; i < 5; i++) add(cos(4 * M_PI * i / 5), sin(4 * M_PI * i / 5)); /* a pentagram */
    triangulate(PRIM_POLYGON);
    assert_true(shape->triangles > 0);
    for (uint64_t seed = 0; seed < 3000; seed++) {
        shape->n = 3 + (uint32_t)(seed % 40);
        for (uint32_t i = 0; i < shape->n; i++)
            shape->v[i] = v3(floor(8 * rng_unit(seed, 3 * i)), floor(8 * rng_unit(seed, 3 * i + 1)),
                seed % 3 ? floor(8 * rng_unit(seed, 3 * i + 2)) : 0);
        triangulate(PRIM_POLYGON);
        triangulate(PRIM_PATCH);
    }
}

/* Star-shaped polygons of random radii are simple: each must be covered exactly. */
static void test_random_stars(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 300; seed++) {
        uint32_t n = 5 + (uint32_t)(rng_u64(seed, 0) % (seed % 30 ? 60 : 2000));
        shape->n = 0;
        for (uint32_t i = 0; i < n; i++) {
            double a = 2 * M_PI * i / n, r = .05 + rng_unit(seed, i + 1);
            add(r * cos(a), r * sin(a));
        }
        check_cover(1e-9);
        assert_int_equal(shape->triangles, n - 2);
    }
}

static void test_deterministic(void **state)
{
    (void)state;
    struct triangle first[144];
    add_gear(1e-6);
    triangulate(PRIM_POLYGON);
    memcpy(first, shape->t, sizeof first);
    triangulate(PRIM_POLYGON);
    assert_memory_equal(first, shape->t, 142 * sizeof *first);
    /* And the same on every host: what the coordinates' signs say, no more. */
    uint64_t h = hash64(HASH64_INIT, shape->t, 142 * sizeof *first);
    shape->n = 0;
    add_gear(0);
    triangulate(PRIM_POLYGON);
    assert_int_equal(h, hash64(HASH64_INIT, shape->t, 142 * sizeof *first));
}

static void test_patch(void **state)
{
    (void)state;
    add(0, 0), add(1, 0), add(1, 0), add(1, 1), add(0, 1);
    triangulate(PRIM_PATCH);
    assert_int_equal(shape->triangles, 2); /* a fan from corner 0, without the empty one */
    static const struct triangle want[2] = {{{0, 2, 3}}, {{0, 3, 4}}};
    assert_memory_equal(shape->t, want, sizeof want);
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, make_shape, free_shape)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_convex),
        TEST(test_concave),
        TEST(test_gear),
        TEST(test_off_plane),
        TEST(test_spiral),
        TEST(test_comb),
        TEST(test_flower),
        cmocka_unit_test(test_many_corners),
        TEST(test_hole),
        TEST(test_holes),
        TEST(test_straight_and_repeated),
        TEST(test_no_area),
        TEST(test_crossing_ends),
        TEST(test_random_stars),
        TEST(test_deterministic),
        TEST(test_patch),
    };
    return cmocka_run_group_tests_name("triangulate", tests, NULL, NULL);
}
