/*
 * grib: fields of GRIB files on rectilinear grids, through ecCodes.
 *
 * A message holds one level at one time. So the file is read once for its index, and again for the
 * values. Grids are regular in longitude and latitude (including Gaussian grids, and rotated ones
 * in their own coordinates) or in metres on a projection plane. Units are labels: nothing is
 * converted.
 *
 * Call order: gb_index_read; gb_stack_at to list the contents, gb_stack_check to find stacks that
 * cannot be read; gb_member; gb_axes; gb_values for each time. Functions that can fail return false
 * with a message in err. A caller must link ecCodes, and libproj if
 * it is there.
 */
#ifndef STORMRING_GRIB_H
#define STORMRING_GRIB_H

#include "base/base.h"
#include "grid/grid.h"
#include "projection/projection.h"

#define GB_TEXT 80 /* bytes of a text key; longer ones are cut */

#define GB_PLACES 16
#define GB_CHOICES 20
#define GB_CHOICE 24 /* bytes of such a value */

/* Which messages count: those whose key has one of some values; or all, as members. */
struct gb_where {
    const char *key, *values; /* values: with / between */
    bool over;
};
/* The metadata of a message. */
struct gb_entry {
    char name[GB_TEXT], long_name[GB_TEXT], units[GB_TEXT]; /* of the variable */
    char levels[GB_TEXT];                                   /* type of level */
    char grid[GB_TEXT], kind[GB_TEXT]; /* hash of the grid's definition; grid type */
    double level;                      /* for a layer, its middle */
    bool no_pv;                        /* a hybrid level without coefficients */
    int64_t when;                      /* validity time, YYYYMMDDhhmm */
    int64_t begin;                     /* of the interval that ends then; 0: there is none */
    int64_t nx, ny;
    size_t number;                      /* message number in the file, from 0 */
    long edition;                       /* of GRIB */
    double place[GB_PLACES];            /* where the grid lies; NaN where a key does not apply */
    char member[GB_CHOICE];             /* the value of the key of which all are wanted; "" */
    char choice[GB_CHOICES][GB_CHOICE]; /* values of the keys of gb_choices, which may tell messages
                                         * of one level and time apart */
};
/* All messages of a file that count, sorted by name, type of level, member, time and level. */
struct gb_index {
    struct gb_entry *at;
    size_t n;
};
/* The entries of one variable at one type of level: n_members times n_times times n_levels. */
struct gb_stack {
    const struct gb_entry *at; /* points into the index */
    size_t n, n_levels, n_times, n_members;
};

/* False with a message in err if no message counts, too. */
bool gb_index_read(const char *path, const struct gb_where *where, size_t n, struct gb_index *x,
    char err[ERR_BYTES]);
void gb_index_free(struct gb_index *x);
/* The stack that starts at entry `first`. The next stack starts n entries later. */
struct gb_stack gb_stack_at(const struct gb_index *x, size_t first);
/* The part of one member, of a stack with several. */
struct gb_stack gb_member(const struct gb_stack *s, size_t member);
/* True if the stack is one rectilinear grid at each time. Otherwise the message says why, and what
 * there is to choose from. */
bool gb_stack_check(const struct gb_stack *s, char err[ERR_BYTES]);
bool gb_same_axes(const struct gb_stack *a, const struct gb_stack *b);

/* The units of a type of level. down: it counts downwards, see gb_counts_down. */
struct gb_measure {
    const char *prefix, *units;
    bool down;
};
const struct gb_measure *gb_measure_of(const char *levels);
/* True if the level counts downwards. Hybrid levels do if they have the coefficients of their
 * pressure; those of NCEP's native files, which have none, count upwards. */
bool gb_counts_down(const struct gb_entry *e);
/* True if x and y of this grid type are metres on a plane. */
bool gb_is_projected(const char *kind);

/* Writes PROJ's string of the plane of x and y, or "" if it is not known. */
bool gb_plane_of(
    const char *path, const struct gb_stack *s, char text[PROJECTION_TEXT], char err[ERR_BYTES]);
/* Makes a grid with these axes, ascending, and room for values. The caller frees it. */
bool gb_axes(const char *path, const struct gb_stack *s, struct grid *g, char err[ERR_BYTES]);
/* Reads the values of one time into g; of the first member. */
bool gb_values(
    const char *path, const struct gb_stack *s, size_t time, struct grid *g, char err[ERR_BYTES]);

/* ---- heights -------------------------------------------------------------------------------- */

/* The fields from which the height of each node of a stack comes. */
struct gb_heights {
    enum { GB_HEIGHTS_NONE, GB_HEIGHTS_GEOPOTENTIAL, GB_HEIGHTS_HYBRID } kind;
    struct gb_stack field; /* the geopotential, or the surface pressure */
    double metres;         /* of a unit of the geopotential */
    bool logarithm;        /* of the surface pressure */
};
/* Looks for a geopotential (height) on the same levels, unless `standard`, or, for hybrid levels,
 * for the surface pressure. */
void gb_heights_find(
    const struct gb_index *x, const struct gb_stack *s, bool standard, struct gb_heights *h);
/* Reads, at one time, metres (GB_HEIGHTS_GEOPOTENTIAL) or pressures in Pa (GB_HEIGHTS_HYBRID) into
 * a grid with the axes of the stack; of the first member. */
bool gb_heights_values(const char *path, const struct gb_stack *s, const struct gb_heights *h,
    size_t time, struct grid *g, char err[ERR_BYTES]);

#endif
