/* cf_int: private to lib/cf. */
#ifndef STORMRING_CF_INT_H
#define STORMRING_CF_INT_H

#include "cf/cf.h"

/* Records the first failure. Callers continue with harmless work and check c->status later. True if
 * status is success. */
static inline bool cf_did(struct cf_file *c, int status)
{
    if (status && !c->status) c->status = status;
    return !status;
}
/* True if libnetcdf reported no failure. Otherwise false with the first failure in err, which is
 * then cleared. */
bool cf_look(struct cf_file *c, char err[ERR_BYTES]);

/* False with the reason in err if a classic NetCDF file is cut or its header is damaged. */
bool cf_is_whole(const char *path, char err[ERR_BYTES]);
/* A directory is a Zarr store, which libnetcdf opens by this URL. False with a message in err if
 * its path has characters that mean something in a URL. (zarr.c) */
bool cf_zarr_url(const char *path, struct buf *url, char err[ERR_BYTES]);
/* False with a message in err if an array of the open store, in this group or below, is packed. */
bool cf_zarr_check(int id, const char *store, char err[ERR_BYTES]);

/* The text of an attribute, or its first string; "" if there is none. The caller frees the whole
 * text. */
char *cf_whole_text(struct cf_file *c, int group, int id, const char *name);
void cf_text(struct cf_file *c, int group, int id, const char *name, char out[CF_TEXT]);
void cf_packing(struct cf_file *c, int group, int id, struct cf_packing *p);
/* False with the reason in err if values cannot be unpacked. */
bool cf_unpacks(const struct cf_packing *p, const char *name, char err[ERR_BYTES]);
/* True if the variable holds numbers. */
bool cf_is_numeric(const struct cf_packing *p);
/* Converts a stored number to a value; NaN if it is missing. */
double cf_unpack(const struct cf_packing *p, double stored);

/* A unit in another one, which it must be proportional to; 0 if it is not, or if libudunits2 was
 * missing. */
double cf_in_units(const char *unit, const char *of);
/* Degrees to the east or north in a unit of angles: -1 for degrees to the west or to the south. */
double cf_degrees_in(const char *units);

/* Finds the variable of a term, such as "ps" in "a: hyam b: hybm p0: P0 ps: PS". (terms.c) */
bool cf_term(const char *terms, const char *what, char name[CF_TEXT]);
/* Finds a variable in the group or an enclosing one, or by a path: /g/v or g/v. */
bool cf_find_above(int *group, const char *name, int *id);
/* Metres in a unit of a geopotential or its height; 0 if it is none of either. */
double cf_metres_in(const char *units);
/* Multiplies by the metres in a unit of a variable; one without a unit is in metres. False with the
 * reason in err if its unit is no length. */
bool cf_to_metres(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES]);
/* The same for a pressure, in Pa. */
bool cf_to_pascals(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES]);
/* Reads the one number of a variable, in the group or an enclosing one. */
bool cf_number(struct cf_file *c, int group, const char *name, double *out, char err[ERR_BYTES]);
/* Reads a number for each level. A variable with more of them, as those of all levels of a model,
 * is indexed by the levels, which count from 1. */
bool cf_level_numbers(
    struct cf_file *c, const struct cf_axis *z, const char *name, double *out, char err[ERR_BYTES]);
/* Reads a variable at one time, as a layer of g. Its dimensions are those of the field, without
 * z. */
bool cf_layer_read(struct cf_file *c, const struct cf_field *f, const struct cf_layer *h,
    size_t time, size_t member, const struct grid *g, double *layer, char err[ERR_BYTES]);
/* True if the levels follow the bottom of the sea, by a formula. (ocean.c) */
bool cf_is_ocean(struct cf_file *c, const struct cf_axis *z);
/* Finds the terms of that formula. NULL with a message in err if one cannot be used. The caller
 * frees it. */
struct cf_ocean *cf_ocean_find(struct cf_file *c, const struct cf_field *f, char err[ERR_BYTES]);
void cf_ocean_free(struct cf_ocean *o);
/* Reads the heights of all nodes at one time, in metres. */
bool cf_ocean_values(struct cf_file *c, const struct cf_field *f, const struct cf_ocean *o,
    size_t time, size_t member, struct grid *g, char err[ERR_BYTES]);

/* A unit of pressure in Pa; 0 if it is none. */
double cf_in_pascals(const char *unit);
/* Refuses an axis of several elements that is none of x, y, z and time, and says what there is to
 * choose from. */
bool cf_choices(
    struct cf_file *c, const struct cf_field *f, const struct cf_axis *a, char err[ERR_BYTES]);
/* True if the name of the axis, or its standard name, says that it is none of them. */
bool cf_is_other(const struct cf_axis *a);
/* Marks the axes of which the caller has chosen an element. False with a message in err if that is
 * not there. */
bool cf_choose(struct cf_file *c, struct cf_field *f, char err[ERR_BYTES]);
/*
 * Finds whether the levels are pressures in the sea, and then their pressures in Pa, which the
 * caller frees. False with a message in err if the levels are pressures, but neither of air nor of
 * the sea.
 */
bool cf_sea_levels(
    struct cf_file *c, const struct cf_field *f, double **pascals, bool *sea, char err[ERR_BYTES]);

/* False with the reason in err if the dimension cannot be the axis of a grid. */
bool cf_axis_read(struct cf_file *c, int group, int dim, struct cf_axis *a, char err[ERR_BYTES]);
/*
 * Assigns kinds to axes that have none: first by name, then the remaining kinds in the order that
 * CF recommends: t z y x. Axes with one element, or a chosen one, stay CF_NONE; one beside a longer
 * axis of its kind becomes that. False with the reason in err unless x, y and z each occur once.
 */
bool cf_tell_axes_apart(struct cf_file *c, struct cf_field *f, char err[ERR_BYTES]);
/* Finds the plane of the field's grid mapping, if it states one. (mapping.c) */
void cf_mapping_read(struct cf_file *c, struct cf_field *f);
/* Makes x and y metres on the plane; or forgets the plane, if they are no lengths. On a rotated
 * sphere they are degrees. */
void cf_mapping_use(struct cf_field *f);
/* Reads an attribute of one or two numbers. Returns their count; 0 if it is none. (packing.c) */
size_t cf_reals(struct cf_file *c, int group, int id, const char *name, double out[2]);
/* Makes x and y of the longitude and latitude of each node, if these are rectilinear. Otherwise
 * plane_fault says why. (curvilinear.c) */
void cf_curvilinear(struct cf_file *c, struct cf_field *f);
/* Takes the middles of staggered axes. (wrf.c) */
void cf_wrf_center(struct cf_field *f);
/* Writes the plane of the file's global attributes, if they state one. */
void cf_wrf_plane(struct cf_file *c, char text[PROJECTION_TEXT]);
/* Reads the times of a dimension that has no coordinates from XTIME or Times. */
void cf_wrf_times(struct cf_file *c, int group, struct cf_axis *a);
/* Adds and takes away whole circles, so that longitudes that cross the end of their range, such as
 * 355, 0, 5, ascend or descend. */
void cf_unwrap(struct cf_axis *a);

#endif
