/*
 * The error budget: a depth-first tracer that drops nothing computes samples. With a budget of 0
 * wave_colours computes the same; with another no channel is off by more than the budget.
 */
#include "trace/pending.h"

#include <stdarg.h>
#include "rounds.h"
#include "trace_scenes.h"

#define ROUNDING 1e-9 /* relative to the greatest colour */

static struct media media;

/* The light of a ray, by recursion. Independent of pending rays, bounds and waves. */
static struct vec3 depth_first(
    struct tracer *t, const struct ray *r, int level, uint32_t outside, uint64_t *rays)
{
    struct hit h;
    struct hit_point at;
    struct onward o;
    struct vec3 sum = v3(0, 0, 0), light;
    struct ray shadow;
    const double *b = t->scene->background;
    ++*rays;
    t->k->closest(&t->bvh, r, &h);
    if (h.item == NO_ITEM) return v3(b[0], b[1], b[2]);
    trace_hit_point(t, r, &h, &at);
    for (uint32_t l = 0; l < t->scene->n_lights; l++) {
        struct crossings *c = &t->crossings[0];
        if (!light_from(t, &at, l, &light, &shadow)) continue;
        c->n = 0;
        if (t->k->blocked(&t->bvh, &shadow, t->transmits, c)) continue;
        sum = v3_mad(sum, light, light_through(t, c));
    }
    if (level >= t->options.depth) return sum;
    trace_spawn_secondary(t, r, &at, level, &media, outside, &o);
    if (o.reflected)
        sum =
            v3_mad(sum, depth_first(t, &o.mirror, o.mirror_level, outside, rays), o.mirror_weight);
    if (!o.passed) return sum;
    light = depth_first(t, &o.through, o.through_level, o.inside, rays);
    media_drop(&media, o.inside);
    sum = v3_mad(sum, light, o.through_weight);
    return sum;
}

static double farthest(struct vec3 a, struct vec3 b)
{
    return fmax(fabs(a.x - b.x), fmax(fabs(a.y - b.y), fabs(a.z - b.z)));
}

static uint64_t rays_of(const struct tracer *t)
{
    struct trace_counts c;
    tracer_counts(t, &c);
    return c.of[RAY_EYE].rays + c.of[RAY_REFLECTED].rays + c.of[RAY_REFRACTED].rays;
}

/* Traces a side x side picture of the scene with budgets from 0 to 1. b is freed. Returns the
 * number of rays with the last budget as a part of all rays. */
static double holds(struct buf *b, int depth, uint32_t side)
{
    static const double budgets[] = {0, 0x1p-17, 1e-3, 0.03, 1};
    struct scene s;
    read_scene(b, &s);
    double part = 0;
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        struct trace_options o = TRACE_OPTIONS_DEFAULT;
        o.depth = depth;
        o.budget = budgets[i];
        struct tracer *t = tracer_new(&s, &o);
        tracer_frame(t, side, side);
        uint64_t all = 0;
        for (uint32_t y = 0; y < side; y++) {
            struct ray ray[WAVE_RAYS];
            struct vec3 colour[WAVE_RAYS];
            for (uint32_t x = 0; x < side; x++) {
                struct vec3 d = camera_direction(&t->camera, x + .5, y + .5);
                ray[x] = (struct ray){t->camera.eye, v3_unit(d), 0, HUGE_VAL, 0, false, 0};
            }
            wave_colours(t, ray, side, colour);
            for (uint32_t x = 0; x < side; x++) {
                struct vec3 want = depth_first(t, &ray[x], 1, 0, &all);
                double off = farthest(want, colour[x]);
                if (off > budgets[i] + ROUNDING * (1 + farthest(want, v3(0, 0, 0))))
                    fail_msg("pixel %u %u: %g off, the budget is %g", x, y, off, budgets[i]);
            }
        }
        if (i == 0) assert_int_equal(rays_of(t), all);
        assert_true(rays_of(t) <= all);
        part = (double)rays_of(t) / (double)all;
        tracer_free(t);
    }
    scene_free(&s);
    return part;
}

static void test_random_scenes(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= (uint64_t)rounds(30); seed++) {
        struct buf b = {0};
        put_random_scene(&b, in_place, seed, 4 + (int)seed * 3);
        holds(&b, 1 + (int)(seed % 7), 24);
    }
}

static void test_glass(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= (uint64_t)rounds(5); seed++) {
        struct buf b = {0};
        put_glass_scene(&b, in_place, seed, 30);
        holds(&b, 5, 24);
    }
}

static struct buf shells(int n, double kd, double ks, double t)
{
    struct buf b = {0};
    put_view(&b, in_place, 0, 5, 0.3, 0);
    put_light(&b, in_place, 3, 4, 5);
    put_light(&b, in_place, 0, 0.5, 0);
    buf_printf(&b, "f 1 .9 .8 %g %g 20 %g 1.5\n", kd, ks, t);
    for (int i = 1; i <= n; i++) put_sphere(&b, in_place, 0, 0, 0, 1.0 * i / n);
    return b;
}

/* Nested glass of equal index: unbent rays, and as many reflections as surfaces. */
static void test_shells(void **state)
{
    (void)state;
    struct buf b = shells(12, .1, .2, .7);
    assert_true(holds(&b, 5, 6) < .1);
    b = shells(12, 0, .3, 1); /* shares grow: no bound by a geometric series */
    assert_true(holds(&b, 4, 6) <= 1);
    b = shells(12, 1, .9, .9); /* shares of more than the light that comes */
    assert_true(holds(&b, 4, 6) <= 1);
    b = shells(2, .2, 1, 1);
    holds(&b, 12, 6);
}

/* More pending rays than are kept sorted. */
static void test_many_pending(void **state)
{
    (void)state;
    struct buf b = shells(14, .1, .2, .8);
    struct scene s;
    read_scene(&b, &s);
    struct trace_options o = TRACE_OPTIONS_DEFAULT;
    o.depth = 7;
    o.budget = 0;
    struct tracer *t = tracer_new(&s, &o);
    tracer_frame(t, 1, 1);
    struct vec3 d = v3_unit(camera_direction(&t->camera, .61, .57)), got;
    struct ray ray = {t->camera.eye, d, 0, HUGE_VAL, 0, false, 0};
    uint64_t all = 0;
    wave_colours(t, &ray, 1, &got);
    struct vec3 want = depth_first(t, &ray, 1, 0, &all);
    assert_int_equal(rays_of(t), all);
    assert_true(all > 10 * PENDING_MOST);
    assert_true(farthest(want, got) < 1e-9);
    tracer_free(t);
    scene_free(&s);
}

/* The best ray first, whatever the order of pushes; an end only if the sum allows it. */
static void test_order(void **state)
{
    (void)state;
    struct pending_pool pool;
    struct pending_rays rays = {0};
    pending_pool_init(&pool);
    for (uint64_t i = 0; i < 500; i++) {
        uint32_t k = pending_new(&pool);
        pool.at[k].weight = pool.at[k].bound = rng_unit(7, i);
        pending_push(&rays, &pool, k);
    }
    double last = HUGE_VAL;
    while (rays.n > 10) {
        uint32_t k = pending_pop(&rays, &pool);
        assert_true(pool.at[k].weight <= last);
        last = pool.at[k].weight;
        pending_release(&pool, k);
        assert_false(pending_end(&rays, &pool, 0));
    }
    double sum = 0;
    for (uint32_t i = 0; i < rays.n; i++) sum += pool.at[rays.heap[i]].bound;
    assert_false(pending_end(&rays, &pool, sum * .999));
    rays.over = 0; /* another budget */
    assert_true(pending_end(&rays, &pool, sum * 1.001));
    assert_int_equal(rays.n, 0);
    assert_int_equal(pool.n_unused, pool.cap);
    free(rays.heap);
    pending_pool_free(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_scenes),
        cmocka_unit_test(test_glass),
        cmocka_unit_test(test_shells),
        cmocka_unit_test(test_many_pending),
        cmocka_unit_test(test_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
