/*
 * volume: ray casting of a scalar field on a rectilinear grid: grid, rendering specification, cell
 * walk, integrators, iso-surfaces, gradient shading. No I/O but grid_load and spec_load.
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
#include "task/task.h"

#define VOLUME_ERR ERR_BYTES /* bytes of a message: "name:line: what, expected what" */
#define VOLUME_NAME 64
#define GRID_TITLE 256 /* bytes: what VTK's reader has room for */
#define VOLUME_AMBIENT 0.3

/* ---- the grid (grid.c, vtk.c) ---------------------------------------------------------------- */

/* A scalar field on axis-aligned planes; coordinates as in the file, in its units. */
struct grid {
    uint32_t n[3]; /* nodes along x, y, z; at least 2 of each */
    double *at[3]; /* n[a] coordinates, ascending (what descends in the file is turned round) */
    float *value;  /* n[0]*n[1]*n[2], x fastest; NaN: missing */
    char name[VOLUME_NAME]; /* of the scalar */
    char title[GRID_TITLE]; /* the second line of the file that was read: units are there */
};
/* Index of node i, j, k. */
static inline size_t grid_node(const struct grid *g, uint32_t i, uint32_t j, uint32_t k)
{
    return ((size_t)k * g->n[1] + j) * g->n[0] + i;
}
/*
 * What is read: coordinates and values are within GRID_MAX of 0, so that squares of them stay
 * inside a float, and neighbouring coordinates differ by GRID_STEP_MIN at least.
 */
#define GRID_MAX 1e18
#define GRID_STEP_MIN 1e-18
/*
 * Reads VTK legacy RECTILINEAR_GRID, ASCII or BINARY: one scalar of point data, of float, double or
 * integers; stormring-grid(5) is the manual. 0, or -1 with text in err; `name` is for messages. The
 * caller frees the grid, which holds no part of `bytes`.
 */
int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[VOLUME_ERR]);
/* The same of a file; "-": standard input. */
int grid_load(const char *path, struct grid *g, char err[VOLUME_ERR]);
/*
 * The same of bytes that nobody else needs, in memory of this process alone: a buffer, or a file
 * mapped private. Pages of them are given back to the system while they are read, so that the
 * values of a BINARY float grid are in memory once. What the bytes are afterwards is undefined.
 */
int grid_consume(
    const char *name, unsigned char *bytes, size_t n, struct grid *g, char err[VOLUME_ERR]);
/*
 * The same format, BINARY float with coordinates in double, appended to b; title stands in the
 * file's second line, cut there where it does not fit. Reading it gives the same grid bit by bit.
 */
void grid_write(const struct grid *g, const char *title, struct buf *b);
void grid_free(struct grid *g);
/*
 * Where ascending or descending coordinates are not apart: the index of the first one that does not
 * continue as the first two began, or 0 where all do. n is at least 2.
 */
uint32_t grid_axis_fault(const double *at, uint32_t n);
/* "A after B, expected ...": what is wrong with at[fault]. */
#define GRID_FAULT 128
void grid_axis_why(const double *at, uint32_t fault, char why[GRID_FAULT]);
/*
 * The field at a point given in the grid's coordinates: trilinear in the cell that it is in, the
 * upper one where it is on a face. NaN outside, and where a corner of the cell is missing.
 */
double grid_at(const struct grid *g, const double p[3]);

/* ---- the specification (spec.c): stormring-spec(5) ------------------------------------------ */

struct spec_knot {
    double s, rgb[3], k; /* two of one s are a jump: the first holds below it, the second above */
};
struct spec_iso {
    double s, rgb[3], opacity; /* opacity 0 .. 1, of the sheet itself, whatever its slant */
};
#define SPEC_LIMIT .9999 /* of opacity, where none is given */
struct spec {
    double from[3], at[3], up[3], angle; /* as in NFF, in scaled space; angle in degrees */
    uint32_t w, h;                       /* resolution */
    bool lit;
    double light[3];      /* in scaled space */
    double attenuation;   /* a, per unit of scaled space */
    double scale[3];      /* of the grid's coordinates; not 0 */
    double opacity_limit; /* a ray ends when its alpha reaches it */
    bool backed;
    double background[3];   /* behind everything, where backed; else transparent */
    struct spec_knot *knot; /* ascending by s, none or two and more; outside of them k = 0 */
    size_t n_knots;
    struct spec_iso *iso; /* ascending by s, each s once */
    size_t n_isos;
};
/* 0, or -1 with text in err; `name` is for messages. The caller frees the specification. */
int spec_read(const char *name, const char *text, size_t n, struct spec *s, char err[VOLUME_ERR]);
/* The same of a file; "-": standard input. */
int spec_load(const char *path, struct spec *s, char err[VOLUME_ERR]);
void spec_free(struct spec *s);

/* ---- rendering ------------------------------------------------------------------------------ */

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
bool volume_method_parse(const char *s, struct volume_options *o, char err[VOLUME_ERR]);
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
/* False when this machine cannot run it. */

#endif
