/*
 * backdrop: writes the background of a picture of a grid as a gnuplot script: the grid's lowest
 * plane as a map, with lines such as coasts; the grid's edges, the graticule, heights; a legend of
 * the colours. The specification's camera projects everything here, so gnuplot gets pixels. No I/O.
 */
#ifndef STORMRING_BACKDROP_H
#define STORMRING_BACKDROP_H

#include "base/base.h"
#include "spec/spec.h"

#define BACKDROP_ERR ERR_BYTES /* bytes of a message: "name:line: what, expected what" */

struct backdrop {
    const struct grid *grid;
    const struct spec *spec;
    uint32_t w, h;          /* picture size in pixels */
    const char *title;      /* title of the legend */
    const char *flat;       /* unit of x and y; NULL: longitude and latitude in degrees */
    const char *unit;       /* unit of heights */
    bool down;              /* heights are negated depths or pressures, and are labelled as those */
    const char *lines_name; /* for messages */
    const char *lines;      /* NULL, or text in the format of backdrop(1) */
};

/* Appends a script that writes a PNG of w x h to standard output. Returns 0, or -1 with a message
 * in err if the lines are invalid. */
int backdrop_write(const struct backdrop *b, struct buf *out, char err[BACKDROP_ERR]);

#endif
