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
/* Opens the file at the message with a number. */
bool gb_open_at(const char *path, size_t number, struct gb_file *in, char err[ERR_BYTES]);
void gb_close(struct gb_file *in);

/* The plane of a grid, its first point there, and from each node to the next one in the order of
 * scanning. text is empty if the plane is not known, and the first point then usually 0. */
struct gb_plane {
    char text[PROJECTION_TEXT];
    double x, y, step[2]; /* in metres */
};
void gb_find_plane(const codes_handle *h, const char *kind, struct gb_plane *p);

/* The value of a key. If it is missing: 0, or NaN for gb_real. */
long gb_long(const codes_handle *h, const char *key);
double gb_real(const codes_handle *h, const char *key);

/* The order of scanning: rows, and columns. What a satellite sees may be stated upside down. */
bool gb_runs_west(const codes_handle *h);
bool gb_runs_north(const codes_handle *h);

/* "" if the key is missing. */
void gb_text(const codes_handle *h, const char *key, char *out, size_t room);
/* Reads the keys by which messages are chosen. */
void gb_read_choices(const codes_handle *h, size_t number, struct gb_entry *e);
/* True if the message counts. */
bool gb_counts(const codes_handle *h, size_t number, const struct gb_where *where, size_t n,
    struct gb_entry *e);
/* Refuses a stack of which two messages have one level and time, and says by which keys they
 * differ. */
bool gb_refuse(const struct gb_stack *s, const struct gb_entry *e, char err[ERR_BYTES]);
/* True if the two have one grid, perhaps in other editions of GRIB, which round differently. */
bool gb_same_grid(const struct gb_entry *a, const struct gb_entry *b);

#endif
