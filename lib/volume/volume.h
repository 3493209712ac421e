/*
 * volume: ray casting of a scalar field on a rectilinear grid (grid/grid.h) as a specification says
 * (spec/spec.h): cell walk, integrators, iso-surfaces, gradient shading. No I/O.
 *
 * The model (emission and absorption; N. Max, "Optical models for direct volume rendering", IEEE
 * TVCG 1(2), 1995): along a ray with t in scaled space,
 *
 *     tau(t) = integral of k(s(t')) dt' from the eye to t
 *     alpha  = 1 - exp(-tau(end))
 *     C      = integral of c k exp(-tau - a t) dt     premultiplied; a: attenuation
 *
 * s is trilinear in each cell, c(s) and k(s) are linear between the knots of the map. Iso-surfaces
 * are thin sheets of their own colour and opacity at the roots of s = value: met where the ray
 * changes between below and at or above it, so that the field may touch a value from above without
 * meeting it. A cell with a missing (NaN) corner is transparent, and has no surface.
 *
 * Where the specification is lit, colours (of sheets too) are multiplied by
 *
 *     VOLUME_AMBIENT + (1 - VOLUME_AMBIENT) |n . l|
 *
 * n: the unit gradient of s in scaled space, l: the direction to the light (Lambert's law, on both
 * sides alike); by 1 where s has no gradient.
 *
 * The picture is a function of grid, specification, options and the frame's size: neither the SIMD
 * width, nor the order or grouping of pixels changes a bit of it.
 */
#ifndef STORMRING_VOLUME_H
#define STORMRING_VOLUME_H

#include "base/base.h"
#include "grid/grid.h"
#include "spec/spec.h"
#include "task/task.h"

#define VOLUME_AMBIENT 0.3

enum volume_method {
    VOLUME_ADAPTIVE, /* to an error of `tolerance`, by whatever is cheapest in each cell */
    VOLUME_DOUBLING, /* as published: trapezoid, sub-steps doubled until that changes < tolerance */
    VOLUME_TRAPEZOID, /* n sub-steps in every cell */
    VOLUME_GAUSS      /* split at the knots, n Gauss-Legendre nodes between */
};
#define VOLUME_NODES_MAX 64 /* n of VOLUME_GAUSS */
struct volume_options {
    enum volume_method method;
    double tolerance; /* of a colour or alpha, 0 .. 1 */
    int n;
    enum isa isa;
};
/* clang-format off */
#define VOLUME_OPTIONS_DEFAULT {VOLUME_ADAPTIVE, 1.0 / 1024, 0, ISA_AUTO}
/* clang-format on */

/*
 * "adaptive", "adaptive:E", "doubling", "doubling:E", "trapezoid:N" or "gauss:N": method, tolerance
 * and n of o; what is not said is as by default. False with what was expected in err. (method.c)
 */
bool volume_method_parse(const char *s, struct volume_options *o, char err[ERR_BYTES]);
#define VOLUME_METHOD 64 /* bytes of its name */
/* The same way round; returns whether it is the default one. */
bool volume_method_print(const struct volume_options *o, char text[VOLUME_METHOD]);

struct volume;
/* Keeps pointers to g and s, which must outlive it. Never NULL. */
struct volume *volume_new(
    const struct grid *g, const struct spec *s, const struct volume_options *o);
void volume_free(struct volume *v);
/* The frame that following pixels belong to. Cheap; before the first volume_pixels. */
void volume_frame(struct volume *v, uint32_t w, uint32_t h);
/* Pixels n0 .. n0+n of the lattice, in its order, into rgba[4*n]: linear, premultiplied. Cheapest
 * for runs of 64 neighbours and more. */
void volume_pixels(struct volume *v, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);

/* Of the latest volume_pixels calls, since volume_frame: for vcworker -n. */
struct volume_counts {
    uint64_t rays, hits; /* hits: rays that enter the grid */
    uint64_t cells;      /* visited and not skipped */
    uint64_t samples;    /* of the field, in integrators */
    uint32_t most_cells; /* that one ray passed */
};
void volume_counts(const struct volume *v, struct volume_counts *c);

#endif
