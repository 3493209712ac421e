/*
 * grib: fields of GRIB files on rectilinear grids, through ecCodes.
 *
 * A message holds one level at one time: the file is read once for what it holds, and again for the
 * values. Grids are regular in longitude and latitude (Gaussian ones too, and rotated ones by their
 * own coordinates) or in metres on a plane of projection. Units are labels: nothing is converted.
 *
 * gb_index_read; gb_stack_at for what there is, gb_stack_check for what cannot be taken;
 * gb_axes, and gb_values for each time. Functions that can fail return false with a text in
 * err. Only what links ecCodes may call them.
 */
#ifndef STORMRING_GRIB_H
#define STORMRING_GRIB_H

#include "base/base.h"
#include "grid/grid.h"

#define GB_TEXT 80 /* bytes of a key that is text; longer ones are cut */

/* What a message is of. */
struct gb_entry {
    char name[GB_TEXT], long_name[GB_TEXT], units[GB_TEXT]; /* of the variable */
    char levels[GB_TEXT];                                   /* the type of its level */
    char grid[GB_TEXT], kind[GB_TEXT]; /* a hash of the grid's definition; its type */
    double level;                      /* of a layer, its middle */
    int64_t when;                      /* it is valid at, YYYYMMDDhhmm */
    int64_t nx, ny;
    size_t number; /* of the message in the file, from 0 */
};
/* All of a file, sorted by name, type of levels, time and level. */
struct gb_index {
    struct gb_entry *at;
    size_t n;
};
/* The entries of one variable at one type of levels: n_times times n_levels of them. */
struct gb_stack {
    const struct gb_entry *at; /* in the index */
    size_t n, n_levels, n_times;
};

bool gb_index_read(const char *path, struct gb_index *x, char err[ERR_BYTES]);
void gb_index_free(struct gb_index *x);
/* The stack that begins at entry `first`; the next one begins n entries later. */
struct gb_stack gb_stack_at(const struct gb_index *x, size_t first);
/* Is it one rectilinear grid at each time? */
bool gb_stack_check(const struct gb_stack *s, char err[ERR_BYTES]);
bool gb_same_axes(const struct gb_stack *a, const struct gb_stack *b);

/* What a type of levels is measured in, and do they count downwards? Then z is negated. */
struct gb_measure {
    const char *prefix, *units;
    bool down;
};
const struct gb_measure *gb_measure_of(const char *levels);
/* Is x and y of such a grid metres on a plane? */
bool gb_is_projected(const char *kind);

/* A grid with these axes, ascending, and values that are yet to come; the caller frees it. */
bool gb_axes(const char *path, const struct gb_stack *s, struct grid *g, char err[ERR_BYTES]);
/* The values of one time into it; where `combine`, hypot of what is there and them. */
bool gb_values(const char *path, const struct gb_stack *s, size_t time, struct grid *g,
    bool combine, char err[ERR_BYTES]);

#endif
