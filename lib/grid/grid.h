/*
 * grid: a scalar field on a rectilinear grid, read from and written to VTK legacy files; bricks of
 * grids larger than memory. Only grid_load and grid_file do I/O. stormring-grid(5) is the manual of
 * the format.
 */
#ifndef STORMRING_GRID_H
#define STORMRING_GRID_H

#include "base/base.h"

#define GRID_NAME 64   /* bytes of the scalar's name */
#define GRID_TITLE 256 /* bytes; the limit of VTK's reader */

/*
 * A brick is a grid that was cut from a larger one. It renders its own cells, those between two
 * planes on each axis. The others are a layer of overlap: copies of the neighbours' cells.
 */
struct grid_brick {
    bool is;            /* the rest counts only if it is one */
    double whole[3][2]; /* the larger grid's least and greatest coordinate on each axis */
    uint32_t own[3][2]; /* the first and the last plane of its own cells */
};

/* A scalar field on axis-aligned planes. Coordinates are in the file's units. */
struct grid {
    uint32_t n[3]; /* nodes along x, y, z; at least 2 each */
    double *at[3]; /* n[a] coordinates, ascending; axes that descend in the file are reversed */
    float *value;  /* n[0]*n[1]*n[2], x fastest; NaN: missing */
    char name[GRID_NAME];   /* name of the scalar */
    char title[GRID_TITLE]; /* second line of the file; holds the units */
    struct grid_brick brick;
    bool flat; /* the file has one level: both levels here have its values; the first is in place */
    /* Further grids of the file; NULL: none. Not written again. */
    float *second; /* values of another field at the same nodes; NaN: both are missing */
    char second_name[GRID_NAME], second_title[GRID_TITLE]; /* its scalar's name, and its title */
    struct grid *ground; /* one level of heights, or of values on a plane: n[2] is 1 */
    char ground_name[GRID_NAME], ground_title[GRID_TITLE];
};
/* Index of node i, j, k. */
static inline size_t grid_node(const struct grid *g, uint32_t i, uint32_t j, uint32_t k)
{
    return ((size_t)k * g->n[1] + j) * g->n[0] + i;
}
/*
 * Limits of input. Coordinates and values are within GRID_MAX of 0, so their squares fit a float.
 * Neighbouring coordinates differ by at least GRID_STEP_MIN.
 */
#define GRID_MAX 1e18
#define GRID_STEP_MIN 1e-18
/*
 * Reads VTK legacy RECTILINEAR_GRID, ASCII or BINARY: one scalar of point data, of float, double or
 * integers. Another file may follow in the same bytes: a second field, or a ground; or both.
 * Returns 0, or -1 with the message in err; `name` is for messages. The caller frees the grid,
 * which keeps no pointer into `bytes`.
 */
int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES]);
/* The number of values of the first grid by its head, which is in the first n bytes; 0: it is not,
 * or is wrong. */
uint64_t grid_nodes(const unsigned char *start, size_t n);
/* The share of the grid's base, 0 to 1, that lies over its ground. (circle.c) */
double grid_over_ground(const struct grid *g);
/* Reads a file; "-": standard input. */
int grid_load(const char *path, struct grid *g, char err[ERR_BYTES]);
/*
 * As grid_read, but destroys `bytes`. They must be private memory of this process. Pages are
 * returned to the system during reading, so the values of a BINARY float grid are in memory only
 * once. The contents of `bytes` are undefined afterwards.
 */
int grid_consume(
    const char *name, unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES]);
/*
 * Appends the grid to b in the same format, BINARY float with coordinates in double. title becomes
 * the file's second line, cut at GRID_TITLE. Reading the file gives the same grid bit by bit.
 */
void grid_write(const struct grid *g, const char *title, struct buf *b);
/* Its two parts: everything before the values; n values. A line end follows the last value. */
void grid_write_head(const struct grid *g, const char *title, struct buf *b);
void grid_write_values(const float *value, size_t n, struct buf *b);
void grid_free(struct grid *g);
/*
 * Appends the grid as POV-Ray's density file (DF3), 32 bits for a value: least becomes 0 and most
 * 2^32 - 1, missing values 0. least < most; all values are between them. mask: as many layers
 * follow, which are 2^32 - 1 at nodes below a cell without missing values, else 0.
 */
void grid_df3(const struct grid *g, double least, double most, bool mask, struct buf *out);
/*
 * Checks that coordinates ascend or descend in steps of at least GRID_STEP_MIN. Returns the index
 * of the first one that breaks the direction of the first two, or 0 if none does. n is at least 1.
 */
uint32_t grid_axis_fault(const double *at, uint32_t n);
/* Writes "A after B, expected ...", the fault of at[fault]. */
#define GRID_FAULT 128
void grid_axis_why(const double *at, uint32_t fault, char why[GRID_FAULT]);
/*
 * v, a place on an axis from lo to hi; or the end of it, if v is beyond that by no more than the
 * rounding to six digits, in which messages and people write coordinates.
 */
double grid_within(double v, double lo, double hi);
/*
 * The trilinear field at p, in the grid's coordinates. A point on a face belongs to the upper cell.
 * NaN outside the grid, and if a corner of the cell is missing.
 */
double grid_at(const struct grid *g, const double p[3]);

/*
 * A grid file that is larger than memory (cut.c): the file is mapped, and its pages are returned as
 * they are read. It must not shrink meanwhile. "-" is standard input, which must be a file.
 * grid_file_open returns NULL with the message in err, and dies with status 2 if there is no such
 * file. grid_file_grid has no values, and one level if the file has. err stays in use until
 * grid_file_cut has another one.
 */
struct grid_file;
struct grid_file *grid_file_open(const char *path, char err[ERR_BYTES]);
const struct grid *grid_file_grid(const struct grid_file *f);
/* Sets names and titles of the second field and of the ground, if the file has them. Values are
 * passed over. Call it before grid_file_cut. False with a message in err if what follows the first
 * grid is invalid. */
bool grid_file_further(struct grid_file *f, char err[ERR_BYTES]);
void grid_file_close(struct grid_file *f);
#define GRID_BRICKS_MAX 256 /* all are open at the same time */
/*
 * Cuts the grid into parts[0] x parts[1] x parts[2] bricks, at most one for each cell and
 * GRID_BRICKS_MAX, and writes them to the files path[], x fastest. Rows are copied one by one. All
 * files appear at the end, if all could be written. Call it once. Returns ST_OK, or an exit status
 * with the message in err.
 */
int grid_file_cut(
    struct grid_file *f, const uint32_t parts[3], char *const *path, char err[ERR_BYTES]);

/* Name and unit of a scalar or an axis from a grid's title; see stormring-grid(5). */
struct grid_named {
    char name[GRID_NAME], unit[GRID_NAME];
    bool down; /* the axis is negated */
};
/* axis: 'x', 'y', 'z' or 't', or 0 for the scalar. False if the title does not mention it. */
bool grid_title(const char *title, char axis, struct grid_named *n);
/* Copies the PROJ string of the plane of x and y. False if the title has none, or is so long that
 * the string may have been cut. */
bool grid_title_proj(const char *title, char proj[GRID_TITLE]);

#endif
