/*
 * convert: what the programs that turn files of fields into grids have in common: what they are
 * asked for, and the way of each time's grid to its file.
 *
 * convert_option for each letter that getopt finds, convert_operands after the last; then, where
 * nothing but a list is wanted, that; else convert_request_parse and convert. All but the parser of
 * requests end the program, with a message, where it cannot go on.
 */
#ifndef STORMRING_CONVERT_H
#define STORMRING_CONVERT_H

#include "base/base.h"
#include "grid/grid.h"

struct convert_options {
    const char *out; /* -o: a file, %d in it is the time's index; NULL: standard output */
    bool round;      /* -c: the first column again, where longitudes come round to it */
    bool list;       /* -l */
    bool every;      /* -t all */
    size_t time;     /* -t INDEX */
    const char *file, *what;
};

/* One of -c, -h, -l, -o and -t; any other letter is refused with the usage. */
void convert_option(
    struct convert_options *o, int letter, const char *argument, const char *usage_text);
/* The file, and, but with -l, what is wanted of it; do the options go together? */
void convert_operands(struct convert_options *o, int n, char **operand, const char *usage_text);

/* What is wanted: "U", or "speed=hypot(U,V)". */
struct convert_request {
    char name[GRID_NAME]; /* of the scalar: "U", without what is before a slash; "speed" */
    const char *part[2];    /* into the text */
    int length[2], n;
};
/* Blanks do not matter. False where it is neither. */
bool convert_request_parse(const char *text, struct convert_request *r);

/* Where grids come from. */
struct converter {
    const char *what, *name; /* for messages; of the scalar */
    bool degrees;            /* x is, of longitude */
    size_t times;
    void *ctx; /* of the functions */
    /* The axes, and room for values. */
    void (*axes)(void *ctx, struct grid *g);
    /* The values of one time. */
    void (*values)(void *ctx, size_t time, struct grid *g);
    /* What is along the grid's axes, in which units; stormring-grid(5). */
    void (*describe)(const void *ctx, size_t time, struct buf *title);
};
/* The grids of the times that are wanted, each to where it belongs. */
void convert(const struct convert_options *o, const struct converter *c);

#endif
