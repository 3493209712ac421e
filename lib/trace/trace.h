/*
 * trace: ray tracing of a scene as DESIGN's shading model says (NFF meaning, POV-Ray 3.7 the
 * reference): intersectors, hierarchies, shading, pixel sampling.
 *
 * The picture is a function of the scene, the frame's size, depth and sampling alone: neither the
 * hierarchy, nor the SIMD width, nor the order or grouping of pixels changes a bit of it.
 */
#ifndef STORMRING_TRACE_H
#define STORMRING_TRACE_H

#include "scene/scene.h"
#include "task/task.h"

struct trace_options {
    /* levels: 5 is the eye ray and four more; rays that pass unbent stay on their level */
    int depth;
    int samples; /* per pixel, a square: 1 is the centre, n*n are stratified in the pixel */
    /* < 0: always all samples; else refine only pixels whose first samples differ by more: 4, or 9
     * where there are 36 and more */
    double threshold;
    enum isa isa;
};
/* clang-format off */
#define TRACE_OPTIONS_DEFAULT {5, 1, -1.0, ISA_AUTO}
/* clang-format on */
#define TRACE_DEPTH_MAX 64
#define TRACE_SAMPLES_MAX 1024

struct tracer;

/* Builds the hierarchy. Keeps a pointer to s, which must outlive it. Never NULL. */
struct tracer *tracer_new(const struct scene *s, const struct trace_options *o);
void tracer_free(struct tracer *t);
/* The frame that following pixels belong to. Cheap; before the first tracer_pixels. */
void tracer_frame(struct tracer *t, uint32_t w, uint32_t h);
/* Pixels n0 .. n0+n of the lattice, in its order, into rgba[4*n]: linear, alpha 1. Cheapest for
 * runs of 64 neighbours and more. */
void tracer_pixels(struct tracer *t, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);

/* What was traced since tracer_new. */
struct trace_counts {
    uint64_t eye, reflected, refracted, shadow;
};
void tracer_counts(const struct tracer *t, struct trace_counts *c);

#endif
