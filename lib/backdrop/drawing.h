/* drawing: declarations that the files of backdrop share. */
#ifndef STORMRING_BACKDROP_DRAWING_H
#define STORMRING_BACKDROP_DRAWING_H

#include "backdrop/backdrop.h"

#define PAGE 0.92       /* linear light of the page */
#define PAPER "#f6f6f6" /* the same in sRGB */
#define SEA "#e3ebf1"
#define LAND "#d9d9cf"
#define COAST "#76828a"
#define COAST_WIDTH .6
#define GRATICULE "#c3ccd3"
#define FRAME "#8a949b"

struct drawing {
    const struct backdrop *b;
    struct buf *out;
    struct camera camera;
    double w, h;         /* pixels */
    double lo[3], hi[3]; /* the grid's box in its own coordinates; in z, lo is the lower side */
};

/* ---- points and text (drawing.c) ------------------------------------------------------------ */

void drawing_init(struct drawing *s, const struct backdrop *b, struct buf *out);
/* Projects a point in grid coordinates to pixels, y upwards as in gnuplot. False if it is not in
 * front of the eye. */
bool backdrop_project(const struct drawing *s, double x, double y, double z, double xy[2]);
/* Writes a point of a line in a data block. Breaks the line if the point is invisible. */
void backdrop_point(const struct drawing *s, double x, double y, double z);
void backdrop_label(const struct drawing *s, const char *text, const double xy[2], const char *how);

/* The ticks in a range: i * step for first <= i <= last. None if rounding would merge them. */
struct ticks {
    double step;
    int first, last;
};
struct ticks backdrop_ticks(double lo, double hi, double step);
/* 1, 2 or 5 times a power of ten, so that the range has at most n steps. */
double backdrop_step(double range, int n);

/* ---- parts of the drawing (map.c, legend.c) ------------------------------------------------ */

void backdrop_graticule(const struct drawing *s);
void backdrop_edges(const struct drawing *s);
void backdrop_labels(const struct drawing *s);
void backdrop_legend(const struct drawing *s);

#endif
