/* A tracer that looks from another view gives the bits of one that was made with it, and builds
 * nothing for it. */
#include "trace/trace_int.h"

#include <stdarg.h>
#include <stddef.h>
#include "trace_scenes.h"

enum { W = 48, H = 32 };

/* Near, and within the scene, where glass may be around the eye; far, to both sides of powers of
 * two; then near again. */
static const struct view views[] = {
    {{5, 1, 2}, {0, 0, 0}, {0, 0, 1}, 40, 0, W, H},
    {{.1, .2, .3}, {1, 1, 0}, {0, 1, 0}, 90, .5, W, H},
    {{70, -3, 2}, {0, 0, 0}, {0, 0, 1}, 4, 66, W, H},
    {{-3, 300, 2}, {0, 1, 0}, {1, 0, 1}, 1, 0, W, H},
    {{-3, 300, 2}, {0, 1, 0}, {1, 0, 1}, 1, 299, W, H},
    {{3e6, 5e6, 2e6}, {0, 0, 0}, {0, 0, 1}, 1e-4, 0, W, H},
    {{5, 1, 2}, {0, 0, 0}, {0, 0, 1}, 60, 4, W, H},
};
enum { VIEWS = sizeof views / sizeof *views };

static void same_blocks(const struct tracer *got, const struct tracer *want)
{
    for (int kind = 0; kind < ITEM_KINDS; kind++) {
        const struct shape *shape = trace_shapes[kind];
        const char *a = got->bvh.blocks[kind], *b = want->bvh.blocks[kind];
        assert_int_equal(got->bvh.n_blocks[kind], want->bvh.n_blocks[kind]);
        for (uint32_t i = 0; i < got->bvh.n_blocks[kind]; i++)
            assert_memory_equal(
                a + i * shape->block_size, b + i * shape->block_size, shape->items_at);
    }
    assert_true(got->bvh.slack == want->bvh.slack && got->reach == want->reach);
}

static void same_pictures(struct scene *s, enum trace_hierarchy hierarchy, double threshold)
{
    struct trace_options o = TRACE_OPTIONS_DEFAULT;
    o.hierarchy = hierarchy;
    o.samples = threshold < 0 ? 1 : 16;
    o.threshold = threshold;
    o.threads = 2;
    const struct view own = s->view;
    struct tracer *t = tracer_new(s, &o);
    const void *nodes = t->bvh.nodes, *items = t->items, *surfaces = t->surfaces;
    for (int i = 0; i <= VIEWS; i++) {
        const struct view *v = i < VIEWS ? &views[i] : NULL; /* the scene's own again */
        tracer_look(t, v);
        float *got = render(t, W, H, W, i & 1);
        if (v) s->view = *v;
        struct tracer *other = tracer_new(s, &o);
        float *want = render(other, W, H, W, false);
        s->view = own;
        assert_memory_equal(got, want, sizeof *got * 4 * W * H);
        same_blocks(t, other);
        assert_memory_equal(t->light_in_surface, other->light_in_surface, s->n_lights);
        assert_int_equal(t->n_enclosing, other->n_enclosing);
        tracer_free(other);
        free(got);
        free(want);
    }
    assert_true(nodes == t->bvh.nodes && items == t->items && surfaces == t->surfaces);
    tracer_free(t);
}

static void test_views(void **state)
{
    (void)state;
    for (uint64_t seed = 31; seed < 34; seed++) {
        struct buf text = {0};
        struct scene s;
        put_random_scene(&text, (struct placing){1, 0}, seed, 60);
        put_light(&text, (struct placing){1, 0}, 0, 0, -1.5); /* on the ground */
        read_scene(&text, &s);
        same_pictures(&s, HIERARCHY_BVH, -1);
        same_pictures(&s, seed & 1 ? HIERARCHY_SLABS : HIERARCHY_NONE, seed & 1 ? .1 : -1);
        scene_free(&s);
    }
}

/* The frame keeps its size. */
static void test_size(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, (struct placing){1, 0}, 35, 9);
    read_scene(&text, &s);
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct tracer *t = tracer_new(&s, &o);
    tracer_frame(t, 7, 5);
    tracer_look(t, &views[2]);
    assert_true(t->camera.w == 7 && t->camera.h == 5);
    tracer_free(t);
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_views),
        cmocka_unit_test(test_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
