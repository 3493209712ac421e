/* trace_scenes: small scenes for the tests of trace, made from text so that nothing is mocked. */
#ifndef TRACE_SCENES_H
#define TRACE_SCENES_H

#include "prim_kinds.h"
#include "trace/trace_int.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static inline void put_view(
    struct buf *b, struct placing at, double x, double y, double z, double hither)
{
    buf_printf(b, "b .1 .2 .4\nv\nfrom");
    put_point(b, at, x, y, z);
    buf_printf(b, "\nat");
    put_point(b, at, 0, 0, 0);
    buf_printf(b, "\nup 0 0 1\nangle 40\nhither %.17g\nresolution 48 32\n", hither * at.scale);
}

static inline void put_light(struct buf *b, struct placing at, double x, double y, double z)
{
    buf_printf(b, "l");
    put_point(b, at, x, y, z);
    buf_printf(b, "\n");
}

static inline void put_random_material(struct buf *b, uint64_t seed, uint64_t *n)
{
    static const double t[] = {0, 0, 0.4, 0.9}, ior[] = {1, 1.1, 1.5, 2};
    double v[6];
    for (int i = 0; i < 6; i++) v[i] = between(seed, n, 0, 1);
    uint64_t pick = rng_u64(seed, (*n)++);
    buf_printf(b, "f %g %g %g %g %g %g %g %g\n", v[0], v[1], v[2], v[3], v[4] < 0.4 ? 0.3 : 0.0,
        1 + 60 * v[5], t[pick & 3], ior[pick >> 2 & 3]);
}

/* A ground square and `count` primitives of every kind, some of glass. */
static inline void put_random_scene(struct buf *b, struct placing at, uint64_t seed, int count)
{
    uint64_t n = 0;
    double y = between(seed, &n, -3, 3), z = between(seed, &n, 1, 4);
    put_view(b, at, 5, y, z, 0);
    for (int i = 0; i < 3; i++) put_light(b, at, 4 - 3 * i, 3 * i - 2, 6);
    buf_printf(b, "f .8 .7 .6 .7 .2 10 0 0\np 4\n");
    put_point(b, at, -6, -6, -1.5);
    put_point(b, at, 6, -6, -1.5);
    put_point(b, at, 6, 6, -1.5);
    put_point(b, at, -6, 6, -1.5);
    buf_printf(b, "\n");
    for (int i = 0; i < count; i++) {
        if (i % 3 == 0) put_random_material(b, seed, &n);
        put_random_prim(b, at, seed, &n);
    }
}

/* A floor under count large triangles of glass, each with a transmittance of its own. */
static inline void put_glass_scene(struct buf *b, struct placing at, uint64_t seed, int count)
{
    uint64_t n = 0;
    put_view(b, at, 0.5, 0.2, 9, 0);
    put_light(b, at, 1, 2, 8);
    put_light(b, at, -2, 1, 7);
    buf_printf(b, "f .8 .7 .6 .7 0 10 0 0\np 3\n");
    put_point(b, at, -9, -9, -2);
    put_point(b, at, 9, -9, -2);
    put_point(b, at, 0, 9, -2);
    for (int i = 0; i < count; i++) {
        buf_printf(b, "\nf 1 1 1 .2 0 1 %.17g 1\np 3\n", between(seed, &n, 0.5, 0.99));
        for (int k = 0; k < 3; k++) {
            double x = between(seed, &n, -4, 4), y = between(seed, &n, -4, 4);
            put_point(b, at, x, y, between(seed, &n, -2, 2));
        }
    }
    buf_printf(b, "\n");
}

/* The text as a scene; b is freed. */
static inline void read_scene(struct buf *b, struct scene *s)
{
    char err[SCENE_ERR];
    if (nff_read("test", (const char *)buf_data(b), buf_size(b), s, err) != 0) fail_msg("%s", err);
    buf_free(b);
}

/* All pixels of a w x h frame, `unit` a call, from the last to the first where `backward`. */
static inline float *render(struct tracer *t, uint32_t w, uint32_t h, uint32_t unit, bool backward)
{
    float *rgba = xcalloc((size_t)4 * w * h, sizeof *rgba);
    const struct lattice all = {0, 0, w, h, 1, 1};
    uint32_t n = (w * h + unit - 1) / unit;
    tracer_frame(t, w, h);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t first = (backward ? n - 1 - i : i) * unit;
        uint32_t count = w * h - first < unit ? w * h - first : unit;
        tracer_pixels(t, &all, first, count, rgba + (size_t)4 * first);
    }
    return rgba;
}

static inline struct tracer *tracer_with(const struct scene *s, const struct kernels *k)
{
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct tracer *t = tracer_new(s, &o);
    t->k = k;
    return t;
}

#endif
