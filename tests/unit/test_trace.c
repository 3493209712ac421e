/*
 * Pictures: the shading model against closed forms, the same bits however pixels are asked for,
 * sampling, and scenes that break ray tracers.
 */
#include "trace/trace.h"
#include "rounds.h"

#include <stdarg.h>
#include <stddef.h>
#include "trace_scenes.h"

#define SQRT_HALF 0.70710678118654752440

static float *picture(const char *nff, const struct trace_options *o, uint32_t w, uint32_t h)
{
    struct buf text = {0};
    struct scene s;
    buf_printf(&text, "%s", nff);
    read_scene(&text, &s);
    struct tracer *t = tracer_new(&s, o);
    float *rgba = render(t, w, h, w, false);
    for (uint32_t i = 0; i < 4 * w * h; i++) assert_true(isfinite(rgba[i]));
    tracer_free(t);
    scene_free(&s);
    return rgba;
}

/* The one pixel of a 1x1 frame: the ray along the view. */
static void centre_is(const char *nff, double r, double g, double b)
{
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    float *c = picture(nff, &o, 1, 1);
    const double want[4] = {r, g, b, 1};
    for (int i = 0; i < 4; i++)
        if (fabs((double)c[i] - want[i]) > 1e-6)
            fail_msg("component %d: %.8f, expected %.8f\n%s", i, (double)c[i], want[i], nff);
    free(c);
}

#define DOWN "v from 0 0 10 at 0 0 0 up 0 1 0 angle 30 hither 0 resolution 1 1 "
#define FLOOR "p 4 -9 -9 0 9 -9 0 9 9 0 -9 9 0 "

static void test_colours(void **state)
{
    (void)state;
    /* the background, and nothing at all in the scene */
    centre_is("b .1 .2 .3 " DOWN, .1, .2, .3);
    /* kd C N.L, light at 45 degrees, of its own colour, and of 1/sqrt(n) each */
    centre_is(DOWN "l 5 0 5 1 .5 .25 f .8 .6 .4 .5 0 1 0 0 " FLOOR, .8 * .5 * SQRT_HALF,
        .6 * .5 * SQRT_HALF * .5, .4 * .5 * SQRT_HALF * .25);
    centre_is(DOWN "l 0 0 5 l 0 0 7 f 1 1 1 .5 0 1 0 0 " FLOOR, SQRT_HALF, SQRT_HALF, SQRT_HALF);
    /* the highlight takes the light's colour; mirrored is straight up */
    centre_is(DOWN "l 5 0 5 1 .5 0 f 0 1 0 0 .5 4 0 0 " FLOOR, .5 * .25, .5 * .25 * .5, 0);
    /* seen from behind: the normal turns toward the ray */
    centre_is(DOWN "l 0 0 5 1 1 1 f 1 1 1 1 0 1 0 0 p 3 -9 -9 0 0 9 0 9 -9 0 ", 1, 1, 1);
    /* a shadow, and light from below that does not come through */
    centre_is(DOWN "l 5 0 5 f 1 1 1 1 0 1 0 0 " FLOOR "s 2 0 2 1 ", 0, 0, 0);
    centre_is(DOWN "l 0 0 -5 f 1 1 1 1 0 1 0 0 " FLOOR, 0, 0, 0);
}

static void test_rays(void **state)
{
    (void)state;
    /* ks * what the mirror sees: the background */
    centre_is("b 1 .5 .2 " DOWN "f 1 1 1 0 .5 1 0 0 " FLOOR, .5, .25, .1);
    /* straight through a sheet of glass, seen beneath it a lit floor that one sheet shades */
    centre_is(DOWN "l 0 0 8 1 1 1 f 1 1 1 1 0 1 0 0 " FLOOR
                   "f 1 1 1 0 0 1 .5 1.5 p 4 -1 -1 2 1 -1 2 1 1 2 -1 1 2 ",
        .25, .25, .25);
    /* a shadow ray crosses a sphere's surface twice, a polygon's seam once */
    centre_is(DOWN "l 5 0 5 f 1 1 1 1 0 1 0 0 " FLOOR "f 1 1 1 0 0 1 .5 1.5 s 2.5 0 2.5 1 ",
        SQRT_HALF * .25, SQRT_HALF * .25, SQRT_HALF * .25);
    centre_is(DOWN "l 5 0 5 f 1 1 1 1 0 1 0 0 " FLOOR
                   "f 1 1 1 0 0 1 .5 1.5 p 4 1 -1 2 3 -1 2 3 1 2 1 1 2 ",
        SQRT_HALF * .5, SQRT_HALF * .5, SQRT_HALF * .5);
    /* inside a prism of glass the ray meets the sloped side beyond the critical angle: all of it is
     * turned back there (weight 1), leaves through the side; two surfaces of .5 */
    centre_is("b 1 1 1 " DOWN "f 1 1 1 0 0 1 .5 1.5 p 4 -1 -1 1 1 -1 1 1 1 1 -1 1 1 "
              "p 4 -1 -1 1 1 -1 -1 1 1 -1 -1 1 1 p 4 1 -1 -1 1 -1 1 1 1 1 1 1 -1 ",
        .25, .25, .25);
}

/* The eye is within glass: what leaves it beyond the critical angle is turned back, until levels
 * end. Entering, as seen from nowhere, would bend and see the background. */
static void test_eye_in_glass(void **state)
{
    (void)state;
#define WITHIN(name, hither)                                                                       \
    "b 1 1 1 v from 0 0 0 at 1 0 0 up 0 1 0 angle 30 hither " hither " resolution 1 1 "            \
    "f 1 1 1 0 0 1 1 1.5 " name " "
#define BALL "s 0 -.9 0 1"
    centre_is(WITHIN(BALL, "0"), 0, 0, 0);
    /* where hither is past it, another ball bends the way to a black one */
    centre_is(WITHIN(BALL " s 10 -.9 0 1 f 1 1 1 0 0 1 0 0 s 15 0 0 .5", "5"), 1, 1, 1);
    /* the same in a rod; not past a rod's end, or that would be left, not the ball */
    centre_is(WITHIN("c 0 -9 .9 1 0 9 .9 1", "0"), 0, 0, 0);
    centre_is(WITHIN(BALL " c 0 1 .9 .95 0 9 .9 .95", "0"), 0, 0, 0);
    /* glass in a ball that bends nothing: the smaller is left first, whichever stands first */
    centre_is(WITHIN(BALL " f 1 1 1 0 0 1 1 1 s 0 0 0 9", "0"), 0, 0, 0);
    centre_is("f 1 1 1 0 0 1 1 1 s 0 0 0 9 " WITHIN(BALL, "0"), 0, 0, 0);
}

/* The same in many balls that bend nothing, wherever the innermost stands. */
static void test_eye_deep_in_glass(void **state)
{
    (void)state;
    static const char ball[] = WITHIN(BALL, "0");
    for (int i = 0; i < 4; i++) {
        struct buf text = {0};
        int around = i / 2 ? 300 : 63;
        buf_printf(&text, "%s f 1 1 1 0 0 1 1 1", i % 2 ? ball : "");
        for (int k = 0; k < around; k++) buf_printf(&text, " s 0 0 0 %d", 5 + k * 29 % around);
        buf_printf(&text, " %s", i % 2 ? "" : ball);
        buf_append(&text, "", 1);
        centre_is((const char *)buf_data(&text), 0, 0, 0);
        buf_free(&text);
    }
}

static void test_hither(void **state)
{
    (void)state;
#define NEAR(h)                                                                                    \
    "b 0 0 1 v from 0 0 10 at 0 0 0 up 0 1 0 angle 30 hither " h " resolution 1 1 l 0 0 20 1 1 1 "
    centre_is(NEAR("0") "f 1 0 0 1 0 1 0 0 s 0 0 5 1 ", 1, 0, 0);
    /* 4 cuts nothing; beyond that the sphere is seen from inside, where no light comes; then
     * it is gone */
    centre_is(NEAR("3.99") "f 1 0 0 1 0 1 0 0 s 0 0 5 1 ", 1, 0, 0);
    centre_is(NEAR("4.01") "f 1 0 0 1 0 1 0 0 s 0 0 5 1 ", 0, 0, 0);
    centre_is(NEAR("6.01") "f 1 0 0 1 0 1 0 0 s 0 0 5 1 ", 0, 0, 1);
}

static void test_levels(void **state)
{
    (void)state;
    /* Two mirrors face each other, the eye between: the n-th level adds ks^(n-1) times what
     * one shows. */
    static const char nff[] =
        "v from 0 0 1 at 0 0 0 up 0 1 0 angle 30 hither 0 resolution 1 1 l 0 0 1 1 1 1 "
        "f 1 1 1 .5 .5 0 0 0 p 3 -9 -9 0 0 9 0 9 -9 0 p 3 -9 -9 2 0 9 2 9 -9 2 ";
    double sum = 0, weight = 1;
    for (int depth = 1; depth <= TRACE_DEPTH_MAX; depth++) {
        struct trace_options o = TRACE_OPTIONS_DEFAULT;
        o.depth = depth;
        o.budget = 0;
        float *c = picture(nff, &o, 1, 1);
        sum += weight;
        weight *= .5;
        assert_true(fabs((double)c[0] - sum) < 1e-6);
        free(c);
    }
}

static void test_any_grouping(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, in_place, 21, 80);
    read_scene(&text, &s);
    struct trace_options o = TRACE_OPTIONS_DEFAULT;
    o.samples = 9;
    o.threshold = 0.02;
    struct tracer *t = tracer_new(&s, &o);
    float *want = render(t, 48, 32, 48 * 32, false);
    static const uint32_t unit[] = {1, 3, 8, 48, 64, 100};
    for (size_t i = 0; i < sizeof unit / sizeof *unit; i++) {
        float *got = render(t, 48, 32, unit[i], i & 1);
        assert_memory_equal(want, got, sizeof *want * 4 * 48 * 32);
        free(got);
    }
    /* scattered: every seventh pixel */
    const struct lattice some = {3, 0, 220, 1, 7, 1};
    float got[4 * 219];
    tracer_pixels(t, &some, 0, 219, got);
    for (uint32_t i = 0; i < 219; i++)
        assert_memory_equal(got + 4 * i, want + 4 * (3 + 7 * i), 4 * sizeof *want);
    free(want);
    tracer_free(t);
    scene_free(&s);
}

enum { W = 64, H = 48, SCENES = 2, PIXELS = SCENES * W * H };

/* Counts the pixels that differ between refined where the first samples say so and everywhere. */
static void refined(const struct scene *s, int side, int *off, int *same)
{
    float *rgba[2];
    for (int i = 0; i < 2; i++) {
        struct trace_options o = TRACE_OPTIONS_DEFAULT;
        o.samples = side * side;
        if (i) o.threshold = .02;
        struct tracer *t = tracer_new(s, &o);
        rgba[i] = render(t, W, H, W, false);
        tracer_free(t);
    }
    for (int p = 0; p < W * H; p++) {
        float most = 0;
        for (int c = 0; c < 3; c++)
            most = fmaxf(most, fabsf(rgba[0][4 * p + c] - rgba[1][4 * p + c]));
        *off += most > .02F;
        *same += most == 0;
    }
    free(rgba[0]);
    free(rgba[1]);
}

/* Refined where the first samples say so, few pixels are off those refined everywhere: .3 % with
 * less than 36 samples and .04 % with more, on average of 40 scenes. */
static void test_first_samples_tell(void **state)
{
    (void)state;
    const int last = 2 + rounds(6), step = nightly(3, 1);
    int off[9] = {0}, same[9] = {0};
    for (uint64_t seed = 1; seed <= SCENES; seed++) {
        struct buf text = {0};
        struct scene s;
        put_random_scene(&text, in_place, seed, 400);
        read_scene(&text, &s);
        for (int side = 3; side <= last; side += step) refined(&s, side, &off[side], &same[side]);
        scene_free(&s);
    }
    for (int side = 3; side <= last; side += step) {
        assert_in_range(same[side], 1, PIXELS - 1); /* some were refined, and some were not */
        assert_in_range(off[side], 0, (side < 6 ? .005 : .001) * (double)PIXELS);
    }
}

static void test_any_width(void **state)
{
    (void)state;
    if (!isa_available(ISA_AVX2)) skip();
    struct buf text = {0};
    struct scene s;
    put_random_scene(&text, in_place, 22, 400);
    read_scene(&text, &s);
    float *rgba[2];
    for (int i = 0; i < 2; i++) {
        struct trace_options o = TRACE_OPTIONS_DEFAULT;
        o.isa = i ? ISA_AVX2 : ISA_SSE2;
        struct tracer *t = tracer_new(&s, &o);
        rgba[i] = render(t, 96, 64, 96, false);
        tracer_free(t);
    }
    assert_memory_equal(rgba[0], rgba[1], sizeof(float) * 4 * 96 * 64);
    free(rgba[0]);
    free(rgba[1]);
    scene_free(&s);
}

/* Powers of two scale every number exactly, so no pixel may change a bit: nothing depends on
 * absolute sizes. */
static void test_any_scale(void **state)
{
    (void)state;
    static const double scale[] = {1, 0x1p-10, 0x1p10, 0x1p20};
    float *want = NULL;
    for (int i = 0; i < 4; i++) {
        struct buf text = {0};
        struct scene s;
        const struct trace_options o = TRACE_OPTIONS_DEFAULT;
        put_random_scene(&text, (struct placing){scale[i], 0}, 23, 80);
        read_scene(&text, &s);
        struct tracer *t = tracer_new(&s, &o);
        float *got = render(t, 48, 32, 48, false);
        if (want) assert_memory_equal(want, got, sizeof *want * 4 * 48 * 32);
        if (want) free(got);
        else want = got;
        tracer_free(t);
        scene_free(&s);
    }
    free(want);
}

/* Moved away from the origin by 2^17 times its size, the picture stays; only silhouettes may
 * differ. */
static void test_far_away(void **state)
{
    (void)state;
    float *rgba[2];
    for (int i = 0; i < 2; i++) {
        struct buf text = {0};
        struct scene s;
        const struct trace_options o = TRACE_OPTIONS_DEFAULT;
        put_random_scene(&text, (struct placing){1, i * 0x1p18}, 24, 40);
        read_scene(&text, &s);
        struct tracer *t = tracer_new(&s, &o);
        rgba[i] = render(t, 48, 32, 48, false);
        tracer_free(t);
        scene_free(&s);
    }
    int off = 0;
    for (int i = 0; i < 48 * 32; i++)
        for (int k = 0; k < 3; k++)
            if (fabsf(rgba[0][4 * i + k] - rgba[1][4 * i + k]) > 1.0f / 255) {
                off++;
                break;
            }
    assert_true(off <= 3);
    free(rgba[0]);
    free(rgba[1]);
}

static void test_sampling(void **state)
{
    (void)state;
    static const char nff[] =
        "b 0 0 0 v from 0 0 10 at 0 0 0 up 0 1 0 angle 30 hither 0 resolution 16 16 "
        "l 0 0 1e6 1 1 1 f 1 1 1 1 0 1 0 0 p 4 -9 -9 0 0.17 -9 0 0.17 9 0 -9 9 0 ";
    struct trace_options one = {.depth = 5, .samples = 1, .threshold = -1}, four = one;
    struct trace_options many = one, adaptive = one;
    four.samples = 4;
    many.samples = adaptive.samples = 256;
    adaptive.threshold = 0.05;
    float *a = picture(nff, &one, 16, 16), *b = picture(nff, &four, 16, 16);
    float *c = picture(nff, &many, 16, 16), *d = picture(nff, &adaptive, 16, 16);
    /* the edge runs through column 8, 0.17 / (2 * 10 tan 15 / 16) of it is covered */
    double covered = 0.17 / (20 * 0.26794919243112270 / 16), light = (double)a[4 * (16 * 8 + 7)];
    assert_true(fabs((double)c[4 * (16 * 8 + 8)] - covered * light) < 0.03);
    assert_true(c[4 * (16 * 8 + 8)] == d[4 * (16 * 8 + 8)]); /* refined: the same samples */
    for (int i = 0; i < 16 * 16; i++) {
        int x = i % 16;
        if (x != 8) assert_true(fabsf(d[4 * i] - b[4 * i]) < 1e-3f); /* flat: four are enough */
        if (x > 8) assert_true(a[4 * i] == 0 && b[4 * i] == 0 && c[4 * i] == 0);
    }
    free(a), free(b), free(c), free(d);
}

static void test_degenerate(void **state)
{
    (void)state;
    /* no area: nothing is seen of them, and nothing breaks */
    centre_is(
        "b .1 .2 .3 " DOWN "l 0 0 5 p 3 0 0 0 1 1 1 2 2 2 p 3 1 1 1 1 1 1 1 1 1 ", .1, .2, .3);
    /* a light on the surface itself, and the eye on one */
    centre_is(DOWN "l 0 0 0 1 1 1 f 1 1 1 1 0 1 0 0 " FLOOR, 0, 0, 0);
    centre_is(
        DOWN "l 0 0 5 1 1 1 f 1 1 1 1 0 1 0 0 " FLOOR "p 3 -1 -1 10 0 1 10 1 -1 10 ", 1, 1, 1);
    /* coincident squares of two colours: the first wins */
    centre_is(DOWN "l 0 0 5 1 1 1 f 1 0 0 1 0 1 0 0 " FLOOR "f 0 1 0 1 0 1 0 0 " FLOOR, 1, 0, 0);
    centre_is(DOWN "l 0 0 5 1 1 1 f 0 1 0 1 0 1 0 0 " FLOOR "f 1 0 0 1 0 1 0 0 " FLOOR, 0, 1, 0);
    /* negative radii mean nothing */
    centre_is(DOWN "l 0 0 20 1 1 1 f 1 1 1 1 0 1 0 0 s 0 0 0 -1 ", 1, 1, 1);
}

/* A lit, unobstructed plane seen and lit at 1e-6 of a radian: no speckle, at any scale. */
static void test_grazing(void **state)
{
    (void)state;
    static const double scale[] = {1e-3, 1, 1e6};
    for (int i = 0; i < 3; i++) {
        struct buf text = {0};
        struct scene s;
        const struct placing at = {scale[i], 0};
        const struct trace_options o = TRACE_OPTIONS_DEFAULT;
        put_view(&text, at, 100, 0, 1e-4, 0);
        buf_printf(&text, "l");
        put_point(&text, at, -1000, 3, 1e-3);
        buf_printf(&text, " 1e6 1e6 1e6\nf 1 1 1 1 0 1 0 0\n");
        for (int k = 0; k < 64; k++) { /* strips: neighbours in one plane */
            buf_printf(&text, "p 4\n");
            put_point(&text, at, k - 32, -40, 0);
            put_point(&text, at, k - 31, -40, 0);
            put_point(&text, at, k - 31, 40, 0);
            put_point(&text, at, k - 32, 40, 0);
            buf_printf(&text, "\n");
        }
        read_scene(&text, &s);
        struct tracer *t = tracer_new(&s, &o);
        float *rgba = render(t, 64, 65536 / 64 - 1, 64, false);
        for (int k = 0; k < 64 * 1023; k++) assert_true(rgba[4 * k] == 0.1f || rgba[4 * k] > 0.5f);
        free(rgba);
        tracer_free(t);
        scene_free(&s);
    }
}

static void test_functions(void **state)
{
    (void)state;
    uint64_t n = 0;
    for (int i = 0; i < 20000; i++) {
        double x = between(5, &n, 0, 1), y = pow(10, between(5, &n, -2, 5)), want = pow(x, y);
        if (i % 4 == 0) x = 1 - x * 1e-5, want = pow(x, y);
        assert_true(fabs(trace_pow(x, y) - want) <= 1e-10 * want + 1e-300);
    }
    assert_true(trace_pow(0, 3) == 0 && trace_pow(1, 1e5) == 1 && trace_pow(0.5, 0) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_rays),
        cmocka_unit_test(test_eye_in_glass),
        cmocka_unit_test(test_eye_deep_in_glass),
        cmocka_unit_test(test_hither),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_any_grouping),
        cmocka_unit_test(test_first_samples_tell),
        cmocka_unit_test(test_any_width),
        cmocka_unit_test(test_any_scale),
        cmocka_unit_test(test_far_away),
        cmocka_unit_test(test_sampling),
        cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_grazing),
        cmocka_unit_test(test_functions),
    };
    return cmocka_run_group_tests_name("trace: pictures", tests, NULL, NULL);
}
