/*
 * What a ray hits: the hierarchy, at every vector width, alone and in packets, against a loop over
 * all blocks with one-lane arithmetic, bit by bit.
 */
#define SIMD_MOST 8
#include "trace/packet.h"

#include <stdarg.h>
#include "rounds.h"
#include "trace_scenes.h"

/* ---- the reference: no hierarchy, no vectors ------------------------------------------------ */

static void brute_closest(const struct bvh *b, const struct ray *r, struct hit *h)
{
    *h = (struct hit){r->t_max, NO_ITEM};
    for (uint32_t kind = 0; kind < ITEM_KINDS; kind++)
        for (uint32_t i = 0; i < b->n_blocks[kind]; i++)
            closest_in_leaf(b, LEAF | kind << 29 | i, r, h);
}

static bool brute_blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    for (uint32_t kind = 0; kind < ITEM_KINDS; kind++)
        for (uint32_t i = 0; i < b->n_blocks[kind]; i++)
            if (blocked_in_leaf(b, LEAF | kind << 29 | i, r, transmits, c)) return true;
    return false;
}

static void brute_closest_packet(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    for (unsigned i = 0; i < n; i++) brute_closest(b, r[i], h[i]);
}

static unsigned brute_blocked_packet(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < n; i++)
        mask |= (unsigned)brute_blocked(b, r[i], transmits, &c[i]) << i;
    return mask;
}

static const struct kernels brute = {
    "brute", brute_closest, brute_blocked, brute_closest_packet, brute_blocked_packet};
static const struct kernels scalar = {"scalar", closest, blocked, closest_packet, blocked_packet};

static void same_hits(const struct kernels *k, const struct tracer *t, const struct ray *r)
{
    struct hit a, b;
    brute_closest(&t->bvh, r, &a);
    k->closest(&t->bvh, r, &b);
    if (a.item != b.item || memcmp(&a.t, &b.t, sizeof a.t) != 0)
        fail_msg("%s: item %u at %.17g, the reference has %u at %.17g", k->name, b.item, b.t,
            a.item, a.t);
}

/* The same rays in packets of every size, neighbours and strangers. */
static void same_packets(
    const struct kernels *k, const struct tracer *t, const struct ray *r, unsigned n)
{
    const struct ray *ray[PACKET] = {0};
    struct hit want[PACKET], got[PACKET], *h[PACKET] = {0};
    struct crossings c[PACKET] = {{0}}, d = {0};
    for (unsigned i = 0; i < n; i++) {
        ray[i] = &r[i];
        h[i] = &got[i];
        brute_closest(&t->bvh, &r[i], &want[i]);
    }
    k->closest_packet(&t->bvh, ray, n, h);
    unsigned blocked_bits = k->blocked_packet(&t->bvh, ray, n, t->transmits, c);
    for (unsigned i = 0; i < n; i++) {
        assert_int_equal(want[i].item, got[i].item);
        assert_memory_equal(&want[i].t, &got[i].t, sizeof want[i].t);
        d.n = 0;
        assert_int_equal(blocked_bits >> i & 1, brute_blocked(&t->bvh, &r[i], t->transmits, &d));
        free(c[i].item);
    }
    free(d.item);
}

static void test_random_rays(void **state)
{
    (void)state;
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    for (uint64_t seed = 1; seed <= 4; seed++) {
        struct buf text = {0};
        struct scene s;
        put_random_scene(&text, in_place, seed, 300);
        read_scene(&text, &s);
        struct tracer *t = tracer_with(&s, &brute);
        uint64_t n = 0;
        for (int i = 0; i < 3000; i++) {
            struct vec3 o = random_point(seed, &n, 4), to = random_point(seed, &n, 2);
            if (i % 4 == 0) to = v3(o.x, o.y, o.z - 1); /* along an axis: slopes of 0 */
            struct ray r = {o, v3_unit(v3_sub(to, o)), 0, i % 3 ? HUGE_VAL : 2, 0, false, 0};
            for (int k = 0; k < 4; k++)
                if (all[k]) same_hits(all[k], t, &r);
        }
        tracer_free(t);
        scene_free(&s);
    }
}

static void test_random_packets(void **state)
{
    (void)state;
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, in_place, 5, 300);
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, &brute);
    uint64_t n = 0;
    for (unsigned i = 0; i < 1000; i++) {
        struct ray r[PACKET];
        unsigned count = 1 + i % PACKET;
        double apart = i % 5 ? 0.05 : 4; /* narrow beams, and rays all over the place */
        struct vec3 o = random_point(5, &n, 4), to = random_point(5, &n, 2);
        for (unsigned k = 0; k < count; k++) {
            struct vec3 from = v3_add(o, random_point(5, &n, i % 3 ? 0 : apart));
            struct vec3 d = v3_sub(v3_add(to, random_point(5, &n, apart)), from);
            r[k] = (struct ray){from, v3_unit(d), 0, i % 2 ? v3_len(d) : HUGE_VAL, 0, false, 0};
        }
        for (int k = 0; k < 4; k++)
            if (all[k]) same_packets(all[k], t, r, count);
    }
    tracer_free(t);
    scene_free(&s);
}

/* Packets that start on surfaces, mirrored and toward a point, far from 0 and in small scenes too:
 * the filter of leaves rejects no hit, and no ray hits the item that it starts on. */
static void test_packets_from_surfaces(void **state)
{
    (void)state;
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    static const struct placing places[] = {{1, 0}, {1, 0x1p12}, {0x1p-30, 0}, {0x1p20, 0}};
    for (uint64_t seed = 0; seed < 4; seed++) {
        struct placing at = places[seed];
        struct buf text = {0};
        struct scene s;
        put_random_scene(&text, at, seed + 30, 300);
        read_scene(&text, &s);
        struct tracer *t = tracer_with(&s, &brute);
        uint64_t n = 0;
        for (unsigned i = 0; i < (unsigned)nightly(200, 600); i++) {
            struct ray r[PACKET];
            unsigned count = 0;
            struct vec3 o = random_point(seed, &n, 4), to = random_point(seed, &n, 2);
            for (unsigned k = 0; k < PACKET; k++) {
                struct vec3 d = v3_sub(v3_add(to, random_point(seed, &n, 0.1)), o);
                struct vec3 from = v3(o.x * at.scale + at.shift, o.y * at.scale + at.shift,
                    o.z * at.scale + at.shift);
                struct ray first = {from, v3_unit(d), 0, HUGE_VAL, 0, false, 0};
                struct hit h;
                struct hit_point p;
                brute_closest(&t->bvh, &first, &h);
                if (h.item == NO_ITEM) continue;
                trace_hit_point(t, &first, &h, &p);
                struct vec3 l = v3_sub(t->scene->lights[0].pos, p.p);
                struct vec3 on = i % 3 == 0 ? v3_unit(l) : i % 3 == 1 ? p.mirrored : first.d;
                r[count++] = (struct ray){
                    p.p, v3_unit(on), 0, i % 3 == 0 ? v3_len(l) : HUGE_VAL, p.err, false, p.start};
            }
            for (int k = 0; count && k < 4; k++)
                if (all[k]) same_packets(all[k], t, r, count);
        }
        tracer_free(t);
        scene_free(&s);
    }
}

static void same_pictures(const struct scene *s)
{
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    struct tracer *t = tracer_with(s, &brute);
    float *want = render(t, 48, 32, 48, false);
    for (int k = 0; k < 4; k++) {
        if (!all[k]) continue;
        t->k = all[k];
        float *got = render(t, 48, 32, 48, false);
        assert_memory_equal(want, got, sizeof *want * 4 * 48 * 32);
        free(got);
    }
    free(want);
    tracer_free(t);
}

static void test_pictures_without_hierarchy(void **state)
{
    (void)state;
    for (uint64_t seed = 10; seed < 16; seed++) {
        struct buf text = {0};
        struct scene s;
        if (seed & 1) put_random_scene(&text, in_place, seed, 60);
        else put_glass_scene(&text, in_place, seed, 40); /* shadows of many factors */
        read_scene(&text, &s);
        same_pictures(&s);
        scene_free(&s);
    }
}

/* In single precision a picture hides the order in which factors were multiplied: use double. */
static void test_factors_in_order(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_glass_scene(&text, in_place, 3, 40);
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, &brute);
    uint32_t item[20];
    struct crossings c = {item, 20, 20};
    double want = 0;
    for (uint64_t shuffle = 0; shuffle < 50; shuffle++) {
        for (uint32_t i = 0; i < 20; i++) item[i] = 1 + 2 * i;
        for (uint32_t i = 19; i > 0; i--) { /* Fisher and Yates */
            uint32_t k = (uint32_t)(rng_u64(shuffle, i) % (i + 1)), x = item[i];
            item[i] = item[k];
            item[k] = x;
        }
        double got = light_through(t, &c);
        if (shuffle == 0) want = got;
        assert_memory_equal(&want, &got, sizeof want);
    }
    tracer_free(t);
    scene_free(&s);
}

/* Everything stands in the scene twice: of two hits at one distance, the lower item counts. */
static void test_ties(void **state)
{
    (void)state;
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    struct buf text = {0};
    struct scene s;
    put_view(&text, in_place, 5, 0, 1, 0);
    for (int twice = 0; twice < 2; twice++) {
        uint64_t n = 0;
        for (int i = 0; i < 200; i++) put_random_prim(&text, in_place, 8, &n);
    }
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, &brute);
    uint64_t n = 0;
    for (int i = 0; i < 3000; i++) {
        struct vec3 o = random_point(9, &n, 4), to = random_point(9, &n, 2);
        struct ray r = {o, v3_unit(v3_sub(to, o)), 0, HUGE_VAL, 0, false, 0};
        for (int k = 0; k < 4; k++) {
            struct hit h;
            if (!all[k]) continue;
            all[k]->closest(&t->bvh, &r, &h);
            assert_true(h.item == NO_ITEM || t->items[h.item].prim < 200);
        }
    }
    tracer_free(t);
    scene_free(&s);
}

/* Lanes without an item: no ray hits them, not even one through 0 or with its end there. */
static void test_empty_lanes(void **state)
{
    (void)state;
    uint64_t n = 0;
    for (int kind = 0; kind < ITEM_KINDS; kind++) {
        struct bvh b = {0};
        b.blocks[kind] = xaligned(1, trace_shapes[kind]->block_size);
        for (int k = 0; k < LANES; k++) trace_shapes[kind]->clear(b.blocks[kind], k);
        for (int i = 0; i < 2000; i++) {
            struct vec3 o = random_point(4, &n, 3);
            if (i % 2) o = v3(i % 3 ? 4 : 0, i % 5 ? -3 : 0, i % 7 ? 2 : 1);
            double far = i % 4 < 2 ? v3_len(o) : HUGE_VAL;
            const struct ray r = {.o = o, .d = v3_scale(o, -1 / v3_len(o)), .t_max = far};
            _Alignas(32) double t[LANES];
            const uint32_t *items;
            unsigned twice;
            assert_int_equal(hit_block(&b, (enum item_kind)kind, 0, &r, far, t, &items, &twice), 0);
        }
        free(b.blocks[kind]);
    }
}

/* On cones of tiny height the rounding of a height moves hits far outward. */
static void test_flat_cones(void **state)
{
    (void)state;
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    static const double heights[] = {1e-7, 1e-9, 1e-11, 1e-14, 1e-17};
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
        struct buf text = {0};
        struct scene s;
        uint64_t n = 0;
        put_view(&text, in_place, 5, 0, 1, 0);
        buf_printf(&text, "c 1 0 0 .5 1 0 %g 0\nc 3 0 0 .2 3 0 %g .5\n", heights[i], heights[i]);
        read_scene(&text, &s);
        struct tracer *t = tracer_with(&s, &brute);
        for (int k = 0; k < 400; k++) {
            struct ray r[PACKET];
            double x = k % 2 ? 1 : 3, z = between(i, &n, -3, -0.3);
            for (int m = 0; m < PACKET; m++) {
                struct vec3 o = v3(x, -0.6, z), to = random_point(i, &n, 0.5);
                struct hit h;
                to.x += x, to.z = 0;
                r[m] = (struct ray){o, v3_unit(v3_sub(to, o)), 0, HUGE_VAL, 0, false, 0};
                brute_closest(&t->bvh, &r[m], &h);
                struct vec3 p = v3_mad(o, r[m].d, h.item == NO_ITEM ? 0 : h.t);
                if (h.item != NO_ITEM) assert_true(hypot(p.x - (h.item ? 3 : 1), p.y) < 0.5 + 1e-9);
                for (int a = 0; a < 4; a++)
                    if (all[a]) same_hits(all[a], t, &r[m]);
            }
            for (int a = 0; a < 4; a++)
                if (all[a]) same_packets(all[a], t, r, PACKET);
        }
        tracer_free(t);
        scene_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_rays),
        cmocka_unit_test(test_random_packets),
        cmocka_unit_test(test_packets_from_surfaces),
        cmocka_unit_test(test_pictures_without_hierarchy),
        cmocka_unit_test(test_factors_in_order),
        cmocka_unit_test(test_ties),
        cmocka_unit_test(test_empty_lanes),
        cmocka_unit_test(test_flat_cones),
    };
    return cmocka_run_group_tests_name("trace: hits", tests, NULL, NULL);
}
