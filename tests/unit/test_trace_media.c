/*
 * Media: lists against arrays, more media than any scene has, and eye rays that begin in different
 * ones.
 */
#include "trace/trace_int.h"
#include "rounds.h"

#include <stdarg.h>
#include <stddef.h>
#include "trace_scenes.h"

enum { RAYS = 20, IDS = 12 };

/* What a ray's list should be, the innermost last. */
struct model {
    uint32_t n, id[IDS];
};

static void model_cross(struct model *m, uint32_t id)
{
    uint32_t i = 0;
    while (i < m->n && m->id[i] != id) i++;
    if (i == m->n) {
        m->id[m->n++] = id;
        return;
    }
    for (m->n--; i < m->n; i++) m->id[i] = m->id[i + 1];
}

static void model_is(const struct media *m, uint32_t list, const struct model *want)
{
    for (uint32_t n = want->n; n > 0; n--, list = m->link[list].outer)
        assert_int_equal(m->link[list].id, want->id[n - 1]);
    assert_int_equal(list, 0);
}

/* Rays take over each other's lists, enter and leave. In the end no link is in use. */
static void test_lists(void **state)
{
    (void)state;
    struct media m = {0};
    struct model want[RAYS] = {0};
    uint32_t list[RAYS] = {0}, unused = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        uint64_t r = rng_u64(3, i);
        uint32_t from = (uint32_t)(r % RAYS), to = (uint32_t)(r >> 8) % RAYS;
        uint32_t id = (uint32_t)(r >> 16) % IDS;
        bool crosses = (r >> 32 & 3) > 0;
        uint32_t next = crosses ? media_cross(&m, list[from], id) : media_keep(&m, list[from]);
        media_drop(&m, list[to]);
        list[to] = next;
        want[to] = want[from];
        if (crosses) model_cross(&want[to], id);
        for (int k = 0; k < RAYS; k++) model_is(&m, list[k], &want[k]);
    }
    for (int k = 0; k < RAYS; k++) media_drop(&m, list[k]);
    for (uint32_t i = m.unused; i; i = m.link[i].outer) unused++;
    assert_int_equal(unused, m.n);
    assert_in_range(m.n, IDS, RAYS * IDS);
    media_free(&m);
}

static float *picture(struct buf *text, uint32_t w, uint32_t h)
{
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct scene s;
    read_scene(text, &s);
    struct tracer *t = tracer_new(&s, &o);
    free(render(t, 1, h, 1, false)); /* what a narrow frame does not see, a wide one may */
    float *rgba = render(t, w, h, w, false);
    tracer_free(t);
    scene_free(&s);
    return rgba;
}

static float *in_shells(int n)
{
    struct buf b = {0};
    buf_printf(&b, "b .1 .2 .4 v from 0 -9 0 at 0 0 0 up 0 0 1 angle 30 resolution 1 1 l 5 -9 5 "
                   "f 1 .5 .1 1 0 0 0 0 p 4 -9 4 -9 9 4 -9 9 4 9 -9 4 9 "
                   "f 0 1 0 1 0 0 0 0 s 0 3 0 .4 f 1 1 1 0 0 0 .7 1.5 s 0 0 0 .8 "
                   "f 1 1 1 0 0 0 1 1");
    for (int i = 0; i < n; i++) buf_printf(&b, " s 0 0 0 %g", 1 + i * .6 / n);
    return picture(&b, 12, 12);
}

/* However many shells that do nothing are around it, a glass ball looks the same. */
static void test_many_shells(void **state)
{
    (void)state;
    static const int n[] = {63, 64, 65, 300};
    const float off = 2 * 0x1p-17f; /* the error budgets of both pictures */
    float *want = in_shells(0);
    for (size_t i = 0; i < sizeof n / sizeof *n; i++) {
        float *got = in_shells(n[i]);
        for (int k = 0; k < 4 * 12 * 12; k++) assert_true(fabsf(want[k] - got[k]) <= off);
        free(got);
    }
    free(want);
}

enum { W = 24, H = 12 };
#define HITHER 2.0

static void put_cut_scene(struct buf *b, uint64_t seed, struct vec3 from, struct vec3 at, double h)
{
    buf_printf(b, "b .1 .2 .4 v from %.17g %.17g %.17g at %.17g %.17g %.17g up 0 1 0 ", from.x,
        from.y, from.z, at.x, at.y, at.z);
    buf_printf(b,
        "angle 60 hither %g resolution 1 1 l 5 5 0 f 1 1 0 1 0 0 0 0 "
        "p 4 -99 -99 20 99 -99 20 99 99 20 -99 99 20 ",
        h);
    uint64_t n = 0;
    for (int i = 0; i < 12; i++) {
        double x = between(seed, &n, -3, 3), y = between(seed, &n, -1.5, 1.5);
        double z = between(seed, &n, 1.8, 2.2), r = between(seed, &n, .2, 1.5);
        buf_printf(b, "f 1 1 1 0 0 0 .9 %g ", 1 + .1 * i);
        if (i % 3) buf_printf(b, "s %.17g %.17g %.17g %.17g ", x, y, z, r);
        else buf_printf(b, "c %.17g %.17g 1.5 %.17g %.17g %.17g 3 .3 ", x, y, r, y, x);
    }
}

/* An eye ray looks as if the eye were where hither ends. */
static void test_cut_by_hither(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= (uint64_t)rounds(16); seed++) {
        struct buf b = {0};
        struct camera c = camera_new(v3(0, 0, 0), v3(0, 0, 9), v3(0, 1, 0), 60);
        c.w = W, c.h = H;
        put_cut_scene(&b, seed, v3(0, 0, 0), v3(0, 0, 9), HITHER);
        float *rgba = picture(&b, W, H);
        for (int i = 0; i < W * H; i++) {
            struct vec3 d = camera_direction(&c, i % W + .5, i / W + .5);
            struct vec3 start = v3_scale(d, HITHER);
            put_cut_scene(&b, seed, start, v3_add(start, d), 0);
            float *want = picture(&b, 1, 1);
            for (int k = 0; k < 4; k++)
                if (!(fabsf(want[k] - rgba[4 * i + k]) < 1e-5f))
                    fail_msg("scene %d, pixel %d %d: %g, expected %g", (int)seed, i % W, i / W,
                        (double)rgba[4 * i + k], (double)want[k]);
            free(want);
        }
        free(rgba);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists),
        cmocka_unit_test(test_many_shells),
        cmocka_unit_test(test_cut_by_hither),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
