/*
 * backdrop: writes the background of a picture of a grid as a gnuplot script: the grid's lowest
 * plane as a map, with lines such as coasts; the grid's edges, the graticule, heights. The
 * specification's camera projects everything here, so gnuplot gets pixels. Below the picture is a
 * strip with a legend of the colours and a caption (title and time), which overlap nothing else
 * there. No I/O.
 */
#ifndef STORMRING_BACKDROP_H
#define STORMRING_BACKDROP_H

#include "base/base.h"
#include "spec/spec.h"

#define BACKDROP_DEGREE "°"    /* the unit of a rotated sphere, which is treated as a plane */
#define BACKDROP_ERR ERR_BYTES /* bytes of a message: "name:line: what, expected what" */

struct backdrop {
    const struct grid *grid;
    const struct spec *spec;
    uint32_t w, h;          /* picture size in pixels */
    const char *title;      /* title of the legend */
    const char *flat;       /* unit of x and y; NULL: longitude and latitude in degrees */
    const char *unit;       /* unit of heights */
    const char *levels;     /* in the place of a unit: the name of the levels, before each number */
    bool down;              /* heights are negated depths or pressures, and are labelled as those */
    const char *time;       /* of the grid; "": not known */
    const char *lines_name; /* for messages */
    const char *lines;      /* NULL, or text in the format of backdrop(1) */
};

/* The names in a grid's title. */
struct backdrop_names {
    struct grid_named scalar, x, z;
    char title[2 * GRID_NAME + 16];
};
/* Sets title, flat, unit, levels and down from the title of b's grid, which n keeps. title: that of
 * the legend, or NULL. unit: of heights, with a minus sign for depths and pressures, or NULL. */
void backdrop_name(
    struct backdrop *b, const char *title, const char *unit, struct backdrop_names *n);
/* True if the maps of these grids are equal except for the time. */
bool backdrop_alike(const struct grid *a, const struct grid *b);

/* The height of the strip in pixels. */
uint32_t backdrop_strip(const struct backdrop *b);
/* Appends a script that writes a PNG to standard output: w pixels wide, h and the strip high. The
 * caption may be left out. Returns 0, or -1 with a message in err if the lines are invalid. */
int backdrop_write(const struct backdrop *b, bool caption, struct buf *out, char err[BACKDROP_ERR]);
/* Appends a script that writes the caption as a PNG of the same width: the bottom of the strip. */
void backdrop_write_caption(const struct backdrop *b, struct buf *out);

/* Writes the time that a grid's title states: the date and time in UTC, or else name, number and
 * unit; "" if it states none. */
#define BACKDROP_TIME (2 * GRID_NAME + 2)
void backdrop_time(const char *title, char text[BACKDROP_TIME]);

#endif
