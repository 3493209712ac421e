/*
 * trace: ray tracing of a scene with the meaning that stormring-nff(5) gives it. POV-Ray 3.7 is the
 * reference. Intersection, hierarchy, shading, pixel sampling.
 *
 * The pixels depend only on the scene, the frame's size, depth and sampling. The hierarchy, the
 * SIMD width, and the order and grouping of pixels do not change a bit.
 */
#ifndef STORMRING_TRACE_H
#define STORMRING_TRACE_H

#include "scene/scene.h"
#include "task/task.h"

struct trace_options {
    /* Maximum ray level: 5 is the eye ray and four more. Unbent rays keep their level. */
    int depth;
    int samples; /* per pixel: 1 samples the centre; n*n are spread over the pixel (pixel.c) */
    /* Adaptive sampling: < 0 always takes all samples. Otherwise a pixel takes all samples only if
     * its first samples differ by more than this in a channel. The first samples are 4, or 9 if
     * samples >= 36. */
    double threshold;
    /* Error budget of each sample, in units of a pixel's channel: rays are dropped that can change
     * it by no more than this in all. 0: every ray is traced. */
    double budget;
    enum isa isa;
    /* The rules of the Standard Procedural Databases (SPD, version 3.14, E. Haines): each light
     * that a surface faces gets a shadow ray, each transmitting surface reflects, and a refracted
     * ray uses up a level even if it is not bent. With budget 0 no ray is left out. */
    bool by_spd;
    enum trace_hierarchy { HIERARCHY_BVH, HIERARCHY_SLABS, HIERARCHY_NONE } hierarchy;
    bool count_tests; /* for tracer_tests; takes longer */
    int threads; /* that tracer_new works with; the tracer is the same with any number */
};
/* clang-format off */
#define TRACE_OPTIONS_DEFAULT {5, 1, -1.0, 0x1p-17, ISA_AUTO, false, HIERARCHY_BVH, false, 1}
/* clang-format on */
#define TRACE_DEPTH_MAX 64
#define TRACE_SAMPLES_MAX 1024

struct tracer;

/* Builds the hierarchy, with o->threads threads: the caller's and others, which end before the
 * function returns. Keeps a pointer to s, which must outlive the tracer. Never NULL. The caller
 * frees it with tracer_free. */
struct tracer *tracer_new(const struct scene *s, const struct trace_options *o);
void tracer_free(struct tracer *t);
/*
 * Looks from another view, which is copied, in the following calls; NULL: the scene's. The pixels
 * are those of a scene with this view. Its resolution does not matter: the frame keeps its size.
 * Cheap, unless the eye's distance from the origin passes a power of two beyond the scene.
 */
void tracer_look(struct tracer *t, const struct view *v);
/* Sets the frame size in pixels for the following calls. Cheap. Without this call the size is the
 * scene's resolution. */
void tracer_frame(struct tracer *t, uint32_t w, uint32_t h);
/* Renders pixels n0 .. n0+n of the lattice, in lattice order, into rgba[4*n]: linear, alpha 1.
 * Fastest for runs of at least 64 neighbours. */
void tracer_pixels(struct tracer *t, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);

/* Traces a ray through each corner of the frame's pixels, (w + 1) * (h + 1) rays, as SPD does. It
 * makes no picture: the rays are counted. */
void tracer_corners(struct tracer *t);

enum ray_kind { RAY_EYE, RAY_REFLECTED, RAY_REFRACTED, RAY_SHADOW, RAY_KINDS };

/* Since tracer_new. What else is counted of each kind becomes a member of ray_counts. */
struct trace_counts {
    struct ray_counts {
        uint64_t rays;
        uint64_t hits; /* rays that met a surface; shadow rays that an opaque surface blocked */
    } of[RAY_KINDS];
    uint64_t turned_back; /* reflected rays in place of refracted ones: total internal reflection */
};
void tracer_counts(const struct tracer *t, struct trace_counts *c);

/* Tests since tracer_new, if options.count_tests, and the size of the hierarchy. */
struct trace_tests {
    uint64_t rays, boxes, items; /* boxes: bounding volumes; items: triangles, other primitives */
    uint64_t bytes;              /* of the hierarchy, without the items */
};
void tracer_tests(const struct tracer *t, struct trace_tests *c);

#endif
