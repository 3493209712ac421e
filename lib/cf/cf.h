/*
 * cf: variables of NetCDF files as fields on rectilinear grids, through libnetcdf.
 *
 * Follows "NetCDF Climate and Forecast (CF) Metadata Conventions" 1.10 (2022) and the older NetCDF
 * Users' Guide. Differs in: if neither identifies the axes, their order in the file does, with x
 * last. Units are labels: only those of heights, and of pressures for heights, are converted.
 *
 * Call order: cf_open; cf_find, or cf_each and cf_field_read; cf_axes; cf_values for each time;
 * cf_close. Functions that can fail return false with a message in err. A caller must link
 * libnetcdf, and libproj if it is there.
 */
#ifndef STORMRING_CF_H
#define STORMRING_CF_H

#include "base/base.h"
#include "grid/grid.h"
#include "projection/projection.h"

#define CF_TEXT 128    /* bytes of a name or text attribute; longer ones are cut */
#define CF_AXES_MAX 16 /* including axes with one element */
#define CF_MISSING_MAX 16

/* One element of a dimension, or all of them. */
struct cf_choice {
    const char *dim;
    size_t length;     /* of its name */
    const char *value; /* an index from 0; or a coordinate, with a point or an exponent; a label */
    bool over;         /* all */
};
struct cf_file {
    int root;                       /* netcdf's id of the root group */
    int status;                     /* first failure of libnetcdf since the last cf_look */
    const struct cf_choice *choice; /* of the caller, for fields that have these dimensions */
    size_t n_choices;
};

enum cf_kind { CF_X, CF_Y, CF_Z, CF_T, CF_NONE /* one element, such as an ensemble member */ };

struct cf_axis {
    enum cf_kind kind;
    bool down; /* increases downwards: cf_axes negates it, so that z points up */
    size_t n;
    double *at; /* as in the file; NULL if there is no coordinate variable */
    char name[CF_TEXT], units[CF_TEXT];
    bool pressure;  /* its units are those of pressure */
    bool rotated;   /* of a rotated sphere, by their standard name */
    bool member;    /* counts members of an ensemble, by its standard name */
    bool made;      /* not in the file: the one level of a field of x and y */
    bool staggered; /* its nodes are the middles between those of the file */
    bool chosen;    /* one element of it was chosen: pick */
    bool over;      /* or all of them: members */
    size_t pick;
    int dim;    /* netcdf's id of the dimension */
    int in, id; /* group and variable of the coordinates, if `at` */
};

/* Conversion of stored numbers to values. */
struct cf_packing {
    int type;            /* netcdf's type */
    bool unsigned_too;   /* stored as signed, interpreted as unsigned */
    bool valid_unpacked; /* valid_min, valid_max apply to values, not to stored numbers */
    double scale, offset, valid_min, valid_max;
    double missing[CF_MISSING_MAX]; /* stored numbers that mean "missing" */
    size_t n_missing;
    const char *bad; /* the attribute that is not one number, as it must be; NULL: none */
};

struct cf_field {
    int group, id, n_axes;
    struct cf_axis axis[CF_AXES_MAX]; /* in file order */
    struct cf_packing packing;
    char name[CF_TEXT], units[CF_TEXT], long_name[CF_TEXT];
    bool difference;             /* of temperatures: units_metadata says so */
    char plane[PROJECTION_TEXT]; /* of x and y, if it is known; "" */
    double radian_m; /* metres on the plane for a radian of x or y; 0: they are no angles */
    char plane_fault[ERR_BYTES]; /* why it is not, if the file states one */
};

bool cf_open(const char *path, struct cf_file *c, char err[ERR_BYTES]);
void cf_close(struct cf_file *c);

/*
 * Reads variable `id` of a group. False if it is not a field on a rectilinear grid, with x, y, z
 * and optionally time, or without z: then that has one level. Call cf_field_free in either case.
 */
bool cf_field_read(struct cf_file *c, int group, int id, struct cf_field *f, char err[ERR_BYTES]);
/* The same for the variable with this name of n characters: "U", "group/U" or "/group/U". */
bool cf_find(
    struct cf_file *c, const char *name, size_t n, struct cf_field *f, char err[ERR_BYTES]);
/* True if there is a variable of this name. */
bool cf_knows(const struct cf_file *c, const char *name);
void cf_field_free(struct cf_field *f);
/* NULL if the field has no such axis. */
const struct cf_axis *cf_axis_of(const struct cf_field *f, enum cf_kind kind);
/* True if element i of the axis stands for an interval, which its `bounds` state. */
bool cf_interval(struct cf_file *c, const struct cf_axis *a, size_t i, double bounds[2]);
/* True if x is periodic after 360: its units are degrees, or it has none. */
bool cf_axis_is_longitude(const struct cf_axis *a);
/* The members of a field: elements of the dimension of which all were chosen; 1: there is none. */
size_t cf_members(const struct cf_field *f);
/* True if levels without a unit have the usual numbers of pressures in hPa. */
bool cf_looks_like_hectopascals(const struct cf_axis *z);
bool cf_same_axes(const struct cf_field *a, const struct cf_field *b);

/* Calls visit for all variables with at least two dimensions, of all groups, in file order, but not
 * for bounds of coordinates, and counts them. path is the variable's full name. */
typedef void cf_visit(struct cf_file *c, int group, int id, const char *path, void *arg);
bool cf_each(struct cf_file *c, cf_visit *visit, void *arg, size_t *count, char err[ERR_BYTES]);

/* Makes a grid with these axes, ascending, and room for values. The caller frees it. */
bool cf_axes(const struct cf_field *f, struct grid *g, char err[ERR_BYTES]);
/* Reads the values of one time and member into a grid with the field's axes. Missing values become
 * NaN. Needs memory for one slab of values besides the grid. */
bool cf_values(struct cf_file *c, const struct cf_field *f, size_t time, size_t member,
    struct grid *g, char err[ERR_BYTES]);

/* ---- heights -------------------------------------------------------------------------------- */

/* A variable of x, y and perhaps time. */
struct cf_layer {
    int group, id;
    double unit;    /* to multiply by */
    bool logarithm; /* it is ln of that */
};
struct cf_ocean;
/* The variables from which the height of each node of a field comes. */
struct cf_heights {
    enum {
        CF_HEIGHTS_NONE,
        CF_HEIGHTS_GEOPOTENTIAL,
        CF_HEIGHTS_HYBRID,
        CF_HEIGHTS_OROGRAPHY,
        CF_HEIGHTS_OCEAN, /* levels that follow the bottom of the sea */
        CF_HEIGHTS_SEA    /* a is the pressure in the sea, in Pa */
    } kind;
    struct cf_field geopotential, base; /* base: to be added, if it has axes */
    double metres;                      /* of a unit of the geopotential */
    double *a, *b; /* hybrid: the pressure is a[k] + b[k] * surface pressure, in Pa; or the height
                    * is that with the height of the ground, in metres; b NULL: a alone */
    struct cf_layer surface; /* its pressure in Pa, or its height in metres */
    double *b2;              /* NULL: none; times a second height of the ground is added */
    struct cf_layer second;
    struct cf_ocean *ocean; /* of CF_HEIGHTS_OCEAN */
};
/*
 * Looks for heights: a geopotential (height) with the axes of the field, or the surface pressure or
 * height and the coefficients of its hybrid or sigma levels, or pressures in the sea. `standard`:
 * no geopotential. False with a message in err if the levels name variables that cannot be used, or
 * are pressures neither of air nor of the sea. Call cf_heights_free in any case.
 */
bool cf_heights_find(struct cf_file *c, const struct cf_field *f, bool standard,
    struct cf_heights *h, char err[ERR_BYTES]);
void cf_heights_free(struct cf_heights *h);
/* Reads, at one time, metres, or for CF_HEIGHTS_HYBRID and CF_HEIGHTS_SEA pressures in Pa, into a
 * grid with the axes of the field. */
bool cf_heights_values(struct cf_file *c, const struct cf_field *f, const struct cf_heights *h,
    size_t time, size_t member, struct grid *g, char err[ERR_BYTES]);

#endif
