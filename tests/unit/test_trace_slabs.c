/*
 * The hierarchy of slabs, and none, against the BVH: the same hits, shadows and pictures, bit by
 * bit; its volumes contain what they bound; the counts of tests.
 */
#include "rounds.h"
#include "trace/slabs.h"
#include "trace/triangle.h"

#include <stdarg.h>
#include <stddef.h>
#include "trace_scenes.h"

static const enum trace_hierarchy every[] = {HIERARCHY_BVH, HIERARCHY_SLABS, HIERARCHY_NONE};

static struct tracer *tracer_by(const struct scene *s, enum trace_hierarchy h, bool count)
{
    struct trace_options o = TRACE_OPTIONS_DEFAULT;
    o.hierarchy = h;
    o.count_tests = count;
    return tracer_new(s, &o);
}

/* Scenes of all kinds of primitives, many factors of transmission, or everything twice. */
static void random_scene(struct scene *s, uint64_t seed, struct placing at)
{
    struct buf text = {0};
    uint64_t n = 0;
    if (seed % 3 == 0) put_random_scene(&text, at, seed, 60);
    else if (seed % 3 == 1) put_glass_scene(&text, at, seed, 40);
    else {
        put_view(&text, at, 5, 0, 1, 0);
        put_light(&text, at, 2, 3, 9);
        for (int twice = 0; twice < 2; twice++, n = 0)
            for (int i = 0; i < 50; i++) {
                if (i % 5 == 0) put_random_material(&text, seed, &n);
                put_random_prim(&text, at, seed, &n);
            }
    }
    read_scene(&text, s);
}

static void same_pictures(const struct scene *s)
{
    float *want = NULL;
    for (int count = 0; count < 2; count++)
        for (int i = 0; i < 3; i++) {
            struct tracer *t = tracer_by(s, every[i], count);
            float *got = render(t, 48, 32, 48, false);
            if (!want) want = got;
            else {
                assert_memory_equal(want, got, sizeof *want * 4 * 48 * 32);
                free(got);
            }
            tracer_free(t);
        }
    free(want);
}

static void test_pictures(void **state)
{
    (void)state;
    static const struct placing places[] = {{1, 0}, {1, 1e6}, {1e-9, 0}, {1e12, 0}};
    for (uint64_t seed = 0; seed < (uint64_t)rounds(12); seed++) {
        struct scene s;
        random_scene(&s, seed, places[seed % 4]);
        same_pictures(&s);
        scene_free(&s);
    }
}

static void test_small_scenes(void **state)
{
    (void)state;
    static const char *const more[] = {"", "s 0 0 0 1\n", "c 0 0 0 1 0 0 1 0\n",
        "p 3 1 1 1 1 1 1 1 1 1\n", /* no surface */
        "p 5 -1 -1 0 1 -1 0 1 -1 0 1 1 0 -1 1 0\ns 0 0 1 .5\n",
        /* the lamp lies on a ball of glass: its light crosses the ball's surface once */
        "p 4 -9 -9 -2 9 -9 -2 9 9 -2 -9 9 -2\nf 1 1 1 .5 .2 9 .5 1.2\ns 0 0 0 1.5\n"};
    for (size_t i = 0; i < sizeof more / sizeof more[0]; i++) {
        struct buf text = {0};
        struct scene s;
        put_view(&text, in_place, 4, 1, 2, 0);
        put_light(&text, in_place, 0, 0, 1.5);
        buf_printf(&text, "f 1 .5 .2 .7 .3 9 0 0\n%s", more[i]);
        read_scene(&text, &s);
        same_pictures(&s);
        scene_free(&s);
    }
}

/* Hits and shadows of rays between random points, and along axes and diagonals. */
static void test_rays(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < (uint64_t)rounds(6); seed++) {
        struct scene s;
        struct tracer *t[3];
        struct crossings c[3] = {{0}};
        uint64_t n = 0;
        random_scene(&s, seed, in_place);
        for (int i = 0; i < 3; i++) t[i] = tracer_by(&s, every[i], true);
        for (int k = 0; k < 2000; k++) {
            struct vec3 o = random_point(seed, &n, 4), to = random_point(seed, &n, 2);
            if (k % 5 == 0) to = v3(o.x, o.y - 1, o.z);
            if (k % 5 == 1) to = v3(o.x - 1, o.y + 1, o.z); /* in the planes of two normals */
            const struct ray r = {
                .o = o, .d = v3_unit(v3_sub(to, o)), .t_max = k % 3 ? HUGE_VAL : 2};
            struct hit h[3];
            bool blocked[3];
            for (int i = 0; i < 3; i++) {
                c[i].n = 0;
                t[i]->k->closest(&t[i]->bvh, &r, &h[i]);
                blocked[i] = t[i]->k->blocked(&t[i]->bvh, &r, t[i]->transmits, &c[i]);
                double part[2] = {light_through(t[i], &c[i]), light_through(t[0], &c[0])};
                assert_int_equal(h[i].item, h[0].item);
                assert_memory_equal(&h[i].t, &h[0].t, sizeof h[0].t);
                assert_int_equal(blocked[i], blocked[0]);
                if (!blocked[0]) assert_memory_equal(&part[0], &part[1], sizeof part[0]);
            }
        }
        for (int i = 0; i < 3; i++) {
            free(c[i].item);
            tracer_free(t[i]);
        }
        scene_free(&s);
    }
}

/* Lamps on surfaces, and in the planes of triangles but beside them: marked alike. */
static void test_lamps(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    uint64_t n = 0;
    put_view(&text, in_place, 5, 0, 1, 0);
    for (int i = 0; i < 60; i++) {
        double x = between(3, &n, -2, 2), y = between(3, &n, -2, 2);
        put_light(&text, in_place, x, y, 0.5 * (i % 3));
    }
    buf_printf(&text, "f 1 1 1 1 0 1 0 0\n");
    for (int i = 0; i < 40; i++) { /* small triangles in two planes */
        double x = between(3, &n, -2, 2), y = between(3, &n, -2, 2), z = 0.5 * (i % 2);
        buf_printf(&text, "p 3 %.17g %.17g %g %.17g %.17g %g %.17g %.17g %g\n", x, y, z, x + 1, y,
            z, x, y + .6, z);
    }
    read_scene(&text, &s);
    struct tracer *t[3];
    for (int i = 0; i < 3; i++) t[i] = tracer_by(&s, every[i], false);
    uint32_t marked = 0;
    for (uint32_t l = 0; l < s.n_lights; l++) {
        marked += t[0]->light_in_surface[l];
        for (int i = 1; i < 3; i++)
            assert_int_equal(t[i]->light_in_surface[l], t[0]->light_in_surface[l]);
    }
    assert_in_range(marked, 1, s.n_lights * 2 / 3 - 1); /* a third is in no plane */
    for (int i = 0; i < 3; i++) tracer_free(t[i]);
    scene_free(&s);
}

/* A node's slabs contain those of its children, and a leaf's the vertices of its triangles. */
static uint32_t check_node(const struct tracer *t, uint32_t node, uint32_t first, uint32_t n)
{
    const struct slabs *s = t->bvh.slabs;
    const struct slabs_node *at = &s->nodes[node];
    if (n > 1) {
        uint32_t half = n / 2, child[2] = {node + 1, node + 2 * half};
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < SLABS; i++) {
                assert_true(at->lo[i] <= s->nodes[child[k]].lo[i]);
                assert_true(at->hi[i] >= s->nodes[child[k]].hi[i]);
            }
        return check_node(t, child[0], first, half) +
               check_node(t, child[1], first + half, n - half);
    }
    const struct slabs_leaf *l = &s->leaves[first];
    for (uint32_t k = l->first; l->kind == ITEM_TRIANGLE && k < l->first + l->n; k++) {
        const struct triangle4 *b =
            (const struct triangle4 *)t->bvh.blocks[ITEM_TRIANGLE] + k / LANES;
        for (int v = 0; v < 3; v++) {
            struct vec3 p = t->scene->vertices[t->items[b->item[k % LANES]].vertex[v]];
            for (int i = 0; i < SLABS; i++) {
                const double *a = slabs_normal[i];
                double d = v3_dot(v3(a[0], a[1], a[2]), p), slack = 3 * (double)t->bvh.slack;
                assert_true((double)at->lo[i] - slack <= d && d <= (double)at->hi[i] + slack);
            }
        }
    }
    return 1;
}

static void test_volumes(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, in_place, 7, 501);
    read_scene(&text, &s);
    struct tracer *t = tracer_by(&s, HIERARCHY_SLABS, false);
    const struct slabs *h = t->bvh.slabs;
    bool *seen = xcalloc(t->n_items, 1);
    assert_int_equal(h->n, s.n_prims); /* whole polygons */
    assert_int_equal(check_node(t, 0, 0, h->n), s.n_prims);
    for (uint32_t i = 0; i < h->n; i++)
        for (uint32_t k = h->leaves[i].first; k < h->leaves[i].first + h->leaves[i].n; k++) {
            uint32_t kind = h->leaves[i].kind;
            size_t at = k / LANES * trace_shapes[kind]->block_size;
            uint32_t item = block_items(kind, (char *)t->bvh.blocks[kind] + at)[k % LANES];
            assert_false(seen[item]);
            seen[item] = true;
        }
    for (uint32_t i = 0; i < t->n_items; i++) assert_true(seen[i]);
    free(seen);
    tracer_free(t);
    scene_free(&s);
}

static void test_counts(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    struct trace_tests c[3];
    put_random_scene(&text, in_place, 9, 400);
    read_scene(&text, &s);
    uint32_t items = 0;
    for (int i = 0; i < 3; i++) {
        struct tracer *t = tracer_by(&s, every[i], true);
        struct trace_counts rays;
        struct hit h;
        const struct ray up = {.o = v3(0, 0, 9), .d = v3(0, 0, 1), .t_max = HUGE_VAL};
        t->k->closest(&t->bvh, &up, &h);
        tracer_tests(t, &c[i]);
        assert_int_equal(c[i].rays, 1);
        items = t->n_items;
        /* Nothing lies above: one volume is tested, or the eight of the root, or each item. */
        assert_int_equal(c[i].boxes, every[i] == HIERARCHY_NONE ? 0 : i ? 1 : 8);
        assert_int_equal(c[i].items, every[i] == HIERARCHY_NONE ? items : 0);
        free(render(t, 48, 32, 48, false));
        tracer_tests(t, &c[i]);
        tracer_counts(t, &rays);
        uint64_t sum = 1;
        for (int k = 0; k < RAY_KINDS; k++) sum += rays.of[k].rays;
        assert_int_equal(c[i].rays, sum);
        tracer_free(t);
    }
    assert_true(c[0].rays == c[1].rays && c[1].rays == c[2].rays);
    assert_true(c[2].items > c[2].rays / 2 * items && c[2].boxes == 0);
    assert_true(10 * c[0].items < c[2].items && 10 * c[1].items < c[2].items);
    assert_int_equal(c[2].bytes, 0);
    assert_true(c[1].bytes > (2 * (uint64_t)s.n_prims - 1) * sizeof(struct slabs_node));
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_small_scenes),
        cmocka_unit_test(test_rays),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_volumes),
        cmocka_unit_test(test_counts),
    };
    return cmocka_run_group_tests_name("trace: slabs", tests, NULL, NULL);
}
