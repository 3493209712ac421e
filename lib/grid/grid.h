/*
 * grid: a scalar field on a rectilinear grid, read from and written to VTK legacy files. No I/O but
 * grid_load. stormring-grid(5) is the manual of the format.
 */
#ifndef STORMRING_GRID_H
#define STORMRING_GRID_H

#include "base/base.h"

#define GRID_NAME 64   /* bytes: the scalar's name */
#define GRID_TITLE 256 /* bytes: what VTK's reader has room for */

/* A scalar field on axis-aligned planes; coordinates as in the file, in its units. */
struct grid {
    uint32_t n[3]; /* nodes along x, y, z; at least 2 of each */
    double *at[3]; /* n[a] coordinates, ascending (what descends in the file is turned round) */
    float *value;  /* n[0]*n[1]*n[2], x fastest; NaN: missing */
    char name[GRID_NAME];   /* of the scalar */
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
 * integers. 0, or -1 with text in err; `name` is for messages. The
 * caller frees the grid, which holds no part of `bytes`.
 */
int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES]);
/* The same of a file; "-": standard input. */
int grid_load(const char *path, struct grid *g, char err[ERR_BYTES]);
/*
 * The same of bytes that nobody else needs, in memory of this process alone: a buffer, or a file
 * mapped private. Pages of them are given back to the system while they are read, so that the
 * values of a BINARY float grid are in memory once. What the bytes are afterwards is undefined.
 */
int grid_consume(
    const char *name, unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES]);
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

#endif
