/*
 * The twin of kernel.h, without vectors and without a stack of its own: how a ray goes through the
 * hierarchy. To be read before kernel.h. The kernels find the same hits, bit by bit.
 */
#define SIMD_MOST 8
#include "trace/shapes.h"

#include <stdarg.h>
#include "trace_scenes.h"

/* True if the ray is in the box, widened by slack, somewhere between 0 and t_max. */
static bool enters(
    const struct node8 *n, int child, const struct ray *r, double slack, double t_max)
{
    const double o[3] = {r->o.x, r->o.y, r->o.z}, d[3] = {r->d.x, r->d.y, r->d.z};
    double in = 0, out = t_max;
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)n->lo[axis][child] - slack, hi = (double)n->hi[axis][child] + slack;
        if (d[axis] == 0 && (o[axis] < lo || o[axis] > hi)) return false;
        if (d[axis] == 0) continue;
        double a = (lo - o[axis]) / d[axis], b = (hi - o[axis]) / d[axis];
        in = fmax(in, fmin(a, b));
        out = fmin(out, fmax(a, b));
    }
    return in <= out;
}

/* A leaf's items are tested; of equal hits the lower item counts. A node's children that the ray
 * enters before the nearest hit so far are searched. kernel.h takes the nearest child first, so
 * that it can leave out more of the others. */
static void twin(const struct bvh *b, uint32_t child, const struct ray *r, struct hit *h)
{
    if (!(child & LEAF)) {
        const struct node8 *n = &b->nodes[child];
        for (int i = 0; i < WIDTH; i++)
            if (n->used >> i & 1 && enters(n, i, r, 2 * (double)b->slack, h->t))
                twin(b, n->child[i], r, h);
        return;
    }
    for (uint32_t i = 0; i < leaf_count(child); i++) {
        double t[LANES];
        const uint32_t *items;
        unsigned hits =
            hit_block(b, leaf_kind(child), leaf_first(child) + i, r, h->t, t, &items, NULL);
        for (int k = 0; k < LANES; k++)
            if (hits >> k & 1 && (t[k] < h->t || (t[k] == h->t && items[k] < h->item)))
                *h = (struct hit){t[k], items[k]};
    }
}

static uint32_t compare(const struct tracer *t, const struct ray *r)
{
    const struct kernels *all[] = {
        trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    struct hit want = {r->t_max, NO_ITEM}, got;
    struct crossings c = {0};
    twin(&t->bvh, 0, r, &want);
    for (int k = 0; k < 3; k++) {
        if (!all[k]) continue;
        all[k]->closest(&t->bvh, r, &got);
        if (got.item != want.item || memcmp(&got.t, &want.t, sizeof got.t) != 0)
            fail_msg("%s: item %u at %.17g, the twin has %u at %.17g", all[k]->name, got.item,
                got.t, want.item, want.t);
        assert_int_equal(all[k]->blocked(&t->bvh, r, NULL, &c), want.item != NO_ITEM);
    }
    return want.item;
}

/* Random rays, rays along axes and in the planes of boxes, rays that end early, and rays from where
 * these hit. */
static void check_scene(struct placing at, uint64_t seed)
{
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, at, seed, 200);
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, trace_kernels_sse2());
    uint64_t n = 0;
    uint32_t hits = 0;
    for (int i = 0; i < 2000; i++) {
        struct vec3 o = random_point(seed, &n, 4), d = v3_sub(random_point(seed, &n, 2), o);
        if (i % 4 == 1) d = v3(i % 8 == 1 ? 0.0 : -0.0, 0, i % 3 ? -1 : 1);
        if (i % 4 == 2) { /* in planes of a box */
            const struct node8 *b = &t->bvh.nodes[(uint32_t)i % t->bvh.n_nodes];
            o = v3((double)b->lo[0][0], (double)b->hi[1][0], (double)b->lo[2][0]);
            d = i % 3 ? v3(0, 0, 1) : v3(1, -1, 0);
        } else {
            o = placed(at, o);
        }
        double far = i % 5 ? HUGE_VAL : 2 * at.scale;
        struct ray r = {o, v3_unit(d), 0, far, 0, false, 0};
        struct hit h = {far, NO_ITEM};
        if (compare(t, &r) == NO_ITEM) continue;
        struct hit_point p;
        hits++;
        twin(&t->bvh, 0, &r, &h);
        trace_hit_point(t, &r, &h, &p);
        struct ray next = {p.p, v3_unit(p.mirrored), 0, HUGE_VAL, p.err, false, p.start};
        compare(t, &next);
        next.d = r.d;
        compare(t, &next);
    }
    assert_true(hits > 500);
    tracer_free(t);
    scene_free(&s);
}

static void test_twin(void **state)
{
    (void)state;
    static const struct placing places[] = {{1, 0}, {1, 0x1p12}, {0x1p-30, 0}, {0x1p20, 0}};
    for (uint64_t i = 0; i < 4; i++) check_scene(places[i], 50 + i);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_twin)};
    return cmocka_run_group_tests_name("trace: the twin", tests, NULL, NULL);
}
