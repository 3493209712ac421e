/*
 * What a ray hits: the hierarchy, at every vector width, against a loop over all blocks with one-lane arithmetic, bit by
 * bit; meshes without cracks; no surface that hits its own rays.
 */
#define SIMD_SCALAR
#include "trace/packet.h"

#include <stdarg.h>
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
    for (unsigned i = 0; i < n; i++) mask |= (unsigned)brute_blocked(b, r[i], transmits, &c[i]) << i;
    return mask;
}

static const struct kernels brute = {
    "brute", brute_closest, brute_blocked, brute_closest_packet, brute_blocked_packet};
static const struct kernels scalar = {"scalar", closest, blocked, closest_packet, blocked_packet};

static struct tracer *tracer_with(const struct scene *s, const struct kernels *k)
{
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct tracer *t = tracer_new(s, &o);
    t->k = k;
    return t;
}

static void same_hits(const struct kernels *k, const struct tracer *t, const struct ray *r)
{
    struct hit a, b;
    brute_closest(&t->bvh, r, &a);
    k->closest(&t->bvh, r, &b);
    if (a.item != b.item || memcmp(&a.t, &b.t, sizeof a.t) != 0)
        fail_msg("%s: item %u at %.17g, the reference has %u at %.17g", k->name, b.item, b.t, a.item, a.t);
}

/* The same rays in packets of every size, neighbours and strangers. */
static void same_packets(const struct kernels *k, const struct tracer *t, const struct ray *r, unsigned n)
{
    const struct ray *ray[PACKET];
    struct hit want[PACKET], got[PACKET], *h[PACKET];
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

static struct vec3 random_point(uint64_t seed, uint64_t *n, double size)
{
    double x = between(seed, n, -size, size), y = between(seed, n, -size, size);
    return v3(x, y, between(seed, n, -size, size));
}

static void test_random_rays(void **state)
{
    (void)state;
    const struct kernels *all[] = {&scalar, kernels_sse2(), kernels_avx2()};
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
            struct ray r = {o, v3_unit(v3_sub(to, o)), 0, i % 3 ? HUGE_VAL : 2, 0};
            for (int k = 0; k < 3; k++)
                if (all[k]) same_hits(all[k], t, &r);
        }
        tracer_free(t);
        scene_free(&s);
    }
}

static void test_random_packets(void **state)
{
    (void)state;
    const struct kernels *all[] = {&scalar, kernels_sse2(), kernels_avx2()};
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
            r[k] = (struct ray){from, v3_unit(d), 0, i % 2 ? v3_len(d) : HUGE_VAL, 0};
        }
        for (int k = 0; k < 3; k++)
            if (all[k]) same_packets(all[k], t, r, count);
    }
    tracer_free(t);
    scene_free(&s);
}

static void test_pictures_without_hierarchy(void **state)
{
    (void)state;
    const struct kernels *all[] = {&scalar, kernels_sse2(), kernels_avx2()};
    for (uint64_t seed = 10; seed < 16; seed++) {
        struct buf text = {0};
        struct scene s;
        put_random_scene(&text, in_place, seed, 60);
        read_scene(&text, &s);
        struct tracer *t = tracer_with(&s, &brute);
        float *want = render(t, 48, 32, 48, false);
        for (int k = 0; k < 3; k++) {
            if (!all[k]) continue;
            t->k = all[k];
            float *got = render(t, 48, 32, 48, false);
            assert_memory_equal(want, got, sizeof *want * 4 * 48 * 32);
            free(got);
        }
        free(want);
        tracer_free(t);
        scene_free(&s);
    }
}

/* ---- cracks ------------------------------------------------------------------------------------ */

/* A closed box of n x n squares a side, its corners pushed onto a sphere of radius 1 around `at.shift`. */
static void put_ball_of_squares(struct buf *b, struct placing at, int n)
{
    for (int side = 0; side < 6; side++)
        for (int i = 0; i < n * n; i++) {
            buf_printf(b, "p 4\n");
            for (int k = 0; k < 4; k++) {
                double u = 2.0 * (i % n + (k == 1 || k == 2)) / n - 1, v = 2.0 * (i / n + (k >= 2)) / n - 1;
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
            struct ray r = {centre, v3_unit(to), 0, HUGE_VAL, 0};
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
        shoot_at_seams(&s, centre, kernels_sse2());
        shoot_at_seams(&s, v3_mad(centre, v3(0.1, 0.2, 0.3), at[i].scale), kernels_sse2());
        scene_free(&s);
    }
}

/* ---- rays that start on a surface ------------------------------------------------------------- */

/*
 * From where a ray met one lone convex primitive, rays away from it hit nothing, however grazing; rays into a
 * sphere come out on the other side.
 */
static void leave_surface(const struct tracer *t, uint64_t seed, struct placing at)
{
    uint64_t n = 0;
    struct vec3 centre = v3(at.shift, at.shift, at.shift);
    for (int i = 0; i < 2000; i++) {
        struct vec3 from = v3_mad(centre, random_point(seed, &n, 3), at.scale);
        struct vec3 to = v3_mad(centre, random_point(seed, &n, 0.8), at.scale);
        struct ray r = {from, v3_unit(v3_sub(to, from)), 0, HUGE_VAL, 0};
        struct hit h;
        t->k->closest(&t->bvh, &r, &h);
        if (h.item == NO_ITEM) continue;
        const struct item *it = &t->items[h.item];
        struct vec3 p = v3_mad(r.o, r.d, h.t), normal = shapes[it->kind]->normal(t->scene, it, &p);
        if (it->kind != ITEM_TRIANGLE && v3_dot(normal, r.d) > 0) continue; /* seen from inside */
        if (v3_dot(normal, r.d) > 0) normal = v3_scale(normal, -1);
        struct vec3 side = v3_unit(v3_cross(normal, r.d));
        double err = ERR_UNIT * (fabs(p.x) + fabs(p.y) + fabs(p.z) + h.t);
        /* The normal itself is only as good as p: below that, "away" means nothing. */
        for (double slope = 1; slope > 4 * err / at.scale; slope /= 10) {
            struct ray away = {p, v3_unit(v3_mad(side, normal, slope)), 0, HUGE_VAL, err};
            t->k->closest(&t->bvh, &away, &h);
            if (h.item != NO_ITEM) fail_msg("slope %g: hit itself at %g", slope, h.t);
        }
    }
}

static void test_no_self_hit(void **state)
{
    (void)state;
    static const char *const kinds[] = {"s 0 0 0 1\n", "c\n0 0 -1 .7\n.2 .1 1 .7\n",
        "c\n0 0 -1 .9\n.2 .1 1 .1\n", "p 5\n1 0 .1\n.3 1 .23\n-1 .4 -.02\n-.8 -.7 -.22\n.4 -.9 -.14\n"};
    const struct placing at[] = {{1, 0}, {1e-3, 0}, {1e6, 0}, {1, 1000}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
            struct buf text = {0};
            struct scene s;
            put_view(&text, in_place, 5, 0, 1, 0);
            buf_printf(&text, "%s", kinds[i]);
            read_scene(&text, &s);
            /* Placed after reading, so that the shapes stay what the text says. */
            struct vec3 shift = v3(at[k].shift, at[k].shift, at[k].shift);
            for (uint32_t v = 0; v < s.n_vertices; v++) s.vertices[v] = v3_mad(shift, s.vertices[v], at[k].scale);
            struct prim *p = &s.prims[0];
            if (p->kind == PRIM_SPHERE) {
                p->sphere.center = v3_mad(shift, p->sphere.center, at[k].scale);
                p->sphere.radius *= at[k].scale;
            } else if (p->kind == PRIM_CONE) {
                p->cone.base = v3_mad(shift, p->cone.base, at[k].scale);
                p->cone.apex = v3_mad(shift, p->cone.apex, at[k].scale);
                p->cone.base_radius *= at[k].scale;
                p->cone.apex_radius *= at[k].scale;
            }
            struct tracer *t = tracer_with(&s, kernels_sse2());
            leave_surface(t, 7, at[k]);
            tracer_free(t);
            scene_free(&s);
        }
}

static void test_sphere_from_inside(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_view(&text, in_place, 5, 0, 1, 0);
    buf_printf(&text, "s 3 -2 1 .5\n");
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, kernels_sse2());
    uint64_t n = 0;
    for (int i = 0; i < 1000; i++) {
        struct vec3 c = v3(3, -2, 1), a = v3_unit(random_point(3, &n, 1)), b = v3_unit(random_point(3, &n, 1));
        struct vec3 p = v3_mad(c, a, 0.5), q = v3_mad(c, b, 0.5);
        struct ray r = {p, v3_unit(v3_sub(q, p)), 0, HUGE_VAL, 8 * ERR_UNIT};
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
        cmocka_unit_test(test_random_rays),
        cmocka_unit_test(test_random_packets),
        cmocka_unit_test(test_pictures_without_hierarchy),
        cmocka_unit_test(test_no_cracks),
        cmocka_unit_test(test_no_self_hit),
        cmocka_unit_test(test_sphere_from_inside),
    };
    return cmocka_run_group_tests_name("trace: hits", tests, NULL, NULL);
}
