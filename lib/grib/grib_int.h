/* Private to lib/grib. */
#ifndef STORMRING_GRIB_INT_H
#define STORMRING_GRIB_INT_H

#include "grib/grib.h"

#include <eccodes.h>

/* The messages of a file, one after the other. */
struct gb_file {
    FILE *f;
    codes_handle *h; /* the message; NULL at the end, and after a failure */
    size_t number;   /* of it, from 0 */
};
bool gb_open(const char *path, struct gb_file *in, char err[ERR_BYTES]);
/* The first, or the next one. */
bool gb_next(struct gb_file *in, char err[ERR_BYTES]);
void gb_close(struct gb_file *in);

/* What a key says; 0 and NaN where it is not there. */
long gb_long(const codes_handle *h, const char *key);
double gb_real(const codes_handle *h, const char *key);

#endif
