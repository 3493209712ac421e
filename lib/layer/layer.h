/*
 * layer: layers of a grid: a level, lines on it where the field has a value, and signs for
 * the wind; a vertical section. No I/O.
 */
#ifndef STORMRING_LAYER_H
#define STORMRING_LAYER_H

#include "grid/grid.h"
#include "plane/plane.h"

/*
 * Sets *value to the field at height z, a coordinate of the grid: g->n[0] times g->n[1] values,
 * linear between the two levels beside it; NaN where one that counts is missing. The caller frees
 * them. False with a message in err if z is not between the first and the last level.
 */
bool layer_level(const struct grid *g, double z, float **value, char err[ERR_BYTES]);

/* A point in the grid's coordinates. */
struct layer_point {
    double x, y;
};
/* Called for each line, of at least two points. A closed one ends at its first point. */
typedef void layer_line(void *ctx, const struct layer_point *at, size_t n);
/*
 * Finds the lines on which the field, bilinear in the cells of g, is v: a point on each edge whose
 * ends are on both sides, linear between them. A node with the value itself is above. In a cell
 * whose four edges have a point, the mean of the corners, which is the value at the centre, decides
 * what is joined. Lines end at cells with a missing corner and at the edge of the grid.
 */
void layer_isolines(
    const struct grid *g, const float *value, double v, layer_line *line, void *ctx);

/* The value of a level, as layer_level has it, at a point: bilinear. NaN outside of the grid, and
 * if a node that counts is missing. */
double layer_at(const struct grid *g, const float *value, struct layer_point p);

/* A sign for the wind, whose shaft begins at its foot. */
struct layer_barb {
    struct layer_point foot, to; /* to: a vector of length 1 to where the wind blows */
    double length;               /* of the shaft */
    double knots;                /* speed, at least 0 */
    bool southern;               /* on the southern hemisphere: feathers are on the other side */
};
/* Calls line once. */
void layer_barb(const struct layer_barb *b, layer_line *line, void *ctx);

/* The length of a line between two places: km on the great circle if x and y are longitude and
 * latitude, otherwise that of the straight line, in the grid's unit. */
double layer_length(struct layer_point a, struct layer_point b, bool globe);
/* What places are, and where they are in a grid. */
struct layer_on {
    bool globe;                /* longitude and latitude; otherwise x and y of the grid */
    const struct plane *plane; /* of globe: gives x and y; NULL: they are the same */
    bool circles;              /* x may be moved by whole circles */
};
/* True if the grid has this place. */
bool layer_inside(const struct grid *g, struct layer_point p, const struct layer_on *on);
/*
 * Makes a grid of what is above that line: x is the distance from a, in n >= 2 even steps, z as in
 * g, and y has two equal rows. Bilinear in each level. The unit of x goes into the title. The
 * length is not 0. The caller frees *out.
 */
void layer_section(const struct grid *g, struct layer_point a, struct layer_point b,
    const struct layer_on *on, const char *unit, uint32_t n, struct grid *out);

#endif
