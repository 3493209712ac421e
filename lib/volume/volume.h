/*
 * volume: ray casting of a scalar field on a rectilinear grid. No I/O.
 */
#ifndef STORMRING_VOLUME_H
#define STORMRING_VOLUME_H

#include "base/base.h"

#define VOLUME_ERR 256 /* bytes of a message: "name:line: what, expected what" */
#define VOLUME_NAME 64

/* ---- the grid (grid.c, vtk.c) ---------------------------------------------------------------- */

/* A scalar field on axis-aligned planes; coordinates as in the file, in its units. */
struct grid {
    uint32_t n[3]; /* nodes along x, y, z; at least 2 of each */
    double *at[3]; /* n[a] coordinates, ascending (what descends in the file is turned round) */
    float *value;  /* n[0]*n[1]*n[2], x fastest; NaN: missing */
    char name[VOLUME_NAME]; /* of the scalar */
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
 * caller frees the grid, which holds no part of `bytes`: map a file rather than reading it, and the
 * values are in memory once.
 */
int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[VOLUME_ERR]);
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
/*
 * The field at a point given in the grid's coordinates: trilinear in the cell that it is in, the
 * upper one where it is on a face. NaN outside, and where a corner of the cell is missing.
 */
double grid_at(const struct grid *g, const double p[3]);

#endif
