/*
 * backdrop: draws the background of a picture of a grid: the grid's lowest plane as a map, with
 * lines such as coasts; the grid's edges, the graticule, heights. The specification's camera
 * projects everything here, into a list of lines, areas and texts in pixels. backdrop_write makes a
 * gnuplot script of the list; lib/paint paints it. Below the picture is a strip with a legend of
 * the colours and a caption (title and time), which overlap nothing else there. No I/O.
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
    const char *proj;       /* with flat: a PROJ string of the plane; NULL: not known */
    const char *unit;       /* unit of heights */
    const char *levels;     /* in the place of a unit: the name of the levels, before each number */
    bool down;              /* heights are negated depths or pressures, and are labelled as those */
    const char *time;       /* of the grid; "": not known */
    const char *lines_name; /* for messages */
    const char *lines;      /* NULL, or text in the format of backdrop(1) */
};

/* The names in a grid's title. */
#define BACKDROP_NAMED (2 * GRID_NAME + 16)
struct backdrop_names {
    struct grid_named scalar, x, z;
    char title[2 * BACKDROP_NAMED], proj[GRID_TITLE];
};
/* Sets title, flat, proj, unit, levels and down from the title of b's grid, which n keeps. title:
 * that of the legend, or NULL. unit: of heights, with a minus sign for depths and pressures, or
 * NULL. */
void backdrop_name(
    struct backdrop *b, const char *title, const char *unit, struct backdrop_names *n);
/* True if the grid's title says that x and y are longitude and latitude. */
bool backdrop_on_globe(const struct grid *g);
/* The line before lines in the coordinates of g: "> globe", "> plane" if the plane is known, or "",
 * with a line's end. */
const char *backdrop_head(const struct grid *g);
/* The line after them: "> globe" if the plane is known, so that places may follow; or "". */
const char *backdrop_tail(const struct grid *g);
/* True if the maps of these grids are equal except for the time. */
bool backdrop_alike(const struct grid *a, const struct grid *b);

/* 1, 2 or 5 times a power of ten, so that the range has at most n steps. */
double backdrop_step(double range, int n);

/* The height of the strip in pixels. */
uint32_t backdrop_strip(const struct backdrop *b);

/* ---- what is drawn --------------------------------------------------------------------------- */

/* In pixels: x from the left edge, y upwards from the lower edge of the picture; y < 0 in the
 * strip. NaN: a line or an area ends, and the next point begins another one. */
struct backdrop_at {
    double x, y;
};
/* They are drawn in this order: each kind over those before it, otherwise as in the list. */
enum backdrop_kind {
    BACKDROP_PLANE,     /* areas: the plane of the map */
    BACKDROP_AREA,      /* land or water */
    BACKDROP_GRATICULE, /* lines */
    BACKDROP_LINES,     /* coasts */
    BACKDROP_NUMBERED,  /* lines with texts, such as isobars */
    BACKDROP_EDGES,     /* of the grid */
    BACKDROP_DOTS,      /* discs around points */
    BACKDROP_PATCH,     /* a rectangle between two corners */
    BACKDROP_BOX,       /* its border */
    BACKDROP_LABEL      /* a text, centred in height at its point */
};
struct backdrop_mark {
    enum backdrop_kind kind;
    uint32_t rgb;    /* sRGB, 0xrrggbb; a label is black */
    double width;    /* of lines, and across discs, in pixels */
    size_t first, n; /* its points in the list */
    size_t text;     /* where the text of a label begins */
    int align;       /* the point is its left end (-1), its middle (0) or its right end (1) */
    double turn;     /* degrees: a label is turned around its point to the left, from -90 to 90 */
    bool boxed;      /* a label is on a translucent box: it may be over any colour */
};
struct backdrop_list {
    double em;  /* pixels: the size of the font, sans serif */
    bool boxed; /* while it grows: of the next labels */
    struct backdrop_mark *mark;
    struct backdrop_at *at;
    size_t n_marks, n_at;
    struct buf text; /* each ends with a byte 0 */
};
#define BACKDROP_PAPER 0xf6f6f6u /* the colour under all, and of the boxes, */
#define BACKDROP_BOXED .62       /* which are so opaque */

/* The lines of b, read once: they are on the globe, or on a plane if b->flat. With b->proj, those
 * that are on the globe are put on the plane, around b->grid. NULL with a message in err if they
 * are invalid; lines NULL is none. */
struct backdrop_lines;
struct backdrop_lines *backdrop_lines_read(const struct backdrop *b, char err[BACKDROP_ERR]);
void backdrop_lines_free(struct backdrop_lines *l);
/* True if some lines, areas or places are at a height. */
bool backdrop_lines_raised(const struct backdrop_lines *l);

#define BACKDROP_MAP 1u     /* plane, areas and lines */
#define BACKDROP_AXES 2u    /* graticule, edges and labels */
#define BACKDROP_LEGEND 4u  /* in the strip */
#define BACKDROP_CAPTION 8u /* likewise */
#define BACKDROP_RAISED 16u /* lines and places at heights */
#define BACKDROP_ALL 31u
#define BACKDROP_CLIPPED 32u /* the map without what is outside of the picture */
/* Puts these parts into the list, in the place of what it holds. b->lines do not count. */
void backdrop_draw(const struct backdrop *b, struct backdrop_lines *lines, unsigned parts,
    struct backdrop_list *list);
void backdrop_list_free(struct backdrop_list *list);

/* ---- as a gnuplot script --------------------------------------------------------------------- */

/* Appends a script that writes these parts as a PNG to standard output: w pixels wide, h and the
 * strip high; transparent where nothing is drawn if they are BACKDROP_RAISED only. Returns 0, or -1
 * with a message in err if the lines are invalid. */
int backdrop_write(
    const struct backdrop *b, unsigned parts, struct buf *out, char err[BACKDROP_ERR]);
/* Appends a script that writes the caption as a PNG of the same width: the bottom of the strip. */
void backdrop_write_caption(const struct backdrop *b, struct buf *out);

/* ---- the time -------------------------------------------------------------------------------- */

/* Writes the time that a grid's title states: the date and time in UTC, or of another calendar with
 * its name; or else name, number and unit; "" if it states none. */
#define BACKDROP_TIME (2 * GRID_NAME + 2)
void backdrop_time(const char *title, char text[BACKDROP_TIME]);

#endif
