/*
 * volume: ray casting of a scalar field on a rectilinear grid (grid/grid.h) with the camera and
 * colours of a specification (spec/spec.h): cell traversal, integrators, iso-surfaces, gradient
 * shading. No I/O.
 *
 * The model is emission and absorption (N. Max, "Optical models for direct volume rendering", IEEE
 * TVCG 1(2), 1995). Along a ray with t in scaled space,
 *
 *     tau(t) = integral of k(s(t')) dt' from the eye to t
 *     alpha  = 1 - exp(-tau(end))
 *     C      = integral of c k exp(-tau - a t) dt     premultiplied; a: attenuation
 *
 * s is trilinear in each cell; c(s) and k(s) are linear between the knots of the map. Iso-surfaces
 * are thin sheets with their own colour and opacity at the roots of s = value. A ray crosses a
 * sheet where s changes between below the value and at or above it. So a field that touches the
 * value from above crosses no sheet. A cell with a missing (NaN) corner is transparent and has no
 * surface.
 *
 * If the specification is lit, colours (of sheets too) are multiplied by
 *
 *     VOLUME_AMBIENT + (1 - VOLUME_AMBIENT) |n . l|
 *
 * n is the unit gradient of s in scaled space, l the direction to the light (Lambert's law, the
 * same on both sides). If s has no gradient, the factor is 1.
 *
 * If the specification has colours of a second field, c is a function of that field instead of s. A
 * slice is a plane in the colours of the map. The ground is a surface that ends rays: opaque, or
 * flat and of some opacity. Light does not change slices and a flat ground. A clip box hides
 * everything outside.
 *
 * The pixels depend only on grid, specification, options and the frame's size. The SIMD width, and
 * the order and grouping of pixels do not change a bit.
 */
#ifndef STORMRING_VOLUME_H
#define STORMRING_VOLUME_H

#include "base/base.h"
#include "grid/grid.h"
#include "spec/spec.h"
#include "task/task.h"

#define VOLUME_AMBIENT 0.3

enum volume_method {
    VOLUME_ADAPTIVE,  /* error at most `tolerance`, with the cheapest rule per cell */
    VOLUME_DOUBLING,  /* as published: trapezoid, sub-steps doubled until change < tolerance */
    VOLUME_TRAPEZOID, /* n sub-steps per cell */
    VOLUME_GAUSS      /* split at the knots; n Gauss-Legendre nodes per piece */
};
#define VOLUME_NODES_MAX 64 /* maximum n of VOLUME_GAUSS */
struct volume_options {
    enum volume_method method;
    double tolerance; /* error of a colour or alpha, 0 .. 1 */
    int n;
    enum isa isa;
    int threads; /* that volume_new works with; the volume is the same with any number */
};
/* clang-format off */
#define VOLUME_OPTIONS_DEFAULT {VOLUME_ADAPTIVE, 1.0 / 1024, 0, ISA_AUTO, 1}
/* clang-format on */

/*
 * Parses "adaptive", "adaptive:E", "doubling", "doubling:E", "trapezoid:N" or "gauss:N" into
 * method, tolerance and n of o. Omitted values get their defaults. False: err describes what was
 * expected. (method.c)
 */
bool volume_method_parse(const char *s, struct volume_options *o, char err[ERR_BYTES]);
#define VOLUME_METHOD 64 /* bytes of a method's name */
/* The inverse: writes the name into text. True if it is the default method. */
bool volume_method_print(const struct volume_options *o, char text[VOLUME_METHOD]);

struct volume;
/* False with a message in err if the grid lacks what the specification names: a second field, a
 * ground. */
bool volume_check(const struct grid *g, const struct spec *s, char err[ERR_BYTES]);
/* For a grid and a specification that pass volume_check. Keeps pointers to g and s, which must
 * outlive the volume. Never NULL. The caller frees it with volume_free. */
struct volume *volume_new(
    const struct grid *g, const struct spec *s, const struct volume_options *o);
void volume_free(struct volume *v);
/* Sets the frame size in pixels for the following calls and resets the counts. Cheap. Without this
 * call the size is the specification's. */
void volume_frame(struct volume *v, uint32_t w, uint32_t h);
/* Renders pixels n0 .. n0+n of the lattice, in lattice order, into rgba[4*n]: linear,
 * premultiplied. Fastest for runs of at least 64 neighbours. */
void volume_pixels(struct volume *v, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);

/* Counts of all volume_pixels calls since volume_frame. vcworker -n prints them. */
struct volume_counts {
    uint64_t rays, hits; /* hits: rays that enter the grid */
    uint64_t cells;      /* visited and not skipped */
    uint64_t samples;    /* field samples taken by the integrators */
    uint32_t most_cells; /* maximum number of cells passed by one ray */
};
void volume_counts(const struct volume *v, struct volume_counts *c);

#endif
