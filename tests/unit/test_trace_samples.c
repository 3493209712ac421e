/* Samples of a pixel: each column and each row of the pixel has one, so an edge is nearly exact. */
#include "trace/trace.h"

#include <stdarg.h>
#include "trace_scenes.h"

/* A white half-plane covers `part` of one pixel, with an upright or a level edge. Returns how far
 * the pixel is from that part. */
static double off_by(double part, bool upright, int samples, uint64_t seed)
{
    struct buf b = {0};
    struct scene s;
    /* 64 pixels of side 1 along the axis, so that each has another number and other samples. */
    double edge = -32 + (double)(seed % 64) + part;
    buf_printf(&b, "b 0 0 0 v from 0 0 100 at 0 0 0 up 0 1 0 angle %.17g hither 0 resolution 1 1\n",
        2 * atan(32.0 / 100) * 180 / M_PI);
    buf_printf(&b, "l 0 0 1e9 1 1 1 f 1 1 1 1 0 0 0 0 ");
    if (upright) buf_printf(&b, "p 4 -99 -99 0 %.17g -99 0 %.17g 99 0 -99 99 0\n", edge, edge);
    else buf_printf(&b, "p 4 -99 %.17g 0 99 %.17g 0 99 99 0 -99 99 0\n", -edge, -edge);
    read_scene(&b, &s);
    struct trace_options o = TRACE_OPTIONS_DEFAULT;
    o.samples = samples;
    struct tracer *t = tracer_new(&s, &o);
    tracer_frame(t, 64, 64);
    const struct lattice one = {
        upright ? (uint32_t)(seed % 64) : 20, upright ? 20 : (uint32_t)(seed % 64), 1, 1, 1, 1};
    float rgba[4];
    tracer_pixels(t, &one, 0, 1, rgba);
    tracer_free(t);
    scene_free(&s);
    return fabs((double)rgba[0] - part);
}

static void test_edges(void **state)
{
    (void)state;
    for (int side = 2; side <= 32; side *= 2)
        for (uint64_t seed = 0; seed < 200; seed++) {
            double part = rng_unit(3, seed), off = off_by(part, seed % 2, side * side, seed);
            if (off > 1.0 / (side * side) + 1e-5)
                fail_msg("%d samples, %g of the pixel: off by %g", side * side, part, off);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_edges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
