/*
 * cf: variables of NetCDF files as fields on rectilinear grids, through libnetcdf.
 *
 * The conventions are those of "NetCDF Climate and Forecast (CF) Metadata Conventions" 1.10 (2022)
 * and of the NetCDF Users' Guide before them. Differs in: where neither says which axis is which,
 * the order in the file does, the last being x. Units are labels: nothing is converted.
 *
 * cf_open; then cf_find, or cf_each and cf_field_read; cf_axes, and cf_values for each time;
 * cf_close. Functions that can fail return false with a text in err. Only what links libnetcdf may
 * call them.
 */
#ifndef STORMRING_CF_H
#define STORMRING_CF_H

#include "base/base.h"
#include "grid/grid.h"

#define CF_TEXT 128    /* bytes of a name or an attribute that is text; longer ones are cut */
#define CF_AXES_MAX 16 /* with those of one element */
#define CF_MISSING_MAX 16

struct cf_file {
    int root;   /* netcdf's id */
    int status; /* the first thing that libnetcdf refused since it was last looked at */
};

enum cf_kind { CF_X, CF_Y, CF_Z, CF_T, CF_NONE /* one element, that of an ensemble perhaps */ };

struct cf_axis {
    enum cf_kind kind;
    bool down; /* increases downwards: cf_axes negates it, so that z is up */
    size_t n;
    double *at; /* as in the file; NULL where there is no coordinate variable */
    char name[CF_TEXT], units[CF_TEXT];
};

/* How stored numbers become values. */
struct cf_packing {
    int type;            /* netcdf's */
    bool unsigned_too;   /* stored as signed, meant unsigned */
    bool valid_unpacked; /* valid_min, valid_max are of values, not of stored numbers */
    double scale, offset, valid_min, valid_max;
    double missing[CF_MISSING_MAX]; /* stored numbers that are none */
    size_t n_missing;
};

struct cf_field {
    int group, id, n_axes;
    struct cf_axis axis[CF_AXES_MAX]; /* in the order of the file */
    struct cf_packing packing;
    char name[CF_TEXT], units[CF_TEXT], long_name[CF_TEXT];
};

bool cf_open(const char *path, struct cf_file *c, char err[ERR_BYTES]);
void cf_close(struct cf_file *c);

/*
 * Variable `id` of a group: false where it is no field on a rectilinear grid, of x, y, z and
 * perhaps time. To be freed in either case.
 */
bool cf_field_read(struct cf_file *c, int group, int id, struct cf_field *f, char err[ERR_BYTES]);
/* The same of the variable with this name of n characters: "U", "group/U" or "/group/U". */
bool cf_find(
    struct cf_file *c, const char *name, size_t n, struct cf_field *f, char err[ERR_BYTES]);
void cf_field_free(struct cf_field *f);
/* NULL where it has none. */
const struct cf_axis *cf_axis_of(const struct cf_field *f, enum cf_kind kind);
/* Does it come round after 360? x in units of degrees, or without any. */
bool cf_axis_is_longitude(const struct cf_axis *a);
bool cf_same_axes(const struct cf_field *a, const struct cf_field *b);

/* The variables of two dimensions and more, of all groups, in the file's order; path is the
 * variable's whole name. */
typedef void cf_visit(struct cf_file *c, int group, int id, const char *path, void *arg);
bool cf_each(struct cf_file *c, cf_visit *visit, void *arg, char err[ERR_BYTES]);

/* A grid with these axes, ascending, and values that are yet to come; the caller frees it. */
bool cf_axes(const struct cf_field *f, struct grid *g, char err[ERR_BYTES]);
/*
 * The values of one time into a grid with the field's axes; where `combine`, hypot of what is there
 * and them. Missing values become NaN. Needs room for one slab of values beside the grid.
 */
bool cf_values(struct cf_file *c, const struct cf_field *f, size_t time, struct grid *g,
    bool combine, char err[ERR_BYTES]);

#endif
