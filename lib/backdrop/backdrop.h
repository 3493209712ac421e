/*
 * backdrop: what is behind a picture of a grid, as a gnuplot script: the grid's lowest plane as a
 * map, with lines such as coasts; the edges of the grid, the graticule, heights; a legend of the
 * colours. All is projected here, by the specification's camera; gnuplot gets pixels. No I/O.
 */
#ifndef STORMRING_BACKDROP_H
#define STORMRING_BACKDROP_H

#include "base/base.h"
#include "spec/spec.h"

#define BACKDROP_ERR ERR_BYTES /* bytes of a message: "name:line: what, expected what" */

struct backdrop {
    const struct grid *grid;
    const struct spec *spec;
    uint32_t w, h;          /* of the picture */
    const char *title;      /* of the legend */
    const char *flat;       /* unit of x and y; NULL: they are longitude and latitude, in degrees */
    const char *unit;       /* of heights */
    bool down;              /* heights are negated depths or pressures, and read as those */
    const char *lines_name; /* for messages */
    const char *lines;      /* NULL, or text: backdrop(1) */
};

/* What a grid's title says of its scalar, or of an axis; stormring-grid(5). */
struct backdrop_named {
    char name[GRID_NAME], unit[GRID_NAME];
    bool down; /* it is negated */
};
/* axis: 'x', 'y', 'z' or 't', or 0 for the scalar. False where the title does not say. */
bool backdrop_title(const char *title, char axis, struct backdrop_named *n);

/* Appends a script that writes a PNG of w x h to standard output. 0, or -1 with text in err where
 * the lines are not such. */
int backdrop_write(const struct backdrop *b, struct buf *out, char err[BACKDROP_ERR]);

#endif
