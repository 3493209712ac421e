/*
 * convert: the part that nc2vtk and grib2vtk share: options, requests, and one output file per
 * time.
 *
 * Call order: convert_option for each letter from getopt; convert_operands after the last. Then
 * list, if o->list, with convert_table_*; otherwise convert_request_parse and convert. On failure
 * all functions except convert_request_parse end the program with a message.
 */
#ifndef STORMRING_CONVERT_H
#define STORMRING_CONVERT_H

#include "base/base.h"
#include "grid/grid.h"

struct convert_options {
    const char *out; /* -o: a file; %d stands for the time's index; NULL: standard output */
    bool round;  /* -c: repeat the first column at the end, if longitudes go all the way round */
    bool list;   /* -l */
    bool every;  /* -t all */
    size_t time; /* -t INDEX */
    const char *file, *what;
};

/* Handles -c, -h, -l, -o and -t; any other letter prints the usage and exits. */
void convert_option(
    struct convert_options *o, int letter, const char *argument, const char *usage_text);
/* Takes the file and, without -l, the request. Checks that the options go together. */
void convert_operands(struct convert_options *o, int n, char **operand, const char *usage_text);

/* A request: "U", or "speed=hypot(U,V)". */
struct convert_request {
    char name[GRID_NAME]; /* name of the scalar: "U", without the part before a slash; "speed" */
    const char *part[2];  /* points into the text */
    int length[2], n;
};
/* Blanks are ignored. False if the text is neither form. */
bool convert_request_parse(const char *text, struct convert_request *r);

/* The source of grids. */
struct converter {
    const char *what, *name; /* what: for messages; name: of the scalar */
    bool degrees;            /* x is longitude in degrees */
    size_t times;
    void *ctx; /* passed to the functions */
    /* Makes the grid's axes and room for values. */
    void (*axes)(void *ctx, struct grid *g);
    /* Reads the values of one time. */
    void (*values)(void *ctx, size_t time, struct grid *g);
    /* Writes names and units of the grid's axes; see stormring-grid(5). */
    void (*describe)(const void *ctx, size_t time, struct buf *title);
};
/* Writes the grids of the requested times to their files. */
void convert(const struct convert_options *o, const struct converter *c);

/* ---- the contents of a file ----------------------------------------------------------------- */

enum { CONVERT_NAME, CONVERT_SHAPE, CONVERT_UNITS, CONVERT_RANGE, CONVERT_TIMES, CONVERT_ABOUT };
#define CONVERT_COLUMNS 6
#define CONVERT_TEXT 256 /* bytes of a cell */

/* All zero at first. */
struct convert_table {
    struct buf cells, refused;
    size_t width[CONVERT_COLUMNS];
};
/* Adds a row; NULL and "" become "-". */
void convert_table_row(struct convert_table *t, const char *const cell[CONVERT_COLUMNS]);
/* Adds a line below the table. */
void convert_table_refused(struct convert_table *t, const char *name, const char *why);
/* Prints the table, with aligned columns, and frees it. */
void convert_table_print(struct convert_table *t);

/* The least and the greatest value; all zero at first. */
struct convert_range {
    double lo, hi;
    bool any; /* a value is there */
};
void convert_range_add(struct convert_range *r, const struct grid *g);
const char *convert_range_text(const struct convert_range *r, char text[CONVERT_TEXT]);

#endif
