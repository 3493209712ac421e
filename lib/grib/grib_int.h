/* grib_int: private to lib/grib. */
#ifndef STORMRING_GRIB_INT_H
#define STORMRING_GRIB_INT_H

#include "grib/grib.h"

#include <eccodes.h>

/* Iterates over the messages of a file. */
struct gb_file {
    FILE *f;
    codes_handle *h; /* current message; NULL at the end, and after a failure */
    size_t number;   /* number of the current message, from 0 */
};
bool gb_open(const char *path, struct gb_file *in, char err[ERR_BYTES]);
/* Reads the first or the next message. */
bool gb_next(struct gb_file *in, char err[ERR_BYTES]);
void gb_close(struct gb_file *in);

/* The value of a key. If it is missing: 0, or NaN for gb_real. */
long gb_long(const codes_handle *h, const char *key);
double gb_real(const codes_handle *h, const char *key);

#endif
