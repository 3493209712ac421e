/*
 * Surfaces: meshes without cracks, whatever the scale and the distance from the origin; no surface
 * that its own rays hit.
 */
#define SIMD_MOST 8
#include "trace/packet.h"

#include <stdarg.h>
#include "trace_scenes.h"

static const struct kernels scalar = {"scalar", closest, blocked, closest_packet, blocked_packet};

/* ---- cracks
 * ------------------------------------------------------------------------------------ */

/* A closed box of n x n squares a side, its corners pushed onto a sphere of radius 1 around
 * `at.shift`. */
static void put_ball_of_squares(struct buf *b, struct placing at, int n)
{
    for (int side = 0; side < 6; side++)
        for (int i = 0; i < n * n; i++) {
            buf_printf(b, "p 4\n");
            for (int k = 0; k < 4; k++) {
                double u = 2.0 * (i % n + (k == 1 || k == 2)) / n - 1,
                       v = 2.0 * (i / n + (k >= 2)) / n - 1;
                double w = side & 1 ? 1 : -1, p[3] = {u, v, w};
                struct vec3 q = v3(p[side / 2], p[(side / 2 + 1) % 3], p[(side / 2 + 2) % 3]);
                q = v3_unit(q);
                put_point(b, at, q.x, q.y, q.z);
            }
            buf_printf(b, "\n");
        }
}

/* From inside, at every corner, every edge's middle and beside: something is always hit. */
static void shoot_at_seams(const struct scene *s, struct vec3 centre, const struct kernels *k)
{
    struct tracer *t = tracer_with(s, k);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        uint32_t next = i % 4 == 3 ? i - 3 : i + 1;
        for (int step = 0; step < 8; step++) {
            struct vec3 a = s->vertices[i], b = s->vertices[next];
            struct vec3 to = v3_sub(v3_mad(a, v3_sub(b, a), step / 8.0), centre);
            struct ray r = {centre, v3_unit(to), 0, HUGE_VAL, 0, false, 0};
            struct hit h;
            k->closest(&t->bvh, &r, &h);
            assert_int_not_equal(h.item, NO_ITEM);
        }
    }
    tracer_free(t);
}

static void test_no_cracks(void **state)
{
    (void)state;
    const struct placing at[] = {{1, 0}, {1e-3, 0}, {1e6, 0}, {1, 12345.678}, {1e-3, 1000}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        struct buf text = {0};
        struct scene s;
        put_view(&text, at[i], 5, 0, 1, 0);
        put_ball_of_squares(&text, at[i], 9);
        read_scene(&text, &s);
        struct vec3 centre = v3(at[i].shift, at[i].shift, at[i].shift);
        shoot_at_seams(&s, centre, trace_kernels_sse2());
        shoot_at_seams(&s, v3_mad(centre, v3(0.1, 0.2, 0.3), at[i].scale), trace_kernels_sse2());
        scene_free(&s);
    }
}

/* Straight down on the corners and sides of a grid of squares: where boxes end and slopes are 0. */
static void test_axis_parallel(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_view(&text, in_place, 5, 0, 1, 0);
    for (int i = 0; i < 256; i++) {
        double x = (i % 16) / 10.0 - 0.8, y = (i / 16) / 10.0 - 0.8;
        buf_printf(&text, "p 4 %.17g %.17g .1 %.17g %.17g .1 %.17g %.17g .1 %.17g %.17g .1\n", x, y,
            x + 0.1, y, x + 0.1, y + 0.1, x, y + 0.1);
    }
    read_scene(&text, &s);
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    for (int k = 0; k < 4; k++) {
        if (!all[k]) continue;
        struct tracer *t = tracer_with(&s, all[k]);
        for (uint32_t i = 0; i < s.n_vertices; i++)
            for (int step = 0; step < 4; step++) {
                struct vec3 a = s.vertices[i], b = s.vertices[i % 4 == 3 ? i - 3 : i + 1];
                struct vec3 p = v3_mad(a, v3_sub(b, a), step / 4.0);
                struct ray r = {v3(p.x, p.y, step & 1 ? 7 : -7),
                    v3(0, step & 2 ? -0.0 : 0, step & 1 ? -1 : 1), 0, HUGE_VAL, 0, false, 0};
                struct hit h;
                t->k->closest(&t->bvh, &r, &h);
                assert_int_not_equal(h.item, NO_ITEM);
            }
        tracer_free(t);
    }
    scene_free(&s);
}

/* ---- rays that start on a surface ---------------------------------------------------------- */

/*
 * From where a ray met one lone convex primitive, rays away from it hit nothing, however grazing;
 * rays into a sphere come out on the other side.
 */
static void leave_surface(const struct tracer *t, uint64_t seed, struct placing at)
{
    uint64_t n = 0;
    struct vec3 centre = v3(at.shift, at.shift, at.shift);
    for (int i = 0; i < 2000; i++) {
        struct vec3 from = v3_mad(centre, random_point(seed, &n, 3), at.scale);
        struct vec3 to = v3_mad(centre, random_point(seed, &n, 0.8), at.scale);
        struct ray r = {from, v3_unit(v3_sub(to, from)), 0, HUGE_VAL, 0, false, 0};
        struct hit h;
        t->k->closest(&t->bvh, &r, &h);
        if (h.item == NO_ITEM) continue;
        const struct item *it = &t->items[h.item];
        struct vec3 p = v3_mad(r.o, r.d, h.t),
                    normal = trace_shapes[it->kind]->normal(t->scene, it, &p);
        if (it->kind != ITEM_TRIANGLE && v3_dot(normal, r.d) > 0) continue; /* seen from inside */
        if (v3_dot(normal, r.d) > 0) normal = v3_scale(normal, -1);
        struct vec3 side = v3_unit(v3_cross(normal, r.d));
        double err = ERR_UNIT * (fabs(p.x) + fabs(p.y) + fabs(p.z) + h.t);
        /* The normal itself is only as good as p: below that, "away" means nothing. */
        for (double slope = 1; slope > 4 * err / at.scale; slope /= 10) {
            struct ray away = {p, v3_unit(v3_mad(side, normal, slope)), 0, HUGE_VAL, err, false, 0};
            t->k->closest(&t->bvh, &away, &h);
            if (h.item != NO_ITEM) fail_msg("slope %g: hit itself at %g", slope, h.t);
        }
    }
}

static void check_no_self_hit(const char *convex, struct placing at)
{
    struct buf text = {0};
    struct scene s;
    put_view(&text, in_place, 5, 0, 1, 0);
    buf_printf(&text, "%s", convex);
    read_scene(&text, &s);
    /* Placed after reading, so that the shapes stay what the text says. */
    for (uint32_t v = 0; v < s.n_vertices; v++) s.vertices[v] = placed(at, s.vertices[v]);
    if (prim_kinds[s.prims[0].kind].place) prim_kinds[s.prims[0].kind].place(&s.prims[0], at);
    struct tracer *t = tracer_with(&s, trace_kernels_sse2());
    leave_surface(t, 7, at);
    tracer_free(t);
    scene_free(&s);
}

static void test_no_self_hit(void **state)
{
    (void)state;
    const struct placing at[] = {{1, 0}, {1e-3, 0}, {1e6, 0}, {1, 1000}};
    for (int kind = 0; kind < PRIM_KINDS; kind++)
        for (int i = 0; i < 2 && prim_kinds[kind].convex[i]; i++)
            for (size_t k = 0; k < sizeof at / sizeof *at; k++)
                check_no_self_hit(prim_kinds[kind].convex[i], at[k]);
}

static void test_sphere_from_inside(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_view(&text, in_place, 5, 0, 1, 0);
    buf_printf(&text, "s 3 -2 1 .5\n");
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, trace_kernels_sse2());
    uint64_t n = 0;
    for (int i = 0; i < 1000; i++) {
        struct vec3 c = v3(3, -2, 1), a = v3_unit(random_point(3, &n, 1)),
                    b = v3_unit(random_point(3, &n, 1));
        struct vec3 p = v3_mad(c, a, 0.5), q = v3_mad(c, b, 0.5);
        struct ray r = {p, v3_unit(v3_sub(q, p)), 0, HUGE_VAL, 8 * ERR_UNIT, false, 0};
        struct hit h;
        t->k->closest(&t->bvh, &r, &h);
        assert_int_equal(h.item, 0);
        assert_true(fabs(h.t - v3_len(v3_sub(q, p))) < 1e-13);
    }
    tracer_free(t);
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_cracks),
        cmocka_unit_test(test_axis_parallel),
        cmocka_unit_test(test_no_self_hit),
        cmocka_unit_test(test_sphere_from_inside),
    };
    return cmocka_run_group_tests_name("trace: surfaces", tests, NULL, NULL);
}
