/* Private to lib/cf. */
#ifndef STORMRING_CF_INT_H
#define STORMRING_CF_INT_H

#include "cf/cf.h"

/* Remembers the first failure: callers go on with what is harmless, and look at c->status later. */
static inline bool cf_did(struct cf_file *c, int status)
{
    if (status && !c->status) c->status = status;
    return !status;
}
/* False, with the first thing that libnetcdf refused in err, which is then forgotten; true where it
 * refused nothing. */
bool cf_look(struct cf_file *c, char err[ERR_BYTES]);

/* The text of an attribute, the first if there are several; "" where there is none. */
void cf_text(struct cf_file *c, int group, int id, const char *name, char out[CF_TEXT]);
void cf_packing(struct cf_file *c, int group, int id, struct cf_packing *p);
/* Are the variable's numbers ones at all? */
bool cf_is_numeric(const struct cf_packing *p);
/* A stored number's value; NaN where it is missing. */
double cf_unpack(const struct cf_packing *p, double stored);

/* False, with the reason in err, where it cannot be the axis of a grid. */
bool cf_axis_read(struct cf_file *c, int group, int dim, struct cf_axis *a, char err[ERR_BYTES]);
/*
 * Those that do not say what they are get what is left, in the order that CF recommends: t z y x;
 * those of one element nothing. False, with the reason in err, where not each of x, y and z is
 * there once.
 */
bool cf_tell_axes_apart(struct cf_field *f, char err[ERR_BYTES]);

#endif
