/*
 * The build of the hierarchy: the same bytes with any number of threads; every item is in one lane
 * of one leaf, within the boxes of all nodes above.
 */
#include <stdarg.h>
#include <stddef.h>
#include "rounds.h"
#include "trace_scenes.h"

/* A scene of n primitives, more than a chunk of references has and than a task builds. */
static void make_scene(struct scene *s, uint64_t seed, uint32_t n,
    void (*put)(struct buf *b, uint64_t seed, uint64_t *at, uint32_t i))
{
    struct buf b = {0};
    char err[SCENE_ERR];
    uint64_t at = 0;
    put_view(&b, in_place, 9, 8, 7, 0);
    put_light(&b, in_place, 5, 5, 9);
    for (uint32_t i = 0; i < n; i++) put(&b, seed, &at, i);
    if (nff_read("t", (const char *)buf_data(&b), buf_size(&b), s, err) != 0) fail_msg("%s", err);
    buf_free(&b);
}

static void put_point_near(struct buf *b, uint64_t seed, uint64_t *at, struct vec3 c, double r)
{
    put_point(b, in_place, between(seed, at, c.x - r, c.x + r), between(seed, at, c.y - r, c.y + r),
        between(seed, at, c.z - r, c.z + r));
}

/* All kinds, small and large, some without a surface. */
static void put_any(struct buf *b, uint64_t seed, uint64_t *at, uint32_t i)
{
    struct vec3 c = v3(between(seed, at, -5, 5), between(seed, at, -5, 5), 0);
    double r = i % 100 ? .1 : 5;
    if (i % 5 == 0) {
        put_sphere(b, in_place, c.x, c.y, c.z, r);
        return;
    }
    if (i % 5 == 1) {
        buf_printf(b, "c");
        put_point_near(b, seed, at, c, r);
        buf_printf(b, " .1");
        put_point_near(b, seed, at, c, r);
        buf_printf(b, " .2\n");
        return;
    }
    buf_printf(b, "p %d", 3 + (int)(i % 3));
    for (uint32_t k = 0; k < 3 + i % 3; k++) {
        if (i % 7 == 0) put_point(b, in_place, c.x, c.y, c.z);
        else put_point_near(b, seed, at, c, r);
    }
    buf_printf(b, "\n");
}

/* One centre: no split by centres separates them. */
static void put_same(struct buf *b, uint64_t seed, uint64_t *at, uint32_t i)
{
    if (i % 2) put_sphere(b, in_place, 1, 1, 1, between(seed, at, .4, .5));
    else buf_printf(b, "p 3 0 0 1 2 0 1 1 2 1\n");
}

/* Along a line, each a thousandth of the one before: splits cut off a few at a time. */
static void put_shrinking(struct buf *b, uint64_t seed, uint64_t *at, uint32_t i)
{
    double x = pow(.999, i);
    put_sphere(b, in_place, x, between(seed, at, 0, x), 0, x / 1000);
}

static const struct {
    const char *name;
    void (*put)(struct buf *b, uint64_t seed, uint64_t *at, uint32_t i);
    uint32_t n;
} scenes[] = {{"any", put_any, 60000}, {"any, few", put_any, 900}, {"one", put_any, 1},
    {"none", put_any, 0}, {"same", put_same, 20000}, {"shrinking", put_shrinking, 12000}};

static void same_items(const struct tracer *a, const struct tracer *b)
{
    assert_int_equal(a->n_items, b->n_items);
    for (uint32_t i = 0; i < a->n_items; i++) {
        const struct item *x = &a->items[i], *y = &b->items[i];
        assert_true(x->prim == y->prim && x->material == y->material && x->kind == y->kind &&
                    x->smooth == y->smooth);
        assert_memory_equal(x->vertex, y->vertex, sizeof x->vertex);
    }
}

static void same_hierarchy(const struct bvh *a, const struct bvh *b)
{
    assert_int_equal(a->n_nodes, b->n_nodes);
    if (a->n_nodes) assert_memory_equal(a->nodes, b->nodes, a->n_nodes * sizeof *a->nodes);
    for (int k = 0; k < ITEM_KINDS; k++) {
        size_t size = trace_shapes[k]->block_size;
        size_t n = trace_shapes[k]->items_at + LANES * sizeof(uint32_t); /* no padding */
        assert_int_equal(a->n_blocks[k], b->n_blocks[k]);
        for (uint32_t i = 0; i < a->n_blocks[k]; i++)
            assert_memory_equal((const char *)a->blocks[k] + i * size,
                (const char *)b->blocks[k] + i * size, n);
    }
}

static void test_any_number_of_threads(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct scene s;
        struct trace_options o = TRACE_OPTIONS_DEFAULT;
        make_scene(&s, 1, scenes[i].n, scenes[i].put);
        struct tracer *one = tracer_new(&s, &o);
        for (o.threads = 2; o.threads <= 1 + rounds(6); o.threads++) {
            struct tracer *t = tracer_new(&s, &o);
            same_items(one, t);
            same_hierarchy(&one->bvh, &t->bvh);
            tracer_free(t);
        }
        tracer_free(one);
        scene_free(&s);
    }
}

/* ---- every item in its place ---------------------------------------------------------------- */

struct seen {
    const struct tracer *t;
    uint8_t *times; /* by item */
    uint32_t nodes;
    int depth; /* most nodes on the way to a leaf */
};

static const uint32_t *items_of(const struct bvh *b, enum item_kind kind, uint32_t i)
{
    return block_items(kind, (char *)b->blocks[kind] + i * trace_shapes[kind]->block_size);
}

static void see_leaf(struct seen *seen, uint32_t leaf, const float lo[3], const float hi[3])
{
    for (uint32_t i = 0; i < leaf_count(leaf); i++) {
        const uint32_t *item = items_of(&seen->t->bvh, leaf_kind(leaf), leaf_first(leaf) + i);
        for (int k = 0; k < LANES; k++) {
            if (item[k] == NO_ITEM) continue;
            struct vec3 a, b;
            const struct item *it = &seen->t->items[item[k]];
            assert_int_equal(it->kind, leaf_kind(leaf));
            trace_shapes[it->kind]->bounds(seen->t->scene, it, &a, &b);
            assert_true(lo[0] <= (float)a.x && lo[1] <= (float)a.y && lo[2] <= (float)a.z);
            assert_true(hi[0] >= (float)b.x && hi[1] >= (float)b.y && hi[2] >= (float)b.z);
            seen->times[item[k]]++;
        }
    }
}

static void see_node(struct seen *seen, uint32_t k, const float lo[3], const float hi[3], int depth)
{
    const struct node8 *n = &seen->t->bvh.nodes[k];
    seen->nodes++;
    if (depth > seen->depth) seen->depth = depth;
    for (int i = 0; i < WIDTH; i++) {
        if (!(n->used >> i & 1)) continue;
        float a[3], b[3];
        for (int c = 0; c < 3; c++) {
            a[c] = n->lo[c][i];
            b[c] = n->hi[c][i];
            assert_true(lo[c] <= a[c] && b[c] <= hi[c]);
        }
        if (n->child[i] & LEAF) see_leaf(seen, n->child[i], a, b);
        else see_node(seen, n->child[i], a, b, depth + 1);
    }
}

static void test_every_item_once(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        const float lo[3] = {-1e9F, -1e9F, -1e9F}, hi[3] = {1e9F, 1e9F, 1e9F};
        struct scene s;
        const struct trace_options o = TRACE_OPTIONS_DEFAULT;
        make_scene(&s, 2, scenes[i].n, scenes[i].put);
        struct tracer *t = tracer_new(&s, &o);
        struct seen seen = {t, xcalloc(t->n_items, 1), 0, 0};
        if (t->bvh.nodes) see_node(&seen, 0, lo, hi, 1);
        assert_int_equal(seen.nodes, t->bvh.n_nodes);
        assert_true(seen.depth * (WIDTH - 1) < STACK_MAX);
        for (uint32_t k = 0; k < t->n_items; k++)
            if (seen.times[k] != trace_shapes[t->items[k].kind]->has_surface(&s, &t->items[k]))
                fail_msg("%s: item %u is in %u lanes", scenes[i].name, k, seen.times[k]);
        free(seen.times);
        tracer_free(t);
        scene_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_number_of_threads),
        cmocka_unit_test(test_every_item_once),
    };
    return cmocka_run_group_tests_name("trace: build", tests, NULL, NULL);
}
